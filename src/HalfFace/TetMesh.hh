// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_TET_MESH_HH
#define HFR_HALFFACE_TET_MESH_HH

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/Cell.hh"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/Labels.hh"
#include "hfremesh/HalfFace/PropertyAccess.hh"
#include "hfremesh/HalfFace/Vec3.hh"
#include "hfremesh/Parallel/Parallel.hh"

namespace hfr {

/// Old handle → new one, by index; invalid where it is gone.
struct GarbageMap {
  std::vector<VertexHandle> vertices;
  std::vector<CellHandle> cells;
};

struct GarbageOptions {
  bool drop_unused_vertices = false;  ///< also those that no cell uses
  par::Policy policy = {};
};

struct ReorderOptions;

// What the queries below return; all are C++20 views that do not allocate, see Circulators.hh.
template <class T, std::size_t N>
class FixedList;
template <class H, bool kOnlyBoundary>
class MeshRange;
template <class H>
using AllRange = MeshRange<H, false>;
template <class H>
using BoundaryRange = MeshRange<H, true>;
template <class Policy>
class StarRange;
template <class Policy>
class RingRange;
class VertexVertices;
namespace policy {
struct StarCells;
struct StarEdges;
struct StarFaces;
struct StarHalfFaces;
template <bool kOutgoing>
struct StarHalfEdges;
struct RingCells;
struct RingFaces;
struct RingHalfFaces;
struct RingBothHalfFaces;
}  // namespace policy

/// Tetrahedral mesh with four implicit half-faces a cell.
/// Invariant: mate(mate(h)) == h inside, and mates see their three vertices in opposite order.
/// Reading is thread-safe.
class TetMesh : public PropertyAccess<TetMesh> {
 public:
  // --- sizes; handles run from 0 to n-1, deleted ones included until collect_garbage() ---
  /// More would leave no index for the 12 half-edges of each. What asks for more throws ResourceLimit.
  static constexpr std::size_t kMostCells = HalfFaceHandle::kInvalid / 12;
  std::size_t n_vertices() const { return points_.size(); }
  std::size_t n_cells() const { return cells_.size(); }
  std::size_t n_logical_vertices() const { return points_.size() - n_deleted_vertices_.n; }
  std::size_t n_logical_cells() const { return cells_.size() - free_cells_.size(); }
  /// Whether a vertex or cell has been deleted since collect_garbage().
  bool needs_garbage_collection() const { return n_deleted_vertices_.n > 0 || !free_cells_.empty(); }
  // What follows is there as long as a cell has it, so all of it is logical.
  std::size_t n_edges() const;  ///< by counting: O(n)
  std::size_t n_faces() const;  ///< by counting: O(n)
  std::size_t n_halfedges() const { return 2 * n_edges(); }
  /// Half-faces that have a cell: the outer side of a boundary face is not stored.
  std::size_t n_halffaces() const { return 4 * n_logical_cells(); }
  std::size_t n_logical_edges() const { return n_edges(); }
  std::size_t n_logical_faces() const { return n_faces(); }
  std::size_t n_logical_halfedges() const { return n_halfedges(); }
  std::size_t n_logical_halffaces() const { return n_halffaces(); }
  /// 1 - (vertices - edges + faces - cells): 0 for a solid ball. O(n).
  int genus() const;
  std::size_t memory_bytes() const;  ///< heap memory of everything, capacity included

