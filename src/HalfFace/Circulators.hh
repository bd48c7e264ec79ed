// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_CIRCULATORS_HH
#define HFR_HALFFACE_CIRCULATORS_HH

#include <array>
#include <bit>
#include <cstddef>
#include <iterator>
#include <ranges>
#include <type_traits>

#include "hfremesh/HalfFace/TetMesh.hh"

/// Ranges over the things of a mesh and over neighbourhoods. All are views in the sense of C++20, forward,
/// and none allocates: what a star needs is kept inside the range object (1 kB for vertex_vertices, 2.4 kB
/// for other vertex_… ranges, 0.5 kB for rings), so iterators of those are valid while the range object
/// lives, and a temporary gives none: `for (c : mesh.vertex_cells(v))` and
/// `const auto star = mesh.vertex_cells(v); star.begin()` compile, `mesh.vertex_cells(v).begin()` does not.
/// Iterators over the whole mesh (cells(), boundary_edges() …) own what they need. A range sees the mesh as
/// it is when it is read; writing to the mesh ends its validity.
namespace hfr {

/// A few items by value: neighbours of something that has at most N of them.
template <class T, std::size_t N>
class FixedList {
 public:
  void push_back(T item) { items_[size_++] = item; }
  const T* begin() const& { return items_.data(); }
  const T* end() const& { return items_.data() + size_; }
  void begin() const&& = delete;  ///< would outlive the list: give it a name
  void end() const&& = delete;
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T operator[](std::size_t i) const { return items_[i]; }

 private:
  std::array<T, N> items_{};
  std::size_t size_ = 0;
};

/// Forward iterator over those of the places 0 … limit()-1 of a range for which has(place) holds.
template <class Range, class Value>
class PlaceIterator {
 public:
  using value_type = Value;
  using reference = Value;
  using pointer = void;
  using difference_type = std::ptrdiff_t;
  using iterator_category = std::input_iterator_tag;  // C++17 asks a forward iterator for true references
  using iterator_concept = std::forward_iterator_tag;

  PlaceIterator() = default;
  PlaceIterator(const Range* range, std::size_t place) : range_(range), place_(place) { skip(); }
  Value operator*() const { return range_->item(place_); }
  PlaceIterator& operator++() {
    ++place_;
    skip();
    return *this;
  }
  PlaceIterator operator++(int) {
    PlaceIterator old = *this;
    ++*this;
    return old;
  }
  friend bool operator==(const PlaceIterator& a, const PlaceIterator& b) { return a.place_ == b.place_; }

 private:
  void skip() {
    while (place_ < range_->limit() && !range_->has(place_)) ++place_;
  }

  const Range* range_ = nullptr;
  std::size_t place_ = 0;
};

/// What ranges over places have in common; Derived says limit(), has(place) and item(place).
template <class Derived, class Value>
class PlaceRange : public std::ranges::view_base {
 public:
  using iterator = PlaceIterator<Derived, Value>;
  iterator begin() const& { return {&derived(), 0}; }
  iterator end() const& { return {&derived(), derived().limit()}; }
  void begin() const&& = delete;  ///< would outlive the range: give it a name
  void end() const&& = delete;
  bool empty() const { return begin() == end(); }
  /// Number of items, by counting them.
  std::size_t count() const {
    std::size_t n = 0;
    for (iterator i = begin(); i != end(); ++i) ++n;
    return n;
  }

 private:
  const Derived& derived() const { return static_cast<const Derived&>(*this); }
};

/// Forward iterator over the things of a mesh that exist, by ascending handle. Owns what it needs.
template <class H, bool kOnlyBoundary>
class MeshIterator {
 public:
  using value_type = H;
  using reference = H;
  using pointer = void;
  using difference_type = std::ptrdiff_t;
  using iterator_category = std::input_iterator_tag;
  using iterator_concept = std::forward_iterator_tag;

  MeshIterator() = default;
  MeshIterator(const TetMesh& mesh, std::size_t place, std::size_t limit)
      : mesh_(&mesh), place_(place), limit_(limit) {
    skip();
  }
  H operator*() const { return H(place_); }
  MeshIterator& operator++() {
    ++place_;
    skip();
    return *this;
  }
  MeshIterator operator++(int) {
    MeshIterator old = *this;
    ++*this;
    return old;
  }
  friend bool operator==(const MeshIterator& a, const MeshIterator& b) { return a.place_ == b.place_; }

 private:
  void skip() {
    while (place_ < limit_ && !wanted(H(place_))) ++place_;
  }
  bool wanted(H h) const { return mesh_->exists(h) && (!kOnlyBoundary || mesh_->is_boundary(h)); }

