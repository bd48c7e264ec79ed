// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/DistributedMesh.hh"

#include <algorithm>
#include <array>
#include <utility>

#include "HalfFace/Writer.hh"

namespace hfr::mpi {
namespace {

constexpr Index kNone = CellHandle::kInvalid;

std::uint64_t face_number(std::uint64_t cell, int corner) {
  return 4 * cell + static_cast<std::uint64_t>(corner);
}

/// Owners within one edge, and within two, of the vertices of these cells; others stay as they are.
template <class Cells, class Owner>
void find_near(const TetMesh& mesh, const Cells& cells, const Owner& owner, RankSets& one, RankSets& two) {
  const auto for_live = [&](auto&& body) {
    for (Index c : cells)
      if (!mesh.is_deleted(CellHandle(c))) body(mesh.cell(CellHandle(c)).v);
  };
  for_live([&](const auto& v) {
    for (VertexHandle u : v) {
      one.set_only(u.idx(), owner(u));
      two.set_only(u.idx(), owner(u));
    }
  });
  for_live([&](const auto& v) {
    for (VertexHandle u : v)
      for (VertexHandle w : v) one.add(u.idx(), owner(w));
  });
  for_live([&](const auto& v) {
    for (VertexHandle u : v)
      for (VertexHandle w : v) two.add(u.idx(), one[w.idx()]);
  });
}

std::vector<Index> all_slots(const TetMesh& mesh) {
  std::vector<Index> slots(mesh.n_cells());
  for (std::size_t i = 0; i < slots.size(); ++i) slots[i] = static_cast<Index>(i);
  return slots;
}

/// The message that makes a part of the cells that a rank holds. `place`: scratch, an entry a slot and a
/// vertex of the whole, all kNone before and after.
class PartMessage {
 public:
  PartMessage(const TetMesh& mesh, const Workspace& work, std::span<const int> owner)
      : mesh_(mesh),
        work_(work),
        owner_(owner),
        cell_(mesh.n_cells(), kNone),
        vertex_(mesh.n_vertices(), kNone) {}

  void write(std::span<const Index> cells, Packer& out) {
    std::vector<Index> vertices;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cell_[cells[i]] = static_cast<Index>(i);
      for (VertexHandle v : mesh_.cell(CellHandle(cells[i])).v) {
        if (vertex_[v.idx()] == kNone) vertices.push_back(v.idx());
        vertex_[v.idx()] = 0;
      }
    }
    std::sort(vertices.begin(), vertices.end());
    for (std::size_t i = 0; i < vertices.size(); ++i) vertex_[vertices[i]] = static_cast<Index>(i);
    write_vertices(vertices, out);
    write_cells(cells, out);
    for (Index c : cells) cell_[c] = kNone;
    for (Index v : vertices) vertex_[v] = kNone;
  }

 private:
  template <class T, class Items, class Value>
  static void put(Packer& out, const Items& items, Value&& value) {
    std::vector<T> values;
    values.reserve(items.size());
    for (Index i : items) values.push_back(value(i));
    out.put_all(values);
  }
  void write_vertices(std::span<const Index> vertices, Packer& out) const {
    put<std::uint64_t>(out, vertices, [](Index v) { return std::uint64_t{v}; });
    put<Vec3>(out, vertices, [&](Index v) { return mesh_.points()[v]; });
    put<int>(out, vertices, [&](Index v) { return owner_[v]; });
    put<std::uint32_t>(out, vertices, [&](Index v) { return work_.star_size[v]; });
    put<std::uint32_t>(out, vertices, [&](Index v) { return work_.changed[v]; });
    put<std::uint8_t>(out, vertices, [&](Index v) { return work_.frozen[v]; });
    put<Index>(out, vertices, [&](Index v) {
      const CellHandle c = mesh_.incident_cell(VertexHandle(v));
      return c.is_valid() ? cell_[c.idx()] : kNone;
    });
  }
  void write_cells(std::span<const Index> cells, Packer& out) const {
    using Four = std::array<Index, 4>;
    put<std::uint64_t>(out, cells, [](Index c) { return std::uint64_t{c}; });
    put<Four>(out, cells, [&](Index c) {
      const auto& v = mesh_.cell(CellHandle(c)).v;
      return Four{vertex_[v[0].idx()], vertex_[v[1].idx()], vertex_[v[2].idx()], vertex_[v[3].idx()]};
    });
    put<Four>(out, cells, [&](Index c) {
      Four mates;
      for (std::size_t k = 0; k < 4; ++k) {
        const HalfFaceHandle m = mesh_.cell(CellHandle(c)).mate[k];
        const Index there = m.is_valid() ? cell_[cell_of(m).idx()] : kNone;
        mates[k] = there == kNone ? kNone : 4 * there + static_cast<Index>(corner_of(m));
      }
      return mates;
    });
    put<double>(out, cells, [&](Index c) { return work_.quality[c]; });
    put<std::uint8_t>(out, cells, [&](Index c) { return work_.pending[c]; });
    put<int>(out, cells, [&](Index c) { return mesh_.region(CellHandle(c)); });
  }

