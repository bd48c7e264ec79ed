// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/RankPasses.hh"

#include <exception>
#include <utility>

#include "HalfFace/Errors.hh"

namespace hfr {

RankPasses::RankPasses(PassState& state, const RankMetric& metric) : state_(state), metric_(metric) {
  state_.ranks_ = this;
  is_resident_ = state_.run_.is_part();
}

RankPasses::~RankPasses() {
  HFR_ASSERT(!is_resident_ || state_.run_.is_part() || std::uncaught_exceptions() > 0);
}

bool RankPasses::takes(PassKind kind, const Turn& turn) {
  // Counts decide, never a clock: the same passes run there each time.
  const Run& run = state_.run_;
  if (!run.ranks || !run.ranks->can_do(kind, metric_)) return false;
  if ((run.surface && !run.is_part()) || turn.focus.everything() || !turn.focus.around.empty()) return false;
  if ((checks_links(kind) && !run.is_part()) || run.strategy.pass.ranks_exactly) return false;
  if (kind == PassKind::kSmooth && run.strategy.pass.smoother != Smoother::kNewton) return false;
  if (is_resident_) return true;
  return state_.n_below(turn.focus.below) >= run.ranks->least_cells(run.mesh.n_logical_cells()) &&
         run.ranks->can_take(run.mesh, run.work);
}

/// What cells cover is looked into where shared memory does so: before they are connected anew.
bool RankPasses::checks_links(PassKind kind) {
  if (kind != PassKind::kSmooth) return state_.checks_links();
  return state_.n_invalid() > 0 || state_.run_.findings.is_folded;
}

void RankPasses::renew(Ranks::Look& look, const Turn& turn) {
  const Run& run = state_.run_;
  look.since = std::exchange(state_.looked_[static_cast<std::size_t>(look.kind)], run.work.clock);
  look.may_lose = run.bounds.may_lose(run.ranks->n_cells());
  look.may_gain = run.bounds.may_gain(run.ranks->n_cells());
  look.check_links = checks_links(look.kind);
  look.is_marked = turn.focus.is_marked;
}

void RankPasses::count(const Turn& turn) {
  const Ranks::Tally tally = state_.run_.ranks->tally(turn.focus.below);
  state_.count_as(tally.n_invalid, tally.worst);
}

std::optional<std::size_t> RankPasses::run(PassKind kind, const char* name, const Turn& turn) {
  Run& run = state_.run_;
  if (!takes(kind, turn)) {
    if (run.is_part()) throw InternalError("a pass of a run that meshes in parts do not have");
    bring_back();
    return std::nullopt;
  }
  const double start = run.control.seconds();
  if (kind == PassKind::kSmooth && run.control.stopped()) return 0;
  if (!is_resident_) run.ranks->take(run.mesh, run.work);
  is_resident_ = true;
  const PassEffort& effort = run.strategy.pass;
  Ranks::Look look{kind, metric_, turn.focus.below, 0, effort.seed, 0, 0, run.policy().threads};
  // As edge_pass() of PassRunner.
  if (effort.first_edge_does && metric_.metric != Metric::kVolumeLength)
    look.first_edge_beyond = effort.few_seeds;
  look.ops = turn.removes_vertices ? effort.ops : without(effort.ops, Ops::kNode);
  RoundCounts total;
  std::size_t first = 0;
  const int most = kind == PassKind::kSmooth ? 1 : effort.rounds;
  for (int r = 0; r < most && (kind == PassKind::kSmooth || !run.control.stopped()); ++r) {
    renew(look, turn);
    const RoundCounts counts =
        kind == PassKind::kCluster
            ? run.ranks->search({look, effort.least_gain, effort.search_points, effort.search_nodes})
            : run.ranks->pass(look);
    if (counts.rounds == 0) break;
    if (!run.is_part()) ++run.work.clock;  // the round has, of its own workspace
    if (counts.held_back > 0) run.findings.note_cell_bound(run.bounds);
    total += counts;
    if (state_.n_invalid() > 0) count(turn);
    if (r == 0) first = counts.winners;
    if (counts.winners * effort.little <= first) break;
  }
  count(turn);
  state_.report(name, turn, total, run.control.seconds() - start);
  return total.winners;
}

std::size_t RankPasses::insert(const char* name, const Turn& turn, double gain) {
  Run& run = state_.run_;
  if (!takes(PassKind::kInsert, turn))
    throw InternalError("a pass of a run that meshes in parts do not have");
  if (!run.has_room()) {
    run.findings.note_cell_bound(run.bounds);
    return 0;
  }
  const double start = run.control.seconds();
  const PassEffort& effort = run.strategy.pass;
  Ranks::Dig dig{{PassKind::kInsert, metric_, turn.focus.below, 0, effort.seed, 0, 0, run.policy().threads},
                 gain,
                 run.may_add_poor_cells,
                 effort.few_seeds,
                 effort.sites_of_many,
                 effort.promise_of_many,
                 effort.leaves_early};
  RoundCounts total;
  std::size_t first = 0;
  for (int r = 0; r < effort.insert_rounds && !run.control.stopped(); ++r) {
    renew(dig.look, turn);
    const RoundCounts counts = run.ranks->dig(dig, waiting_);
    if (counts.rounds == 0) break;
    if (counts.held_back > 0) run.findings.note_cell_bound(run.bounds);
    total += counts;
    if (state_.n_invalid() > 0) count(turn);
    if (r == 0) first = counts.winners;
    if (counts.winners < counts.held_back) break;  // the room is used up
    if (turn.is_vain(counts, effort.few_seeds, r == 0)) break;
    if (counts.winners * effort.little <= first && waiting_.empty()) break;
  }
  count(turn);
  state_.report(name, turn, total, run.control.seconds() - start);
  return total.winners;
}

void RankPasses::bring_back() {
  Run& run = state_.run_;
  if (run.is_part() || !std::exchange(is_resident_, false)) return;
  const double start = run.control.seconds();
  run.ranks->bring_back(run.mesh, run.work);
  PassReport pass;
  pass.stage = state_.stage_;
  pass.op = "gather";
  pass.n_inverted = state_.n_invalid_;
  pass.worst = state_.worst_;
  pass.seconds = run.control.seconds() - start;
  run.control.add(std::move(pass));
}

}  // namespace hfr
