// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_CHECK_CHANGES_HH
#define HFR_HALFFACE_CHECK_CHANGES_HH

#include "HalfFace/Check.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr {

/// Looks for what operators have broken since `mesh` was `before`, only where cells are others than they
/// were: a pass over the cells, and about half a microsecond for each vertex of a changed cell. Tests the
/// rules up to kNonManifoldVertex. Of edges that exist twice and of edges and vertices that are not manifold
/// only those count that were less so before; faces with three cells always count. Handles must not have been
/// renumbered in between. Vertices may have been moved, which no rule asks about.
CheckResult check_changes(const TetMesh& mesh, const TetMesh& before, par::Policy policy = {});

}  // namespace hfr

#endif