  const TetMesh& mesh_;
  const Workspace& work_;
  std::span<const int> owner_;
  std::vector<Index> cell_, vertex_;
};

}  // namespace

std::string DistributedMesh::reason_against(const TetMesh& mesh, const Workspace& work) {
  const Labels& labels = mesh.labels();
  if (!labels.faces.empty() || !labels.edges.empty() || !labels.vertices.empty()) return "labels";
  if (!mesh.locks().empty()) return "fixed edges, faces or patches";
  if (!mesh.properties().cells.empty()) return "cell properties";
  if (!work.pinched.empty()) return "vertices whose cells do not connect through faces";
  for (std::size_t c = 0; c < mesh.n_cells(); ++c)
    if (mesh.is_fixed(CellHandle(c)) || mesh.is_selected(CellHandle(c)) || mesh.is_tagged(CellHandle(c)))
      return "cells that are fixed, selected or tagged";
  return {};
}

void DistributedMesh::scatter(const TetMesh* mesh, const Workspace* work, std::span<const int> owner) {
  std::vector<Packer> to(comm_.n_ranks());
  if (comm_.rank() == 0) {
    const std::string reason = reason_against(*mesh, *work);
    HFR_REQUIRE(reason.empty(), "a mesh with " + reason + " cannot be cut among ranks yet");
    RankSets one(mesh->n_vertices(), comm_.size()), two(mesh->n_vertices(), comm_.size());
    find_near(
        *mesh, all_slots(*mesh), [&](VertexHandle v) { return owner[v.idx()]; }, one, two);
    std::vector<std::vector<Index>> held(comm_.n_ranks());
    RankSet set(one.words());
    for (std::size_t c = 0; c < mesh->n_cells(); ++c) {
      if (mesh->is_deleted(CellHandle(c))) continue;
      set.clear();
      for (VertexHandle v : mesh->cell(CellHandle(c)).v) set.add(two[v.idx()]);
      for_ranks(set.bits(),
                [&](int r) { held[static_cast<std::size_t>(r)].push_back(static_cast<Index>(c)); });
    }
    std::vector<std::uint64_t> free;
    for (CellHandle c : mesh->free_cells()) free.push_back(c.idx());
    PartMessage message(*mesh, *work, owner);
    for (std::size_t r = 0; r < comm_.n_ranks(); ++r) {
      to[r].put(std::uint64_t{mesh->n_cells()});
      to[r].put_all(free);
      to[r].put(work->clock);
      to[r].put(work->floor);
      to[r].put(static_cast<std::uint8_t>(work->holds_damage ? 1 : 0));
      message.write(held[r], to[r]);
      held[r] = {};
    }
  }
  build_part(comm_.exchange(to).at(0).bytes);
}

