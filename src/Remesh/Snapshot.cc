// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Snapshot.hh"

#include <utility>

#include "Remesh/Survey.hh"

namespace hfr {

Snapshot::Snapshot(const Run& run) : surface_(run.surface), n_changes_(run.control.n_changes()) {
  if (run.checkpoint) mesh_ = run.checkpoint->copy_after(n_changes_);
  if (!mesh_) mesh_ = std::make_shared<TetMesh>(run.mesh);
}

void Snapshot::put_back(const Run& run) {
  restore(run.mesh, std::move(mesh_));
  surface_.put_back(run.surface);
  run.work.attach(run.mesh, run.policy());
  const Survey found = survey(run.mesh, run.policy());
  run.control.add_undo(n_changes_, found.n_invalid, found.worst);
}

}  // namespace hfr
