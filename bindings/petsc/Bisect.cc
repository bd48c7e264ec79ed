// SPDX-License-Identifier: BSD-3-Clause
// M.-C. Rivara, Mesh refinement processes based on the generalized bisection of simplices, SIAM J. Numer.
// Anal. 21, 1984: no edge is halved before a longer one of the same cell.
#include <cmath>
#include <tuple>

#include "Plex.hh"
#include "hfremesh/HalfFace/Circulators.hh"
#include "hfremesh/HalfFace/Geometry.hh"

namespace hfr::petsc {
namespace {

/// Orders edges by length, and where that is equal by their vertices: no two are alike.
using Rank = std::tuple<double, Index, Index>;

struct LongestEdge {
  Rank rank;
  EdgeHandle edge;
};

LongestEdge longest_edge(const TetMesh& mesh, CellHandle c) {
  LongestEdge longest{{-1, 0, 0}, EdgeHandle()};
  for (EdgeHandle e : mesh.cell_edges(c)) {
    const auto v = mesh.edge_vertices(e);
    const Vec3 d = mesh.point(v[1]) - mesh.point(v[0]);
    const Rank rank = {dot(d, d), static_cast<Index>(std::min(v[0].idx(), v[1].idx())),
                       static_cast<Index>(std::max(v[0].idx(), v[1].idx()))};
    if (rank > longest.rank) longest = {rank, e};
  }
  return longest;
}

/// From the longest edge of the cell to longer ones of the cells round it, until it is the longest of all its
/// cells.
EdgeHandle terminal_edge(const TetMesh& mesh, CellHandle c) {
  LongestEdge longest = longest_edge(mesh, c);
  for (bool is_terminal = false; !is_terminal;) {
    is_terminal = true;
    for (CellHandle d : mesh.edge_cells(longest.edge)) {
      const LongestEdge other = longest_edge(mesh, d);
      if (other.rank > longest.rank) {
        longest = other;
        is_terminal = false;
        break;
      }
    }
  }
  return longest.edge;
}

}  // namespace

void bisect(TetMesh& mesh, const std::vector<double>& largest) {
  auto limit = mesh.request_cell_property<double>({}, kKeep);
  for (std::size_t i = 0; i < largest.size(); ++i) {
    const CellHandle c(i);
    limit[c] = largest[i] == kRefine ? std::abs(volume(mesh, c)) / 8 : largest[i];
  }
  // Halves of halves are exact but for rounding: three of them are an eighth.
  constexpr double kRounding = 1 + 1e-9;
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {  // which grows
    const CellHandle c(i);
    while (limit[c] > 0 && std::abs(volume(mesh, c)) > kRounding * limit[c])
      mesh.split_edge(terminal_edge(mesh, c));
  }
}

}  // namespace hfr::petsc