  // --- every thing of a kind by ascending handle; the deleted left out ---
  AllRange<VertexHandle> vertices() const;
  AllRange<EdgeHandle> edges() const;
  AllRange<HalfEdgeHandle> halfedges() const;
  AllRange<FaceHandle> faces() const;
  AllRange<HalfFaceHandle> halffaces() const;
  AllRange<CellHandle> cells() const;
  BoundaryRange<VertexHandle> boundary_vertices() const;
  BoundaryRange<EdgeHandle> boundary_edges() const;
  BoundaryRange<HalfEdgeHandle> boundary_halfedges() const;
  BoundaryRange<FaceHandle> boundary_faces() const;
  BoundaryRange<HalfFaceHandle> boundary_halffaces() const;
  BoundaryRange<CellHandle> boundary_cells() const;
  /// True when the handle names a thing of the mesh: in range, not deleted, and for faces, edges and
  /// half-edges the canonical handle. O(1); O(ring) for edges and half-edges.
  bool exists(VertexHandle v) const { return v.idx() < n_vertices() && !is_deleted(v); }
  bool exists(CellHandle c) const { return c.idx() < n_cells() && !is_deleted(c); }
  bool exists(HalfFaceHandle h) const { return exists(cell_of(h)); }
  bool exists(FaceHandle f) const {
    const HalfFaceHandle h(f.idx());
    return exists(h) && h < opposite_halfface(h);  // an invalid mate is larger than any
  }
  bool exists(EdgeHandle e) const;
  bool exists(HalfEdgeHandle e) const { return exists(edge_handle(e)); }
  /// The local edges of c whose ring has no smaller cell, a bit each: the edges that have their handles from
  /// c. 0 for a deleted cell. O(rings) of those that no neighbour of c is smaller for.
  unsigned first_edges(CellHandle c) const;

  // --- round a vertex: the cells that connect to its incident cell through faces at the vertex ---
  /// In order of discovery from the incident cell. O(star); O(mesh) for a vertex with more than
  /// Star::kCapacity cells, which is given all its cells, connected or not.
  StarRange<policy::StarCells> vertex_cells(VertexHandle v) const;
  StarRange<policy::StarEdges> vertex_edges(VertexHandle v) const;
  StarRange<policy::StarFaces> vertex_faces(VertexHandle v) const;
  StarRange<policy::StarHalfFaces> vertex_halffaces(VertexHandle v) const;
  StarRange<policy::StarHalfEdges<true>> outgoing_halfedges(VertexHandle v) const;
  StarRange<policy::StarHalfEdges<false>> incoming_halfedges(VertexHandle v) const;
  VertexVertices vertex_vertices(VertexHandle v) const;
  std::size_t valence(VertexHandle v) const;  ///< number of vertices that it shares an edge with

  // --- round an edge, counter-clockwise; a fan starts at the boundary. One cell record a step ---
  RingRange<policy::RingCells> edge_cells(EdgeHandle e) const;
  RingRange<policy::RingFaces> edge_faces(EdgeHandle e) const;
  RingRange<policy::RingBothHalfFaces> edge_halffaces(EdgeHandle e) const;
  RingRange<policy::RingCells> halfedge_cells(HalfEdgeHandle e) const;
  RingRange<policy::RingFaces> halfedge_faces(HalfEdgeHandle e) const;
  /// The half-faces that have the half-edge in its direction, one a cell.
  RingRange<policy::RingHalfFaces> halfedge_halffaces(HalfEdgeHandle e) const;
  std::size_t valence(EdgeHandle e) const;  ///< number of faces

  // --- edges and half-edges ---
  std::array<VertexHandle, 2> edge_vertices(EdgeHandle e) const {
    return halfedge_vertices(HalfEdgeHandle(2 * e.idx()));
  }
  std::array<VertexHandle, 2> halfedge_vertices(HalfEdgeHandle e) const {
    return {from_vertex(e), to_vertex(e)};
  }
  VertexHandle from_vertex(HalfEdgeHandle e) const { return end_vertex(e, e.idx() % 2); }
  VertexHandle to_vertex(HalfEdgeHandle e) const { return end_vertex(e, 1 - e.idx() % 2); }
  static EdgeHandle edge_handle(HalfEdgeHandle e) { return EdgeHandle(e.idx() / 2); }
  /// side 0 or 1.
  static HalfEdgeHandle halfedge_handle(EdgeHandle e, int side) {
    return HalfEdgeHandle(2 * e.idx() + static_cast<Index>(side));
  }
  static HalfEdgeHandle opposite_halfedge(HalfEdgeHandle e) { return HalfEdgeHandle(e.idx() ^ 1U); }
  /// Handle of local edge 0 … 5 of a cell. O(ring).
  EdgeHandle edge_in_cell(CellHandle c, int local_edge) const;
  /// Handle of the half-edge between two different corners of a cell. O(ring).
  HalfEdgeHandle halfedge_in_cell(CellHandle c, int from_corner, int to_corner) const;
  HalfEdgeHandle next_halfedge_in_halfface(HalfEdgeHandle e, HalfFaceHandle h) const;
  HalfEdgeHandle prev_halfedge_in_halfface(HalfEdgeHandle e, HalfFaceHandle h) const;

