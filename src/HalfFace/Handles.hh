// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_HANDLES_HH
#define HFR_HALFFACE_HANDLES_HH

#include <array>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

#include "hfremesh/HalfFace/Config.hh"

namespace hfr {

#ifdef HFR_INDEX64
using Index = std::uint64_t;
#else
using Index = std::uint32_t;
#endif

/// An index with a kind. Handles of different kinds neither convert into each other nor compare.
template <class Kind>
class Handle {
 public:
  constexpr Handle() = default;  ///< invalid
  template <std::integral T>
  explicit constexpr Handle(T index) : index_(static_cast<Index>(index)) {}

  constexpr Index idx() const { return index_; }
  constexpr bool is_valid() const { return index_ != kInvalid; }
  void reset() { index_ = kInvalid; }

  friend constexpr bool operator==(Handle, Handle) = default;
  friend constexpr std::strong_ordering operator<=>(Handle, Handle) = default;

  static constexpr Index kInvalid = std::numeric_limits<Index>::max();

 private:
  Index index_ = kInvalid;
};

/// A vertex: 0 … n_vertices()-1.
using VertexHandle = Handle<struct VertexKind>;
/// A cell (tetrahedron): 0 … n_cells()-1.
using CellHandle = Handle<struct CellKind>;
/// A half-face: 4·cell + corner, the face opposite that corner as its cell sees it.
using HalfFaceHandle = Handle<struct HalfFaceKind>;
/// A face: the index of the smaller of its half-faces.
using FaceHandle = Handle<struct FaceKind>;
/// A half-edge: 12·cell + directed local edge, with the smallest cell of the edge's ring.
using HalfEdgeHandle = Handle<struct HalfEdgeKind>;
/// An edge: 6·cell + local edge, with the smallest cell of the edge's ring.
using EdgeHandle = Handle<struct EdgeKind>;

/// Corners of half-face k of a cell, in the order in which det(a, b, c, corner k) > 0 for a positive cell.
/// With corner k appended each row is an even permutation of 0 1 2 3.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceCorners = {
    {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

/// End corners of local edge k of a cell.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kEdgeCorners = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// The other two corners (p, q) of local edge k = (a, b), ordered so that (a, b, p, q) is an even
/// permutation.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kEdgeOpposite = {
    {{2, 3}, {3, 1}, {1, 2}, {0, 3}, {2, 0}, {0, 1}}};

/// Local edge between corners i and j (6 when i == j).
inline constexpr std::array<std::array<std::uint8_t, 4>, 4> kEdgeOfCorners = {
    {{6, 0, 1, 2}, {0, 6, 3, 4}, {1, 3, 6, 5}, {2, 4, 5, 6}}};

constexpr CellHandle cell_of(HalfFaceHandle h) { return CellHandle(h.idx() / 4); }
constexpr int corner_of(HalfFaceHandle h) { return static_cast<int>(h.idx() % 4); }
constexpr HalfFaceHandle halfface_of(CellHandle c, int corner) {
  return HalfFaceHandle(4 * c.idx() + static_cast<Index>(corner));
}

}  // namespace hfr

template <class Kind>
struct std::hash<hfr::Handle<Kind>> {
  std::size_t operator()(hfr::Handle<Kind> h) const noexcept { return std::hash<hfr::Index>{}(h.idx()); }
};

#endif
