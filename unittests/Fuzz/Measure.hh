// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_FUZZ_MEASURE_HH
#define HFR_UNITTESTS_FUZZ_MEASURE_HH

#include <array>
#include <map>
#include <set>
#include <vector>

#include "HalfFace/Check.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr::fuzz {

using Place = std::array<double, 3>;

/// A half-face that no operator of a frozen run may change: where its corners are, in the order that its cell
/// sees, the region of that cell, whether it has a neighbour, and its label (-1: none).
struct FrozenFace {
  std::array<Place, 3> corners;
  int region = 0;
  bool inside = false;
  int label = -1;
  friend auto operator<=>(const FrozenFace&, const FrozenFace&) = default;
};

struct FrozenEdge {
  std::array<Place, 2> ends;
  int label = 0;
  friend auto operator<=>(const FrozenEdge&, const FrozenEdge&) = default;
};

/// What must not get worse, or not change, from the input of a run to its output; found without the code that
/// the run itself uses for it, as far as that can be. Signs and angles are those of the mesh scaled by a
/// power of two to a size of about 1.
struct Measure {
  std::size_t cells = 0;
  std::size_t inverted = 0, flat = 0;
  double worst = 0;                 ///< smallest dihedral of all, degrees; negative in inverted cells
  double p1 = 0;                    ///< 1st percentile of the cells' smallest dihedrals
  std::vector<double> angles;       ///< these, ascending
  long double inverted_volume = 0;  ///< sum of |V| of the inverted cells
  long double absolute_volume = 0;
  std::map<int, long double> region_volume;  ///< signed
  std::size_t extra_fans = 0;                ///< fans of cells round edges, beyond one for each edge
  std::size_t extra_stars = 0;  ///< sets of cells at vertices that faces connect, beyond one for each vertex
  double largest_coordinate = 0;
  double diagonal = 0;   ///< of the bounding box
  long double area = 0;  ///< of boundary and interfaces
  Rule rule = Ok;        ///< the first broken one of the kernel's own
  std::string rule_message;
  bool labels_fit = true;  ///< labelled faces and edges are there

  std::multiset<FrozenFace> frozen_faces;
  std::multiset<FrozenEdge> labelled_edges;
  std::multiset<Place> fixed_vertices;
  std::multiset<int> vertex_labels;
  std::map<int, long double> patch_area;   ///< by label of faces; 0 on the boundary is none
  std::map<int, long double> patch_edges;  ///< sum of the lengths of these faces' sides
  std::map<int, long double> edge_length;  ///< by label of edges
};

Measure measure(const TetMesh& mesh);

/// Cells that are inverted or flat in the mesh's own coordinates, ascending.
std::vector<CellHandle> invalid_cells_of(const TetMesh& mesh);

}  // namespace hfr::fuzz

#endif
