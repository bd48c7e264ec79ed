// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_CAVITY_HH
#define HFR_OPERATORS_CAVITY_HH

#include <array>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// Vector of at most N items that lives where it is declared.
template <class T, std::size_t N>
class FixedVector {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == N; }
  void clear() { size_ = 0; }
  void push_back(const T& item) {
    HFR_ASSERT(size_ < N);
    items_[size_++] = item;
  }
  void resize(std::size_t n) {
    HFR_ASSERT(n <= N);
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
/// vertex that goes, comes or moves. A new vertex is named kNewVertex in `born`.
struct Cavity {
  static constexpr VertexHandle kNewVertex{VertexHandle::kInvalid - 1};
  static constexpr std::size_t kCapacity = 2 * Star::kCapacity;

  FixedVector<CellHandle, kCapacity> dead;
  FixedVector<Tet, kCapacity> born;
  VertexHandle removed;            ///< has no cell afterwards
  std::optional<Vec3> new_vertex;  ///< position of kNewVertex
  VertexHandle moved;              ///< no cell changes, only this vertex's place
  Vec3 target;                     ///< of `moved`
  /// Where dead cells lie in two regions, as many of `dead` and `born` belong to the first and stand first.
  std::size_t n_dead_first = 0, n_born_first = 0;

  void clear() {
    dead.clear();
    born.clear();
    n_dead_first = n_born_first = 0;
    removed.reset();
    new_vertex.reset();
    moved.reset();
  }
};

/// The cells of one region in a cavity: dead ones from first_dead on, and as many born.
struct CavityPart {
  std::size_t first_dead = 0, n_dead = 0, n_born = 0;
};
/// Of n_dead and n_born cells in all, those of the first region and those of the second, or only one.
inline std::array<CavityPart, 2> parts_of(std::size_t n_dead, std::size_t n_born, std::size_t n_dead_first,
                                          std::size_t n_born_first) {
  return {{{0, n_dead_first, n_born_first}, {n_dead_first, n_dead - n_dead_first, n_born - n_born_first}}};
}
inline std::array<CavityPart, 2> parts_of(const Cavity& cavity) {
  return parts_of(cavity.dead.size(), cavity.born.size(), cavity.n_dead_first, cavity.n_born_first);
}

/// True when the cavity may be committed as far as labels, regions and, if `check_links`, the link condition
/// go:
///  - all dead cells lie in one region, or in two as the cavity says,
///  - no face between dead cells of one region is labelled or fixed, and no such edge is lost,
///  - the outer faces are a sphere and no edge or face would exist twice (the full link condition; it can
///  only
///    fail where cells are inverted or the boundary meets itself, so callers leave it out elsewhere).
bool admissible(const TetMesh& mesh, const Cavity& cavity, bool check_links, Star& scratch);

/// Of the dead cells' vertices the one nearest to the new vertex, which inherits its data. Needs a new
/// vertex.
VertexHandle nearest_vertex(const TetMesh& mesh, const Cavity& cavity);

/// An edge or a face (third vertex invalid for an edge), vertices ascending.
using Simplex = std::array<VertexHandle, 3>;

/// What the cavity creates that none of its dead cells has: edges, or, when it creates none, faces. Two
/// cavities that create the same simplex must not be committed together.
std::size_t created_simplices(const TetMesh& mesh, const Cavity& cavity, std::span<Simplex> out);

}  // namespace hfr

#endif
