// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RUN_MEMORY_HH
#define HFR_REMESH_RUN_MEMORY_HH

#include <optional>

#include "Remesh/Options.hh"
#include "Remesh/Result.hh"
#include "Remesh/Survey.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

class Ranks;

/// What one run leaves for the next one over the same mesh, whose vertices have moved between them. Whoever
/// keeps it takes back what does not hold any more. Results have the same bits with it as without.
struct RunMemory {
  Workspace work;
  /// star_size and pinched of the workspace are those of the mesh, whose connectivity has not changed since;
  /// frozen marks at least its boundary.
  bool knows_stars = false;
  /// Whether folded_faces() has any, where no vertex of the boundary has moved since that was asked.
  std::optional<bool> is_folded;
  /// The cells are known to cover each direction round a vertex once (Coverage.hh), as positive ones do while
  /// no vertex of the boundary is moved.
  bool covers_once = false;
  /// What survey() would find; for the next run only.
  std::optional<Survey> found;
  /// A copy of the mesh as it is before the next run, for its maps; for that run only.
  const TetMesh* before = nullptr;
  /// Other processes that may do passes of the run; null: none.
  Ranks* ranks = nullptr;
};

/// improve() with a memory.
Result improve(TetMesh& mesh, const ImproveOptions& options, RunMemory& memory);

}  // namespace hfr

#endif
