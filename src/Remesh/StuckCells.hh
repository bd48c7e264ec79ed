// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_STUCK_CELLS_HH
#define HFR_REMESH_STUCK_CELLS_HH

#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Remesh/Result.hh"
#include "Remesh/Survey.hh"

namespace hfr {

/// Each cell whose smallest dihedral is below `degrees`, ascending, with what is proven to keep it there,
/// else kNotFound. `unfillable`: those of the boundary faces at the invalid cells.
std::vector<StuckCell> stuck_cells(const TetMesh& mesh, double degrees,
                                   std::span<const HalfFaceHandle> unfillable, par::Policy policy = {},
                                   const KnownValues& known = {});

/// These cells with their smallest dihedrals, in this order, and no reason yet but kNotFound.
std::vector<StuckCell> without_proofs(const TetMesh& mesh, std::span<const CellHandle> cells,
                                      par::Policy policy = {});
/// Whether each of them has a positive angle. Of all cells below an angle: whether all of the mesh have.
bool are_positive(std::span<const StuckCell> cells);
/// Notes of each what is proven to keep it from rising by so many degrees; not what needs the fold of a
/// boundary, and without the number of vertices that may not move. `frozen`: constrained_vertices().
/// `all_positive`: see are_positive(), of the cells round the edges of these; fewer edges are looked at then.
void prove_kept(const TetMesh& mesh, std::span<const std::uint8_t> frozen, std::span<StuckCell> cells,
                double by, bool all_positive, par::Policy policy = {});

/// Says kMaxCells of the cells without a reason of which VertexInsertion would raise the worst angle, with
/// more cells than `max_cells`, and how many cells there would have to be for all of them; where there are
/// none, that there is no room for a vertex, if some have no reason.
CellBoundMet blame_max_cells(const TetMesh& mesh, std::vector<StuckCell>& stuck, double degrees,
                             std::size_t max_cells, par::Policy policy = {});

/// The cells that the frozen surface is proven to keep, or that nothing was found for and all of whose
/// vertices it has.
std::vector<CellHandle> cells_held_back(const std::vector<StuckCell>& stuck);

}  // namespace hfr

#endif