  const TetMesh* mesh_ = nullptr;
  std::size_t place_ = 0, limit_ = 0;
};

/// The same for edges and half-edges, cell by cell: one look at a cell tells which edges are its to name.
template <class H, bool kOnlyBoundary>
class MeshEdgeIterator {
 public:
  using value_type = H;
  using reference = H;
  using pointer = void;
  using difference_type = std::ptrdiff_t;
  using iterator_category = std::input_iterator_tag;
  using iterator_concept = std::forward_iterator_tag;

  MeshEdgeIterator() = default;
  MeshEdgeIterator(const TetMesh& mesh, std::size_t cell, std::size_t n_cells)
      : mesh_(&mesh), cell_(cell), n_cells_(n_cells) {
    if (cell_ < n_cells_) left_ = edges_of(cell_);
    skip();
  }
  H operator*() const {
    const std::size_t edge = 6 * cell_ + static_cast<unsigned>(std::countr_zero(left_));
    return H(kSides * edge + side_);
  }
  MeshEdgeIterator& operator++() {
    if (++side_ < kSides) return *this;
    side_ = 0;
    left_ &= left_ - 1;
    skip();
    return *this;
  }
  MeshEdgeIterator operator++(int) {
    MeshEdgeIterator old = *this;
    ++*this;
    return old;
  }
  friend bool operator==(const MeshEdgeIterator& a, const MeshEdgeIterator& b) {
    return a.cell_ == b.cell_ && a.left_ == b.left_ && a.side_ == b.side_;
  }

 private:
  static constexpr unsigned kSides = std::same_as<H, HalfEdgeHandle> ? 2 : 1;

  void skip() {
    while (left_ == 0 && cell_ < n_cells_)
      if (++cell_ < n_cells_) left_ = edges_of(cell_);
  }
  unsigned edges_of(std::size_t cell) const {
    unsigned edges = mesh_->first_edges(CellHandle(cell));
    if constexpr (kOnlyBoundary)
      for (unsigned k = 0; k < 6; ++k)
        if ((edges >> k & 1U) != 0 && !mesh_->is_boundary(EdgeHandle(6 * cell + k))) edges ^= 1U << k;
    return edges;
  }

  const TetMesh* mesh_ = nullptr;
  std::size_t cell_ = 0, n_cells_ = 0;
  unsigned left_ = 0;  // local edges of the cell, this one and those to come
  unsigned side_ = 0;
};

/// Every thing of one kind, or every one on the boundary, by ascending handle.
template <class H, bool kOnlyBoundary>
class MeshRange : public std::ranges::view_base {
 public:
  static constexpr bool kByCell = std::same_as<H, EdgeHandle> || std::same_as<H, HalfEdgeHandle>;
  using iterator =
      std::conditional_t<kByCell, MeshEdgeIterator<H, kOnlyBoundary>, MeshIterator<H, kOnlyBoundary>>;

  /// limit: handles end before it; for edges and half-edges, cells.
  MeshRange(const TetMesh& mesh, std::size_t limit) : mesh_(&mesh), limit_(limit) {}
  iterator begin() const { return {*mesh_, 0, limit_}; }
  iterator end() const { return {*mesh_, limit_, limit_}; }
  bool empty() const { return begin() == end(); }
  /// Number of items, by counting them.
  std::size_t count() const {
    std::size_t n = 0;
    for (iterator i = begin(); i != end(); ++i) ++n;
    return n;
  }

 private:
  const TetMesh* mesh_;
  std::size_t limit_;
};

/// What the cells of a vertex's star contribute, kSlots places a cell. A vertex with more cells than a Star
/// holds is served by a pass over all cells of the mesh.
template <class Policy>
class StarRange : public PlaceRange<StarRange<Policy>, typename Policy::Value> {
 public:
  StarRange(const TetMesh& mesh, VertexHandle v) : mesh_(&mesh), v_(v) {
    scan_ = !mesh.gather_star(v, star_) && mesh.incident_cell(v).is_valid();
    limit_ = Policy::kSlots * (scan_ ? mesh.n_cells() : static_cast<std::size_t>(star_.size));
  }
  std::size_t limit() const { return limit_; }
  bool has(std::size_t place) const {
    const std::size_t at = place / Policy::kSlots;
    if (scan_ && !mesh_->cell(CellHandle(at)).has(v_)) return false;
    if constexpr (Policy::kEvery)
      return true;
    else
      return Policy::has(*mesh_, cell(at), corner(at), place % Policy::kSlots);
  }
  typename Policy::Value item(std::size_t place) const {
    const std::size_t at = place / Policy::kSlots;
    if constexpr (Policy::kSlots == 1)
      return cell(at);
    else
      return Policy::item(*mesh_, cell(at), corner(at), place % Policy::kSlots);
  }

