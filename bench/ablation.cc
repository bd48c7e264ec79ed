// SPDX-License-Identifier: BSD-3-Clause
// Runs of improve() with one number of the strategy multiplied, or one stage left out; bench/ablation.py
// makes tables of them.
// Usage: bench_ablation --list
//        bench_ablation FILE [--set ROW FACTOR ...] [--goal DEGREES] [--mode MODE] [--seed N]
// --list prints each row and what it can be multiplied by. A run prints a line of JSON: degrees, the number
// of cells and CPU seconds on one thread.
//
// The strategy is the library's: this file is compiled with a resolve() of its own, which calls that of
// Strategy.cc and then multiplies; the linker takes it in the place of the library's.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#define resolve resolve_as_it_is
#define strategy_of_patch strategy_of_patch_as_it_is
#include "Remesh/Strategy.cc"  // NOLINT(bugprone-suspicious-include)
#undef resolve
#undef strategy_of_patch

#include "HalfFace/TetMesh.hh"
#include "IO/Assemble.hh"
#include "IO/MeshFile.hh"
#include "Remesh/Improve.hh"

namespace hfr {
namespace {

/// Calls f for each effort of a strategy that it takes.
template <class F>
void for_each(Strategy& s, F&& f) {
  const auto call = [&](auto& effort) {
    if constexpr (std::invocable<F&, decltype(effort)>) f(effort);
  };
  const auto call_if = [&](auto& effort) {
    if (effort) call(*effort);
  };
  call(s);
  call(s.pass);
  call_if(s.untangle);
  call(s.first_polish);
  call(s.first_polish.polish);
  call_if(s.coarsen);
  call(s.bulk);
  call(s.polish);
  call(s.throughout);
  call(s.throughout.polish);
  call_if(s.throughout.refine);
  call(s.targets);
  call_if(s.refine);
  call_if(s.refine_again);
  call_if(s.neighbourhoods);
  call(s.patch);
  call(s.last_cells);
  for (PatchEffort& effort : s.last_cells.patches_first) call(effort);
  for (PatchEffort& effort : s.last_cells.patches) call(effort);
  call_if(s.goal);
  if (s.any_cost) {
    call(*s.any_cost);
    call(s.any_cost->polish);
    for (PatchEffort& effort : s.any_cost->patches) call(effort);
    call_if(s.any_cost->refine);
    call_if(s.any_cost->refine_again);
  }
}

/// How a number is multiplied.
enum class Kind {
  kPlain,
  kAboveOne,  ///< a factor of gain: what it has beyond 1
  kBelowOne,  ///< a share that may be left: what it lacks of 1
};

double scaled(double value, double factor, Kind kind) {
  if (!std::isfinite(value)) return value;
  switch (kind) {
    case Kind::kPlain:
      return value * factor;
    case Kind::kAboveOne:
      return 1 + (value - 1) * factor;
    case Kind::kBelowOne:
      return 1 - (1 - value) * factor;
  }
  return value;
}

template <std::integral T>
T scaled(T value, double factor, Kind) {
  if (value == std::numeric_limits<T>::max()) return value;
  return static_cast<T>(std::lround(static_cast<double>(value) * factor));
}

template <class T, std::size_t N>
std::array<T, N> scaled(std::array<T, N> values, double factor, Kind kind) {
  for (T& value : values) value = scaled(value, factor, kind);
  return values;
}

using Change = std::function<void(Strategy&, double factor)>;

struct Row {
  std::string name;
  Change change;
  std::vector<double> factors;
};

const std::vector<double> kBothWays = {0.5, 2};
/// For numbers of which none is a setting of its own.
const std::vector<double> kOffToo = {0, 0.5, 2};

template <class Effort, class T>
Row number(std::string name, T Effort::*member, std::vector<double> factors = kBothWays,
           Kind kind = Kind::kPlain) {
  return {std::move(name),
          [=](Strategy& s, double factor) {
            for_each(s, [&](Effort& effort) { effort.*member = scaled(effort.*member, factor, kind); });
          },
          std::move(factors)};
}

/// One number that several efforts go by.
Row common(const std::string& name, const std::vector<Row>& members) {
  return {"common." + name,
          [=](Strategy& s, double factor) {
            for (const Row& row : members) row.change(s, factor);
          },
          members.front().factors};
}

/// A stage that is left out.
Row stage(std::string name, std::function<void(Strategy&)> leave_out) {
  return {std::move(name), [=](Strategy& s, double) { leave_out(s); }, {0}};
}

/// Every second target is left out, from the first on; the last one stays.
void halve(std::vector<TargetAngle>& targets) {
  std::vector<TargetAngle> left;
  for (std::size_t i = 0; i < targets.size(); ++i)
    if ((targets.size() - 1 - i) % 2 == 0) left.push_back(targets[i]);
  targets = left;
}

/// The share of the bound on cells that is kept back for the last ones, and that of the poor cells which have
/// to get a vertex for the next round of them: a few.
void keep_back(Strategy& s, double factor) {
  s.throughout.of_hundred = scaled(std::size_t{100}, 1 - factor * kFewShare, Kind::kPlain);
  for_each(s, [&](RefineEffort& refine) {
    if (refine.of_hundred == kAllButFew) refine.of_hundred = s.throughout.of_hundred;
    refine.one_in = factor > 0 ? scaled(refine.one_in, 1 / factor, Kind::kPlain) : std::size_t{1} << 30;
  });
}

std::vector<Row> make_rows() {
  using P = PassEffort;
  using U = UntangleEffort;
  using O = PolishEffort;
  using T = TargetEffort;
  using R = RefineEffort;
  using H = ThroughoutEffort;
  using N = NeighbourhoodEffort;
  using A = PatchEffort;
  using L = PatchTrial;
  using C = LastCellsEffort;
  using G = GoalEffort;
  using Y = AnyCostEffort;
  constexpr Kind kAbove = Kind::kAboveOne;
  constexpr Kind kBelow = Kind::kBelowOne;
  return {
      common("poor", {number("", &FirstPolish::target), number("", &H::below)}),
      common("good", {number("", &R::below, {0.67, 1.33}), number("", &C::up_to)}),
      common("few", {number("", &H::dig_share, kOffToo),
                     number("", &R::fewer, {}, kBelow),
                     {"", [](Strategy& s, double factor) { keep_back(s, factor); }, {}},
                     number("", &CoarsenEffort::still, {}, kBelow),
                     number("", &Y::may_fall)}),
      common("many", {number("", &FirstPolish::largest_share, kOffToo),
                      number("", &H::share),
                      {"",
                       [](Strategy& s, double factor) {
                         for (auto* list : {&s.targets.targets, &s.targets.beyond})
                           for (TargetAngle& target : *list) target.largest_share *= factor;
                       },
                       {}}}),
      common("few_cells", {number("", &P::few_seeds, kOffToo), number("", &A::few)}),
      common("rise", {number("", &L::rise, {0, 10}, kAbove), number("", &C::again, {}, kAbove),
                      number("", &C::rise, {}, kAbove), number("", &Y::gain, {}, kAbove)}),
      common("large_rise", {number("", &P::least_gain, kOffToo, kAbove), number("", &Y::again, {}, kAbove)}),
      common("more_cells", {number("", &G::more_cells, kBothWays, kAbove), number("", &Y::most_of_hundred)}),
      common("claim", {number("", &G::may_fall, kOffToo), number("", &G::pays)}),
      common("iterations",
             {number("", &O::iterations), number("", &R::iterations), number("", &U::iterations),
              number("", &CoarsenEffort::iterations), number("", &A::turns)}),
      common("idle", {number("", &O::idle), number("", &U::idle)}),
      number("pass.rounds", &P::rounds),
      number("pass.little", &P::little),
      number("pass.insert_rounds", &P::insert_rounds),
      number("pass.cells_of_vertex", &P::cells_of_vertex),
      number("pass.search_points", &P::search_points, {0.7, 1.3}),
      number("pass.search_nodes", &P::search_nodes),
      number("pass.sites_of_many", &P::sites_of_many),
      number("pass.promise_of_many", &P::promise_of_many, kOffToo),
      number("pass.many_moves", &P::many_moves, kOffToo),
      number("pass.many_moves_share", &P::many_moves_share),
      number("pass.move_gain", &P::move_gain, kOffToo, kAbove),
      number("untangle.first_sweeps", &U::first_sweeps),
      number("untangle.patience", &U::patience),
      number("untangle.still", &U::still),
      number("untangle.newton_steps", &U::newton_steps),
      number("bulk.iterations", &BulkEffort::iterations, {0, 1.0 / 3, 2}),
      number("bulk.focus", &BulkEffort::focus),
      number("polish.gain", &O::gain, kOffToo, kAbove),
      number("polish.many", &O::many),
      number("polish.least_fewer", &O::least_fewer),
      number("polish.fan_of", &O::fan_of),
      number("polish.few_to_dig", &O::few_to_dig, kOffToo),
      number("polish.dig_share", &O::dig_share),
      number("polish.seeds_of_vertex", &O::seeds_of_vertex),
      number("polish.dig_again_tenths", &O::dig_again_tenths, {0.8, 1.1}),
      {"targets.list",
       [](Strategy& s, double) {
         halve(s.targets.targets);
         halve(s.targets.beyond);
       },
       {0.5}},
      number("targets.in_turn_beyond", &T::in_turn_beyond, {0.5, 2}),
      number("targets.enough_left", &T::enough_left),
      stage("refine", [](Strategy& s) { s.refine.reset(); }),
      stage("refine_again", [](Strategy& s) { s.refine_again.reset(); }),
      number("refine.least_share", &R::least_share, kOffToo),
      number("refine.largest_share", &R::largest_share, {0.5, 1.6}),
      number("refine.gain", &R::gain, kBothWays, kAbove),
      number("refine.of_hundred", &R::of_hundred, {0.95, 1.02}),
      stage("throughout", [](Strategy& s) { s.throughout.share = 2; }),
      stage("throughout.refine", [](Strategy& s) { s.throughout.refine.reset(); }),
      stage("neighbourhoods", [](Strategy& s) { s.neighbourhoods.reset(); }),
      number("neighbourhoods.few", &N::few),
      number("neighbourhoods.iterations", &N::iterations),
      {"neighbourhoods.degrees",
       [](Strategy& s, double factor) {
         if (!s.neighbourhoods) return;
         for (auto& attempt : s.neighbourhoods->tries) attempt.degrees *= factor;
       },
       kBothWays},
      {"neighbourhoods.layers",
       [](Strategy& s, double factor) {
         if (!s.neighbourhoods) return;
         for (auto& attempt : s.neighbourhoods->tries)
           attempt.layers = static_cast<int>(std::lround(attempt.layers * factor));
       },
       {0.5, 1.5}},
      stage("patches", [](Strategy& s) { s.patch.enabled = false; }),
      stage("patches.last",
            [](Strategy& s) {
              if (s.last_cells.patches.size() > 1) s.last_cells.patches.resize(1);
            }),
      number("patches.layers", &A::layers, {0.67, 1.33}),
      number("patches.patches", &A::patches),
      number("patches.rows", &A::rows, {0, 0.5}),
      number("patches.vertices", &A::vertices, kOffToo),
      number("patches.removals", &A::removals, kOffToo),
      number("patches.degrees", &A::degrees, kOffToo),
      number("trial.ahead", &L::ahead, kOffToo, kAbove),
      number("trial.iterations", &L::iterations),
      number("trial.row_shares", &L::row_shares, {0.7, 1.3}),
      number("trial.row_height", &L::row_height, {0.7, 1.25}),
      number("trial.slender", &L::slender, kOffToo),
      stage("claimed",
            [](Strategy& s) {
              s.claimed.reset();
              s.towards_claim.reset();
              s.frozen.reset();  // which goes on below what is claimed
            }),
      stage("towards_claim", [](Strategy& s) { s.towards_claim.reset(); }),
      number("goal.many_miss", &G::many_miss, kOffToo),
      number("goal.few_miss", &G::few_miss, kOffToo),
      stage("goal.goes_on",
            [](Strategy& s) {
              if (s.goal) s.goal->goes_on = false;
            }),
      number("goal.turns", &G::turns, {0.33, 2}),
      number("any_cost.missed", &Y::missed),
      number("any_cost.fewer", &Y::fewer, {0.5, 2}, kBelow),
  };
}

const std::vector<Row>& rows() {
  static const std::vector<Row> all = make_rows();
  return all;
}

/// What this run changes, and by how much; for all strategies that come up in it.
std::vector<std::pair<const Row*, double>> changes;

std::shared_ptr<const Strategy> changed(const std::shared_ptr<const Strategy>& strategy);

Strategy changed(Strategy strategy) {
  for (const auto& [row, factor] : changes) row->change(strategy, factor);
  strategy.plain = changed(strategy.plain);
  strategy.usual = changed(strategy.usual);
  strategy.claimed = changed(strategy.claimed);
  strategy.towards_claim = changed(strategy.towards_claim);
  strategy.frozen = changed(strategy.frozen);
  strategy.flat = changed(strategy.flat);
  strategy.without_goal = changed(strategy.without_goal);
  return strategy;
}

std::shared_ptr<const Strategy> changed(const std::shared_ptr<const Strategy>& strategy) {
  return strategy ? std::make_shared<const Strategy>(changed(*strategy)) : nullptr;
}

}  // namespace

Strategy resolve(const ImproveOptions& options, const Survey& found, std::size_t n_cells) {
  return changed(resolve_as_it_is(options, found, n_cells));
}

/// Numbers that a patch has from the whole are changed there already; the others are its own.
Strategy strategy_of_patch(const Strategy& whole) {
  const Strategy patch = strategy_of_patch_as_it_is(whole);
  Strategy own = changed(patch);
  own.polish.iterations = patch.polish.iterations;
  own.patch = patch.patch;
  return own;
}

}  // namespace hfr

