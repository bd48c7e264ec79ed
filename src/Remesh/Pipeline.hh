// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PIPELINE_HH
#define HFR_REMESH_PIPELINE_HH

#include <array>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Improve.hh"
#include "Remesh/RunControl.hh"
#include "Remesh/Survey.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

/// Whether the surface may change its shape.
inline bool is_free(const ImproveOptions& options) { return options.surface.mode == SurfaceMode::kFree; }
/// Smallest dihedral angle of the mesh in degrees, 0 or negative when a cell is flat or inverted.
double smallest_dihedral(const TetMesh& mesh, par::Policy policy);
/// Number of cells whose smallest dihedral is below so many degrees.
std::size_t n_below(const TetMesh& mesh, double degrees, par::Policy policy);
/// Cells whose volume is not positive beyond rounding, ascending.
std::vector<CellHandle> invalid_cells(const TetMesh& mesh, par::Policy policy);

/// Mends inverted and flat cells on volume-length, the focus widening from the damage while it helps.
void untangle(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control);
/// Improves all cells in options.metric, until an iteration gains little.
void improve_bulk(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control);
/// Removes vertices where that raises the worst angle of their cells, and works on all cells that are no very
/// good ones, until an iteration takes few cells away.
void coarsen(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control);
/// Works on cells with a dihedral below `goal` degrees (or above 180 - goal) until there are none or nothing
/// helps. True when the smallest dihedral meets the goal. Not begun when more than `largest_share` of the
/// cells miss the goal.
bool polish(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, double goal,
            double largest_share = 1);
/// The same towards a decision value of MinDihedral, which may be that of an inverted cell.
bool polish_to(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
               double decision, double largest_share = 1);
/// Puts vertices in where cells are below `goal` degrees and a new one raises sin² of the worst cell of its
/// cavity by the factor `gain`, until that does not help many of them any more. Removes none.
void refine(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, double goal,
            double gain);
/// At most so many cells below so many degrees, the worst first.
std::vector<CellHandle> worst_cells_below(const TetMesh& mesh, double degrees, std::size_t n,
                                          par::Policy policy);
/// Degrees below which there are only as many cells as relieve() takes on, at most `degrees`.
double few_below(const TetMesh& mesh, double degrees, par::Policy policy);
/// Ways there are to put an apex over each needle of a patch at once.
constexpr std::size_t kNeedleRows = 2;
/// How much search_patches() does.
struct PatchEffort {
  std::size_t few;       ///< cells below the next angle; where there are more, nothing is tried
  int layers;            ///< of cells round the worst one
  std::size_t patches;   ///< at a time
  int turns;             ///< at most
  std::size_t rows;      ///< of apexes over needles that are tried, at most kNeedleRows
  std::size_t vertices;  ///< new ones for one patch, each in a try of its own
  std::size_t removals;  ///< and vertices next to the worst cell that are taken out instead
  double degrees;        ///< beyond the worst angle, that are worked for in a turn
};
constexpr PatchEffort kLittleEffort = {64, 3, 4, 12, kNeedleRows, 8, 12, 0.6};
/// Where the surface may change, which has cheaper ways to mend needles, but for the very last cells.
constexpr PatchEffort kSurfaceEffort = {64, 3, 4, 4, 0, 8, 12, 0.6};
/// For the very last cells, one after the other.
constexpr std::array<PatchEffort, 2> kLastEfforts = {
    {{6, 2, 4, 2, kNeedleRows, 20, 30, 0.6}, {6, 4, 4, 2, kNeedleRows, 12, 30, 0.6}}};
/// One after the other, where the worst angle is to be raised at any cost: what one cannot mend, another may.
constexpr std::array<PatchEffort, 3> kAllEfforts = {{{64, 3, 8, 40, kNeedleRows, 20, 20, 2},
                                                     {64, 4, 8, 40, kNeedleRows, 20, 20, 0.5},
                                                     {64, 2, 8, 40, kNeedleRows, 20, 20, 3}}};
/// Tries for the worst cells below `goal` degrees what a new vertex does, or one less, each time on a copy of
/// the cell's surroundings that is improved and put back only if its worst cell has got better. Faces of the
/// surface stay as they are. For a mesh without invalid cells where vertices may be inserted; does nothing
/// elsewhere. True when the mesh has changed.
bool search_patches(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
                    double goal, const PatchEffort& effort);
/// Works on the surroundings of the cells below `goal` degrees as if the goal were larger, and then on these
/// cells again. Where there are more than a few, it does nothing. True when none are left.
bool relieve(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, double goal);
/// With a surface that may change its shape: moves it so that the enclosed volume is what it was.
void restore_volume(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control);
/// The paper's pipeline in the paper's form: star operators and candidate smoothing over the whole mesh,
/// edge → face → node → smooth, a fixed number of iterations.
void run_jpdc2013(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control);

}  // namespace hfr

#endif
