// SPDX-License-Identifier: BSD-3-Clause
// The first half of a commit, for rounds and replace().
#ifndef HFR_OPERATORS_WRITE_CELLS_HH
#define HFR_OPERATORS_WRITE_CELLS_HH

#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"

namespace hfr {

/// An outer face of a cavity: where it was, what lies behind it, and where it is now.
struct OuterFace {
  HalfFaceHandle before;  ///< of the removed cell
  HalfFaceHandle behind;  ///< its mate before the round, invalid on the boundary
  HalfFaceHandle after;   ///< of the created cell
};

/// Commit A. Writes the created cells into `slots` (as many as there are created cells; removed cells first)
/// and links them with each other; appends the outer faces to `notes`. Removed cells beyond the slots are
/// marked deleted. Touches no cell outside the cavity and its slots, so cavities that share no cell may be
/// written concurrently. `new_vertex` stands in for Cavity::kNewVertex. Outside mates are left to the caller
/// (commit B).
void write_cells(TetMesh& mesh, const Cavity& cavity, std::span<const CellHandle> slots,
                 VertexHandle new_vertex, std::vector<OuterFace>& notes);

}  // namespace hfr

#endif
