// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Trial.hh"

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

constexpr std::size_t kHundredth = 100;

/// Decision values of MinDihedral; infinity in deleted slots.
std::vector<double> angles_of(const TetMesh& mesh, par::Policy policy) {
  std::vector<double> values(mesh.n_cells());
  par::for_ranges(policy, values.size(), [&](std::size_t begin, std::size_t end) {
    for_decisions(mesh, MinDihedral{}, begin, end, [&](std::size_t i, double value) { values[i] = value; });
  });
  return values;
}

template <class Is>
std::size_t count(const std::vector<double>& values, par::Policy policy, Is&& is) {
  return par::reduce(
      policy, values.size(), std::size_t{0},
      [&](std::size_t i) -> std::size_t { return is(values[i]) ? 1 : 0; }, std::plus<>{});
}

bool is_invalid(double decision) { return !(decision > 0); }

/// Rank of the percentile, counted from 1.
std::size_t hundredth(std::size_t n) { return std::max<std::size_t>((n + kHundredth - 1) / kHundredth, 1); }

/// The decision value from which on an angle has risen.
double risen_from(double decision) {
  return decision_value(Metric::kMinDihedral, report_value(Metric::kMinDihedral, decision) + kLeastRise);
}

}  // namespace

Trial::Trial(const Run& run, double goal) : run_(run), goal_(dihedral_decision(goal)), before_(run) {
  std::vector<double> values = angles_of(run.mesh, run.policy());
  if (values.empty()) return;
  n_below_ = count(values, run_.policy(), [&](double value) { return value < goal_; });
  n_invalid_ = count(values, run_.policy(), is_invalid);
  n_poorest_ = hundredth(run.mesh.n_logical_cells());
  const auto last = values.begin() + static_cast<std::ptrdiff_t>(n_poorest_) - 1;
  std::nth_element(values.begin(), last, values.end());
  low_to_reach_ = risen_from(*last);
  const double worst = *std::min_element(values.begin(), last + 1);
  const double may_rise = decision_value(Metric::kMinDihedral, smallest_that_may_rise(run, kLargestGoal));
  worst_to_reach_ = risen_from(may_rise > risen_from(worst) ? may_rise : worst);
}

bool Trial::pays() const {
  if (run_.mesh.n_logical_cells() <= before_.mesh().n_logical_cells()) return true;
  const std::vector<double> values = angles_of(run_.mesh, run_.policy());
  const auto n_below = [&](double decision) {
    return count(values, run_.policy(), [&](double value) { return value < decision; });
  };
  const std::size_t n_low = n_below(low_to_reach_);
  const double worst = report_value(Metric::kMinDihedral, worst_to_reach_);
  const std::size_t n_worse = n_below(worst_to_reach_);
  if (n_worse == 0 || n_worse == cells_at_ceiling(run_, worst).size() || n_low < n_poorest_) return true;
  if (count(values, run_.policy(), is_invalid) < n_invalid_) return true;
  const std::size_t n_missing = n_below(goal_);
  // With many more cells, a hundredth of them holds more: a percentile that has risen counts where no cell
  // has come to be below the angle.
  return n_missing < n_below_ || (n_missing == n_below_ && n_low < hundredth(run_.mesh.n_logical_cells()));
}

bool Trial::settle() {
  if (pays()) return true;
  before_.put_back(run_);
  return false;
}

}  // namespace hfr
