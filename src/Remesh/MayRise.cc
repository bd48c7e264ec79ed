// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MayRise.hh"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "Quality/Metrics.hh"
#include "Remesh/SmallestDihedrals.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/StuckCells.hh"
#include "Remesh/SurfaceRun.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

/// Cells below `degrees`, without proofs; of a mesh in parts those of this one.
struct LowCells {
  std::vector<StuckCell> cells;  ///< ascending
  bool all_positive;             ///< all cells of the mesh, or that this part holds

  LowCells(const Run& run, double degrees)
      : cells(without_proofs(run.mesh, cells_below(run.mesh, degrees, run.policy(), run.known()),
                             run.policy())),
        all_positive(are_positive(cells)) {
    if (run.is_part()) std::erase_if(cells, [&](const StuckCell& c) { return !run.parts()->is_own(c.cell); });
  }
};

/// Notes what holds these cells of `low`.
void prove(const Run& run, const LowCells& low, std::span<StuckCell> cells) {
  prove_kept(run.mesh, run.work.frozen, cells, kLeastRise, low.all_positive, run.policy());
  if (!run.surface) return;
  // What a feature holds, the faces at it hold as well while they stay, which is quicker to see.
  const bool here = std::ranges::any_of(cells, [](const StuckCell& c) { return is_proof(c.reason); });
  if (run.is_part() ? run.parts()->sum(here ? 1 : 0) > 0 : here) blame_features(run, cells, kLargestGoal);
}

std::vector<StuckCell> with_proofs(const Run& run, double degrees) {
  LowCells low(run, degrees);
  prove(run, low, low.cells);
  return std::move(low.cells);
}

bool is_at_ceiling(const StuckCell& cell) {
  return is_proof(cell.reason) && cell.ceiling <= cell.degrees + kLeastRise;
}

/// Smallest dihedral of the cells below `degrees` that may rise; `degrees` where there is none. With a frozen
/// surface from the worst cell on, twice as many at a time: the first that may rise is the answer. Features
/// are found in the whole surface each time.
double smallest_below(const Run& run, double degrees) {
  LowCells low(run, degrees);
  double smallest = degrees;
  const auto look_at = [&](std::span<StuckCell> cells) {
    prove(run, low, cells);
    for (const StuckCell& cell : cells)
      if (!is_at_ceiling(cell)) smallest = std::min(smallest, cell.degrees);
  };
  if (run.surface) {
    look_at(low.cells);
  } else {
    std::span<StuckCell> left(low.cells);
    std::ranges::stable_sort(left, {}, &StuckCell::degrees);
    for (std::size_t n = kFewCells; smallest == degrees && !left.empty(); n *= 2) {
      const std::size_t n_now = std::min(n, left.size());
      look_at(left.first(n_now));
      left = left.subspan(n_now);
    }
  }
  return run.is_part() ? run.parts()->min(smallest) : smallest;
}

}  // namespace

std::vector<CellHandle> cells_at_ceiling(const Run& run, double degrees) {
  std::vector<CellHandle> held;
  for (const StuckCell& cell : with_proofs(run, degrees))
    if (is_at_ceiling(cell)) held.push_back(cell.cell);
  return held;
}

std::vector<CellHandle> cells_that_may_rise(const Run& run, double degrees) {
  std::vector<CellHandle> cells;
  for (const StuckCell& cell : with_proofs(run, degrees))
    if (!is_at_ceiling(cell)) cells.push_back(cell.cell);
  return cells;
}

std::size_t n_at_ceiling(const Run& run, double degrees) {
  const std::size_t here = cells_at_ceiling(run, degrees).size();
  return run.is_part() ? run.parts()->sum(here) : here;
}

std::size_t n_out_of(const Run& run, double degrees, double vain_below) {
  const std::size_t n_held = n_at_ceiling(run, degrees);
  if (!(vain_below > 0)) return n_held;
  return n_held + run.n_below(vain_below) - n_at_ceiling(run, vain_below);
}

double share_that_may_rise(const Run& run, double degrees, double largest) {
  const AngleTally tally = run.tally_below(std::span(&degrees, 1));
  return tally.share(0) > largest ? tally.share(0, n_at_ceiling(run, degrees)) : tally.share(0);
}

double degrees_with_few_that_may_rise(const Run& run, double degrees, std::size_t n) {
  SmallestDihedrals angles(run, cells_at_ceiling(run, degrees));
  if (angles.n_below(dihedral_decision(degrees)) <= n) return degrees;
  return report_value(Metric::kMinDihedral, angles.smallest(n + 1));
}

double smallest_that_may_rise(const Run& run, double degrees) {
  const double worst = run.smallest_dihedral();
  if (worst >= degrees) return degrees;
  // Nearly always the worst cell has no proof, and no other is looked at.
  const double near = std::min(worst + kLeastRise, degrees);
  const double found = smallest_below(run, near);
  return found < near || near == degrees ? found : smallest_below(run, degrees);
}

}  // namespace hfr
