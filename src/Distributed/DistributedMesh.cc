// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/DistributedMesh.hh"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "Distributed/Cut.hh"
#include "Distributed/PartMessage.hh"
#include "Distributed/PartTurns.hh"
#include "Distributed/Sources.hh"
#include "HalfFace/Reorder.hh"
#include "HalfFace/Writer.hh"
#include "Parallel/Sort.hh"

namespace hfr::mpi {
namespace {

std::uint64_t face_number(std::uint64_t cell, int corner) {
  return 4 * cell + static_cast<std::uint64_t>(corner);
}

}  // namespace

std::string DistributedMesh::reason_against(const TetMesh& mesh, const Workspace& work) {
  const auto has_loose = [&](const auto& map) {
    const std::vector<std::uint8_t> used = used_entries(mesh, map);
    return std::find(used.begin(), used.end(), 0) != used.end();
  };
  if (has_loose(mesh.labels().faces) || has_loose(mesh.labels().edges) || has_loose(mesh.locks().faces) ||
      has_loose(mesh.locks().edges))
    return "labelled or fixed edges or faces that no cell has";
  if (!mesh.properties().cells.empty()) return "cell properties";
  if (!work.pinched.empty()) return "vertices whose cells do not connect through faces";
  for (std::size_t c = 0; c < mesh.n_cells(); ++c)
    if (mesh.is_fixed(CellHandle(c)) || mesh.is_selected(CellHandle(c)) || mesh.is_tagged(CellHandle(c)))
      return "cells that are fixed, selected or tagged";
  return {};
}

void DistributedMesh::scatter(const TetMesh* mesh, const Workspace* work, std::span<const int> owner,
                              par::Policy policy) {
  std::optional<Cut> cut;
  if (comm_.rank() == 0) {
    const std::string reason = reason_against(*mesh, *work);
    HFR_REQUIRE(reason.empty(), "a mesh with " + reason + " cannot be cut among ranks yet");
    cut.emplace(*mesh, *work, owner, comm_.size(), policy);
  }
  Block mine = comm_.hand_out([&](int rank) { return cut->message(rank); });
  cut.reset();
  build_part(mine, policy);
  scatter_labels(mesh, owner);
}

void DistributedMesh::build_part(Block& block, par::Policy policy) {
  const PartHeader header = PartArrays::header_of(block);
  const PartArrays in = PartArrays::in(block);
  n_slots_ = header.n_slots;
  n_vertices_ = header.n_vertices_of_whole;
  free_.assign(in.free.begin(), in.free.end());
  work_ = Workspace();
  clock_at_scatter_ = work_.clock = header.clock;
  work_.floor = header.floor;
  work_.holds_damage = header.holds_damage != 0;
  work_.star_size.assign(in.star_size.begin(), in.star_size.end());
  work_.changed.assign(in.changed.begin(), in.changed.end());
  work_.frozen.assign(in.frozen.begin(), in.frozen.end());
  work_.quality.assign(in.quality.begin(), in.quality.end());
  work_.pending.assign(in.pending.begin(), in.pending.end());
  work_.claim.assign(in.quality.size(), kUnclaimed);
  vertex_number_.assign(in.vertex_number.begin(), in.vertex_number.end());
  owner_.assign(in.owner.begin(), in.owner.end());
  cell_number_.assign(in.cell_number.begin(), in.cell_number.end());
  later_.clear();
  n_sorted_ = cell_number_.size();
  mesh_ = TetMesh();
  arrays_.reset();
  labels_ = PartLabels();
  mesh_.reserve_vertices(in.point.size());
  for (Vec3 p : in.point) mesh_.add_vertex(p);
  TetMesh::Writer writer(mesh_);
  const auto handle = []<class H>(Index i, H) { return i == PartArrays::kNothing ? H() : H(i); };
  for (std::size_t v = 0; v < in.incident.size(); ++v)
    writer.set_incident_cell(VertexHandle(v), handle(in.incident[v], CellHandle()));
  writer.resize_cells(n_sorted_);
  par::for_each(policy, n_sorted_, [&](std::size_t c) {
    Cell& cell = writer.cell(CellHandle(c));
    for (std::size_t k = 0; k < 4; ++k) {
      cell.v[k] = VertexHandle(in.corners[c][k]);
      cell.mate[k] = handle(in.mates[c][k], HalfFaceHandle());
    }
  });
  for (std::size_t c = 0; c < in.region.size(); ++c) mesh_.set_region(CellHandle(c), in.region[c]);
  start_zone();
  complete_rim();
}

/// At the edge of the part the incident cell may be one that is not here.
void DistributedMesh::complete_rim() {
  TetMesh::Writer writer(mesh_);
  for (Index c : rim_)
    for (VertexHandle v : mesh_.cell(CellHandle(c)).v)
      if (!mesh_.incident_cell(v).is_valid()) writer.set_incident_cell(v, CellHandle(c));
}

Turned DistributedMesh::assemble(Piece piece, std::uint64_t n_vertices, std::uint64_t n_cells,
                                 Inverted inverted) {
  n_slots_ = n_cells;
  n_vertices_ = n_vertices;
  free_.clear();
  mesh_ = std::move(piece.mesh);
  arrays_.reset();
  labels_ = PartLabels();
  vertex_number_ = std::move(piece.vertex_number);
  cell_number_ = std::move(piece.cell_number);
  owner_ = std::move(piece.owner);
  later_.clear();
  n_sorted_ = cell_number_.size();
  work_ = Workspace();
  clock_at_scatter_ = work_.clock;
  // Of vertices within two edges of own ones all cells are here, and the rest is not asked about.
  work_.star_size = star_sizes(mesh_);
  work_.changed.assign(mesh_.n_vertices(), work_.clock);
  work_.frozen = constrained_vertices(mesh_, {});
  work_.forget_qualities();
  work_.quality.assign(mesh_.n_cells(), 0.0);
  work_.pending.assign(mesh_.n_cells(), 0xff);
  work_.claim.assign(mesh_.n_cells(), kUnclaimed);
  start_zone();
  find_pinched();
  return orient(*this, std::move(piece.turned), inverted);
}

void DistributedMesh::attach_arrays(std::shared_ptr<const AttachedArrays> arrays) {
  arrays_ = std::move(arrays);
  sources::follow(mesh_);
  for (VertexHandle v : mesh_.vertices()) sources::set(mesh_, v, number(v));
  for (CellHandle c : mesh_.cells()) sources::set(mesh_, c, number(c));
}

std::uint64_t DistributedMesh::source(VertexHandle v) const { return sources::of(mesh_, v); }
std::uint64_t DistributedMesh::source(CellHandle c) const { return sources::of(mesh_, c); }

/// Of vertices further away a part does not hold all cells. Where any rank has a pinched one, all keep bytes.
void DistributedMesh::find_pinched() {
  std::vector<std::uint8_t>& pinched = work_.pinched;
  pinched = pinched_vertices(mesh_, work_.star_size, {});
  std::uint64_t n_own = 0;
  for (std::size_t v = 0; v < pinched.size(); ++v) {
    if (!near2_.has(v, comm_.rank())) pinched[v] = 0;
    n_own += pinched[v] != 0 && is_own(VertexHandle(v)) ? 1 : 0;
  }
  if (comm_.sum(n_own) == 0)
    pinched.clear();
  else
    pinched.resize(mesh_.n_vertices(), 0);
}

std::vector<std::uint64_t> DistributedMesh::renumber(std::span<const std::uint64_t> to) {
  std::vector<CellHandle> order;
  {
    std::vector<par::KeyIndex> keys, scratch;
    keys.reserve(to.size());
    for (std::size_t i = 0; i < to.size(); ++i) keys.push_back({to[i], static_cast<std::uint32_t>(i)});
    par::stable_sort({}, keys, scratch);
    order.reserve(keys.size());
    for (const par::KeyIndex& key : keys) order.push_back(CellHandle(key.index));
  }
  std::vector<std::uint64_t> before, now;
  before.reserve(order.size());
  now.reserve(order.size());
  for (CellHandle c : order) {
    before.push_back(number(c));
    now.push_back(to[c.idx()]);
  }
  order_cells(mesh_, order);
  cell_number_ = std::move(now);
  n_sorted_ = cell_number_.size();
  later_.clear();
  work_.forget_qualities();
  work_.quality.assign(mesh_.n_cells(), 0.0);
  work_.pending.assign(mesh_.n_cells(), 0xff);
  work_.claim.assign(mesh_.n_cells(), kUnclaimed);
  work_.all_touched = true;
  start_zone();
  return before;
}

std::shared_ptr<const DistributedMesh> DistributedMesh::copy() const {
  const auto copy = std::make_shared<DistributedMesh>(comm_);
  static_cast<State&>(*copy) = *this;
  copy->work_.star_size = work_.star_size;
  copy->work_.frozen = work_.frozen;
  return copy;
}

void DistributedMesh::put_back(const DistributedMesh& copy) {
  static_cast<State&>(*this) = copy;
  work_.star_size = copy.work_.star_size;
  work_.frozen = copy.work_.frozen;
  work_.forget_qualities();
  work_.quality.assign(mesh_.n_cells(), 0.0);
  work_.changed.assign(mesh_.n_vertices(), work_.clock);
  work_.pending.assign(mesh_.n_cells(), 0xff);
  work_.claim.assign(mesh_.n_cells(), kUnclaimed);
  work_.all_touched = true;
  start_zone();
  find_pinched();
}

VertexHandle DistributedMesh::vertex_at(std::uint64_t number) const {
  const auto at = std::lower_bound(vertex_number_.begin(), vertex_number_.end(), number);
  if (at == vertex_number_.end() || *at != number) return {};
  return VertexHandle(at - vertex_number_.begin());
}

CellHandle DistributedMesh::cell_at(std::uint64_t number) const {
  const auto end = cell_number_.begin() + static_cast<std::ptrdiff_t>(n_sorted_);
  const auto at = std::lower_bound(cell_number_.begin(), end, number);
  if (at != end && *at == number) return CellHandle(at - cell_number_.begin());
  const auto later = later_.find(number);
  return later == later_.end() ? CellHandle() : CellHandle(later->second);
}

CellHandle DistributedMesh::slot_of(std::uint64_t number) {
  if (const CellHandle c = cell_at(number); c.is_valid()) return c;
  const CellHandle c(cell_number_.size());
  TetMesh::Writer(mesh_).resize_cells(cell_number_.size() + 1);
  work_.grow(mesh_);
  work_.quality[c.idx()] = std::numeric_limits<double>::infinity();
  cell_number_.push_back(number);
  later_.emplace(number, c.idx());
  return c;
}

void DistributedMesh::detach(CellHandle c) {
  TetMesh::Writer writer(mesh_);
  note_changed(mesh_.cell(c).v);
  for (HalfFaceHandle h : mesh_.cell_halffaces(c)) {
    const HalfFaceHandle m = mesh_.opposite_halfface(h);
    if (!m.is_valid() || mesh_.opposite_halfface(m) != h) continue;
    writer.set_mate(m, HalfFaceHandle());
    open_.push_back(m);
  }
  writer.mark_deleted(c);
  work_.quality[c.idx()] = std::numeric_limits<double>::infinity();
}

auto DistributedMesh::record(VertexHandle v) const -> VertexRecord {
  VertexRecord r;
  r.number = number(v);
  const CellHandle c = mesh_.incident_cell(v);
  if (c.is_valid()) r.incident = number(c);
  r.source = sources::of(mesh_, v);
  r.point = mesh_.point(v);
  r.owner = owner(v);
  r.star_size = work_.star_size[v.idx()];
  r.changed = work_.changed[v.idx()];
  r.frozen = work_.frozen[v.idx()];
  r.of_owner = is_own(v) ? 1 : 0;
  r.deleted = mesh_.is_deleted(v) ? 1 : 0;
  r.pinched = work_.pinched.empty() ? std::uint8_t{0} : work_.pinched[v.idx()];
  return r;
}

auto DistributedMesh::record(CellHandle c) const -> CellRecord {
  CellRecord r;
  r.number = number(c);
  const Cell& cell = mesh_.cell(c);
  for (std::size_t k = 0; k < 4; ++k) {
    r.v[k] = number(cell.v[k]);
    const HalfFaceHandle m = cell.mate[k];
    r.mate[k] = m.is_valid() ? face_number(number(cell_of(m)), corner_of(m)) : kNoNumber;
  }
  r.source = sources::of(mesh_, c);
  r.quality = work_.quality[c.idx()];
  r.region = mesh_.region(c);
  r.pending = work_.pending[c.idx()];
  return r;
}

void DistributedMesh::Records::append(Unpacker& in) {
  in.append_to(vertices);
  in.append_to(cells);
  if (!in.at_end()) in.append_to(labels);
}

void DistributedMesh::pack(std::span<const CellHandle> cells, std::span<const VertexHandle> vertices,
                           Packer& to, bool as_owner) const {
  std::vector<VertexRecord> vertex_records;
  vertex_records.reserve(vertices.size());
  for (VertexHandle v : vertices) {
    vertex_records.push_back(record(v));
    if (as_owner) vertex_records.back().of_owner = 1;
  }
  std::vector<CellRecord> cell_records;
  cell_records.reserve(cells.size());
  for (CellHandle c : cells) cell_records.push_back(record(c));
  to.put_all(vertex_records);
  to.put_all(cell_records);
  const std::vector<LabelRecord> labels = labels_of(cells, vertices);
  if (!labels.empty()) to.put_all(labels);
}

void DistributedMesh::apply(const Records& records) {
  const auto& [vertices, cells, labels] = records;
  std::vector<VertexRecord> fresh;
  for (const VertexRecord& r : vertices)
    if (!vertex_at(r.number).is_valid()) fresh.push_back(r);
  if (!fresh.empty()) add_vertices(std::move(fresh));
  write_cells(cells);
  link(cells);
  match_open_faces();
  add_labels(labels);
  TetMesh::Writer writer(mesh_);
  for (const VertexRecord& r : vertices) {
    const VertexHandle v = vertex_at(r.number);
    mesh_.set_point(v, r.point);  // whoever holds a vertex has its point, and knows whose it is
    sources::set(mesh_, v, r.source);
    owner_[v.idx()] = r.owner;
    if (!r.of_owner) continue;
    work_.star_size[v.idx()] = r.star_size;
    work_.changed[v.idx()] = r.changed;
    work_.frozen[v.idx()] = r.frozen;
    if (!work_.pinched.empty()) work_.pinched[v.idx()] = r.pinched;
    const CellHandle c = r.incident == kNoNumber ? CellHandle() : cell_at(r.incident);
    if (c.is_valid() && !mesh_.is_deleted(c)) writer.set_incident_cell(v, c);
  }
}

void DistributedMesh::write_cells(std::span<const CellRecord> cells) {
  for (const CellRecord& r : cells) {
    const CellHandle c = slot_of(r.number);
    TetMesh::Writer writer(mesh_);
    Tet corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = vertex_at(r.v[k]);
    if (!mesh_.is_deleted(c) && mesh_.cell(c).v != corners) detach(c);
    const bool is_new = mesh_.is_deleted(c);
    writer.cell(c).v = corners;
    mesh_.set_region(c, r.region);
    sources::set(mesh_, c, r.source);
    work_.quality[c.idx()] = r.quality;
    work_.pending[c.idx()] = r.pending;
    work_.touch({&c, 1});
    for (VertexHandle v : corners) {
      const CellHandle incident = mesh_.incident_cell(v);
      if (!incident.is_valid() || mesh_.is_deleted(incident) || !mesh_.cell(incident).has(v))
        writer.set_incident_cell(v, c);
    }
    if (is_new) note_created(c);
  }
}

/// Whether the two are the sides of one face.
bool DistributedMesh::see_each_other(HalfFaceHandle h, HalfFaceHandle g) const {
  if (mesh_.is_deleted(cell_of(g))) return false;
  auto mine = mesh_.halfface_vertices(h), theirs = mesh_.halfface_vertices(g);
  std::sort(mine.begin(), mine.end());
  std::sort(theirs.begin(), theirs.end());
  return mine == theirs;
}

void DistributedMesh::link(std::span<const CellRecord> cells) {
  TetMesh::Writer writer(mesh_);
  for (const CellRecord& r : cells) {
    const CellHandle c = cell_at(r.number);
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k), before = mesh_.opposite_halfface(h);
      if (before.is_valid() && see_each_other(h, before)) continue;
      writer.set_mate(h, HalfFaceHandle());
      const std::uint64_t m = r.mate[static_cast<std::size_t>(k)];
      const CellHandle there = m == kNoNumber ? CellHandle() : cell_at(m / 4);
      const HalfFaceHandle g =
          there.is_valid() ? halfface_of(there, static_cast<int>(m % 4)) : HalfFaceHandle();
      if (!g.is_valid() || !see_each_other(h, g)) {
        open_.push_back(h);
        continue;
      }
      writer.set_mate(h, g);
      writer.set_mate(g, h);
    }
  }
}