void DistributedMesh::build_part(std::span<const std::byte> bytes) {
  using Four = std::array<Index, 4>;
  Unpacker in(bytes);
  n_slots_ = in.get<std::uint64_t>();
  free_ = in.get_all<std::uint64_t>();
  work_ = Workspace();
  clock_at_scatter_ = work_.clock = in.get<std::uint32_t>();
  work_.floor = in.get<double>();
  work_.holds_damage = in.get<std::uint8_t>() != 0;
  vertex_number_ = in.get_all<std::uint64_t>();
  mesh_ = TetMesh();
  mesh_.reserve_vertices(vertex_number_.size());
  for (Vec3 p : in.get_all<Vec3>()) mesh_.add_vertex(p);
  owner_ = in.get_all<int>();
  work_.star_size = in.get_all<std::uint32_t>();
  work_.changed = in.get_all<std::uint32_t>();
  work_.frozen = in.get_all<std::uint8_t>();
  TetMesh::Writer writer(mesh_);
  const auto incident = in.get_all<Index>();
  cell_number_ = in.get_all<std::uint64_t>();
  later_.clear();
  n_sorted_ = cell_number_.size();
  writer.resize_cells(n_sorted_);
  const auto corners = in.get_all<Four>();
  const auto mates = in.get_all<Four>();
  for (std::size_t v = 0; v < incident.size(); ++v)
    writer.set_incident_cell(VertexHandle(v), incident[v] == kNone ? CellHandle() : CellHandle(incident[v]));
  for (std::size_t c = 0; c < n_sorted_; ++c) {
    Cell& cell = writer.cell(CellHandle(c));
    for (std::size_t k = 0; k < 4; ++k) {
      cell.v[k] = VertexHandle(corners[c][k]);
      cell.mate[k] = mates[c][k] == kNone ? HalfFaceHandle() : HalfFaceHandle(mates[c][k]);
      if (!mesh_.incident_cell(cell.v[k]).is_valid()) writer.set_incident_cell(cell.v[k], CellHandle(c));
    }
  }
  work_.quality = in.get_all<double>();
  work_.pending = in.get_all<std::uint8_t>();
  work_.claim.assign(n_sorted_, kUnclaimed);
  const auto regions = in.get_all<int>();
  for (std::size_t c = 0; c < n_sorted_; ++c) mesh_.set_region(CellHandle(c), regions[c]);
  start_zone();
}

void DistributedMesh::start_zone() {
  near1_ = near2_ = RankSets(mesh_.n_vertices(), comm_.size());
  zone_.clear();
  rim_.clear();
  open_.clear();
  for (std::size_t c = 0; c < mesh_.n_cells(); ++c) note_created(CellHandle(c));
  update_zone();
  note_told();
}

void DistributedMesh::update_zone() {
  while (true) {
    std::vector<VertexHandle> inside;  // so far: cells of theirs may be missing in the zone
    for (Index c : zone_)
      if (!mesh_.is_deleted(CellHandle(c)))
        for (VertexHandle v : mesh_.cell(CellHandle(c)).v)
          if (is_own(v) && is_inside(v)) inside.push_back(v);
    std::sort(inside.begin(), inside.end());
    inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
    find_near(
        mesh_, zone_, [&](VertexHandle v) { return owner(v); }, near1_, near2_);
    std::erase_if(inside, [&](VertexHandle v) { return is_inside(v); });
    if (inside.empty()) break;
    for (VertexHandle v : inside)
      for (CellHandle c : mesh_.vertex_cells(v)) zone_.push_back(c.idx());
    std::sort(zone_.begin(), zone_.end());
    zone_.erase(std::unique(zone_.begin(), zone_.end()), zone_.end());
  }
  std::erase_if(zone_, [&](Index c) {
    if (mesh_.is_deleted(CellHandle(c))) return true;
    const auto& v = mesh_.cell(CellHandle(c)).v;
    return std::all_of(v.begin(), v.end(), [&](VertexHandle u) { return is_inside(u); });
  });
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
  for (HalfFaceHandle h : mesh_.cell_halffaces(c)) {
    const HalfFaceHandle m = mesh_.opposite_halfface(h);
    if (!m.is_valid() || mesh_.opposite_halfface(m) != h) continue;
    writer.set_mate(m, HalfFaceHandle());
    open_.push_back(m);
  }
  writer.mark_deleted(c);
  work_.quality[c.idx()] = std::numeric_limits<double>::infinity();
}

