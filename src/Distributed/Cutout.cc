// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Cutout.hh"

#include <algorithm>
#include <limits>

#include "Distributed/Buffer.hh"
#include "Distributed/Sources.hh"
#include "Distributed/Spread.hh"
#include "HalfFace/Writer.hh"

namespace hfr::mpi {
namespace {

using VertexRecord = DistributedMesh::VertexRecord;
using CellRecord = DistributedMesh::CellRecord;

/// Each once, in the order of numbers.
template <class Record>
void sort_by_number(std::vector<Record>& records) {
  const auto order = [](const Record& a, const Record& b) {
    if constexpr (requires { a.of_owner; })
      return a.number != b.number ? a.number < b.number : a.of_owner > b.of_owner;
    else
      return a.number < b.number;
  };
  if (!std::is_sorted(records.begin(), records.end(), order))  // as from one rank
    std::sort(records.begin(), records.end(), order);
  records.erase(std::unique(records.begin(), records.end(),
                            [](const Record& a, const Record& b) { return a.number == b.number; }),
                records.end());
}

/// What lies round these vertices: their numbers, the records of all cells that have one and of the corners
/// of these, and labels.
void pack_round(const DistributedMesh& parts, std::span<const VertexHandle> vertices, Packer& out) {
  const TetMesh& part = parts.part();
  std::vector<std::uint64_t> taken;
  taken.reserve(vertices.size());
  Marks &cell_marks = parts.cell_marks(), &vertex_marks = parts.vertex_marks();
  WholeStars stars(part, parts.work());
  for (VertexHandle v : vertices) {
    taken.push_back(parts.number(v));
    stars.for_cells(v, [&](CellHandle c) {
      if (!cell_marks.add(c.idx())) return;
      for (VertexHandle u : part.cell(c).v) vertex_marks.add(u.idx());
    });
  }
  const auto cells = cell_marks.take<CellHandle>();
  const auto corners = vertex_marks.take<VertexHandle>();
  std::vector<CellRecord> cell_records;
  cell_records.reserve(cells.size());
  for (CellHandle c : cells) cell_records.push_back(parts.record(c));
  std::vector<VertexRecord> vertex_records;
  vertex_records.reserve(corners.size());
  for (VertexHandle v : corners) vertex_records.push_back(parts.record(v));
  out.put_all(taken);
  out.put_all(vertex_records);
  out.put_all(cell_records);
  out.put_all(parts.labels_of(cells, corners));
}

}  // namespace

Cutout::Cutout(const DistributedMesh& parts, std::span<const std::uint64_t> cells,
               std::span<const std::uint8_t> depth, Where where) {
  const TetMesh& part = parts.part();
  Comm& comm = parts.comm();
  Spread spread(parts, Spread::Stars::kWhole, where == Where::kOnAll ? 0 : comm.rank());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellHandle c = parts.cell_at(cells[i]);
    if (!c.is_valid() || part.is_deleted(c) || !parts.is_own(c)) continue;
    spread.begin(c, depth[i]);
    if (where == Where::kOnOwners) centres_.push_back(cells[i]);
  }
  if (where == Where::kOnAll) centres_.assign(cells.begin(), cells.end());
  spread.run();
  std::vector<Packer> to(comm.n_ranks());
  const auto asked_for = spread.take_own();
  for (std::size_t r = 0; r < asked_for.size(); ++r)
    if (!asked_for[r].empty()) pack_round(parts, asked_for[r], to[r]);
  std::vector<std::uint64_t> taken;
  std::vector<CellRecord> cell_records;
  std::vector<LabelRecord> labels;
  for (const Comm::Message& message : comm.exchange(to)) {
    Unpacker in(message.bytes);
    in.append_to(taken);
    in.append_to(vertices_);
    in.append_to(cell_records);
    in.append_to(labels);
  }
  std::sort(taken.begin(), taken.end());
  sort_by_number(vertices_);
  sort_by_number(cell_records);
  if (where == Where::kOnAll) {  // by way of the first
    Packer first;
    first.put_all(taken);
    first.put_all(vertices_);
    first.put_all(cell_records);
    first.put_all(labels);
    const std::vector<std::byte> said = told_by_first(comm, first);
    Unpacker in(said);
    taken = in.get_all<std::uint64_t>();
    vertices_ = in.get_all<VertexRecord>();
    cell_records = in.get_all<CellRecord>();
    labels = in.get_all<LabelRecord>();
  }
  work_.clock = parts.work().clock;
  work_.floor = parts.work().floor;
  work_.holds_damage = parts.work().holds_damage;
  if (sources::are_followed(part)) sources::follow(mesh_);
  build(cell_records, taken, !parts.work().pinched.empty());
  labels_.add(mesh_, labels, [this](std::uint64_t n) { return vertex_at(n); });
}