  // --- faces and half-faces ---
  static CellHandle incident_cell(HalfFaceHandle h) { return cell_of(h); }
  FaceHandle face_handle(HalfFaceHandle h) const {
    const HalfFaceHandle m = opposite_halfface(h);
    return FaceHandle(h < m ? h.idx() : m.idx());
  }
  /// side 0 or 1; side 1 is invalid on the boundary.
  HalfFaceHandle halfface_handle(FaceHandle f, int side) const {
    return side == 0 ? HalfFaceHandle(f.idx()) : opposite_halfface(HalfFaceHandle(f.idx()));
  }
  FixedList<HalfFaceHandle, 2> face_halffaces(FaceHandle f) const;
  FixedList<CellHandle, 2> face_cells(FaceHandle f) const;
  std::array<VertexHandle, 3> face_vertices(FaceHandle f) const {
    return halfface_vertices(HalfFaceHandle(f.idx()));
  }
  std::array<HalfEdgeHandle, 3> face_halfedges(FaceHandle f) const {
    return halfface_halfedges(HalfFaceHandle(f.idx()));
  }
  std::array<EdgeHandle, 3> face_edges(FaceHandle f) const { return halfface_edges(HalfFaceHandle(f.idx())); }
  /// Half-edge i goes from vertex i of halfface_vertices() to the next.
  std::array<HalfEdgeHandle, 3> halfface_halfedges(HalfFaceHandle h) const;
  std::array<EdgeHandle, 3> halfface_edges(HalfFaceHandle h) const;
  static constexpr std::size_t valence(FaceHandle) { return 3; }
  /// The other half-face of the cell of h that has the edge; the edge is one of h. O(1).
  HalfFaceHandle adjacent_halfface_in_cell(HalfFaceHandle h, EdgeHandle e) const {
    return adjacent_halfface_in_cell(h, halfedge_handle(e, 0));
  }
  HalfFaceHandle adjacent_halfface_in_cell(HalfFaceHandle h, HalfEdgeHandle e) const;
  /// The boundary half-face on the other side of an edge of boundary half-face h. O(ring).
  HalfFaceHandle adjacent_halfface_on_surface(HalfFaceHandle h, HalfEdgeHandle e) const;
  /// Its three neighbours on the boundary, across halfface_halfedges(h) in turn.
  std::array<HalfFaceHandle, 3> boundary_halfface_halffaces(HalfFaceHandle h) const;
  bool is_incident(FaceHandle f, EdgeHandle e) const;

  // --- round and in a cell ---
  FixedList<CellHandle, 4> cell_cells(CellHandle c) const;
  const std::array<VertexHandle, 4>& cell_vertices(CellHandle c) const { return cell(c).v; }
  /// Beginning with v, the rest so that the order stays a positive one.
  std::array<VertexHandle, 4> cell_vertices(CellHandle c, VertexHandle v) const;
  /// The vertices of half-face h, then the one opposite: a positive order.
  std::array<VertexHandle, 4> cell_vertices(HalfFaceHandle h) const {
    const auto f = halfface_vertices(h);
    return {f[0], f[1], f[2], halfface_opposite_vertex(h)};
  }
  /// Half-face k lies opposite vertex k.
  std::array<HalfFaceHandle, 4> cell_halffaces(CellHandle c) const {
    return {halfface_of(c, 0), halfface_of(c, 1), halfface_of(c, 2), halfface_of(c, 3)};
  }
  std::array<FaceHandle, 4> cell_faces(CellHandle c) const;
  std::array<EdgeHandle, 6> cell_edges(CellHandle c) const;
  std::array<HalfEdgeHandle, 12> cell_halfedges(CellHandle c) const;
  static constexpr std::size_t valence(CellHandle) { return 4; }
  HalfFaceHandle vertex_opposite_halfface(CellHandle c, VertexHandle v) const {
    return halfface_of(c, cell(c).corner(v));
  }

