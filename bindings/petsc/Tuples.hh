// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PETSC_TUPLES_HH
#define HFR_BINDINGS_PETSC_TUPLES_HH

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

/// Points of a mesh (cells, faces, edges, vertices) by the places of their vertices.
namespace hfr::petsc {

/// kNone after the last.
template <class Place>
using Tuple = std::array<Place, 4>;
template <class Place>
inline constexpr Place kNone = std::numeric_limits<Place>::max();

/// Vertices in ascending order.
template <class Place>
Tuple<Place> point_of(Tuple<Place> v) {
  std::sort(v.begin(), v.end());
  return v;
}

template <class Place>
int n_vertices(const Tuple<Place>& point) {
  return static_cast<int>(std::find(point.begin(), point.end(), kNone<Place>) - point.begin());
}

/// The points that bound a point: its vertices but one.
template <class Place>
std::vector<Tuple<Place>> faces_of(const Tuple<Place>& point) {
  std::vector<Tuple<Place>> faces;
  const int n = n_vertices(point);
  for (int i = 0; n > 1 && i < n; ++i) {
    Tuple<Place> face = point;
    face[static_cast<std::size_t>(i)] = kNone<Place>;
    faces.push_back(point_of(face));
  }
  return faces;
}

/// The same four vertices, the smallest first, then the smallest of the others, by even permutations alone.
template <class Place>
Tuple<Place> turned(Tuple<Place> v) {
  const auto smallest = static_cast<std::size_t>(std::min_element(v.begin(), v.end()) - v.begin());
  if (smallest > 0) {
    std::swap(v[0], v[smallest]);
    std::swap(v[smallest], v[smallest == 3 ? 2 : 3]);
  }
  std::rotate(v.begin() + 1, std::min_element(v.begin() + 1, v.end()), v.end());
  return v;
}

}  // namespace hfr::petsc

#endif