void DistributedMesh::match_open_faces() {
  using Key = std::array<VertexHandle, 3>;
  std::vector<std::pair<Key, HalfFaceHandle>> faces;
  for (HalfFaceHandle h : open_) {
    if (mesh_.is_deleted(cell_of(h)) || mesh_.opposite_halfface(h).is_valid()) continue;
    Key key = mesh_.halfface_vertices(h);
    std::sort(key.begin(), key.end());
    faces.emplace_back(key, h);
  }
  open_.clear();
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  TetMesh::Writer writer(mesh_);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].first != faces[i - 1].first) continue;
    writer.set_mate(faces[i].second, faces[i - 1].second);
    writer.set_mate(faces[i - 1].second, faces[i].second);
  }
}

/// Vertices keep the order of their numbers: those that are new in the whole go to the end.
void DistributedMesh::add_vertices(std::vector<VertexRecord> fresh) {
  std::stable_sort(fresh.begin(), fresh.end(), [](const VertexRecord& a, const VertexRecord& b) {
    return a.number < b.number || (a.number == b.number && a.of_owner > b.of_owner);
  });
  fresh.erase(std::unique(fresh.begin(), fresh.end(),
                          [](const auto& a, const auto& b) { return a.number == b.number; }),
              fresh.end());
  const auto first_new = std::find_if(fresh.begin(), fresh.end(), [&](const VertexRecord& r) {
    return vertex_number_.empty() || r.number > vertex_number_.back();
  });
  if (first_new != fresh.begin()) insert_vertices({fresh.begin(), first_new});
  for (const VertexRecord& r : std::span(first_new, fresh.end())) {
    mesh_.add_vertex(r.point);
    vertex_number_.push_back(r.number);
    owner_.push_back(r.owner);
    work_.star_size.push_back(r.star_size);
    work_.changed.push_back(r.changed);
    work_.frozen.push_back(r.frozen);
    if (!work_.pinched.empty()) work_.pinched.push_back(r.pinched);
    for (RankSets* sets : {&near1_, &near2_, &told_}) sets->append_only(r.owner);
    marks_.push_back(0);
  }
}

