// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Best.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

double degrees(const Standing& standing) {
  return report_value(Metric::kMinDihedral, std::min(standing.worst, kRegularDihedral));
}

/// Of the cells.
constexpr std::array<double, 2> kLowShares = {0.01, 0.05};

}  // namespace

Best::Best(const Run& run, double may_fall) : run_(run), standing_(now()), mesh_(run) {
  low_ = least_ = percentiles();
  for (double& value : least_)
    if (value > 0) value = dihedral_decision((1 - may_fall) * report_value(Metric::kMinDihedral, value));
}

Best::Percentiles Best::percentiles() const {
  std::vector<double> values(run_.mesh.n_cells());
  par::for_ranges(run_.policy(), values.size(), [&](std::size_t begin, std::size_t end) {
    for_decisions(run_.mesh, MinDihedral{}, begin, end,
                  [&](std::size_t i, double value) { values[i] = value; });
  });
  const auto n = static_cast<double>(run_.mesh.n_logical_cells());
  Percentiles found{};
  if (values.empty()) return found;
  for (std::size_t k = 0; k < found.size(); ++k) {                    // deleted slots hold infinity
    const double rank = std::max(std::ceil(kLowShares[k] * n), 1.0);  // counted from 1
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
    std::nth_element(values.begin(), at, values.end());
    found[k] = *at;
  }
  return found;
}

bool Best::is_admissible(const Standing& found) const {
  // Cells that have become valid are worth more.
  if (found.n_inverted + found.n_flat < standing_.n_inverted + standing_.n_flat) return true;
  const Percentiles low = percentiles();
  return low[0] >= least_[0] && low[1] >= least_[1];
}

Standing Best::now() const { return standing_of(run_.mesh, survey(run_.mesh, run_.policy()), run_.policy()); }

void Best::note() {
  const Standing found = now();
  if (!is_better(found, standing_) || !is_admissible(found)) return;
  standing_ = found;
  low_ = percentiles();
  mesh_.emplace(run_);
}

void Best::settle() {
  Standing found = now();
  if (std::abs(degrees(found) - degrees(standing_)) <= kLeastRise) found.worst = standing_.worst;
  const bool is_alike = !is_better(standing_, found) && !is_better(found, standing_);
  if (is_better(standing_, found) || !is_admissible(found) || (is_alike && percentiles() < low_))
    mesh_->put_back(run_);
}

}  // namespace hfr
