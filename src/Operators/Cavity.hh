// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_CAVITY_HH
#define HFR_OPERATORS_CAVITY_HH

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr {

namespace detail {
[[noreturn]] void throw_full(std::size_t n);
}

/// Vector of at most N items that lives where it is declared; one more throws ResourceLimit.
template <class T, std::size_t N>
class FixedVector {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == N; }
  void clear() { size_ = 0; }
  void push_back(const T& item) {
    if (size_ == N) [[unlikely]]
      detail::throw_full(N);
    items_[size_++] = item;
  }
  void resize(std::size_t n) {
    if (n > N) [[unlikely]]
      detail::throw_full(N);
    size_ = n;
  }
  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  T* begin() { return items_.data(); }
  T* end() { return items_.data() + size_; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + size_; }
  operator std::span<const T>() const { return {items_.data(), size_}; }

 private:
  std::size_t size_ = 0;
  RawArray<T, N> items_;
};

/// Cells that an operator may write, all of them.
using Scope = FixedVector<CellHandle, Star::kCapacity>;

/// Four vertices in positive order.
using Tet = std::array<VertexHandle, 4>;

/// What a plan does to the mesh, in full: the cells that go, the cells that come into the same place, a
/// vertex that goes, comes or moves. A new vertex is named kNewVertex in `created`.
struct Cavity {
  static constexpr VertexHandle kNewVertex{VertexHandle::kInvalid - 1};
  static constexpr std::size_t kCapacity = 2 * Star::kCapacity;

  FixedVector<CellHandle, kCapacity> removed;
  FixedVector<Tet, kCapacity> created;
  VertexHandle removed_vertex;     ///< has no cell afterwards
  std::optional<Vec3> new_vertex;  ///< position of kNewVertex
  VertexHandle moved;              ///< no cell changes, only this vertex's place
  Vec3 target;                     ///< of `moved`
  /// Where removed cells lie in two regions, as many of `removed` and `created` belong to the first and stand
  /// first.
  std::size_t n_removed_first = 0, n_created_first = 0;
  /// Somebody holds the surface (SurfaceMesh) and writes the labels of its faces; nobody else looks at them.
  bool surface_is_held = false;

  void clear() {
    removed.clear();
    created.clear();
    n_removed_first = n_created_first = 0;
    surface_is_held = false;
    removed_vertex.reset();
    new_vertex.reset();
    moved.reset();
  }
};

/// The cells of one region in a cavity: removed ones from first_removed on, and as many created.
struct CavityPart {
  std::size_t first_removed = 0, n_removed = 0, n_created = 0;
};
/// Of n_removed and n_created cells in all, those of the first region and those of the second, or only one.
inline std::array<CavityPart, 2> parts_of(std::size_t n_removed, std::size_t n_created,
                                          std::size_t n_removed_first, std::size_t n_created_first) {
  return {{{0, n_removed_first, n_created_first},
           {n_removed_first, n_removed - n_removed_first, n_created - n_created_first}}};
}
inline std::array<CavityPart, 2> parts_of(const Cavity& cavity) {
  return parts_of(cavity.removed.size(), cavity.created.size(), cavity.n_removed_first,
                  cavity.n_created_first);
}

class PinchedStars;

/// What is known of the vertices of a mesh. Of their stars for who asks whether an edge or face exists: only
/// a vertex all of whose cells are known can say that it does not.
struct StarKnowledge {
  std::span<const std::uint32_t> star_size = {};  ///< number of cells per vertex; empty: not known
  const PinchedStars* pinched = nullptr;
  /// Of each vertex what constrained_vertices() says, by which most edges and faces have no label; empty: not
  /// known.
  std::span<const std::uint8_t> constrained = {};
};

/// True when the cavity may be committed as far as labels, regions and, if `check_links`, the link condition
/// go:
///  - all removed cells lie in one region, or in two as the cavity says,
///  - no face between removed cells of one region is labelled or fixed, and no such edge is lost,
///  - a labelled face of the boundary or between the regions that goes is cut by the new vertex into faces
///    that can take its label (see find_heirs()), and none that is fixed goes,
///  - the outer faces are a sphere and no edge or face would exist twice (the full link condition; it can
///    only fail where cells are inverted or the boundary meets itself, so callers leave it out elsewhere).
/// `known` is what the last of these is asked of (see makes_twice()), and saves looking for labels.
bool admissible(const TetMesh& mesh, const Cavity& cavity, bool check_links, Star& scratch,
                const StarKnowledge& known = {});

/// The last part of the link condition by itself: true when an edge or face that the cavity creates exists
/// already, or when it makes a face of three cells. What no vertex can tell counts as existing; without
/// `known` it is looked for in the whole mesh.
bool makes_twice(const TetMesh& mesh, const Cavity& cavity, Star& scratch, const StarKnowledge& known = {});

/// A labelled face that goes with the cavity, and a created one that lies on it and takes its label; both
/// with their vertices as the label names them.
struct Heir {
  std::array<VertexHandle, 3> parent, child;
};
inline constexpr std::size_t kMostHeirs = 96;
using Heirs = FixedVector<Heir, kMostHeirs>;
/// The heirs of the labelled faces of the boundary, and of those between the two regions, that no created
/// cell has; none where the surface is held. A face has heirs when the new vertex cuts it: into three, or
/// into two where an edge of it goes too. False when one has none, is fixed, or there are too many.
bool find_heirs(const TetMesh& mesh, const Cavity& cavity, Heirs& out);
/// Takes the labels from the parents to the children, in which `new_vertex` stands in for
/// Cavity::kNewVertex; parents' labels go. The heirs of a parent stand together.
void inherit_labels(TetMesh& mesh, std::span<const Heir> heirs, VertexHandle new_vertex);

/// True when the change would leave `cells`, the removed ones or those of the vertex that moves, more damaged
/// than they are: more of them inverted, more inverted or flat, more overlap while no fewer are inverted, or
/// an angle below `floor` (Workspace::floor) that they have not had. A worst cell that rises must not pay for
/// itself so; see kernels/damage.h.
bool worsens_damage(const TetMesh& mesh, const Cavity& cavity, std::span<const CellHandle> cells,
                    double floor);

/// Of the removed cells' vertices the one nearest to the new vertex, which inherits its data. Needs a new
/// vertex.
VertexHandle nearest_vertex(const TetMesh& mesh, const Cavity& cavity);

/// An edge or a face (third vertex invalid for an edge), vertices ascending.
using Simplex = std::array<VertexHandle, 3>;

/// What the cavity creates that none of its removed cells has: edges, and faces with none of these; what has
/// the new vertex is left out. Two cavities that create the same simplex must not be committed together.
std::vector<Simplex> created_simplices(const TetMesh& mesh, const Cavity& cavity);

}  // namespace hfr

#endif