 private:
  CellHandle cell(std::size_t at) const { return scan_ ? CellHandle(at) : star_.cells[at]; }
  std::size_t corner(std::size_t at) const {
    return scan_ ? static_cast<std::size_t>(mesh_->cell(CellHandle(at)).corner(v_)) : star_.corners[at];
  }

  const TetMesh* mesh_;
  VertexHandle v_;
  bool scan_;
  std::size_t limit_;
  Star star_;
};

/// The vertices that share an edge with a vertex, each once, in order of discovery from the incident cell:
/// those of its cell, then what each cell adds to the one before.
class VertexVertices : public PlaceRange<VertexVertices, VertexHandle> {
 public:
  VertexVertices(const TetMesh& mesh, VertexHandle v);
  std::size_t limit() const { return limit_; }
  bool has(std::size_t place) const { return !scan_ || scan_has(place); }
  VertexHandle item(std::size_t place) const {
    return scan_ ? mesh_->cell(CellHandle(place / 4)).v[place % 4] : neighbours_[place];
  }

 private:
  bool scan_has(std::size_t place) const;

  const TetMesh* mesh_;
  VertexHandle v_;
  bool scan_ = false;
  std::size_t limit_ = 0;
  RawArray<VertexHandle, Star::kCapacity + 3> neighbours_;  // three of the first cell, one of each other
};

/// Forward iterator over a RingRange.
template <class Policy>
class RingIterator {
 public:
  using value_type = typename Policy::Value;
  using reference = value_type;
  using pointer = void;
  using difference_type = std::ptrdiff_t;
  using iterator_category = std::input_iterator_tag;
  using iterator_concept = std::forward_iterator_tag;

  RingIterator() = default;
  RingIterator(const RingRange<Policy>* range, int number) : range_(range), number_(number) {
    if (!range->is_kept()) large_ = range->places()[0];
    if (number == 0 && !Policy::has(0, !range->is_closed())) ++*this;
  }
  value_type operator*() const {
    // By reference: copying a place that was written member by member a moment ago stalls the processor.
    const RingPlace& at = range_->is_kept() ? range_->places()[number_] : large_;
    return Policy::item(range_->mesh(), at, slot_);
  }
  RingIterator& operator++() {
    do {
      if (++slot_ < Policy::kSlots) continue;
      slot_ = 0;
      ++number_;
      if (!range_->is_kept()) large_ = range_->mesh().next_in_ring(large_);
    } while (number_ < range_->n_cells() && !Policy::has(slot_, false));
    return *this;
  }
  RingIterator operator++(int) {
    RingIterator old = *this;
    ++*this;
    return old;
  }
  friend bool operator==(const RingIterator& a, const RingIterator& b) {
    return a.number_ == b.number_ && a.slot_ == b.slot_;
  }

 private:
  const RingRange<Policy>* range_ = nullptr;
  RingPlace large_;  // where it stands in a ring that is not kept
  int number_ = 0;   // of the cell, from the first
  int slot_ = 0;
};

/// What lies round an edge, counter-clockwise about its direction; a fan that ends at the boundary starts
/// there. The ring is walked once, when the range is made, and kept inside; one with more than
/// Ring::kCapacity cells is walked again while it is read.
template <class Policy>
class RingRange : public std::ranges::view_base {
 public:
  using iterator = RingIterator<Policy>;
  RingRange(const TetMesh& mesh, HalfEdgeHandle e) : mesh_(&mesh) {
    const bool kept = mesh.gather_ring(mesh.ring_place(e), ring_);
    n_cells_ = kept ? ring_.size : mesh.start_large_ring(mesh.ring_place(e), ring_);
  }
  iterator begin() const& { return {this, 0}; }
  iterator end() const& { return {this, n_cells_}; }
  void begin() const&& = delete;  ///< would outlive the range: give it a name
  void end() const&& = delete;
  bool empty() const { return false; }
  std::size_t count() const {
    std::size_t n = 0;
    for (iterator i = begin(); i != end(); ++i) ++n;
    return n;
  }
  /// True when the cells go all the way round, false when the edge is on the boundary.
  bool is_closed() const { return ring_.closed; }

  const TetMesh& mesh() const { return *mesh_; }
  int n_cells() const { return n_cells_; }
  bool is_kept() const { return ring_.size > 0; }
  const RingPlace* places() const { return ring_.places.data(); }

