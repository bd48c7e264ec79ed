// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/WholeRun.hh"

#include <optional>

#include "Remesh/Pipeline.hh"
#include "Remesh/Polish.hh"
#include "Remesh/RestoreVolume.hh"
#include "Remesh/Snapshot.hh"

namespace hfr {
namespace {

/// Before the end of a run that may have left the mesh worse than its input: works on what has fallen below
/// the input's smallest angle, if that is all, and puts back what was kept if that does not do. False when it
/// did that.
bool settle(const Run& run, bool known_to_meet) {
  Checkpoint& checkpoint = *run.checkpoint;
  const auto mend = [&] {
    if (run.control.stopped() || run.strategy.course == Course::kCompat) return;
    Run mending = run.within(run.strategy.bounds_asked);
    mending.may_add_poor_cells = run.strategy.course == Course::kAnyCost;
    polish_to(mending, run.strategy.mending(), checkpoint.input().worst);
  };
  const Findings& findings = run.findings;
  if (findings.is_folded || findings.may_cover_twice || !run.work.pinched.empty()) checkpoint.distrust();
  if (!checkpoint.settle(run.mesh, known_to_meet, mend)) return true;
  run.work.forget_qualities();
  const Survey found = run.survey();
  run.control.add_undo(checkpoint.kept_revision(), found.n_invalid, found.worst);
  return false;
}

/// All stages. Over inverted or flat cells first without holding each cluster to being no more damaged: from
/// a state between that is worse, more of them come right. Where the mesh ends worse for it than it began,
/// again from the beginning, and held; a plain goal also where cells stay invalid, and the better of both, as
/// other runs do it with theirs.
bool run_twice_if_worse(const Run& run) {
  const auto run_all = [&] {
    const bool met = run_stages(run);
    if (run.strategy.volume) restore_volume(run, *run.strategy.volume);
    return met;
  };
  if (run.checkpoint->input().is_valid()) return run_all();
  run.work.floor = run.checkpoint->input().worst;
  Snapshot before(run);
  run.work.holds_damage = false;
  const bool met = run_all();
  run.work.holds_damage = true;
  if (met || run.control.stopped()) return met;
  const Standing found = run.standing();
  std::optional<Snapshot> unheld;
  if (run.checkpoint->allows(run.mesh)) {
    const bool is_plain = run.strategy.untangle && !run.strategy.plain;
    if (!is_plain || found.is_valid()) return met;
    unheld.emplace(run);
    run.keep(false);
  }
  before.put_back(run);
  const bool met_held = run_all();
  if (!unheld || (run.checkpoint->allows(run.mesh) && is_better(run.standing(), found))) return met_held;
  unheld->put_back(run);
  return met;
}

}  // namespace

Ending run_to_the_end(const Run& run) {
  const bool valid = run.checkpoint->input().is_valid();
  // Elsewhere all cells are positive: no new edge or face can come twice, or rounds ask whether one would,
  // and there is no copy to make.
  if (!valid || run.findings.is_folded || !run.work.pinched.empty()) run.keep(valid);
  const bool met = run_twice_if_worse(run);
  const bool stays = settle(run, met);
  return {stays && met, stays};
}

}  // namespace hfr
