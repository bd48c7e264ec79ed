// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Best.hh"

#include <algorithm>
#include <array>
#include <cmath>

#include "Quality/Metrics.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/SmallestDihedrals.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

double degrees(double decision) { return report_value(Metric::kMinDihedral, decision); }
double degrees(const Standing& standing) { return degrees(std::min(standing.worst, kRegularDihedral)); }

/// Of the cells.
constexpr std::array<double, 2> kLowShares = {0.01, 0.05};

Best::Percentiles percentiles_of(const Run& run) {
  SmallestDihedrals angles(run);
  Best::Percentiles found{};
  if (angles.n_cells() == 0) return found;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double rank = std::max(std::ceil(kLowShares[k] * static_cast<double>(angles.n_cells())), 1.0);
    found[k] = angles.smallest(static_cast<std::size_t>(rank));
  }
  return found;
}

/// Whether both percentiles are worth less: in degrees, each as a share of what it was. Where one was not
/// positive, the first that differs decides.
bool are_lower(const Best::Percentiles& now, const Best::Percentiles& before) {
  double kept = 1;
  for (std::size_t k = 0; k < now.size(); ++k) {
    if (!(before[k] > 0)) return now < before;
    kept *= degrees(now[k]) / degrees(before[k]);
  }
  return kept < 1;
}

bool is_alike(double a, double b) { return std::abs(a - b) <= kLeastRise; }
double risen_now(const Run& run) { return smallest_that_may_rise(run, kLargestGoal); }

}  // namespace

Best::Beginning::Beginning(const Run& run) : worst(degrees(run.standing())), low(percentiles_of(run)) {}

Best::Best(const Run& run, double may_fall, Loss loss, const Beginning& beginning)
    : run_(run),
      loss_(loss),
      beginning_(beginning),
      least_(beginning.low),
      standing_(run.standing()),
      risen_(risen_now(run)),
      low_(percentiles_of(run)),
      mesh_(run) {
  for (double& value : least_)
    if (value > 0) value = dihedral_decision((1 - may_fall) * degrees(value));
}

bool Best::is_admissible(const Standing& found) const {
  // Cells that have become valid are worth more.
  if (found.n_inverted + found.n_flat < standing_.n_inverted + standing_.n_flat) return true;
  const Percentiles low = percentiles_of(run_);
  if (low[0] >= least_[0] && low[1] >= least_[1]) return true;
  return loss_ == Loss::kMadeUpFor && makes_up_for(degrees(found), low);
}

bool Best::makes_up_for(double worst, const Percentiles& low) const {
  double sum = worst - beginning_.worst, kept = 1;  // degrees; share of both
  for (std::size_t k = 0; k < low.size(); ++k) {
    const double now = degrees(low[k]), before = degrees(beginning_.low[k]);
    sum += now - before;
    if (before > 0) kept *= now / before;
  }
  return sum >= 0 && worst * kept * kept >= beginning_.worst;
}

int Best::by_risen(const Standing& found, double risen) const {
  Standing alike = found;
  alike.worst = standing_.worst;
  if (!is_alike(degrees(found), degrees(standing_)) || is_alike(risen, risen_) ||
      is_better(alike, standing_) || is_better(standing_, alike))
    return 0;
  return risen > risen_ ? 1 : -1;
}

void Best::note() {
  const Standing found = run_.standing();
  const double risen = risen_now(run_);
  const int by = by_risen(found, risen);
  if (by < 0 || (by == 0 && !is_better(found, standing_)) || !is_admissible(found)) return;
  standing_ = found;
  risen_ = risen;
  low_ = percentiles_of(run_);
  mesh_.emplace(run_);
}

void Best::settle() {
  Standing found = run_.standing();
  const int by = by_risen(found, risen_now(run_));
  if (is_alike(degrees(found), degrees(standing_))) found.worst = standing_.worst;
  const bool is_worse = by < 0 || (by == 0 && is_better(standing_, found));
  const bool decides_low = by == 0 && !is_worse && !is_better(found, standing_);
  if (is_worse || !is_admissible(found) || (decides_low && are_lower(percentiles_of(run_), low_)))
    mesh_->put_back(run_);
}

}  // namespace hfr
