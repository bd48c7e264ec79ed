// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_TET_MESH_HH
#define HFR_HALFFACE_TET_MESH_HH

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/Errors.hh"
#include "HalfFace/Handles.hh"
#include "HalfFace/Labels.hh"
#include "HalfFace/Vec3.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// One tetrahedron: 32 bytes with 32-bit indices. mate[k] is the half-face that lies on half-face k from the
/// other side, invalid on the boundary. A deleted cell has invalid vertices.
struct Cell {
  std::array<VertexHandle, 4> v;
  std::array<HalfFaceHandle, 4> mate;

  /// Corner of vertex w; 4 when w is none of this cell's.
  int corner(VertexHandle w) const {
    for (int i = 0; i < 4; ++i)
      if (v[static_cast<std::size_t>(i)] == w) return i;
    return 4;
  }
  bool has(VertexHandle w) const { return v[0] == w || v[1] == w || v[2] == w || v[3] == w; }
};

/// Cells round one vertex, gathered once. Fixed memory, reusable; see TetMesh::gather_star.
struct Star {
  static constexpr int kCapacity = 256;
  int size = 0;
  std::array<CellHandle, kCapacity> cells;        ///< in order of discovery from the hook
  std::array<std::uint8_t, kCapacity> corners;    ///< corner of the vertex in each cell
  std::array<std::uint16_t, 2 * kCapacity> slot;  ///< hash table: 1 + position in cells
};

/// Old handle → new one, by index; invalid where it is gone.
struct GarbageMap {
  std::vector<VertexHandle> vertices;
  std::vector<CellHandle> cells;
};

struct GarbageOptions {
  bool drop_unused_vertices = false;  ///< also those that no cell uses
  par::Policy policy = {};
};

/// Tetrahedral mesh with four implicit half-faces a cell.
/// Invariant: mate(mate(h)) == h inside, and mates see their three vertices in opposite order.
/// Reading is thread-safe.
class TetMesh {
 public:
  // --- sizes; handles run from 0 to n-1, deleted ones included until collect_garbage() ---
  std::size_t n_vertices() const { return points_.size(); }
  std::size_t n_cells() const { return cells_.size(); }
  std::size_t n_logical_vertices() const { return points_.size() - n_deleted_vertices_; }
  std::size_t n_logical_cells() const { return cells_.size() - free_cells_.size(); }

  // --- cells and half-faces ---
  const Cell& cell(CellHandle c) const { return cells_[c.idx()]; }
  bool is_deleted(CellHandle c) const { return !cells_[c.idx()].v[0].is_valid(); }
  /// O(1). Invalid on the boundary.
  HalfFaceHandle opposite_halfface(HalfFaceHandle h) const { return cells_[h.idx() / 4].mate[h.idx() % 4]; }
  /// The three vertices of a half-face as its cell sees them: with the opposite vertex appended, a positive
  /// cell.
  std::array<VertexHandle, 3> halfface_vertices(HalfFaceHandle h) const {
    const Cell& k = cells_[h.idx() / 4];
    const auto& f = kFaceCorners[h.idx() % 4];
    return {k.v[f[0]], k.v[f[1]], k.v[f[2]]};
  }
  VertexHandle halfface_opposite_vertex(HalfFaceHandle h) const { return cells_[h.idx() / 4].v[h.idx() % 4]; }

  // --- vertices ---
  Vec3 point(VertexHandle v) const { return points_[v.idx()]; }
  void set_point(VertexHandle v, Vec3 p) { points_[v.idx()] = p; }
  std::span<const Vec3> points() const { return points_; }
  /// 3·n_vertices() doubles x0 y0 z0 x1 …; valid until a vertex is added.
  double* point_data() { return points_.empty() ? nullptr : &points_[0].x; }
  const double* point_data() const { return points_.empty() ? nullptr : &points_[0].x; }
  /// A cell of the vertex; invalid when no cell uses it.
  CellHandle hook(VertexHandle v) const { return hook_[v.idx()]; }
  bool is_deleted(VertexHandle v) const { return (vertex_status_[v.idx()] & kDeleted) != 0; }
  /// A fixed vertex is neither moved nor removed by any operator.
  bool is_fixed(VertexHandle v) const { return (vertex_status_[v.idx()] & kFixed) != 0; }
  void set_fixed(VertexHandle v, bool fixed = true) { set_bit(vertex_status_[v.idx()], kFixed, fixed); }