namespace {

double cpu_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

int list_rows() {
  for (const hfr::Row& row : hfr::rows()) {
    std::printf("%s", row.name.c_str());
    for (double factor : row.factors) std::printf(" %g", factor);
    std::printf("\n");
  }
  return 0;
}

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "bench_ablation: %s\n", what.c_str());
  std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--list") return list_rows();
  if (argc < 2)
    fail("usage: bench_ablation FILE [--set ROW FACTOR ...] [--goal DEGREES] [--mode MODE] [--seed N]");
  hfr::ImproveOptions options;
  options.policy.threads = 1;
  for (int i = 2; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    const std::string value = argv[i + 1];
    if (name == "--goal") {
      options.min_dihedral = std::stod(value);
    } else if (name == "--mode") {
      options.surface.mode = value == "flat"   ? hfr::SurfaceMode::kFlat
                             : value == "free" ? hfr::SurfaceMode::kFree
                                               : hfr::SurfaceMode::kFrozen;
      options.raise_min_dihedral = value == "max";
    } else if (name == "--seed") {
      options.seed = std::stoull(value);
    } else if (name == "--set" && i + 2 < argc) {
      const auto row = std::ranges::find(hfr::rows(), value, &hfr::Row::name);
      if (row == hfr::rows().end()) fail("there is no row " + value);
      hfr::changes.emplace_back(&*row, std::stod(argv[i + 2]));
      ++i;
    } else {
      fail("unknown option " + name);
    }
  }
  hfr::TetMesh mesh = hfr::io::assemble(hfr::io::read_mesh(argv[1]));
  const double start = cpu_seconds();
  const hfr::Result result = hfr::improve(mesh, options);
  const double seconds = cpu_seconds() - start;
  const hfr::Distribution& angles = result.after.min_dihedral;
  std::printf(
      "{\"min\": %.9g, \"p1\": %.6g, \"p5\": %.6g, \"cells\": %zu, \"inverted\": %zu, \"seconds\": %.4g}\n",
      angles.min, angles.percentiles[1], angles.percentiles[2], mesh.n_cells(), result.after.inverted.size(),
      seconds);
}