void DistributedMesh::note_created(CellHandle c) {
  const auto& v = mesh_.cell(c).v;
  zone_.push_back(c.idx());
  if (std::none_of(v.begin(), v.end(), [&](VertexHandle u) { return is_own(u); })) rim_.push_back(c.idx());
}

void DistributedMesh::prune() {
  std::erase_if(rim_, [&](Index i) {
    const CellHandle c(i);
    if (mesh_.is_deleted(c)) return true;
    const auto& v = mesh_.cell(c).v;
    if (std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return near2_.has(u.idx(), comm_.rank()); }))
      return false;
    detach(c);
    return true;
  });
  open_.clear();  // behind them is nothing that this part holds
}

auto DistributedMesh::record(VertexHandle v) const -> VertexRecord {
  VertexRecord r;
  r.number = number(v);
  const CellHandle c = mesh_.incident_cell(v);
  if (c.is_valid()) r.incident = number(c);
  r.point = mesh_.point(v);
  r.owner = owner(v);
  r.star_size = work_.star_size[v.idx()];
  r.changed = work_.changed[v.idx()];
  r.frozen = work_.frozen[v.idx()];
  r.of_owner = is_own(v) ? 1 : 0;
  r.deleted = mesh_.is_deleted(v) ? 1 : 0;
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
  r.quality = work_.quality[c.idx()];
  r.region = mesh_.region(c);
  r.pending = work_.pending[c.idx()];
  return r;
}

