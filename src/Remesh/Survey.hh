// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_SURVEY_HH
#define HFR_REMESH_SURVEY_HH

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

/// Decision value of MinDihedral for the regular tetrahedron, the largest there is.
inline constexpr double kRegularDihedral = 8.0 / 9.0;

/// Decision values of all cell slots of a mesh as it is, which need not be evaluated then; empty where nobody
/// has them.
struct KnownValues {
  std::span<const double> sines;      ///< of MinSine2
  std::span<const double> dihedrals;  ///< of MinDihedral
};
KnownValues known_values(const Workspace& work);

/// The mesh in two numbers, from one pass over its cells.
struct Survey {
  double worst = 0;           ///< smallest decision value of MinDihedral; infinity without cells
  std::size_t n_invalid = 0;  ///< cells whose volume is not positive beyond rounding
};
/// `counts`: the cells that are looked at; all where it is empty.
Survey survey(const TetMesh& mesh, par::Policy policy, const KnownValues& known = {},
              const std::function<bool(CellHandle)>& counts = {});

/// Smallest dihedral angle of the mesh in degrees, 0 or negative when a cell is flat or inverted.
double smallest_dihedral(const TetMesh& mesh, par::Policy policy);
/// What there is below each of a few angles, from one pass over the cells.
struct AngleTally {
  double worst = 0;                  ///< smallest decision value of MinDihedral, kRegularDihedral at most
  double smallest = 0;               ///< see smallest_dihedral()
  std::size_t n_cells = 0;           ///< of the mesh
  std::vector<std::size_t> n_below;  ///< by angle: cells whose smallest dihedral is below
  /// Of all cells; `without`: of those below, that do not count.
  double share(std::size_t angle, std::size_t without = 0) const {
    const std::size_t n = n_below[angle];
    return static_cast<double>(n - std::min(n, without)) / static_cast<double>(n_cells);
  }
};
/// `counts`: the cells that are looked at, but for n_cells; all where it is empty.
AngleTally tally_below(const TetMesh& mesh, std::span<const double> degrees, par::Policy policy,
                       const KnownValues& known = {}, const std::function<bool(CellHandle)>& counts = {});
/// Number of cells whose smallest dihedral is below so many degrees.
std::size_t n_below(const TetMesh& mesh, double degrees, par::Policy policy);
/// These cells, ascending.
std::vector<CellHandle> cells_below(const TetMesh& mesh, double degrees, par::Policy policy,
                                    const KnownValues& known = {});
/// At most n of them, the worst first; none of `but`, which ascends.
std::vector<CellHandle> worst_cells_below(const TetMesh& mesh, double degrees, std::size_t n,
                                          par::Policy policy, std::span<const CellHandle> but = {},
                                          const KnownValues& known = {});
/// At most `degrees`, such that no more than n cells are below.
double degrees_with_few_below(const TetMesh& mesh, double degrees, std::size_t n, par::Policy policy,
                              const KnownValues& known = {});
/// Cells whose volume is not positive beyond rounding, ascending.
std::vector<CellHandle> invalid_cells(const TetMesh& mesh, par::Policy policy, const KnownValues& known = {});

}  // namespace hfr

#endif