  // --- on the boundary? ---
  bool is_boundary(VertexHandle v) const;  ///< O(star)
  bool is_boundary(EdgeHandle e) const { return is_boundary(halfedge_handle(e, 0)); }
  bool is_boundary(HalfEdgeHandle e) const;  ///< O(ring)
  bool is_boundary(FaceHandle f) const { return is_boundary(HalfFaceHandle(f.idx())); }
  /// True when nothing lies on the other side.
  bool is_boundary(HalfFaceHandle h) const { return !opposite_halfface(h).is_valid(); }
  bool is_boundary(CellHandle c) const;  ///< a face of it is

  // --- by vertices; invalid when there is none among the cells that vertex_cells() gives for one of them:
  // O(star)
  EdgeHandle find_edge(VertexHandle a, VertexHandle b) const;
  HalfEdgeHandle find_halfedge(VertexHandle from, VertexHandle to) const;
  HalfEdgeHandle find_halfedge_in_cell(VertexHandle from, VertexHandle to, CellHandle c) const;
  FaceHandle find_face(const std::array<VertexHandle, 3>& vertices) const;  ///< in any order
  /// In this cyclic order.
  HalfFaceHandle find_halfface(const std::array<VertexHandle, 3>& vertices) const;
  HalfFaceHandle find_halfface_in_cell(const std::array<VertexHandle, 3>& vertices, CellHandle c) const;
  CellHandle find_cell(const std::array<VertexHandle, 4>& vertices) const;  ///< in any order

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
  /// The same, beginning with `from`; throws InvalidInput when that is none of them.
  std::array<VertexHandle, 3> halfface_vertices(HalfFaceHandle h, VertexHandle from) const;
  VertexHandle halfface_opposite_vertex(HalfFaceHandle h) const { return cells_[h.idx() / 4].v[h.idx() % 4]; }

  // --- vertices ---
  Vec3 point(VertexHandle v) const { return points_[v.idx()]; }
  void set_point(VertexHandle v, Vec3 p) { points_[v.idx()] = p; }
  std::span<const Vec3> points() const { return points_; }
  /// 3·n_vertices() doubles x0 y0 z0 x1 …; valid until a vertex is added.
  double* point_data() { return points_.empty() ? nullptr : &points_[0].x; }
  const double* point_data() const { return points_.empty() ? nullptr : &points_[0].x; }
  /// A cell of the vertex; invalid when no cell uses it.
  CellHandle incident_cell(VertexHandle v) const { return incident_cell_[v.idx()]; }
  bool is_deleted(VertexHandle v) const { return (vertex_status_[v.idx()] & kDeleted) != 0; }
  // Edges and faces go with their last cell. A handle that is no longer the canonical one counts as deleted.
  bool is_deleted(EdgeHandle e) const { return !exists(e); }
  bool is_deleted(HalfEdgeHandle e) const { return !exists(e); }
  bool is_deleted(FaceHandle f) const { return !exists(f); }
  bool is_deleted(HalfFaceHandle h) const { return !exists(h); }
  /// A fixed vertex is neither moved nor removed by any operator.
  bool is_fixed(VertexHandle v) const { return (vertex_status_[v.idx()] & kFixed) != 0; }
  void set_fixed(VertexHandle v, bool fixed = true) { set_bit(vertex_status_[v.idx()], kFixed, fixed); }

  /// A fixed edge or face is not removed by any operator, and its vertices are neither moved nor removed.
  /// Like a label it hangs on its vertices: it stays through renumbering and goes when no cell has it any
  /// more.
  bool is_fixed(EdgeHandle e) const { return locks_.edges.find(edge_vertices(e)) != nullptr; }
  bool is_fixed(FaceHandle f) const { return locks_.faces.find(face_vertices(f)) != nullptr; }
  void set_fixed(EdgeHandle e, bool fixed = true);
  void set_fixed(FaceHandle f, bool fixed = true);
  /// All faces of a fixed patch, those with that label, are as if fixed.
  bool is_fixed_patch(int label) const { return locks_.patches.contains(label); }
  void set_fixed_patch(int label, bool fixed = true);
  /// The fixed edges, faces and patches; of the vertices see is_fixed().
  const Locks& locks() const { return locks_; }

