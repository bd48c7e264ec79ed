// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MEAN_EDGE_HH
#define HFR_REMESH_MEAN_EDGE_HH

#include <algorithm>
#include <cstddef>

#include "HalfFace/Geometry.hh"
#include "HalfFace/TetMesh.hh"
#include "HalfFace/TetTopology.hh"
#include "Quality/FixedSum.hh"

namespace hfr {

/// The mean length of the edges of cells, each once for each of its cells. All cells are gone through twice,
/// so that the sum depends on no order: cells of several parts of a mesh may be.
class MeanEdge {
 public:
  /// First.
  void find_longest(const TetMesh& mesh, CellHandle c) {
    for_lengths(mesh, c, [&](double length) { longest_ = std::max(longest_, length); });
  }
  double longest() const { return longest_; }
  /// Then, with the longest edge of all parts.
  void begin_sum(double longest) { sum_ = FixedSum(longest); }
  void add(const TetMesh& mesh, CellHandle c) {
    for_lengths(mesh, c, [&](double length) { sum_.add(length); });
    ++n_cells_;
  }
  const FixedSum& sum() const { return sum_; }
  std::size_t n_cells() const { return n_cells_; }
  static double of(const FixedSum& sum, std::size_t n_cells) {
    return sum.value() / (6.0 * static_cast<double>(std::max<std::size_t>(n_cells, 1)));
  }

 private:
  template <class Visit>
  static void for_lengths(const TetMesh& mesh, CellHandle c, Visit&& visit) {
    const auto& v = mesh.cell_vertices(c);
    for (const auto& e : kEdgeCorners) visit(norm(mesh.point(v[e[1]]) - mesh.point(v[e[0]])));
  }

  double longest_ = 0;
  FixedSum sum_;
  std::size_t n_cells_ = 0;
};

}  // namespace hfr

#endif
