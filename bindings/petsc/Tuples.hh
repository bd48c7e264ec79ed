// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PETSC_TUPLES_HH
#define HFR_BINDINGS_PETSC_TUPLES_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

/// Points of a mesh (cells, faces, edges, vertices) by the places of their vertices.
namespace hfr::petsc {

using Place = std::uint64_t;
using Tuple = std::array<Place, 4>;  ///< kNone after the last
inline constexpr Place kNone = std::numeric_limits<Place>::max();

/// Vertices in ascending order.
inline Tuple point_of(Tuple v) {
  std::sort(v.begin(), v.end());
  return v;
}

inline int n_vertices(const Tuple& point) {
  return static_cast<int>(std::find(point.begin(), point.end(), kNone) - point.begin());
}

/// The points that bound a point: its vertices but one.
inline std::vector<Tuple> faces_of(const Tuple& point) {
  std::vector<Tuple> faces;
  const int n = n_vertices(point);
  for (int i = 0; n > 1 && i < n; ++i) {
    Tuple face = point;
    face[static_cast<std::size_t>(i)] = kNone;
    faces.push_back(point_of(face));
  }
  return faces;
}

/// The same four things, the one of the smallest place first, then that of the smallest of the others, by
/// even permutations alone.
template <class T, class PlaceOf>
std::array<T, 4> turned(std::array<T, 4> v, PlaceOf&& place_of) {
  const auto smallest = [&](auto begin) { return std::ranges::min_element(begin, v.end(), {}, place_of); };
  const auto first = static_cast<std::size_t>(smallest(v.begin()) - v.begin());
  if (first > 0) {
    std::swap(v[0], v[first]);
    std::swap(v[first], v[first == 3 ? 2 : 3]);
  }
  std::rotate(v.begin() + 1, smallest(v.begin() + 1), v.end());
  return v;
}

}  // namespace hfr::petsc

#endif
