// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Cutout.hh"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "Distributed/Buffer.hh"
#include "Distributed/Spread.hh"
#include "HalfFace/Writer.hh"

namespace hfr::mpi {
namespace {

using VertexRecord = DistributedMesh::VertexRecord;
using CellRecord = DistributedMesh::CellRecord;

template <class Record>
void sort_by_number(std::vector<Record>& records) {
  std::sort(records.begin(), records.end(), [](const Record& a, const Record& b) {
    if constexpr (requires { a.of_owner; })
      return a.number != b.number ? a.number < b.number : a.of_owner > b.of_owner;
    else
      return a.number < b.number;
  });
  records.erase(std::unique(records.begin(), records.end(),
                            [](const Record& a, const Record& b) { return a.number == b.number; }),
                records.end());
}

/// What lies round these vertices: their numbers, the records of all cells that have one and of the corners
/// of these, and labels.
void pack_round(const DistributedMesh& parts, std::span<const VertexHandle> vertices, Packer& out) {
  const TetMesh& part = parts.part();
  std::vector<std::uint64_t> taken;
  std::vector<CellHandle> cells;
  for (VertexHandle v : vertices) {
    taken.push_back(parts.number(v));
    for (CellHandle c : part.vertex_cells(v)) cells.push_back(c);
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  std::vector<CellRecord> cell_records;
  std::vector<VertexHandle> corners;
  for (CellHandle c : cells) {
    cell_records.push_back(parts.record(c));
    corners.insert(corners.end(), part.cell(c).v.begin(), part.cell(c).v.end());
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::vector<VertexRecord> vertex_records;
  for (VertexHandle v : corners) vertex_records.push_back(parts.record(v));
  out.put_all(taken);
  out.put_all(vertex_records);
  out.put_all(cell_records);
  out.put_all(parts.labels_of(cells, corners));
}

}  // namespace

Cutout::Cutout(const DistributedMesh& parts, std::span<const std::uint64_t> cells,
               std::span<const std::uint8_t> depth) {
  const TetMesh& part = parts.part();
  Comm& comm = parts.comm();
  Spread spread(parts);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellHandle c = parts.cell_at(cells[i]);
    if (!c.is_valid() || part.is_deleted(c) || !parts.is_own(c)) continue;
    spread.begin(c, depth[i], comm.rank());
    centres_.push_back(cells[i]);
  }
  spread.run();
  std::vector<Packer> to(comm.n_ranks());
  const auto asked_for = spread.own();
  for (std::size_t r = 0; r < asked_for.size(); ++r)
    if (!asked_for[r].empty()) pack_round(parts, asked_for[r], to[r]);
  std::vector<std::uint64_t> taken;
  std::vector<CellRecord> cell_records;
  std::vector<LabelRecord> labels;
  for (const Comm::Message& message : comm.exchange(to)) {
    Unpacker in(message.bytes);
    const auto append = [&]<class T>(std::vector<T>& list) {
      const std::vector<T> theirs = in.get_all<T>();
      list.insert(list.end(), theirs.begin(), theirs.end());
    };
    append(taken);
    append(vertices_);
    append(cell_records);
    append(labels);
  }
  std::sort(taken.begin(), taken.end());
  sort_by_number(vertices_);
  sort_by_number(cell_records);
  work_.clock = parts.work().clock;
  work_.floor = parts.work().floor;
  work_.holds_damage = parts.work().holds_damage;
  build(std::move(cell_records), taken);
  labels_.add(mesh_, labels, [this](std::uint64_t n) { return vertex_at(n); });
}

/// `taken`: numbers of vertices, ascending.
void Cutout::build(std::vector<CellRecord> cells, const std::vector<std::uint64_t>& taken) {
  TetMesh::Writer writer(mesh_);
  mesh_.reserve_vertices(vertices_.size());
  std::vector<std::uint8_t> is_taken;
  for (const VertexRecord& r : vertices_) {
    mesh_.add_vertex(r.point);
    work_.star_size.push_back(r.star_size);
    work_.changed.push_back(r.changed);
    work_.frozen.push_back(r.frozen);
    is_taken.push_back(std::binary_search(taken.begin(), taken.end(), r.number) ? 1 : 0);
  }
  n_sorted_ = cells.size();
  writer.resize_cells(n_sorted_);
  work_.claim.assign(n_sorted_, kUnclaimed);
  rim_.is_rim.assign(n_sorted_, 0);
  rim_.has_met.assign(n_sorted_, 0);
  for (std::size_t i = 0; i < n_sorted_; ++i) {
    const CellRecord& r = cells[i];
    const CellHandle c(i);
    cell_number_.push_back(r.number);
    work_.quality.push_back(r.quality);
    work_.pending.push_back(r.pending);
    for (std::size_t k = 0; k < 4; ++k) {
      const VertexHandle v = vertex_at(r.v[k]);
      writer.cell(c).v[k] = v;
      writer.cell(c).mate[k] = HalfFaceHandle();
      if (!is_taken[v.idx()]) rim_.is_rim[i] = 1;
      if (!mesh_.incident_cell(v).is_valid() || vertices_[v.idx()].incident == r.number)
        writer.set_incident_cell(v, c);
    }
    mesh_.set_region(c, r.region);
  }
  match_faces();
}

void Cutout::match_faces() {
  using Face = std::pair<std::array<VertexHandle, 3>, HalfFaceHandle>;
  std::vector<Face> faces;
  faces.reserve(4 * n_sorted_);
  for (std::size_t i = 0; i < n_sorted_; ++i)
    for (HalfFaceHandle h : mesh_.cell_halffaces(CellHandle(i))) {
      std::array<VertexHandle, 3> key = mesh_.halfface_vertices(h);
      std::sort(key.begin(), key.end());
      faces.emplace_back(key, h);
    }
  std::sort(faces.begin(), faces.end());
  TetMesh::Writer writer(mesh_);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].first != faces[i - 1].first) continue;
    writer.set_mate(faces[i].second, faces[i - 1].second);
    writer.set_mate(faces[i - 1].second, faces[i].second);
  }
}

/// Of those that it was built with.
VertexHandle Cutout::vertex_at(std::uint64_t number) const {
  const auto at = std::lower_bound(vertices_.begin(), vertices_.end(), number,
                                   [](const VertexRecord& v, std::uint64_t n) { return v.number < n; });
  return at != vertices_.end() && at->number == number ? VertexHandle(at - vertices_.begin())
                                                       : VertexHandle();
}

CellHandle Cutout::cell_at(std::uint64_t number) const {
  const auto end = cell_number_.begin() + static_cast<std::ptrdiff_t>(n_sorted_);
  const auto at = std::lower_bound(cell_number_.begin(), end, number);
  return at != end && *at == number ? CellHandle(at - cell_number_.begin()) : CellHandle();
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
  r.point = mesh_.point(v);
  r.star_size = work_.star_size[v.idx()];
  r.changed = work_.changed[v.idx()];
  r.frozen = work_.frozen[v.idx()];
  r.of_owner = 1;
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
  r.quality = work_.quality[c.idx()];
  r.region = mesh_.region(c);
  r.pending = work_.pending[c.idx()];
  return r;
}

}  // namespace hfr::mpi
