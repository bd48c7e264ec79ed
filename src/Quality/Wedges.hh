// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_WEDGES_HH
#define HFR_QUALITY_WEDGES_HH

#include <optional>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// The cells at an edge between two faces that may not change (TetMesh::is_constrained) and have no other one
/// between them.
struct Wedge {
  /// The angle that the faces leave to these cells. Where the cells are positive it is the sum of their
  /// dihedrals; else it is known from the faces up to whole turns, and lies above 0 and at most at 360,
  /// unless no mesh has only positive cells round the edge: see EdgeWedges::impossible. 360 where it hangs on
  /// a face without area.
  double degrees = 0;
  HalfFaceHandle first, last;  ///< the faces, as the cells see them
  bool positive = true;        ///< all of the cells are
};

/// What the faces that may not change leave to the cells at an edge.
struct EdgeWedges {
  bool closed = false;        ///< the cells go all the way round
  std::vector<Wedge> wedges;  ///< counter-clockwise from `start`; the last one of a boundary edge ends there
  /// Of an edge of the boundary: the angle between its two boundary faces, through the cells.
  std::optional<Wedge> whole;
  /// The wedges, each at least as wide as its faces leave it, take more than a whole turn, or more than the
  /// boundary leaves: two of the faces are folded over one another, and every mesh that keeps the faces, and
  /// whose cells go round the edge no more than once, has an inverted or flat cell here. The narrowest way
  /// round of the folded faces then counts as a negative angle, or 0.
  bool impossible = false;
};

/// The wedges at a→b of `start`. `start` must lie behind a constrained face (the one opposite its corner q),
/// at an edge of the boundary behind the boundary face. `out` is overwritten; its memory is used again.
void find_wedges(const TetMesh& mesh, RingPlace start, EdgeWedges& out);

/// The same for local edge `edge` of cell c, from the boundary, or from the first constrained face clockwise
/// of c; nothing where no face at the edge is constrained.
std::optional<EdgeWedges> wedges_at(const TetMesh& mesh, CellHandle c, int edge);

/// Degrees: the largest that the smallest dihedral of the cells in a wedge at edge (a, b) can be, in every
/// mesh that keeps its faces and whose cells go round the edge no more than once. Two cells have one of no
/// more than half of the wedge, and a single cell is the one on both faces.
double wedge_ceiling(const TetMesh& mesh, VertexHandle a, VertexHandle b, const Wedge& wedge);

}  // namespace hfr

#endif
