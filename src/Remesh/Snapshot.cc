// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Snapshot.hh"

#include <utility>

#include "Remesh/Survey.hh"

namespace hfr {

void Snapshot::put_back(const Run& run) {
  run.mesh.restore(std::move(mesh_));
  surface_.put_back(run.surface);
  run.work.attach(run.mesh, run.policy());
  const Survey found = survey(run.mesh, run.policy());
  run.control.add_undo(n_changes_, found.n_invalid, found.worst);
}

}  // namespace hfr