void DistributedMesh::apply(std::span<const VertexRecord> vertices, std::span<const CellRecord> cells) {
  std::vector<VertexRecord> fresh;
  for (const VertexRecord& r : vertices)
    if (!vertex_at(r.number).is_valid()) fresh.push_back(r);
  if (!fresh.empty()) insert_vertices(fresh);
  write_cells(cells);
  link(cells);
  match_open_faces();
  TetMesh::Writer writer(mesh_);
  for (const VertexRecord& r : vertices) {
    if (!r.of_owner) continue;
    const VertexHandle v = vertex_at(r.number);
    mesh_.set_point(v, r.point);
    work_.star_size[v.idx()] = r.star_size;
    work_.changed[v.idx()] = r.changed;
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
    work_.quality[c.idx()] = r.quality;
    work_.pending[c.idx()] = r.pending;
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

/// Vertices keep the order of their numbers, so all handles change: O(part), and rare.
void DistributedMesh::insert_vertices(std::span<const VertexRecord> records) {
  std::vector<VertexRecord> fresh(records.begin(), records.end());
  std::stable_sort(fresh.begin(), fresh.end(), [](const VertexRecord& a, const VertexRecord& b) {
    return a.number < b.number || (a.number == b.number && a.of_owner > b.of_owner);
  });
  fresh.erase(std::unique(fresh.begin(), fresh.end(),
                          [](const auto& a, const auto& b) { return a.number == b.number; }),
              fresh.end());
  const std::size_t n_old = vertex_number_.size(), n = n_old + fresh.size();
  std::vector<VertexHandle> to(n_old);
  TetMesh mesh;
  mesh.reserve_vertices(n);
  std::vector<std::uint64_t> numbers;
  std::vector<int> owners;
  std::vector<std::uint32_t> star_size, changed;
  std::vector<std::uint8_t> frozen;
  std::vector<CellHandle> incident;
  const auto add = [&](const VertexRecord& r, CellHandle c) {
    numbers.push_back(r.number);
    owners.push_back(r.owner);
    star_size.push_back(r.star_size);
    changed.push_back(r.changed);
    frozen.push_back(r.frozen);
    incident.push_back(c);
    return mesh.add_vertex(r.point);
  };
  for (std::size_t i = 0, k = 0; i < n_old || k < fresh.size();) {
    if (k == fresh.size() || (i < n_old && vertex_number_[i] < fresh[k].number)) {
      to[i] = add(record(VertexHandle(i)), mesh_.incident_cell(VertexHandle(i)));
      ++i;
    } else {
      add(fresh[k++], CellHandle());
    }
  }
  TetMesh::Writer writer(mesh);
  writer.resize_cells(mesh_.n_cells());
  for (std::size_t c = 0; c < mesh_.n_cells(); ++c) {
    Cell cell = mesh_.cell(CellHandle(c));
    for (VertexHandle& v : cell.v)
      if (v.is_valid()) v = to[v.idx()];
    writer.cell(CellHandle(c)) = cell;
    mesh.set_region(CellHandle(c), mesh_.region(CellHandle(c)));
  }
  for (std::size_t v = 0; v < n; ++v) writer.set_incident_cell(VertexHandle(v), incident[v]);
  for (std::size_t i = 0; i < n_old; ++i)
    if (mesh_.is_deleted(VertexHandle(i))) writer.mark_deleted(to[i]);
  RankSets one(n, comm_.size()), two(n, comm_.size()), known(n, comm_.size());
  for (std::size_t i = 0; i < n_old; ++i) {
    known.add(to[i].idx(), told_[i]);
    one.add(to[i].idx(), near1_[i]);
    two.add(to[i].idx(), near2_[i]);
  }
  near1_ = std::move(one);
  near2_ = std::move(two);
  told_ = std::move(known);
  mesh_ = std::move(mesh);
  vertex_number_ = std::move(numbers);
  owner_ = std::move(owners);
  work_.star_size = std::move(star_size);
  work_.changed = std::move(changed);
  work_.frozen = std::move(frozen);
}

void DistributedMesh::gather(TetMesh* mesh, Workspace* work, Gather what) {
  std::vector<VertexRecord> vertices;
  std::vector<CellRecord> cells;
  const auto has_changed = [&](VertexHandle v) {
    return what == Gather::kEverything || work_.changed[v.idx()] > clock_at_scatter_;
  };
  for (std::size_t i = 0; i < mesh_.n_vertices(); ++i) {
    const VertexHandle v(i);
    if (is_own(v) && (has_changed(v) || mesh_.is_deleted(v))) vertices.push_back(record(v));
  }
  for (std::size_t i = 0; i < mesh_.n_cells(); ++i) {
    const CellHandle c(i);
    if (mesh_.is_deleted(c) || !is_own(c)) continue;
    const auto& v = mesh_.cell(c).v;
    if (std::any_of(v.begin(), v.end(), has_changed)) cells.push_back(record(c));
  }
  std::vector<Packer> to(comm_.n_ranks());
  to[0].put_all(vertices);
  to[0].put_all(cells);
  const auto came = comm_.exchange(to);
  if (comm_.rank() != 0) return;
  TetMesh::Writer writer(*mesh);
  writer.resize_cells(n_slots_);
  work->grow(*mesh);
  work->clock = work_.clock;
  work->all_touched = true;
  writer.free_cells().clear();
  for (std::uint64_t c : free_) {
    writer.free_cells().push_back(CellHandle(c));
    writer.mark_deleted(CellHandle(c));
    work->quality[c] = std::numeric_limits<double>::infinity();
  }
  for (const Comm::Message& message : came) {
    Unpacker in(message.bytes);
    for (const VertexRecord& r : in.get_all<VertexRecord>()) {
      const VertexHandle v(r.number);
      mesh->set_point(v, r.point);
      writer.set_incident_cell(v, r.incident == kNoNumber ? CellHandle() : CellHandle(r.incident));
      work->star_size[v.idx()] = r.star_size;
      work->changed[v.idx()] = r.changed;
      if (r.deleted) writer.mark_deleted(v);
    }
    for (const CellRecord& r : in.get_all<CellRecord>()) {
      const CellHandle c(r.number);
      Cell& cell = writer.cell(c);
      for (std::size_t k = 0; k < 4; ++k) {
        cell.v[k] = VertexHandle(r.v[k]);
        cell.mate[k] = r.mate[k] == kNoNumber ? HalfFaceHandle() : HalfFaceHandle(r.mate[k]);
      }
      mesh->set_region(c, r.region);
      work->quality[c.idx()] = r.quality;
      work->pending[c.idx()] = r.pending;
    }
  }
}

}  // namespace hfr::mpi
