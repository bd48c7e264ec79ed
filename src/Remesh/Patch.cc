// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Patch.hh"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "HalfFace/Layers.hh"
#include "HalfFace/TupleMap.hh"
#include "HalfFace/Writer.hh"
#include "Operators/Cavity.hh"

namespace hfr {

Patch::Patch(const TetMesh& whole, CellHandle centre, int layers, std::span<const std::uint8_t> pinched)
    : cells_(cells_within(whole, centre, layers)) {
  std::unordered_map<VertexHandle, Index> local;
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> tets;
  for (CellHandle c : cells_) {
    std::array<Index, 4>& tet = tets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      const VertexHandle v = whole.cell(c).v[i];
      const auto [at, is_new] = local.try_emplace(v, static_cast<Index>(vertices_.size()));
      if (is_new) {
        vertices_.push_back(v);
        points.push_back(whole.point(v));
      }
      tet[i] = at->second;
    }
  }
  mesh_ = build(std::move(points), tets);
  copy_constraints(whole, pinched);
}

/// Fixed and labelled vertices stay what they are; an edge or a face that may not change is a labelled one
/// here.
void Patch::copy_constraints(const TetMesh& whole, std::span<const std::uint8_t> pinched) {
  Labels& labels = mesh_.labels();
  if (!whole.labels().vertices.empty()) labels.vertices.resize(vertices_.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const bool is_pinched = !pinched.empty() && pinched[vertices_[i].idx()] != 0;
    mesh_.set_fixed(VertexHandle(i), is_pinched || whole.is_fixed(vertices_[i]));
    if (!labels.vertices.empty()) labels.vertices[i] = whole.labels().vertex(vertices_[i]);
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const auto& there = whole.cell(cells_[i]).v;
    const auto& here = mesh_.cell(CellHandle(i)).v;  // in the same order: build() turns no positive cell
    for (const auto& e : kEdgeCorners)
      if (whole.is_labelled_edge(there[e[0]], there[e[1]]) ||
          whole.locks().edges.find({there[e[0]], there[e[1]]}))
        labels.edges.set({here[e[0]], here[e[1]]}, 1);
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(cells_[i], k);
      auto face = mesh_.halfface_vertices(halfface_of(CellHandle(i), k));
      if (whole.opposite_halfface(h).is_valid()) {
        if (whole.is_constrained(h)) labels.faces.set(face, 1);
        continue;
      }
      const auto& known = whole.labels().faces;
      const std::size_t at = known.position(whole.halfface_vertices(h));
      if (at == known.size()) continue;
      const auto& entry = known.entries()[at];
      if (CyclicOrder::key(entry.vertices) != CyclicOrder::key(whole.halfface_vertices(h)))
        std::swap(face[1], face[2]);
      labels.faces.set(face, entry.value);
    }
  }
}

bool Patch::fits(const TetMesh& whole, const TetMesh& changed) const {
  const auto for_simplices = [](const TetMesh& mesh, CellHandle c, auto&& visit) {
    const auto& v = mesh.cell(c).v;
    for (const auto& e : kEdgeCorners) visit(Simplex{v[e[0]], v[e[1]], VertexHandle()});
    for (const auto& f : kFaceCorners) visit(Simplex{v[f[0]], v[f[1]], v[f[2]]});
  };
  const auto in_order = [](Simplex simplex) {
    std::sort(simplex.begin(), simplex.end());  // an invalid handle is the last
    return simplex;
  };
  std::unordered_set<Simplex, TupleHash> known, born;
  for (CellHandle c : mesh_.cells())
    for_simplices(mesh_, c, [&](const Simplex& simplex) { known.insert(in_order(simplex)); });
  std::vector<std::uint8_t> has_born(whole.n_vertices(), 0);
  for (CellHandle c : changed.cells()) {
    for_simplices(changed, c, [&](Simplex simplex) {
      const bool is_of_old_vertices = std::all_of(simplex.begin(), simplex.end(), [&](VertexHandle v) {
        return !v.is_valid() || v.idx() < vertices_.size();
      });
      if (!is_of_old_vertices || known.contains(in_order(simplex))) return;
      for (VertexHandle& v : simplex) {
        if (!v.is_valid()) continue;
        v = vertices_[v.idx()];
        has_born[v.idx()] = 1;
      }
      born.insert(in_order(simplex));
    });
  }
  if (born.empty()) return true;
  const std::unordered_set<CellHandle> mine(cells_.begin(), cells_.end());
  for (CellHandle c : whole.cells()) {
    const auto& v = whole.cell(c).v;
    if (std::count_if(v.begin(), v.end(), [&](VertexHandle u) { return has_born[u.idx()] != 0; }) < 2 ||
        mine.contains(c))
      continue;
    bool is_double = false;
    for_simplices(whole, c,
                  [&](const Simplex& simplex) { is_double = is_double || born.contains(in_order(simplex)); });
    if (is_double) return false;
  }
  return true;
}