  // --- status bits for the user; no operator reads these ---
  bool is_selected(VertexHandle v) const { return (vertex_status_[v.idx()] & kSelected) != 0; }
  bool is_tagged(VertexHandle v) const { return (vertex_status_[v.idx()] & kTagged) != 0; }
  void set_selected(VertexHandle v, bool on = true) { set_bit(vertex_status_[v.idx()], kSelected, on); }
  void set_tagged(VertexHandle v, bool on = true) { set_bit(vertex_status_[v.idx()], kTagged, on); }
  bool is_fixed(CellHandle c) const { return has_cell_bit(c, kFixed); }
  bool is_selected(CellHandle c) const { return has_cell_bit(c, kSelected); }
  bool is_tagged(CellHandle c) const { return has_cell_bit(c, kTagged); }
  void set_fixed(CellHandle c, bool on = true) { set_cell_bit(c, kFixed, on); }
  void set_selected(CellHandle c, bool on = true) { set_cell_bit(c, kSelected, on); }
  void set_tagged(CellHandle c, bool on = true) { set_cell_bit(c, kTagged, on); }
  /// Makes room for the status of cells (a byte each), as the first set_…(cell) does; after it those are safe
  /// in parallel for distinct cells.
  void request_cell_status() { cell_status_.resize(cells_.size(), 0); }

  // --- regions, labels ---
  bool has_regions() const { return !regions_.empty(); }
  int region(CellHandle c) const { return regions_.empty() ? 0 : regions_[c.idx()]; }
  void set_region(CellHandle c, int region);
  const Labels& labels() const { return labels_; }
  Labels& labels() { return labels_; }

  // --- properties: request_…_property and get_…_property are of PropertyAccess ---
  /// By kind: names(), remove(name).
  PropertySet& properties() { return properties_; }
  const PropertySet& properties() const { return properties_; }

  // --- what a new cell or vertex inherits ---
  /// Gives `to` the region, status and properties of `from`: for a cell created in a fresh slot. A cell
  /// created in the slot of a removed one keeps that slot's. Safe in parallel for distinct `to`.
  void copy_cell_data(CellHandle from, CellHandle to) {
    if (!regions_.empty()) regions_[to.idx()] = regions_[from.idx()];
    if (!cell_status_.empty()) cell_status_[to.idx()] = cell_status_[from.idx()];
    for (const auto& p : properties_.cells) p->copy(from.idx(), to.idx());
  }
  /// Gives `to` the properties of `from` and whether it is selected or tagged; neither its label nor whether
  /// it is fixed, which are constraints. Safe in parallel for distinct `to`.
  void copy_vertex_data(VertexHandle from, VertexHandle to) {
    constexpr int kInherited = kSelected | kTagged;
    std::uint8_t& bits = vertex_status_[to.idx()];
    bits = static_cast<std::uint8_t>((bits & ~kInherited) | (vertex_status_[from.idx()] & kInherited));
    for (const auto& p : properties_.vertices) p->copy(from.idx(), to.idx());
  }

  /// True when no operator may remove the face of h: boundary, interface between regions, labelled or fixed.
  bool is_constrained(HalfFaceHandle h) const {
    const HalfFaceHandle m = opposite_halfface(h);
    if (!m.is_valid()) return true;
    if (!regions_.empty() && regions_[h.idx() / 4] != regions_[m.idx() / 4]) return true;
    if (!locks_.faces.empty() && locks_.faces.find(halfface_vertices(h))) return true;
    return !labels_.faces.empty() && labels_.faces.find(halfface_vertices(h)) != nullptr;
  }
  /// True when no operator may remove the edge (a, b) for its own sake (its faces may constrain it too).
  bool is_labelled_edge(VertexHandle a, VertexHandle b) const {
    return !labels_.edges.empty() && labels_.edges.find({a, b}) != nullptr;
  }