/// Between others, so that handles change: O(part), and rare. `fresh`: ascending.
void DistributedMesh::insert_vertices(std::span<const VertexRecord> fresh) {
  const std::size_t n_old = vertex_number_.size(), n = n_old + fresh.size();
  std::vector<VertexHandle> to(n_old), places;
  for (std::size_t i = 0, k = 0; i < n_old || k < fresh.size();)
    if (k == fresh.size() || (i < n_old && vertex_number_[i] < fresh[k].number))
      to[i] = VertexHandle(i + k), ++i;
    else
      places.push_back(VertexHandle(i + k)), ++k;
  TetMesh::Writer(mesh_).open_gaps(to, n);
  open_gaps(to, n, std::uint64_t{0}, vertex_number_);
  open_gaps(to, n, 0, owner_);
  open_gaps(to, n, std::uint32_t{0}, work_.star_size);
  open_gaps(to, n, std::uint32_t{0}, work_.changed);
  open_gaps(to, n, std::uint8_t{0}, work_.frozen);
  if (!work_.pinched.empty()) open_gaps(to, n, std::uint8_t{0}, work_.pinched);
  for (RankSets* sets : {&near1_, &near2_, &told_}) open_gaps(to, n, RankSets::kEmpty, sets->ids());
  for (auto* list : {&dirty_, &renewed_})
    for (VertexHandle& v : *list) v = to[v.idx()];
  marks_.assign(n, 0);
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    const VertexRecord& r = fresh[k];
    const VertexHandle v = places[k];
    mesh_.set_point(v, r.point);
    vertex_number_[v.idx()] = r.number;
    owner_[v.idx()] = r.owner;
    work_.star_size[v.idx()] = r.star_size;
    work_.changed[v.idx()] = r.changed;
    work_.frozen[v.idx()] = r.frozen;
    if (!work_.pinched.empty()) work_.pinched[v.idx()] = r.pinched;
    for (RankSets* sets : {&near1_, &near2_, &told_}) sets->set_only(v.idx(), r.owner);
  }
}

