// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/OldRegion.hh"

#include <algorithm>
#include <numeric>
#include <utility>

#include "Distributed/Buffer.hh"
#include "Distributed/OwnItems.hh"
#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"

namespace hfr::mpi {
namespace {

/// Each once, in the order of numbers. All records of one number are equal.
template <class Record>
void sort_by_number(std::vector<Record>& records) {
  std::ranges::sort(records, {}, &Record::number);
  const auto is_same = [](const Record& a, const Record& b) { return a.number == b.number; };
  records.erase(std::unique(records.begin(), records.end(), is_same), records.end());
}

template <class Handle, class Record>
Handle handle_at(const std::vector<Record>& records, std::uint64_t number) {
  const auto at = std::ranges::lower_bound(records, number, {}, &Record::number);
  return at != records.end() && at->number == number ? Handle(at - records.begin()) : Handle();
}

}  // namespace

OldRegion::OldRegion(const DistributedMesh& old, std::function<bool(CellHandle)> is_changed,
                     par::Policy policy)
    : old_(old),
      has_changed_(std::move(is_changed)),
      policy_(policy),
      own_stars_(old.part(), own_vertices(old), policy) {
  for (CellHandle c : own_cells(old))
    if (has_changed_(c)) own_changed_.push_back(c);
  own_boxes_.reserve(own_changed_.size());
  for (CellHandle c : own_changed_) own_boxes_.emplace_back(points_of(old.part(), c));
  std::vector<Index> all(own_changed_.size());
  std::iota(all.begin(), all.end(), Index{0});
  own_tree_ = BoxTree(own_boxes_, std::move(all));
}

VertexHandle OldRegion::vertex_at(std::uint64_t number) const {
  return handle_at<VertexHandle>(vertices_, number);
}

CellHandle OldRegion::cell_at(std::uint64_t number) const { return handle_at<CellHandle>(cells_, number); }

int OldRegion::owner(CellHandle c) const {
  const auto& v = mesh_.cell(c).v;
  return owner(std::min(std::min(v[0], v[1]), std::min(v[2], v[3])));
}

void OldRegion::ask_for_stars(std::vector<Named> vertices) {
  Comm& comm = old_.comm();
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::erase_if(vertices, [&](const Named& v) { return std::ranges::binary_search(whole_, v.number); });
  std::vector<std::vector<std::uint64_t>> asked(comm.n_ranks());
  for (const Named& v : vertices) asked[static_cast<std::size_t>(v.owner)].push_back(v.number);
  std::vector<Packer> to(comm.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    if (!asked[r].empty()) to[r].put_all(asked[r]);
  const Comm::Exchanged came = comm.exchange(to, vertices.size());
  if (came.sum == 0) return;
  std::vector<Packer> answers(comm.n_ranks());
  for (const Comm::Message& message : came.messages) {
    std::vector<CellHandle> cells;
    for (std::uint64_t number : Unpacker(message.bytes).get_all<std::uint64_t>()) {
      const VertexHandle v = old_.vertex_at(number);
      if (!v.is_valid() || !old_.is_own(v))
        throw InternalError("a rank was asked for a star that is not its own");
      const auto star = own_stars_.of(v);
      cells.insert(cells.end(), star.begin(), star.end());
    }
    pack(std::move(cells), answers[static_cast<std::size_t>(message.from)]);
  }
  for (const Named& v : vertices) whole_.push_back(v.number);
  std::ranges::sort(whole_);
  take(answers);
}

void OldRegion::ask_for_changed(std::span<const TetBox> boxes) {
  Comm& comm = old_.comm();
  struct Room {  // round the changed cells of a rank
    TetBox box;
    std::uint64_t n = 0;
  };
  Room mine;
  mine.n = own_boxes_.size();
  if (mine.n > 0) mine.box = own_boxes_.front();
  for (const TetBox& box : own_boxes_) mine.box.add(box);
  const std::vector<Room> rooms = comm.all_gather(std::span<const Room>(&mine, 1));
  std::vector<Packer> to(comm.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r) {
    if (rooms[r].n == 0 || static_cast<int>(r) == comm.rank()) continue;
    std::vector<TetBox> near;
    for (const TetBox& box : boxes)
      if (box.meets(rooms[r].box)) near.push_back(box);
    if (!near.empty()) to[r].put_all(near);
  }
  std::vector<Packer> answers(comm.n_ranks());
  for (const Comm::Message& message : comm.exchange(to)) {
    std::vector<std::uint8_t> is_asked_for(own_changed_.size(), 0);
    for (const TetBox& box : Unpacker(message.bytes).get_all<TetBox>())
      own_tree_.find_near(box, [&](Index i) {
        is_asked_for[i] = 1;
        return false;
      });
    std::vector<CellHandle> cells;
    for (std::size_t i = 0; i < is_asked_for.size(); ++i)
      if (is_asked_for[i] != 0) cells.push_back(own_changed_[i]);
    pack(std::move(cells), answers[static_cast<std::size_t>(message.from)]);
  }
  pack(own_changed_, answers[static_cast<std::size_t>(comm.rank())]);
  take(answers);
}

/// Cells with an own vertex: what is behind their faces is here.
void OldRegion::pack(std::vector<CellHandle> cells, Packer& to) const {
  const TetMesh& part = old_.part();
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  if (cells.empty()) return;
  std::vector<CellRecord> cell_records(cells.size());
  std::vector<VertexHandle> corners;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell& cell = part.cell(cells[i]);
    CellRecord& r = cell_records[i];
    r.number = old_.number(cells[i]);
    for (std::size_t k = 0; k < 4; ++k) {
      r.v[k] = old_.number(cell.v[k]);
      const HalfFaceHandle m = cell.mate[k];
      r.mate[k] = kNoNumber;
      if (m.is_valid()) r.mate[k] = 4 * old_.number(cell_of(m)) + static_cast<std::uint64_t>(corner_of(m));
      corners.push_back(cell.v[k]);
    }
    r.is_changed = has_changed_(cells[i]) ? 1 : 0;
  }
  std::ranges::sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::vector<VertexRecord> vertex_records;
  for (VertexHandle v : corners) vertex_records.push_back({old_.number(v), part.point(v), old_.owner(v), 0});
  to.put_all(vertex_records);
  to.put_all(cell_records);
}

void OldRegion::take(std::vector<Packer>& to) {
  const auto came = old_.comm().exchange(to);
  if (came.empty()) return;
  for (const Comm::Message& message : came) {
    Unpacker in(message.bytes);
    in.append_to(vertices_);
    in.append_to(cells_);
  }
  sort_by_number(vertices_);
  sort_by_number(cells_);
  build();
}

void OldRegion::build() {
  mesh_ = TetMesh();
  mesh_.reserve_vertices(vertices_.size());
  for (const VertexRecord& r : vertices_) mesh_.add_vertex(r.point);
  TetMesh::Writer writer(mesh_);
  writer.resize_cells(cells_.size());
  is_cut_.assign(4 * cells_.size(), 0);
  par::for_each(policy_, cells_.size(), [&](std::size_t i) {
    const CellRecord& r = cells_[i];
    Cell& cell = writer.cell(CellHandle(i));
    for (std::size_t k = 0; k < 4; ++k) {
      cell.v[k] = vertex_at(r.v[k]);  // which has come with the cell
      if (r.mate[k] == kNoNumber) continue;
      const CellHandle there = cell_at(r.mate[k] / 4);
      if (there.is_valid())
        cell.mate[k] = halfface_of(there, static_cast<int>(r.mate[k] % 4));
      else
        is_cut_[4 * i + k] = 1;
    }
  });
  for (std::size_t i = 0; i < cells_.size(); ++i)
    for (VertexHandle v : mesh_.cell(CellHandle(i)).v) writer.set_incident_cell(v, CellHandle(i));
}

}  // namespace hfr::mpi