/// `taken`: numbers of vertices, ascending.
void Cutout::build(const std::vector<CellRecord>& cells, const std::vector<std::uint64_t>& taken,
                   bool has_pinched) {
  TetMesh::Writer writer(mesh_);
  mesh_.reserve_vertices(vertices_.size());
  vertex_index_ = NumberIndex(vertices_.size());
  std::vector<std::uint8_t> is_taken;
  for (const VertexRecord& r : vertices_) {
    const VertexHandle v = mesh_.add_vertex(r.point);
    vertex_index_.insert(r.number, v.idx());
    sources::set(mesh_, v, r.source);
    work_.star_size.push_back(r.star_size);
    work_.changed.push_back(r.changed);
    work_.frozen.push_back(r.frozen);
    if (has_pinched) work_.pinched.push_back(r.pinched);
    is_taken.push_back(std::binary_search(taken.begin(), taken.end(), r.number) ? 1 : 0);
  }
  const std::size_t n = cells.size();
  writer.resize_cells(n);
  work_.claim.assign(n, kUnclaimed);
  rim_.is_rim.assign(n, 0);
  rim_.has_met.assign(n, 0);
  cell_index_ = NumberIndex(n);
  for (std::size_t i = 0; i < n; ++i) cell_index_.insert(cells[i].number, static_cast<Index>(i));
  for (std::size_t i = 0; i < n; ++i) {
    const CellRecord& r = cells[i];
    const CellHandle c(i);
    cell_number_.push_back(r.number);
    work_.quality.push_back(r.quality);
    work_.pending.push_back(r.pending);
    for (std::size_t k = 0; k < 4; ++k) {
      const VertexHandle v = vertex_at(r.v[k]);
      writer.cell(c).v[k] = v;
      // Who sends a cell has all its neighbours; those that are not here lie behind the rim.
      const CellHandle there = r.mate[k] == kNoNumber ? CellHandle() : cell_at(r.mate[k] / 4);
      writer.cell(c).mate[k] =
          there.is_valid() ? halfface_of(there, static_cast<int>(r.mate[k] % 4)) : HalfFaceHandle();
      if (!is_taken[v.idx()]) rim_.is_rim[i] = 1;
      if (!mesh_.incident_cell(v).is_valid() || vertices_[v.idx()].incident == r.number)
        writer.set_incident_cell(v, c);
    }
    mesh_.set_region(c, r.region);
    sources::set(mesh_, c, r.source);
  }
}

VertexHandle Cutout::vertex_at(std::uint64_t number) const {
  const Index at = vertex_index_[number];
  return at == NumberIndex::kNone ? VertexHandle() : VertexHandle(at);
}

CellHandle Cutout::cell_at(std::uint64_t number) const {
  const Index at = cell_index_[number];
  return at == NumberIndex::kNone ? CellHandle() : CellHandle(at);
}

CellHandle Cutout::add_slot(std::uint64_t number) {
  const CellHandle c(cell_number_.size());
  TetMesh::Writer(mesh_).resize_cells(cell_number_.size() + 1);
  work_.grow(mesh_);
  work_.quality[c.idx()] = std::numeric_limits<double>::infinity();
  cell_number_.push_back(number);
  return c;
}

VertexRecord Cutout::record(VertexHandle v) const {
  VertexRecord r;
  if (v.idx() < vertices_.size()) r = vertices_[v.idx()];
  r.number = number(v);
  r.incident = number(mesh_.incident_cell(v));
  r.source = sources::of(mesh_, v);
  r.point = mesh_.point(v);
  r.star_size = work_.star_size[v.idx()];
  r.changed = work_.changed[v.idx()];
  r.frozen = work_.frozen[v.idx()];
  r.of_owner = 1;
  r.pinched = work_.pinched.empty() ? std::uint8_t{0} : work_.pinched[v.idx()];
  return r;
}

CellRecord Cutout::record(CellHandle c) const {
  CellRecord r;
  r.number = number(c);
  const Cell& cell = mesh_.cell(c);
  for (std::size_t k = 0; k < 4; ++k) {
    r.v[k] = number(cell.v[k]);
    const HalfFaceHandle m = cell.mate[k];
    r.mate[k] = m.is_valid() ? 4 * number(cell_of(m)) + static_cast<std::uint64_t>(corner_of(m)) : kNoNumber;
  }
  r.source = sources::of(mesh_, c);
  r.quality = work_.quality[c.idx()];
  r.region = mesh_.region(c);
  r.pending = work_.pending[c.idx()];
  return r;
}

}  // namespace hfr::mpi
