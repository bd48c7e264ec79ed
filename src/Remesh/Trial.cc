// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Trial.hh"

#include <algorithm>

#include "Quality/Metrics.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/SmallestDihedrals.hh"
#include "Remesh/Strategy.hh"

namespace hfr {
namespace {

constexpr std::size_t kHundredth = 100;

/// Rank of the percentile, counted from 1.
std::size_t hundredth(std::size_t n) { return std::max<std::size_t>((n + kHundredth - 1) / kHundredth, 1); }

std::vector<std::size_t> n_below_each(const SmallestDihedrals& angles, std::span<const double> decisions) {
  std::vector<std::size_t> n;
  for (double decision : decisions) n.push_back(angles.n_below(decision));
  return n;
}

/// The decision value from which on an angle has risen.
double risen_from(double decision) {
  return decision_value(Metric::kMinDihedral, report_value(Metric::kMinDihedral, decision) + kLeastRise);
}

}  // namespace

Trial::Trial(const Run& run, std::span<const double> goals)
    : run_(run), n_cells_(run.n_cells()), before_(run) {
  for (double goal : goals) goals_.push_back(dihedral_decision(goal));
  if (n_cells_ == 0) return;
  SmallestDihedrals angles(run);
  n_below_ = n_below_each(angles, goals_);
  n_invalid_ = angles.n_invalid();
  n_poorest_ = hundredth(n_cells_);
  low_to_reach_ = risen_from(angles.smallest(n_poorest_));
  const double worst = angles.smallest(1);
  const double may_rise = decision_value(Metric::kMinDihedral, smallest_that_may_rise(run, kLargestGoal));
  worst_to_reach_ = risen_from(may_rise > risen_from(worst) ? may_rise : worst);
}

bool Trial::pays() const {
  if (run_.n_cells() <= n_cells_) return true;
  const SmallestDihedrals angles(run_);
  const std::size_t n_low = angles.n_below(low_to_reach_);
  const double worst = report_value(Metric::kMinDihedral, worst_to_reach_);
  const std::size_t n_worse = angles.n_below(worst_to_reach_);
  if (n_worse == 0 || n_worse == n_at_ceiling(run_, worst) || n_low < n_poorest_) return true;
  if (angles.n_invalid() < n_invalid_) return true;
  const std::vector<std::size_t> n_missing = n_below_each(angles, goals_);
  // With many more cells, a hundredth of them holds more: a percentile that has risen counts where no cell
  // has come to be below the angle.
  return n_missing < n_below_ || (n_missing == n_below_ && n_low < hundredth(angles.n_cells()));
}

bool Trial::settle() {
  if (pays()) return true;
  before_.put_back(run_);
  return false;
}

}  // namespace hfr