/// Where a patch meets the rest of its mesh.
struct Patch::Rim {
  std::unordered_map<std::array<VertexHandle, 3>, HalfFaceHandle, TupleHash> behind;  ///< faces, in any order
  std::vector<std::array<VertexHandle, 3>> boundary;  ///< those that face nothing
};

Patch::Rim Patch::rim(const TetMesh& whole) const {
  Rim rim;
  const std::unordered_set<CellHandle> old(cells_.begin(), cells_.end());
  for (CellHandle c : cells_) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = whole.opposite_halfface(h);
      if (m.is_valid() && old.contains(cell_of(m))) continue;
      const auto face = AnyOrder::key(whole.halfface_vertices(h));
      rim.behind[face] = m;
      if (!m.is_valid()) rim.boundary.push_back(face);
    }
  }
  return rim;
}

std::vector<VertexHandle> Patch::put_vertices(TetMesh& whole, TetMesh::Writer& writer,
                                              const TetMesh& changed) const {
  std::vector<VertexHandle> vertices = vertices_;
  for (std::size_t i = 0; i < changed.n_vertices(); ++i) {
    const VertexHandle local(i);
    if (i < vertices_.size()) {
      if (changed.is_deleted(local))
        writer.mark_deleted(vertices[i]);
      else
        whole.set_point(vertices[i], changed.point(local));
      continue;
    }
    vertices.push_back(VertexHandle());
    if (changed.is_deleted(local)) continue;
    const auto distance = [&](VertexHandle v) { return norm2(whole.point(v) - changed.point(local)); };
    const VertexHandle nearest =
        *std::min_element(vertices_.begin(), vertices_.end(),
                          [&](VertexHandle a, VertexHandle b) { return distance(a) < distance(b); });
    vertices.back() = whole.add_vertex(changed.point(local));
    whole.copy_vertex_data(nearest, vertices.back());
  }
  return vertices;
}

std::vector<CellHandle> Patch::slots_for(TetMesh& whole, TetMesh::Writer& writer,
                                         const TetMesh& changed) const {
  std::vector<CellHandle> slots(changed.n_cells());
  std::vector<CellHandle>& free = writer.free_cells();
  std::size_t n_used = 0;
  for (std::size_t i = 0; i < changed.n_cells(); ++i) {
    if (changed.is_deleted(CellHandle(i))) continue;
    if (n_used < cells_.size()) {
      slots[i] = cells_[n_used++];
      continue;
    }
    if (free.empty()) {
      writer.resize_cells(whole.n_cells() + 1);
      free.push_back(CellHandle(whole.n_cells() - 1));
    }
    slots[i] = free.back();
    free.pop_back();
    whole.copy_cell_data(cells_[0], slots[i]);
  }
  for (std::size_t i = n_used; i < cells_.size(); ++i) {
    writer.mark_deleted(cells_[i]);
    free.push_back(cells_[i]);
  }
  return slots;
}

