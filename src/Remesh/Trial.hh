// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_TRIAL_HH
#define HFR_REMESH_TRIAL_HH

#include "HalfFace/TetMesh.hh"
#include "Remesh/Improve.hh"
#include "Remesh/RunControl.hh"
#include "Remesh/SurfaceRun.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

/// A gain in an angle that shows in a table: degrees.
inline constexpr double kLeastRise = 0.01;

/// A mesh in the middle of a run, with the run's surface, to come back to: 40 bytes a cell.
class Snapshot {
 public:
  Snapshot(const TetMesh& mesh, const RunControl& control)
      : mesh_(mesh), surface_(control.surface()), n_changes_(control.n_changes()) {}
  const TetMesh& mesh() const { return mesh_; }
  /// With a line in the report. Once only.
  void put_back(TetMesh& mesh, Workspace& work, RunControl& control, par::Policy policy);

 private:
  TetMesh mesh_;
  SurfaceCopy surface_;
  std::size_t n_changes_;
};

/// A stage that may insert vertices, on trial. Cells are worth having where the worst angle rises by them, or
/// the largest one of the poorest hundredth, or where fewer are below the angle that was worked for. Angles
/// rise where they do so by kLeastRise. Where none of these holds, all that the stage has done goes again.
/// The poorest hundredth is as many cells before as after, because good cells that are added to poor ones
/// raise every percentile; a hundredth of what there is then counts only if no more cells are below the
/// angle.
class Trial {
 public:
  /// Makes a Snapshot. `goal`: degrees that are worked for.
  Trial(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, double goal);
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  /// After the stage: puts everything back where cells were added for nothing, with a line in the report.
  /// True when what was done stays.
  bool settle();

 private:
  bool pays() const;

  TetMesh& mesh_;
  Workspace& work_;
  RunControl& control_;
  par::Policy policy_;
  double goal_;                              // as decision value, like the next two
  double worst_to_reach_ = 0;                // for a gain
  double low_to_reach_ = 0;                  // for the last cell of the poorest hundredth to have risen
  std::size_t n_poorest_ = 0, n_below_ = 0;  // cells of that hundredth, and below the goal
  Snapshot before_;
};

}  // namespace hfr

#endif
