// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Snapshot.hh"

#include <utility>

#include "Remesh/Survey.hh"

namespace hfr {

Snapshot::Snapshot(const Run& run)
    : surface_(run.surface),
      revision_(run.control.revision()),
      may_cover_twice_(run.findings.may_cover_twice),
      is_trusted_(run.checkpoint && run.checkpoint->is_trusted()) {
  if (run.checkpoint) mesh_ = run.checkpoint->copy_of_revision(revision_);
  if (!mesh_) mesh_ = copy_of(run.mesh, run.parts());
}

void Snapshot::put_back(const Run& run) {
  restore(run.mesh, run.parts(), std::exchange(mesh_, {}));
  surface_.put_back(run.surface);
  if (!run.is_part()) run.work.attach(run.mesh, run.policy());
  const Survey found = run.survey();
  if (may_cover_twice_ || found.n_invalid > 0) run.findings.may_cover_twice = true;
  if (run.checkpoint && !is_trusted_) run.checkpoint->distrust();
  run.control.add_undo(revision_, found.n_invalid, found.worst);
}

}  // namespace hfr
