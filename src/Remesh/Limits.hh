// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_LIMITS_HH
#define HFR_REMESH_LIMITS_HH

#include <array>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// What keeps a cell below an angle, the strongest reason first. The second and the third are proofs: while
/// the faces that may not change stay as they are, every mesh has an angle as small there.
enum class Limit {
  kFoldedSurface,   ///< an inverted or flat cell that touches a boundary face which lies on another one
  kSurfaceCeiling,  ///< two boundary faces leave too narrow a wedge, or one that the cell has to fill alone
  kInputFeature,    ///< the same where an interface between regions or a labelled face inside takes part
  kSurfaceFeature,  ///< with a surface that may change: see held_by_features()
  kFrozenVertices,  ///< all four vertices may not move; other cells on them were not found
  kBudget,          ///< time, iterations or the number of cells ran out
  kSearch,          ///< none of these: the operators found nothing better
};
inline constexpr std::array<const char*, 7> kLimitNames = {
    "folded surface",  "surface ceiling", "input feature", "surface feature",
    "frozen vertices", "budget",          "search"};

struct StuckCell {
  CellHandle cell;
  double degrees = 0;  ///< its smallest dihedral; not positive for an inverted or flat cell
  Limit limit = Limit::kSearch;
  int n_frozen_vertices = 0;  ///< of its four
};

/// Each cell whose smallest dihedral is below `degrees`, ascending, with what keeps it there. `out_of_budget`
/// says that the run ended before it was done. `folded`: folded_faces(mesh), or nothing where none are.
std::vector<StuckCell> stuck_cells(const TetMesh& mesh, double degrees, bool out_of_budget,
                                   const std::vector<HalfFaceHandle>& folded, par::Policy policy = {});

/// How many cells each limit keeps, in the order of Limit.
std::array<std::size_t, kLimitNames.size()> count_limits(const std::vector<StuckCell>& cells);

}  // namespace hfr

#endif
