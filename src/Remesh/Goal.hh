// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_GOAL_HH
#define HFR_REMESH_GOAL_HH

#include "Remesh/Best.hh"
#include "Remesh/Run.hh"

namespace hfr {

/// Works on the cells that miss the goal, within the bounds on cells first, then within those that were asked
/// for if the former were in the way. What misses it is raised as far as it goes, and tried once more if that
/// has helped. True when the goal is met.
/// `cells_are_untouched`: nothing else has been worked on, and all cells are if that was not enough.
/// Guarantees: what polish() does; cells that raise nothing are taken back (Trial).
bool reach_goal(const Run& run, const GoalEffort& goal, bool cells_are_untouched);

/// Works for one target after the other up to the goal: with all cells, and vertices where they are missing,
/// where many miss it. Ends with the first target that is missed. `best` is told of what each has left.
void reach_in_turn(const Run& run, const GoalEffort& goal, Best& best);

}  // namespace hfr

#endif
