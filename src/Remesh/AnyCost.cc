// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/AnyCost.hh"

#include <algorithm>

#include "Remesh/MayRise.hh"
#include "Remesh/Neighbourhoods.hh"
#include "Remesh/PatchSearch.hh"
#include "Remesh/Polish.hh"
#include "Remesh/Refine.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

/// Whether the worst angle has, by that factor, and by what shows in a table; 0 before: anything is a gain.
bool has_risen(double now, double before, double factor) {
  return now > (before > 0 ? std::max(before * factor, before + kLeastRise) : 0);
}

class Climb {
 public:
  Climb(const Run& run, const AnyCostEffort& effort) : run_(run), effort_(effort) {}

  /// Over all targets again and again, and beyond those that are missed, while the worst rises.
  void while_it_rises() {
    for (double at_start = 0; has_risen(smallest(), at_start, effort_.gain) && !run_.control.stopped();) {
      at_start = smallest();
      over_targets();
      if (run_.control.stopped()) return;
      const std::size_t few = run_.strategy.neighbourhoods ? run_.strategy.neighbourhoods->few : 0;
      const double last = degrees_with_few_that_may_rise(run_, effort_.targets.back().degrees, few);
      Trial trial(run_, last);
      improve_neighbourhoods(run_, run_.strategy.neighbourhoods, last);
      trial.settle();
    }
  }
  void search_worst() {
    for (const PatchEffort& effort : effort_.patches)
      search_patches(run_, effort_.targets.back().degrees, effort);
  }
  /// Of cells that came to be below that, on the way to what is larger.
  void mend(double degrees) {
    if (smallest() < degrees) polish(run_, run_.strategy.mending(), degrees);
  }
  double smallest() const { return smallest_that_may_rise(run_, kLargestGoal); }

 private:
  std::size_t n_poor(double degrees) const { return run_.n_below(degrees); }

  void over_targets() {
    int n_missed = 0;
    for (const TargetAngle& target : effort_.targets) {
      const double now = smallest();
      if (now >= target.degrees || now < target.from) continue;
      if (n_missed == effort_.missed || run_.control.stopped()) break;
      const auto before = static_cast<double>(n_poor(target.degrees));
      Trial trial(run_, target.degrees);
      polish(run_, effort_.polish, target.degrees);
      if (effort_.neighbourhoods) improve_neighbourhoods(run_, run_.strategy.neighbourhoods, target.degrees);
      trial.settle();
      const bool fewer = effort_.fewer * before > static_cast<double>(n_poor(target.degrees));
      n_missed = fewer || has_risen(smallest(), now, effort_.gain) ? 0 : n_missed + 1;
    }
  }

  const Run& run_;
  const AnyCostEffort& effort_;
};

}  // namespace

void raise_at_any_cost(const Run& whole, const AnyCostEffort& effort, Best& best) {
  CellBounds bounds = effort.bounds;
  if (effort.most_of_hundred > 0) bounds.max = whole.n_cells() * effort.most_of_hundred / 100;
  whole.findings.forget_cell_bound();
  Run run = whole.within(bounds);
  run.may_add_poor_cells = true;
  Climb climb(run, effort);
  climb.search_worst();
  best.note();
  if (effort.refine) refine(run, *effort.refine);
  for (double at_start = 0; has_risen(climb.smallest(), at_start, effort.again) && !run.control.stopped();) {
    climb.while_it_rises();
    climb.mend(best.risen());
    best.note();
    if (at_start == 0 && effort.refine_again) refine(run, *effort.refine_again);
    at_start = climb.smallest();
    climb.search_worst();
    climb.mend(best.risen());
    best.note();
  }
}

}  // namespace hfr
