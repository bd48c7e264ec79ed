// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_LIMITS_HH
#define HFR_REMESH_LIMITS_HH

#include <array>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// Why a cell is below an angle, the strongest reason first. The first four are proofs, for meshes whose
/// cells go round each edge no more than once; then come bounds that the run met; the last claims nothing.
enum class Limit {
  kFoldedSurface,   ///< an inverted or flat cell that touches a boundary face of unfillable_faces()
  kSurfaceCeiling,  ///< two boundary faces leave too narrow a wedge, or one that a single poor cell has to
                    ///< fill
  kInputFeature,    ///< the same where an interface between regions or a labelled face inside takes part
  kSurfaceFeature,  ///< with a surface that may change: see held_by_features()
  kMaxCells,        ///< a new vertex would raise the worst of its surroundings, and the bound on cells is met
  kTimeLimit,       ///< the run was ended before it was done: by the time,
  kCancelled,       ///< by the caller,
  kIterations,      ///< by the number of iterations,
  kDeviceLost,      ///< by a device that failed
  kNotFound,        ///< nothing better was found, which proves nothing
};
inline constexpr std::array<const char*, 10> kLimitNames = {
    "folded surface", "surface ceiling", "input feature", "surface feature", "max cells",
    "time limit",     "cancelled",       "iterations",    "device lost",     "not found"};

/// Whether the reason is that no mesh which keeps the faces has a larger angle there.
constexpr bool is_proof(Limit limit) { return limit <= Limit::kSurfaceFeature; }

struct StuckCell {
  CellHandle cell;
  double degrees = 0;  ///< its smallest dihedral; not positive for an inverted or flat cell
  Limit limit = Limit::kNotFound;
  int n_frozen_vertices = 0;  ///< of its four
  /// Where the limit is a surface ceiling or an input feature, the proof: while the faces at the edge (a, b)
  /// that may not change stay as they are, some cell at this edge has a dihedral of at most `ceiling` degrees
  /// in every mesh; not positive where one is inverted or flat in every mesh.
  double ceiling = 180;
  VertexHandle a, b;
};

/// Each cell whose smallest dihedral is below `degrees`, ascending, with what is proven to keep it there,
/// else kNotFound. `unfillable`: those of the boundary faces at the invalid cells.
std::vector<StuckCell> stuck_cells(const TetMesh& mesh, double degrees,
                                   std::span<const HalfFaceHandle> unfillable, par::Policy policy = {});

/// Says kMaxCells of the cells without a reason of which VertexInsertion would raise the worst angle, with
/// more cells than `max_cells`.
void blame_max_cells(const TetMesh& mesh, std::vector<StuckCell>& stuck, double degrees,
                     std::size_t max_cells, par::Policy policy = {});

/// How many cells each limit keeps, in the order of Limit.
std::array<std::size_t, kLimitNames.size()> count_limits(const std::vector<StuckCell>& cells);

}  // namespace hfr

#endif
