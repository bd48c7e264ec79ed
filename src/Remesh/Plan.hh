// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PLAN_HH
#define HFR_REMESH_PLAN_HH

#include <string>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Improve.hh"

namespace hfr {

/// What improve() would do with these options, as text of some 40 lines: the stages in their order, and the
/// numbers that each works by. The mesh is looked at and left as it is. Throws InvalidInput for options out
/// of range, as improve() does.
std::string plan(const TetMesh& mesh, const ImproveOptions& options);

}  // namespace hfr

#endif
