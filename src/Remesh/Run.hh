// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RUN_HH
#define HFR_REMESH_RUN_HH

#include <algorithm>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Checkpoint.hh"
#include "Remesh/DeviceSession.hh"
#include "Remesh/MeshInParts.hh"
#include "Remesh/Ranks.hh"
#include "Remesh/RunControl.hh"
#include "Remesh/Strategy.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

class SurfaceMesh;

/// What a run finds out on its way.
struct Findings {
  /// The boundary lies on or goes through itself somewhere, or cells cover a direction round a vertex twice:
  /// then positive cells may overlap, and rounds hold the link condition throughout.
  bool is_folded = false;
  /// The cells are not known to cover each direction round a vertex once: that is looked into before a round
  /// over positive cells, and counts as folded where they do not.
  bool may_cover_twice = true;
  /// Something was left undone for the number of cells; and the bound on more of them at that time, 0: none.
  bool met_cell_bound = false;
  std::size_t max_cells_met = 0;
  bool ever_met_cell_bound = false;  ///< also before it was forgotten

  void note_cell_bound(const CellBounds& bounds) {
    met_cell_bound = ever_met_cell_bound = true;
    max_cells_met = bounds.max;
  }
  void forget_cell_bound() {
    met_cell_bound = false;
    max_cells_met = 0;
  }
};

/// A run as its stages see it: what they work on, and what was decided about it. A stage may go on with a
/// copy that has other bounds; everything else is shared.
struct Run {
  TetMesh& mesh;
  Workspace& work;  ///< attached to the mesh
  const Strategy& strategy;
  RunControl& control;
  Findings& findings;
  DeviceSession& device;
  SurfaceMesh* surface = nullptr;    ///< that operators may work on; null while it is frozen
  Checkpoint* checkpoint = nullptr;  ///< null where the caller sees to the mesh, as for tries on a copy
  CellBounds bounds = {};
  /// Whether a new vertex may leave as many poor cells as it takes.
  bool may_add_poor_cells = false;
  Ranks* ranks = nullptr;  ///< that may do passes, too; null: all is done here

  par::Policy policy() const { return strategy.pass.policy; }
  /// Whether this mesh is a part of that of the run; see Ranks::keep_mesh().
  bool is_part() const { return ranks && ranks->keep_mesh(); }
  /// Where it is; null elsewhere.
  MeshInParts* parts() const { return is_part() ? ranks->parts() : nullptr; }
  /// What the workspace has of the cells of this mesh.
  KnownValues known() const { return known_values(work); }
  /// Of the whole, as what follows.
  Survey survey() const { return is_part() ? parts()->survey() : hfr::survey(mesh, policy(), known()); }
  Standing standing() const {
    return is_part() ? parts()->standing() : standing_of(mesh, survey(), policy(), known());
  }
  std::size_t n_below(double degrees) const { return tally_below(std::span(&degrees, 1)).n_below[0]; }
  AngleTally tally_below(std::span<const double> degrees) const {
    return is_part() ? parts()->tally_below(degrees) : hfr::tally_below(mesh, degrees, policy(), known());
  }
  /// See smallest_dihedral().
  double smallest_dihedral() const {
    return report_value(Metric::kMinDihedral, std::min(survey().worst, kRegularDihedral));
  }
  std::size_t n_cells() const { return is_part() ? ranks->n_cells() : mesh.n_logical_cells(); }
  /// Whether the bound on cells leaves room for those of another vertex.
  bool has_room() const { return bounds.max == 0 || n_cells() + strategy.pass.cells_of_vertex <= bounds.max; }
  /// The same run within other bounds on cells.
  Run within(CellBounds other) const {
    Run run = *this;
    run.bounds = other;
    return run;
  }
  /// The same run by another strategy.
  Run with(const Strategy& other) const {
    return {mesh,   work,    other,      control,      findings,
            device, surface, checkpoint, other.bounds, may_add_poor_cells,
            ranks};
  }
  /// Before something that may leave the mesh worse; see Checkpoint::keep().
  void keep(bool valid) const {
    if (checkpoint) checkpoint->keep(mesh, valid, control.revision());
  }
};

/// What a run consists of beside its mesh, for a caller that has no more than a strategy: a try on a copy, or
/// a stage by itself.
class LoneRun {
 public:
  LoneRun(TetMesh& mesh, Strategy strategy, double time_limit = std::numeric_limits<double>::infinity())
      : strategy_(std::move(strategy)), control_(time_limit), mesh_(mesh) {
    work_.attach(mesh, strategy_.pass.policy);
  }
  LoneRun(const LoneRun&) = delete;
  LoneRun& operator=(const LoneRun&) = delete;

  Workspace& work() { return work_; }
  RunControl& control() { return control_; }
  Findings& findings() { return findings_; }
  Run run(SurfaceMesh* surface = nullptr) {
    return {mesh_, work_, strategy_, control_, findings_, device_, surface, nullptr, strategy_.bounds};
  }

 private:
  Strategy strategy_;
  Workspace work_;
  RunControl control_;
  Findings findings_;
  DeviceSession device_;
  TetMesh& mesh_;
};

}  // namespace hfr

#endif