  // --- neighbourhoods in bulk, for operators ---
  /// Fills `star` with the cells that face-connect to the incident cell of v round v. False, with star.size
  /// == 0, when v has no cell or more than Star::kCapacity.
  bool gather_star(VertexHandle v, Star& star) const;
  /// Fills `ring` with the cells round a→b, from the cell of `start` when they go all the way round, else
  /// from the boundary. False, with ring.size == 0, when there are more than Ring::kCapacity.
  bool gather_ring(RingPlace start, Ring& ring) const;
  /// For a ring that gather_ring() refuses: puts its first cell, and closed, into `ring`; returns how many
  /// there are.
  int start_large_ring(RingPlace start, Ring& ring) const;
  /// Where the handle of a half-edge begins: with the smallest cell.
  RingPlace ring_place(HalfEdgeHandle e) const {
    const auto& opposite = kEdgeOpposite[e.idx() / 2 % 6];
    return {CellHandle(e.idx() / 12), opposite[e.idx() % 2], opposite[1 - e.idx() % 2]};
  }
  /// The next cell counter-clockwise about a→b; an invalid one at the boundary.
  RingPlace next_in_ring(RingPlace at) const {
    const Cell& k = cells_[at.cell.idx()];
    const HalfFaceHandle m = k.mate[at.p];
    if (!m.is_valid()) return {};
    return {cell_of(m), cells_[m.idx() / 4].own_corner(k.v[at.q]), static_cast<std::uint8_t>(m.idx() % 4)};
  }
  /// The next cell clockwise.
  RingPlace previous_in_ring(RingPlace at) const {
    const Cell& k = cells_[at.cell.idx()];
    const HalfFaceHandle m = k.mate[at.q];
    if (!m.is_valid()) return {};
    return {cell_of(m), static_cast<std::uint8_t>(m.idx() % 4), cells_[m.idx() / 4].own_corner(k.v[at.p])};
  }
  /// The half-face through which a walk round the edge (a, b) leaves cell c counter-clockwise about a→b,
  /// given the vertex p of c such that (a, b, p, q) is positive: the one opposite p. See edge_cells() for a
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
  /// True when a cell that vertex_cells(a) shows has both vertices, or a has more than Star::kCapacity cells.
  bool has_edge(VertexHandle a, VertexHandle b, Star& scratch) const;
  /// The same for all three vertices.
  bool has_face(VertexHandle a, VertexHandle b, VertexHandle c, Star& scratch) const;

  /// Gives every vertex and cell that is not deleted a handle without gaps, in the old order. Labels and
  /// locks of faces and edges that no cell has any more are dropped.
  GarbageMap collect_garbage(GarbageOptions options = {});

  /// Becomes `saved`, a copy of this mesh at an earlier time. Unlike an assignment it keeps the handles of
  /// properties valid: they name the values of that time. Properties that came since are left with their
  /// defaults, those that were removed since come back.
  void restore(TetMesh saved);

  // --- by hand, one at a time ---
  VertexHandle add_vertex(Vec3 p);
  /// Appends a cell, linked with its neighbours. The first call after building or other writing makes a table
  /// of all faces: O(n). Throws InvalidInput, leaving the mesh as it was, when a vertex does not exist or
  /// comes twice, a face has two cells, a cell has these vertices, or the order contradicts a neighbour. Only
  /// faces are looked at: whether an edge has cells beside those that go all the way round it
  /// (Rule::kDuplicateEdge) is for check() to find.
  CellHandle add_cell(VertexHandle v0, VertexHandle v1, VertexHandle v2, VertexHandle v3);
  /// Deleted things keep their handles until collect_garbage(); labels of edges and faces that vanish go at
  /// once. O(1), but for
  ///  - a vertex that loses its incident cell and has no neighbour of c at it: then the cells of all vertices
  ///  are
  ///    counted, once until other writing;
  ///  - a labelled or fixed edge or face that vanishes: O(number of these).
  void delete_cell(CellHandle c);
  void delete_vertex(VertexHandle v);  ///< and every cell that has it
  /// Cuts every cell of the edge, face or cell at a new vertex: at `at`, or at the barycenter. The parts have
  /// the region, status and properties of the whole; so have the parts of a labelled or fixed edge or face
  /// its label, lock and properties. The new vertex has the data of the nearest end or corner. A part keeps
  /// the handle of each cell. O(cells that are cut); no geometry is looked at.
  VertexHandle split_edge(EdgeHandle e, std::optional<Vec3> at = {});
  VertexHandle split_face(FaceHandle f, std::optional<Vec3> at = {});
  VertexHandle split_cell(CellHandle c, std::optional<Vec3> at = {});
  /// Joins the beginning of the half-edge with its end, which it returns: cells of the edge go, the other
  /// cells of the beginning have the end instead, and what was attached to edges and faces goes along; where
  /// two become one, the value at the end stays. Invalid, and nothing changed, unless is_collapse_ok(e).
  /// Cells may become inverted: no geometry is looked at.
  VertexHandle collapse_edge(HalfEdgeHandle e);
  /// True when a collapse leaves a manifold (the link condition) and loses no constraint: the beginning is
  /// neither fixed, by itself or with an edge, a face or a patch, nor labelled; no two labels would meet on
  /// one edge or face; and a label of the edge, or of a face at it, is also on another at the beginning. The
  /// stars of both ends connect through faces and have at most Star::kCapacity cells. The first call after
  /// other writing counts the cells of all vertices.
  bool is_collapse_ok(HalfEdgeHandle e);
  /// Room for n in all, so that adding moves nothing meanwhile.
  void reserve_vertices(std::size_t n);
  void reserve_cells(std::size_t n);
  /// An empty mesh; properties go, too.
  void clear() { *this = TetMesh(); }
  /// Exchanges the handles of two things, with all that is attached. O(star) and O(labels and properties of
  /// edges and faces) for vertices, O(1) for cells.
  void swap_vertices(VertexHandle a, VertexHandle b);
  void swap_cells(CellHandle a, CellHandle b);

