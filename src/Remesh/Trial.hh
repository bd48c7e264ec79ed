// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_TRIAL_HH
#define HFR_REMESH_TRIAL_HH

#include <cstddef>
#include <span>
#include <vector>

#include "Remesh/Run.hh"
#include "Remesh/Snapshot.hh"

namespace hfr {

/// A gain in an angle that shows in a table: degrees.
inline constexpr double kLeastRise = 0.01;

/// A stage that may insert vertices, on trial. Cells are worth having where the worst angle that may
/// rises by them, or the largest one of the poorest hundredth, or where fewer are below the angle that was
/// worked for, the lowest of several at which their number differs, or fewer inverted or flat. Angles rise
/// where they do so by kLeastRise. Where none of these holds, all that the stage has done goes again. The
/// poorest hundredth is as many cells before as after, because good cells that are added to poor ones raise
/// every percentile; a hundredth of what there is then counts only if no more cells are below the angle.
class Trial {
 public:
  /// Makes a Snapshot. `goals`: degrees that are worked for, ascending.
  Trial(const Run& run, std::span<const double> goals);
  Trial(const Run& run, double goal) : Trial(run, std::span<const double>(&goal, 1)) {}
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  /// After the stage: puts everything back where cells were added for nothing, with a line in the report.
  /// True when what was done stays.
  bool settle();

 private:
  bool pays() const;

  Run run_;
  std::vector<double> goals_;         // as decision values, like the next two
  double worst_to_reach_ = 0;         // for a gain
  double low_to_reach_ = 0;           // for the last cell of the poorest hundredth to have risen
  std::size_t n_poorest_ = 0;         // cells of that hundredth
  std::vector<std::size_t> n_below_;  // each of the goals
  std::size_t n_invalid_ = 0;
  std::size_t n_cells_;
  Snapshot before_;
};

}  // namespace hfr

#endif