void DistributedMesh::gather(TetMesh* mesh, Workspace* work, Gather what, par::Policy policy) {
  const bool all = what == Gather::kEverything;
  const auto has_changed = [&](VertexHandle v) { return work_.changed[v.idx()] > clock_at_scatter_; };
  const std::vector<Index> vertices = par::compact<Index>(policy, mesh_.n_vertices(), [&](std::size_t i) {
    const VertexHandle v(i);
    return is_own(v) && (all || has_changed(v) || mesh_.is_deleted(v));
  });
  // What is written to a cell, or behind one of its faces, leaves three changed corners at least.
  const std::vector<Index> cells = par::compact<Index>(policy, mesh_.n_cells(), [&](std::size_t i) {
    const CellHandle c(i);
    if (mesh_.is_deleted(c) || !is_own(c)) return false;
    const auto& v = mesh_.cell(c).v;
    return all || std::count_if(v.begin(), v.end(), has_changed) >= 3;
  });
  std::vector<VertexRecord> vertex_records(vertices.size());
  par::for_each(policy, vertices.size(),
                [&](std::size_t i) { vertex_records[i] = record(VertexHandle(vertices[i])); });
  std::vector<CellRecord> cell_records(cells.size());
  par::for_each(policy, cells.size(), [&](std::size_t i) { cell_records[i] = record(CellHandle(cells[i])); });
  std::vector<Packer> to(comm_.n_ranks());
  if (comm_.rank() != 0) {
    to[0].put_all(vertex_records);
    to[0].put_all(cell_records);
  }
  const auto came = comm_.exchange(to);
  if (comm_.rank() != 0) return;
  write_slots(*mesh, *work);
  write_whole(*mesh, *work, vertex_records, cell_records, policy);
  for (const Comm::Message& message : came) {
    Unpacker in(message.bytes);
    const auto theirs = in.get_all<VertexRecord>();
    write_whole(*mesh, *work, theirs, in.get_all<CellRecord>(), policy);
  }
}