 private:
  const TetMesh* mesh_;
  int n_cells_;
  Ring ring_;
};

namespace policy {

struct StarCells {
  using Value = CellHandle;
  static constexpr std::size_t kSlots = 1;
  static constexpr bool kEvery = true;
};

/// The three half-faces of each cell that have the vertex.
struct StarHalfFaces {
  using Value = HalfFaceHandle;
  static constexpr std::size_t kSlots = 3;
  static constexpr bool kEvery = true;
  static Value item(const TetMesh&, CellHandle c, std::size_t corner, std::size_t slot) {
    return halfface_of(c, static_cast<int>((corner + 1 + slot) % 4));
  }
};

struct StarFaces {
  using Value = FaceHandle;
  static constexpr std::size_t kSlots = 3;
  static constexpr bool kEvery = false;
  static bool has(const TetMesh& mesh, CellHandle c, std::size_t corner, std::size_t slot) {
    return mesh.exists(FaceHandle(StarHalfFaces::item(mesh, c, corner, slot).idx()));
  }
  static Value item(const TetMesh& mesh, CellHandle c, std::size_t corner, std::size_t slot) {
    return FaceHandle(StarHalfFaces::item(mesh, c, corner, slot).idx());
  }
};

/// An edge is given by the smallest cell of its ring, which is in the star of either end.
struct StarEdges {
  using Value = EdgeHandle;
  static constexpr std::size_t kSlots = 3;
  static constexpr bool kEvery = false;
  static Value item(const TetMesh&, CellHandle c, std::size_t corner, std::size_t slot) {
    return EdgeHandle(6 * c.idx() + kEdgeOfCorners[corner][(corner + 1 + slot) % 4]);
  }
  static bool has(const TetMesh& mesh, CellHandle c, std::size_t corner, std::size_t slot) {
    return mesh.exists(item(mesh, c, corner, slot));
  }
};

template <bool kOutgoing>
struct StarHalfEdges {
  using Value = HalfEdgeHandle;
  static constexpr std::size_t kSlots = 3;
  static constexpr bool kEvery = false;
  static bool has(const TetMesh& mesh, CellHandle c, std::size_t corner, std::size_t slot) {
    return StarEdges::has(mesh, c, corner, slot);
  }
  static Value item(const TetMesh& mesh, CellHandle c, std::size_t corner, std::size_t slot) {
    const EdgeHandle e = StarEdges::item(mesh, c, corner, slot);
    const bool from_first = kEdgeCorners[e.idx() % 6][0] == corner;
    return HalfEdgeHandle(2 * e.idx() + (from_first == kOutgoing ? 0 : 1));
  }
};

struct RingCells {
  using Value = CellHandle;
  static constexpr int kSlots = 1;
  static constexpr bool has(int, bool) { return true; }
  static Value item(const TetMesh&, const RingPlace& at, int) { return at.cell; }
};

/// Of each cell the half-face that has the edge in its own direction.
struct RingHalfFaces {
  using Value = HalfFaceHandle;
  static constexpr int kSlots = 1;
  static constexpr bool has(int, bool) { return true; }
  static Value item(const TetMesh&, const RingPlace& at, int) { return halfface_of(at.cell, at.q); }
};

/// Of each cell both half-faces that have the edge.
struct RingBothHalfFaces {
  using Value = HalfFaceHandle;
  static constexpr int kSlots = 2;
  static constexpr bool has(int, bool) { return true; }
  static Value item(const TetMesh&, const RingPlace& at, int slot) {
    return halfface_of(at.cell, slot == 0 ? at.q : at.p);
  }
};

/// The face that each cell is left by, before them the one that an open fan begins with.
struct RingFaces {
  using Value = FaceHandle;
  static constexpr int kSlots = 2;
  static constexpr bool has(int slot, bool open_begin) { return slot == 1 || open_begin; }
  static Value item(const TetMesh& mesh, const RingPlace& at, int slot) {
    return mesh.face_handle(halfface_of(at.cell, slot == 0 ? at.q : at.p));
  }
};

}  // namespace policy

/// The vertices of a thing: keys of properties and labels.
inline std::array<VertexHandle, 2> vertices_of(const TetMesh& mesh, EdgeHandle e) {
  return mesh.edge_vertices(e);
}
inline std::array<VertexHandle, 2> vertices_of(const TetMesh& mesh, HalfEdgeHandle e) {
  return mesh.halfedge_vertices(e);
}
inline std::array<VertexHandle, 3> vertices_of(const TetMesh& mesh, FaceHandle f) {
  return mesh.face_vertices(f);
}
inline std::array<VertexHandle, 3> vertices_of(const TetMesh& mesh, HalfFaceHandle h) {
  return mesh.halfface_vertices(h);
}

inline AllRange<VertexHandle> TetMesh::vertices() const { return {*this, n_vertices()}; }
inline AllRange<EdgeHandle> TetMesh::edges() const { return {*this, n_cells()}; }
inline AllRange<HalfEdgeHandle> TetMesh::halfedges() const { return {*this, n_cells()}; }
inline AllRange<FaceHandle> TetMesh::faces() const { return {*this, 4 * n_cells()}; }
inline AllRange<HalfFaceHandle> TetMesh::halffaces() const { return {*this, 4 * n_cells()}; }
inline AllRange<CellHandle> TetMesh::cells() const { return {*this, n_cells()}; }
inline BoundaryRange<VertexHandle> TetMesh::boundary_vertices() const { return {*this, n_vertices()}; }
inline BoundaryRange<EdgeHandle> TetMesh::boundary_edges() const { return {*this, n_cells()}; }
inline BoundaryRange<HalfEdgeHandle> TetMesh::boundary_halfedges() const { return {*this, n_cells()}; }
inline BoundaryRange<FaceHandle> TetMesh::boundary_faces() const { return {*this, 4 * n_cells()}; }
inline BoundaryRange<HalfFaceHandle> TetMesh::boundary_halffaces() const { return {*this, 4 * n_cells()}; }
inline BoundaryRange<CellHandle> TetMesh::boundary_cells() const { return {*this, n_cells()}; }

inline StarRange<policy::StarCells> TetMesh::vertex_cells(VertexHandle v) const { return {*this, v}; }
inline StarRange<policy::StarEdges> TetMesh::vertex_edges(VertexHandle v) const { return {*this, v}; }
inline StarRange<policy::StarFaces> TetMesh::vertex_faces(VertexHandle v) const { return {*this, v}; }
inline StarRange<policy::StarHalfFaces> TetMesh::vertex_halffaces(VertexHandle v) const { return {*this, v}; }
inline StarRange<policy::StarHalfEdges<true>> TetMesh::outgoing_halfedges(VertexHandle v) const {
  return {*this, v};
}
inline StarRange<policy::StarHalfEdges<false>> TetMesh::incoming_halfedges(VertexHandle v) const {
  return {*this, v};
}
inline VertexVertices TetMesh::vertex_vertices(VertexHandle v) const { return {*this, v}; }

inline RingRange<policy::RingCells> TetMesh::edge_cells(EdgeHandle e) const {
  return {*this, halfedge_handle(e, 0)};
}
inline RingRange<policy::RingFaces> TetMesh::edge_faces(EdgeHandle e) const {
  return {*this, halfedge_handle(e, 0)};
}
inline RingRange<policy::RingBothHalfFaces> TetMesh::edge_halffaces(EdgeHandle e) const {
  return {*this, halfedge_handle(e, 0)};
}
inline RingRange<policy::RingCells> TetMesh::halfedge_cells(HalfEdgeHandle e) const { return {*this, e}; }
inline RingRange<policy::RingFaces> TetMesh::halfedge_faces(HalfEdgeHandle e) const { return {*this, e}; }
inline RingRange<policy::RingHalfFaces> TetMesh::halfedge_halffaces(HalfEdgeHandle e) const {
  return {*this, e};
}

inline FixedList<CellHandle, 4> TetMesh::cell_cells(CellHandle c) const {
  FixedList<CellHandle, 4> list;
  for (HalfFaceHandle m : cell(c).mate)
    if (m.is_valid()) list.push_back(cell_of(m));
  return list;
}
inline FixedList<HalfFaceHandle, 2> TetMesh::face_halffaces(FaceHandle f) const {
  FixedList<HalfFaceHandle, 2> list;
  for (int side = 0; side < 2; ++side)
    if (halfface_handle(f, side).is_valid()) list.push_back(halfface_handle(f, side));
  return list;
}
inline FixedList<CellHandle, 2> TetMesh::face_cells(FaceHandle f) const {
  FixedList<CellHandle, 2> list;
  for (HalfFaceHandle h : face_halffaces(f)) list.push_back(cell_of(h));
  return list;
}

}  // namespace hfr

template <class H, bool kOnlyBoundary>
inline constexpr bool std::ranges::enable_borrowed_range<hfr::MeshRange<H, kOnlyBoundary>> = true;

#endif