  /// Low-level writing, for builders and operators; see Writer.hh.
  class Writer;
  /// Deleted cells that wait for reuse, in the order in which they are to be taken (from the back).
  const std::vector<CellHandle>& free_cells() const { return free_cells_; }

 private:
  friend class MeshBuilder;
  friend GarbageMap reorder(TetMesh& mesh, const ReorderOptions& options);
  friend void order_cells(TetMesh& mesh, std::span<const CellHandle> order, par::Policy policy);
  static constexpr std::size_t kHeadroom = 16;  // cells per spare slot
  enum StatusBit : std::uint8_t { kDeleted = 1, kFixed = 2, kSelected = 4, kTagged = 8 };
  static void set_bit(std::uint8_t& bits, std::uint8_t bit, bool on) {
    bits = static_cast<std::uint8_t>(on ? bits | bit : bits & ~bit);
  }

  bool has_cell_bit(CellHandle c, StatusBit bit) const {
    return !cell_status_.empty() && (cell_status_[c.idx()] & bit) != 0;
  }
  void set_cell_bit(CellHandle c, StatusBit bit, bool on) {
    if (cell_status_.empty()) request_cell_status();
    set_bit(cell_status_[c.idx()], bit, on);
  }
  VertexHandle end_vertex(HalfEdgeHandle e, Index end) const {
    return cells_[e.idx() / 12].v[kEdgeCorners[e.idx() / 2 % 6][end]];
  }
  template <std::size_t N>
  CellHandle find_cell_with(const std::array<VertexHandle, N>& vertices) const;

  /// What building by hand looks up: made when first needed, void after low-level writing.
  struct HandIndex {
    std::unordered_map<std::array<VertexHandle, 3>, HalfFaceHandle, TupleHash> face;  // one half-face of each
    std::vector<Index> n_cells;                                                       // per vertex
  };
  enum HandIndexState : std::uint8_t { kVoid, kCounts, kCountsAndFaces };
  void count_cells();
  void make_hand_index();
  void outdate_hand_faces() {
    if (hand_index_state_ == kCountsAndFaces) hand_index_state_ = kCounts;
  }
  template <std::size_t N>
  bool any_cell_has(const std::array<VertexHandle, N>& vertices);
  std::vector<CellHandle> cells_of(VertexHandle v);
  bool gather_whole_star(VertexHandle v, Star& star);
  CellHandle take_slot(CellHandle like);
  VertexHandle split(std::span<const CellHandle> parents, std::span<const VertexHandle> simplex, Vec3 at);
  void split_labels(const Cell& parent, std::span<const VertexHandle> simplex, VertexHandle middle);
  bool labels_can_join(const Star& star, VertexHandle v, VertexHandle w) const;
  void join_labels(const Star& star, VertexHandle v, VertexHandle w);
  void resize_cells(std::size_t n);
  void mark_deleted(VertexHandle v);
  void grow_cells(std::size_t n);
  void drop_labels_of_nothing(const Cell& removed);

