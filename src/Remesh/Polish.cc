// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Polish.hh"

#include <algorithm>

#include "Quality/Metrics.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Rise.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

/// At most kNoLimit.
std::size_t more_by(std::size_t n, std::size_t more) { return n + std::min(more, kNoLimit - n); }

}  // namespace

template <class Metric>
bool iterate_below(PassRunner<Metric>& runner, const PolishEffort& effort, double decision, std::size_t few,
                   std::size_t n_held) {
  RunControl& control = runner.run().control;
  std::size_t n_poor = runner.n_below(decision);
  double worst = runner.worst();
  // Those that are held are none of the many that are too many.
  few = more_by(few, n_held);
  const std::size_t many = std::min(few, more_by(effort.many, n_held));
  const auto others = [&](std::size_t n) { return n - std::min(n, n_held); };
  int idle = 0;
  bool has_dug = false;
  std::size_t n_poor_dug = 0;  // when vertices were last inserted
  double worst_dug = 0;
  for (int i = 1; i <= effort.iterations && n_poor > 0 && !control.stopped(); ++i) {
    const Turn turn{i, Focus{decision}, true, effort.seeds_of_vertex, has_dug ? 0 : n_held};
    const std::size_t changes = runner.iterate(turn);
    const std::size_t n_poor_now = runner.n_below(decision);
    const double enough = value_to_rise(worst, effort.gain, decision);
    const std::size_t at_least = n_poor > many ? (n_poor - many) / effort.least_fewer : 0;
    const bool fewer = n_poor_now + at_least < n_poor;
    idle = fewer || runner.worst() > enough ? 0 : idle + 1;
    n_poor = n_poor_now;
    worst = runner.worst();
    if (n_poor == 0 || (changes > 0 && idle < effort.idle)) continue;
    // What helps from here on is tried once; the next idle iteration goes on to what is dearer.
    if (runner.pass(PassKind::kFan, turn) * effort.fan_of > at_least) {
      idle = effort.idle - 1;
      continue;
    }
    // Cells that nothing else mends, such as those between two faces of a frozen corner, get a vertex. Where
    // the last ones have not paid, more of them would only fill the place with poor cells; but they may while
    // one is inverted and has not become much worse.
    const double to_pay =
        worst_dug < 0 ? worst_dug * effort.gain : value_to_rise(worst_dug, effort.gain, decision);
    const bool pays =
        !has_dug || 10 * others(n_poor) <= effort.dig_again_tenths * others(n_poor_dug) || worst > to_pay;
    if (n_poor <= few && pays) {
      has_dug = true;
      n_poor_dug = n_poor;
      worst_dug = worst;
      if (runner.pass(PassKind::kInsert, turn) > 0) {
        idle = effort.idle - 1;
        continue;
      }
    }
    if (n_poor > few || runner.pass(PassKind::kCluster, turn) == 0) break;
    idle = effort.idle - 1;
  }
  runner.to_host();
  return n_poor == 0;
}
template bool iterate_below(PassRunner<MinSine2>&, const PolishEffort&, double, std::size_t, std::size_t);
template bool iterate_below(PassRunner<MinDihedral>&, const PolishEffort&, double, std::size_t, std::size_t);

bool polish(const Run& run, const PolishEffort& effort, double degrees, const PoorOnes& poor) {
  return polish_to(run, effort, dihedral_decision(degrees), poor);
}

bool polish_to(const Run& run, const PolishEffort& effort, double decision, const PoorOnes& poor) {
  const std::size_t few = std::max(effort.few_to_dig, run.n_cells() / effort.dig_share);
  std::size_t n_held = 0;
  {
    PassRunner<MinSine2> runner(run, MinSine2{}, "polish", effort.selection);
    const std::size_t n_poor = runner.n_below(decision);
    if (n_poor > 0 && decision > 0)
      n_held = std::min(n_poor, n_out_of(run, report_value(Metric::kMinDihedral, decision), poor.vain_below));
    if (static_cast<double>(n_poor - n_held) > poor.largest_share * static_cast<double>(run.n_cells()))
      return false;
    if (iterate_below(runner, effort, decision, few, n_held)) return true;
  }
  // What is left may be obtuse only, or give way once obtuse angles do not count.
  PassRunner<MinDihedral> runner(run, MinDihedral{}, "finish", effort.selection);
  return iterate_below(runner, effort, decision, few, n_held);
}

}  // namespace hfr
