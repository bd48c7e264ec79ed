// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/PassState.hh"

#include <algorithm>
#include <utility>

#include "HalfFace/Errors.hh"
#include "Quality/Coverage.hh"
#include "Quality/Metrics.hh"
#include "Remesh/DevicePasses.hh"
#include "Remesh/RankPasses.hh"
#include "Remesh/Survey.hh"

namespace hfr {

PassState::PassState(Run run, std::string stage) : run_(run), stage_(std::move(stage)) {
  std::fill(run_.work.pending.begin(), run_.work.pending.end(), 0xff);
  run_.work.all_touched = true;
  count(Focus{});
}

void PassState::look_again() {
  to_host();
  looked_.fill(0);
  std::fill(run_.work.pending.begin(), run_.work.pending.end(), 0xff);
}

Worklist PassState::worklist(PassKind kind, std::uint8_t pending_bit, const Focus& focus) {
  to_host();
  const TetMesh& mesh = run_.mesh;
  Workspace& work = run_.work;
  if (focus.everything()) {
    HFR_ASSERT(pending_bit != 0);
    return Worklist(mesh, run_.policy(), [&](CellHandle c) {
      if (!(work.pending[c.idx()] & pending_bit)) return false;
      work.pending[c.idx()] = static_cast<std::uint8_t>(work.pending[c.idx()] & ~pending_bit);
      return true;
    });
  }
  const std::uint32_t since = std::exchange(looked_[static_cast<std::size_t>(kind)], work.clock);
  return Worklist(mesh, run_.policy(), poor(focus.below), [&](CellHandle c) {
    const auto& v = mesh.cell(c).v;
    return std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return work.changed[u.idx()] > since; }) &&
           (focus.around.empty() || std::any_of(v.begin(), v.end(), [&](VertexHandle u) {
              return u.idx() >= focus.around.size() || focus.around[u.idx()];
            }));
  });
}

Worklist PassState::changed_since(std::uint32_t since, const Focus& focus) {
  const TetMesh& mesh = run_.mesh;
  const auto has_changed = [&](CellHandle c) {
    for (VertexHandle v : mesh.cell(c).v)
      if (run_.work.changed[v.idx()] > since) return true;
    return false;
  };
  if (focus.everything()) return Worklist(mesh, run_.policy(), has_changed);
  return Worklist(mesh, run_.policy(), poor(focus.below), has_changed);
}

bool PassState::checks_links() {
  Findings& findings = run_.findings;
  Checkpoint* const checkpoint = run_.checkpoint;
  const bool can_break_rules = n_invalid_ > 0 || findings.is_folded || !run_.work.pinched.empty();
  if (checkpoint && can_break_rules) checkpoint->distrust();
  if (n_invalid_ > 0) return true;
  if (std::exchange(findings.may_cover_twice, false) && !findings.is_folded) {
    to_host();
    if (n_invalid_ > 0) return true;  // after a device was lost
    findings.is_folded = run_.is_part() ? run_.ranks->covers_twice() : covers_twice(run_.mesh, run_.policy());
    if (checkpoint && !findings.is_folded && run_.work.pinched.empty())
      checkpoint->trust(run_.mesh, run_.control.revision());
  }
  return findings.is_folded;
}

std::size_t PassState::n_below(double value) {
  return ranks_ && ranks_->is_resident() ? ranks_->n_below(value) : poor(value).size();
}

std::span<const Index> PassState::poor(double value) {
  to_host();
  return poor_.below(value, run_.work, run_.policy());
}

void PassState::count(const Focus& focus) {
  if (run_.is_part()) {
    const Ranks::Tally tally = run_.ranks->tally(focus.below);
    count_as(tally.n_invalid, tally.worst);
    return;
  }
  to_host();
  struct Sum {
    std::size_t invalid = 0;
    double worst = std::numeric_limits<double>::infinity();
  };
  const auto& quality = run_.work.quality;
  const auto sum_over = [&](std::size_t n, auto&& cell) {
    return par::reduce(
        run_.policy(), n, Sum{},
        [&](std::size_t i) {
          const double q = quality[cell(i)];
          return Sum{static_cast<std::size_t>(q > 0 ? 0 : 1), q};
        },
        [](Sum a, Sum b) {
          return Sum{a.invalid + b.invalid, std::min(a.worst, b.worst)};
        });
  };
  Sum sum;
  if (!focus.everything() && focus.below > 0) {
    const auto cells = poor(focus.below);
    sum = sum_over(cells.size(), [&](std::size_t i) { return cells[i]; });
  }
  if (!(sum.worst < focus.below)) sum = sum_over(quality.size(), [](std::size_t i) { return i; });
  count_as(sum.invalid, sum.worst);
}

void PassState::count_as(std::size_t n_invalid, double worst) {
  n_invalid_ = n_invalid;
  worst_ = worst;
  if (n_invalid > 0) run_.findings.may_cover_twice = true;
}

void PassState::report(const char* op, const Turn& turn, const RoundCounts& counts, double seconds) {
  if (turn.replayed_rounds) return;
  const bool on_device = device_ && device_->is_resident();
  PassReport pass;
  pass.stage = stage_;
  pass.op = op;
  pass.iteration = turn.iteration;
  pass.rounds = counts.rounds;
  pass.seeds = counts.seeds;
  pass.candidates = counts.candidates;
  pass.winners = counts.winners;
  pass.sub_rounds = counts.sub_rounds;
  pass.n_inverted = n_invalid_;
  pass.worst = worst_;
  pass.seconds = seconds;
  pass.seconds_evaluate = counts.seconds_evaluate;
  pass.seconds_select = counts.seconds_select;
  pass.seconds_commit = counts.seconds_commit;
  pass.on_device = on_device;
  run_.control.add(std::move(pass));
  run_.control.tell(stage_, turn.iteration, n_invalid_,
                    [&] { return on_device ? device_->smallest_dihedral() : run_.smallest_dihedral(); });
}

void PassState::to_host() {
  if (device_) device_->bring_back();
  if (ranks_) ranks_->bring_back();
}

}  // namespace hfr