  // --- regions, labels ---
  bool has_regions() const { return !regions_.empty(); }
  int region(CellHandle c) const { return regions_.empty() ? 0 : regions_[c.idx()]; }
  void set_region(CellHandle c, int region);
  const Labels& labels() const { return labels_; }
  Labels& labels() { return labels_; }

  // --- what a new cell or vertex inherits ---
  /// Gives `to` the region, status and properties of `from`: for a cell born in a fresh slot. A cell born in
  /// the slot of a dead one keeps that slot's. Safe in parallel for distinct `to`.
  void copy_cell_data(CellHandle from, CellHandle to) {
    if (!regions_.empty()) regions_[to.idx()] = regions_[from.idx()];
    if (!cell_status_.empty()) cell_status_[to.idx()] = cell_status_[from.idx()];
  }
  /// Gives `to` the properties of `from` and whether it is selected or tagged; neither its label nor whether
  /// it is fixed, which are constraints. Safe in parallel for distinct `to`.
  void copy_vertex_data(VertexHandle from, VertexHandle to) {
    constexpr int kInherited = kSelected | kTagged;
    std::uint8_t& bits = vertex_status_[to.idx()];
    bits = static_cast<std::uint8_t>((bits & ~kInherited) | (vertex_status_[from.idx()] & kInherited));
  }

  /// True when no operator may remove the face of h: boundary, interface between regions, or labelled.
  bool is_constrained(HalfFaceHandle h) const {
    const HalfFaceHandle m = opposite_halfface(h);
    if (!m.is_valid()) return true;
    if (!regions_.empty() && regions_[h.idx() / 4] != regions_[m.idx() / 4]) return true;
    return !labels_.faces.empty() && labels_.faces.find(halfface_vertices(h)) != nullptr;
  }
  /// True when no operator may remove the edge (a, b) for its own sake (its faces may constrain it too).
  bool is_labelled_edge(VertexHandle a, VertexHandle b) const {
    return !labels_.edges.empty() && labels_.edges.find({a, b}) != nullptr;
  }

  // --- neighbourhoods in bulk, for operators ---
  /// Fills `star` with the cells that face-connect to the hook of v round v. False, with star.size == 0, when
  /// v has no cell or more than Star::kCapacity.
  bool gather_star(VertexHandle v, Star& star) const;
  /// The half-face through which a walk round the edge (a, b) leaves cell c counter-clockwise about a→b,
  /// given the vertex p of c such that (a, b, p, q) is positive: the one opposite p. See edge_ring() for a
  /// whole walk.
  HalfFaceHandle ring_exit(CellHandle c, VertexHandle p) const {
    return halfface_of(c, cells_[c.idx()].corner(p));
  }
  /// Visits the cells round local edge `edge` of cell c, starting with c: visit(cell, p, q) with (a, b, p, q)
  /// positive, counter-clockwise about a→b. Stops when visit returns false or the boundary is met.
  /// Returns true when the ring closed.
  template <class Visit>
  bool walk_ring(CellHandle c, int edge, Visit&& visit) const;
  /// The same walk in the other direction (clockwise about a→b), again starting with c itself.
  template <class Visit>
  bool walk_ring_back(CellHandle c, int edge, Visit&& visit) const;
  /// True when some cell has both vertices.
  bool has_edge(VertexHandle a, VertexHandle b, Star& scratch) const;
  /// True when some cell has all three vertices.
  bool has_face(VertexHandle a, VertexHandle b, VertexHandle c, Star& scratch) const;

  /// Gives every vertex and cell that is not deleted a handle without gaps, in the old order. Labels of faces
  /// and edges that no cell has any more are dropped.
  GarbageMap collect_garbage(GarbageOptions options = {});

