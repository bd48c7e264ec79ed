// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Best.hh"

#include <algorithm>

#include "Quality/Metrics.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

double degrees(const Standing& standing) {
  return report_value(Metric::kMinDihedral, std::min(standing.worst, kRegularDihedral));
}

}  // namespace

Best::Best(const Run& run) : run_(run), standing_(now()), mesh_(run) {}

Standing Best::now() const { return standing_of(run_.mesh, survey(run_.mesh, run_.policy()), run_.policy()); }

void Best::note() {
  const Standing found = now();
  if (!is_better(found, standing_)) return;
  standing_ = found;
  mesh_.emplace(run_);
}

void Best::settle() {
  Standing found = now();
  if (degrees(found) + kLeastRise >= degrees(standing_)) found.worst = std::max(found.worst, standing_.worst);
  if (is_better(standing_, found)) mesh_->put_back(run_);
}

}  // namespace hfr
