// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PATCH_SEARCH_HH
#define HFR_REMESH_PATCH_SEARCH_HH

#include "Remesh/Run.hh"

namespace hfr {

/// Tries for the worst cells below `degrees` what a new vertex does, or one less, each time on a copy of the
/// surroundings that is improved and put back only if its worst cell has got better. Faces of the surface
/// stay as they are, unless PatchTrial::has_surface. True when the mesh has changed. Expects: a mesh without
/// invalid cells; does nothing elsewhere, nor where PatchTrial is not enabled. Guarantees: the smallest sine
/// of the dihedral angles of no patch falls. Ends: after so many turns, with one in which the worst patch has
/// not got better, where more than PatchEffort::few cells are below, or with the run.
bool search_patches(const Run& run, double degrees, const PatchEffort& effort);

}  // namespace hfr

#endif
