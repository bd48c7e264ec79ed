// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_IMPROVE_HH
#define HFR_REMESH_IMPROVE_HH

#include <string>

#include "hfremesh/Remesh/Options.hh"
#include "hfremesh/Remesh/Result.hh"

namespace hfr {

class TetMesh;

/// Improves `mesh` in place. Boundary, region interfaces, labelled faces and edges and fixed vertices keep
/// every bit, unless options.surface lets the surface change. Deleted cells and vertices are collected before
/// it returns.
///
/// However the run ends, with its goal, without, by time, by cancel, by a device that is lost or by an
/// exception of a callback, the mesh is no worse than it was: it has no more inverted cells, no more inverted
/// and flat cells together, no more overlap (the sum of |volume| of the inverted cells) and no smaller worst
/// dihedral angle. Stages that may lower these are begun with a copy of the mesh; what is worse in the end
/// becomes the best that was kept. Handles of properties stay valid.
///
/// Throws InvalidInput for options out of range or that name what the mesh does not have, and InternalError,
/// with the mesh as it was kept, where operators have broken a rule of check(): see Checkpoint.hh.
Result improve(TetMesh& mesh, const ImproveOptions& options = {});

/// What improve() would do with these options, as text of some 40 lines: the stages in their order, and the
/// numbers that each works by. The mesh is looked at and left as it is. Throws InvalidInput for options out
/// of range.
std::string plan(const TetMesh& mesh, const ImproveOptions& options = {});

}  // namespace hfr

#endif