namespace {

class LabelsOfMesh : public FaceLabels {
 public:
  explicit LabelsOfMesh(TetMesh& mesh) : mesh_(mesh) {}
  void set(const std::array<VertexHandle, 3>& face, int label) override {
    mesh_.labels().faces.set(face, label);
  }
  void erase(const std::array<VertexHandle, 3>& face) override { mesh_.labels().faces.erase_unordered(face); }

 private:
  TetMesh& mesh_;
};

}  // namespace

void Patch::put_back(TetMesh& whole, const TetMesh& changed) const {
  LabelsOfMesh labels(whole);
  write(whole, changed, labels);
}

void Patch::put_back(TetMesh& whole, const TetMesh& changed, FaceLabels& labels) const {
  write(whole, changed, labels);
}

void Patch::put_back(TetMesh& whole, const TetMesh& changed, Workspace& work) const {
  for (CellHandle c : cells_)
    for (VertexHandle v : whole.cell(c).v) --work.star_size[v.idx()];
  LabelsOfMesh labels(whole);
  std::vector<CellHandle> cells = write(whole, changed, labels);
  work.grow(whole);
  std::vector<VertexHandle> vertices = vertices_;
  std::erase_if(cells, [](CellHandle c) { return !c.is_valid(); });
  for (CellHandle c : cells)
    for (VertexHandle v : whole.cell(c).v) {
      ++work.star_size[v.idx()];
      vertices.push_back(v);
    }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (VertexHandle v : vertices) work.changed[v.idx()] = work.clock;
  cells.insert(cells.end(), cells_.begin(), cells_.end());  // some of which are none now
  for (CellHandle c : cells) work.pending[c.idx()] = 0xff;
  work.all_touched = true;
  work.renew_qualities(whole, cells, par::Policy{1});
  work.look_for_pinched(whole, vertices);
}

std::vector<CellHandle> Patch::write(TetMesh& whole, const TetMesh& changed, FaceLabels& labels) const {
  const Rim rim = this->rim(whole);
  TetMesh::Writer writer(whole);
  const std::vector<VertexHandle> vertices = put_vertices(whole, writer, changed);
  const std::vector<CellHandle> slots = slots_for(whole, writer, changed);
  std::unordered_set<std::array<VertexHandle, 3>, TupleHash> kept;  // faces of the rim
  for (std::size_t i = 0; i < changed.n_cells(); ++i) {
    const CellHandle local(i);
    if (changed.is_deleted(local)) continue;
    Cell& cell = writer.cell(slots[i]);
    for (std::size_t k = 0; k < 4; ++k) {
      cell.v[k] = vertices[changed.cell(local).v[k].idx()];
      writer.set_incident_cell(cell.v[k], slots[i]);
    }
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(slots[i], k);
      const HalfFaceHandle m = changed.opposite_halfface(halfface_of(local, k));
      if (m.is_valid()) {
        writer.set_mate(h, halfface_of(slots[cell_of(m).idx()], static_cast<int>(m.idx() % 4)));
        continue;
      }
      const auto face = whole.halfface_vertices(h);
      const auto at = rim.behind.find(AnyOrder::key(face));
      if (at == rim.behind.end()) {  // new on the surface
        writer.set_mate(h, HalfFaceHandle());
        const auto& known = changed.labels().faces;
        const std::size_t entry = known.position(changed.halfface_vertices(halfface_of(local, k)));
        if (entry == known.size()) continue;
        const auto& v = known.entries()[entry].vertices;
        labels.set({vertices[v[0].idx()], vertices[v[1].idx()], vertices[v[2].idx()]},
                   known.entries()[entry].value);
        continue;
      }
      kept.insert(at->first);
      writer.set_mate(h, at->second);
      if (at->second.is_valid()) writer.set_mate(at->second, h);
    }
  }
  for (const auto& face : rim.boundary)
    if (!kept.contains(face)) labels.erase(face);
  return slots;
}

}  // namespace hfr