  // --- low-level writing, for operators and builders; nothing is checked ---
  VertexHandle add_vertex(Vec3 p);
  void resize_cells(std::size_t n);  ///< new cells are deleted ones, not on the free list
  Cell& mutable_cell(CellHandle c) { return cells_[c.idx()]; }
  void set_mate(HalfFaceHandle h, HalfFaceHandle m) { cells_[h.idx() / 4].mate[h.idx() % 4] = m; }
  void set_hook(VertexHandle v, CellHandle c) { hook_[v.idx()] = c; }
  CellHandle& mutable_hook(VertexHandle v) { return hook_[v.idx()]; }
  void mark_deleted(CellHandle c) { cells_[c.idx()] = Cell{}; }
  void mark_deleted(VertexHandle v);
  /// Deleted cells that wait for reuse, in the order in which they are to be taken (from the back).
  std::vector<CellHandle>& free_cells() { return free_cells_; }
  const std::vector<CellHandle>& free_cells() const { return free_cells_; }

 private:
  friend class MeshBuilder;
  enum StatusBit : std::uint8_t { kDeleted = 1, kFixed = 2, kSelected = 4, kTagged = 8 };
  static void set_bit(std::uint8_t& bits, std::uint8_t bit, bool on) {
    bits = static_cast<std::uint8_t>(on ? bits | bit : bits & ~bit);
  }

  void renumber(const GarbageMap& map, std::size_t n_vertices, std::size_t n_cells, par::Policy policy);

  std::vector<Cell> cells_;
  std::vector<int> regions_;               // empty while every cell is in region 0
  std::vector<std::uint8_t> cell_status_;  // empty until a bit is set
  std::vector<CellHandle> free_cells_;
  std::vector<Vec3> points_;
  std::vector<CellHandle> hook_;
  std::vector<std::uint8_t> vertex_status_;
  std::size_t n_deleted_vertices_ = 0;
  Labels labels_;
};

/// What build() had to mend.
struct BuildReport {
  bool flipped = false;                ///< the file orders every cell the other way round
  std::vector<CellHandle> reoriented;  ///< cells whose order contradicted their neighbours'
};

/// Builds the connectivity of a mesh from arrays: n points, m cells of four 0-based point indices in either
/// orientation. Cells that contradict their neighbours are put into the neighbours' orientation, which may
/// make them inverted: that is the truth about them; the whole is flipped when most cells are then negative.
/// Handles equal array indices. Throws InvalidInput for an index out of range, a repeated vertex in a cell, a
/// coordinate that is not finite, a face with three cells, or cells that cannot be oriented alike.
TetMesh build(std::vector<Vec3> points, std::span<const std::array<Index, 4>> cells, par::Policy policy = {},
              BuildReport* report = nullptr);

template <class Visit>
bool TetMesh::walk_ring(CellHandle c, int edge, Visit&& visit) const {
  const Cell* k = &cells_[c.idx()];
  const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(edge)];
  VertexHandle p = k->v[opposite[0]];
  VertexHandle q = k->v[opposite[1]];
  const CellHandle first = c;
  int exit = opposite[0];
  for (;;) {
    if (!visit(c, p, q)) return false;
    const HalfFaceHandle m = k->mate[static_cast<std::size_t>(exit)];
    if (!m.is_valid()) return false;
    c = cell_of(m);
    if (c == first) return true;
    k = &cells_[c.idx()];
    p = q;
    q = k->v[m.idx() % 4];
    exit = k->corner(p);
  }
}

template <class Visit>
bool TetMesh::walk_ring_back(CellHandle c, int edge, Visit&& visit) const {
  const Cell* k = &cells_[c.idx()];
  const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(edge)];
  VertexHandle p = k->v[opposite[0]];
  VertexHandle q = k->v[opposite[1]];
  const CellHandle first = c;
  int exit = opposite[1];
  for (;;) {
    if (!visit(c, p, q)) return false;
    const HalfFaceHandle m = k->mate[static_cast<std::size_t>(exit)];
    if (!m.is_valid()) return false;
    c = cell_of(m);
    if (c == first) return true;
    k = &cells_[c.idx()];
    q = p;
    p = k->v[m.idx() % 4];
    exit = k->corner(q);
  }
}

}  // namespace hfr

#endif