/// The slots of the whole, which of them are free, and the vertices that have come.
void DistributedMesh::write_slots(TetMesh& mesh, Workspace& work) const {
  while (mesh.n_vertices() < n_vertices_) mesh.add_vertex({});
  TetMesh::Writer writer(mesh);
  writer.resize_cells(n_slots_);
  work.grow(mesh);
  work.clock = work_.clock;
  work.all_touched = true;
  writer.free_cells().clear();
  for (std::uint64_t c : free_) {
    writer.free_cells().push_back(CellHandle(c));
    writer.mark_deleted(CellHandle(c));
    work.quality[c] = std::numeric_limits<double>::infinity();
  }
}

/// What one rank tells of its own vertices and cells, in the mesh of the whole.
void DistributedMesh::write_whole(TetMesh& mesh, Workspace& work, std::span<const VertexRecord> vertices,
                                  std::span<const CellRecord> cells, par::Policy policy) const {
  TetMesh::Writer writer(mesh);
  for (const VertexRecord& r : vertices) {
    const VertexHandle v(r.number);
    mesh.set_point(v, r.point);
    writer.set_incident_cell(v, r.incident == kNoNumber ? CellHandle() : CellHandle(r.incident));
    work.star_size[v.idx()] = r.star_size;
    work.changed[v.idx()] = r.changed;
    if (r.deleted) writer.mark_deleted(v);
  }
  par::for_each(policy, cells.size(), [&](std::size_t i) {
    const CellRecord& r = cells[i];
    const CellHandle c(r.number);
    Cell& cell = writer.cell(c);
    for (std::size_t k = 0; k < 4; ++k) {
      cell.v[k] = VertexHandle(r.v[k]);
      cell.mate[k] = r.mate[k] == kNoNumber ? HalfFaceHandle() : HalfFaceHandle(r.mate[k]);
    }
    mesh.set_region(c, r.region);
    work.quality[c.idx()] = r.quality;
    work.pending[c.idx()] = r.pending;
  });
}

}  // namespace hfr::mpi