  /// Moves vertices and cells to new places; those with an invalid one go.
  void renumber(const GarbageMap& map, std::size_t n_vertices, std::size_t n_cells, par::Policy policy);
  void renumber_attached(const GarbageMap& map, std::size_t n_vertices, std::size_t n_cells);
  void find_incident_cells(par::Policy policy);

  std::vector<Cell> cells_;
  std::vector<int> regions_;               // empty while every cell is in region 0
  std::vector<std::uint8_t> cell_status_;  // empty until a bit is set
  std::vector<CellHandle> free_cells_;
  std::vector<Vec3> points_;
  std::vector<CellHandle> incident_cell_;
  std::vector<std::uint8_t> vertex_status_;
  /// 0 in a mesh that was moved from, as the arrays are.
  struct Count {
    std::size_t n = 0;
    Count() = default;
    ~Count() = default;
    Count(const Count&) = default;
    Count& operator=(const Count&) = default;
    Count(Count&& other) noexcept : n(std::exchange(other.n, 0)) {}
    Count& operator=(Count&& other) noexcept {
      n = std::exchange(other.n, 0);
      return *this;
    }
  } n_deleted_vertices_;
  Labels labels_;
  Locks locks_;
  PropertySet properties_;
  HandIndex hand_index_;
  HandIndexState hand_index_state_ = kVoid;
};

/// What build() had to mend.
struct BuildReport {
  bool flipped = false;                ///< the file orders every cell the other way round
  std::vector<CellHandle> reoriented;  ///< cells whose order contradicted their neighbours', or the whole's
  /// With NonManifold::kSplit: the vertices after the given ones, each by the one that it is a copy of.
  std::vector<VertexHandle> copied;
};

/// What build() does at vertices whose cells do not connect through faces.
enum class NonManifold : std::uint8_t {
  kKeep,  ///< nothing, unless an edge would break the kernel's rule: then the input is refused
  kSplit  ///< one part keeps the vertex, that of the smallest cell; each other one gets a copy of it
};

/// What build() does where most cells are negative.
enum class Turning : std::uint8_t {
  kMost,      ///< turns the whole, or the component
  kConflicts  ///< nothing: for a part of a mesh, which may be the inverted one
};

/// Builds the connectivity of a mesh from arrays: n points, m cells of four 0-based point indices in either
/// orientation. Cells that contradict their neighbours are put into the neighbours' orientation, which may
/// make them inverted: that is the truth about them. The whole is flipped when most cells are then negative;
/// a component that connects to the rest through no face, and most of whose cells are negative, is turned by
/// itself. Handles equal array indices. Throws InvalidInput for an index out of range, a repeated vertex in a
/// cell, a coordinate that is not finite, a face with three cells, a cell given twice, cells that cannot be
/// oriented alike, or an edge that cells go all the way round and that others have, too
/// (Rule::kDuplicateEdge); ResourceLimit for more cells than an index can count.
TetMesh build(std::vector<Vec3> points, std::span<const std::array<Index, 4>> cells, par::Policy policy = {},
              BuildReport* report = nullptr, NonManifold non_manifold = NonManifold::kKeep,
              Turning turning = Turning::kMost);

template <class Visit>
bool TetMesh::walk_ring(CellHandle c, int edge, Visit&& visit) const {
  const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(edge)];
  RingPlace at{c, opposite[0], opposite[1]};
  do {
    const Cell& k = cells_[at.cell.idx()];
    if (!visit(at.cell, k.v[at.p], k.v[at.q])) return false;
    at = next_in_ring(at);
    if (!at.cell.is_valid()) return false;
  } while (at.cell != c);
  return true;
}

template <class Visit>
bool TetMesh::walk_ring_back(CellHandle c, int edge, Visit&& visit) const {
  const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(edge)];
  RingPlace at{c, opposite[0], opposite[1]};
  do {
    const Cell& k = cells_[at.cell.idx()];
    if (!visit(at.cell, k.v[at.p], k.v[at.q])) return false;
    at = previous_in_ring(at);
    if (!at.cell.is_valid()) return false;
  } while (at.cell != c);
  return true;
}

}  // namespace hfr

#include "hfremesh/HalfFace/Circulators.hh"
#include "hfremesh/HalfFace/TupleUse.hh"

#endif
