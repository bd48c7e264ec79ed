// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/SurfacePasses.hh"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>

#include "HalfFace/Errors.hh"
#include "Operators/Metrics.hh"
#include "Quality/Coverage.hh"
#include "Quality/FoldedFaces.hh"
#include "Remesh/PassState.hh"
#include "Remesh/SurfaceSeeds.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/SmoothPass.hh"
#include "Surface/InterfaceSwap.hh"
#include "Surface/PeriodicSmooth.hh"
#include "Surface/SurfaceCollapse.hh"
#include "Surface/SurfaceMesh.hh"
#include "Surface/SurfaceSmooth.hh"
#include "Surface/SurfaceSplit.hh"
#include "Surface/SurfaceSwap.hh"

namespace hfr {
namespace {

/// Takes the vertices that periodic patches bind out of the list; returns the first vertex of each orbit.
std::vector<VertexHandle> take_bound(const SurfaceMesh& surface, std::vector<VertexHandle>& vertices) {
  std::vector<VertexHandle> first;
  std::erase_if(vertices, [&](VertexHandle v) {
    const auto orbit = surface.orbit(v);
    if (!orbit.empty()) first.push_back(orbit[0]);
    return !orbit.empty();
  });
  std::sort(first.begin(), first.end());
  first.erase(std::unique(first.begin(), first.end()), first.end());
  return first;
}

}  // namespace

template <class Metric>
template <class Allow>
std::vector<EdgeHandle> SurfacePasses<Metric>::edges(const Worklist& list, bool inside, Allow&& allow) const {
  const Run& run = state_.run();
  return surface_edges(run.mesh, run.work, list, inside, allow, [](CellHandle) { return true; });
}

template <class Metric>
Ranks::SurfaceLook SurfacePasses<Metric>::look_of(SurfacePass pass, const Turn& turn,
                                                  std::uint32_t since) const {
  const Run& run = state_.run();
  const PassEffort& effort = run.strategy.pass;
  Ranks::SurfaceLook look;
  look.pass = pass;
  if constexpr (std::is_same_v<Metric, CustomMetric>)
    throw InternalError("meshes in parts do not have this metric");
  else
    look.look.metric = rank_metric(metric_);
  look.look.below = turn.focus.below;
  look.look.since = since;
  look.look.seed = effort.seed;
  look.look.may_gain = run.bounds.may_gain(run.n_cells());
  look.look.threads = run.policy().threads;
  look.gain_of_many = effort.move_gain;
  look.many = effort.many_moves;
  look.many_share = effort.many_moves_share;
  look.worst = state_.worst();
  return look;
}

template <class Metric>
std::size_t SurfacePasses<Metric>::look_in_parts(Looked kind, const Turn& turn) {
  struct Step {
    SurfacePass pass;
    const char* name;
  };
  const Run& run = state_.run();
  const std::uint32_t since = std::exchange(looked_[kind], run.work.clock);
  std::vector<Step> steps;
  if (kind == kSwaps) steps.push_back({SurfacePass::kSwap, "surface swap"});
  if (kind == kSwaps && run.surface->has_interfaces())
    steps.push_back({SurfacePass::kInterfaceSwap, "surface interface"});
  if (kind == kCollapses) steps.push_back({SurfacePass::kCollapse, "surface node"});
  if (kind == kMoves) steps.push_back({SurfacePass::kMove, "surface smooth"});
  std::size_t changes = 0;
  for (const Step& step : steps) {
    const double start = run.control.seconds();
    const auto counts = run.ranks->surface_pass(*run.surface, look_of(step.pass, turn, since));
    if (!counts) break;
    state_.report(step.name, turn, *counts, run.control.seconds() - start);
    changes += counts->winners;
  }
  return changes;
}

template <class Metric>
std::size_t SurfacePasses<Metric>::split_in_parts(const Turn& turn) {
  const Run& run = state_.run();
  const double start = run.control.seconds();
  const std::uint32_t since = std::exchange(looked_[kSplits], run.work.clock);
  const RoundCounts counts = run.ranks->surface_pass(*run.surface, look_of(SurfacePass::kSplit, turn, since))
                                 .value_or(RoundCounts{});
  if (counts.held_back > 0) run.findings.note_cell_bound(run.bounds);
  state_.count(turn.focus);
  if (counts.winners > 0) look_for_folds(looked_[kSplits]);
  state_.report("surface split", turn, counts, run.control.seconds() - start);
  return counts.winners;
}

template <class Metric>
std::size_t SurfacePasses<Metric>::split(const Turn& turn) {
  using Op = SurfaceSplit<Metric>;
  if (state_.run().is_part()) return split_in_parts(turn);
  const Run& run = state_.run();
  SurfaceMesh& surface = *run.surface;
  const double start = run.control.seconds();
  const std::uint32_t since = looked_[kSplits];
  looked_[kSplits] = run.work.clock;
  std::vector<typename Op::Seed> seeds;
  for (EdgeHandle e : edges(state_.changed_since(since, turn.focus), /*inside=*/false,
                            [&](VertexHandle a, VertexHandle b) { return surface.may_split(a, b); }))
    seeds.push_back(typename Op::Seed(e));
  RoundCounts counts;
  if (!seeds.empty()) {
    RoundOptions round_options{run.policy(), /*check_links=*/true, run.strategy.pass.seed};
    round_options.may_gain = run.bounds.may_gain(run.mesh.n_logical_cells());
    Round<Op> round(run.mesh, run.work, round_options);
    const Op op{metric_, run.work.quality, &surface};
    // The ends of the edges are asked for before the cells that name them are gone.
    std::map<Index, std::array<VertexHandle, 2>> ends;
    for (const auto& seed : seeds) ends[seed.edge.idx()] = run.mesh.edge_vertices(seed.edge);
    counts = round.run(op, seeds);
    if (counts.held_back > 0) run.findings.note_cell_bound(run.bounds);
    round.for_committed([&](const auto& plan, VertexHandle middle) {
      const auto [a, b] = ends.at(plan.seed.edge.idx());
      surface.on_split(a, b, middle, plan.place);
      run.work.frozen[middle.idx()] = 1;  // for what works inside
    });
    surface.write_labels(run.mesh);
  }
  state_.count(turn.focus);
  if (counts.winners > 0) look_for_folds(looked_[kSplits]);
  state_.report("surface split", turn, counts, run.control.seconds() - start);
  return counts.winners;
}

template <class Metric>
template <class Op>
std::size_t SurfacePasses<Metric>::swaps(const char* name, bool inside, const Turn& turn,
                                         const Worklist& list) {
  const Run& run = state_.run();
  SurfaceMesh& surface = *run.surface;
  const double start = run.control.seconds();
  const std::vector<EdgeHandle> seeds =
      edges(list, inside, [&](VertexHandle a, VertexHandle b) { return surface.may_swap(a, b); });
  RoundCounts counts;
  if (!seeds.empty()) {
    Round<Op> round(run.mesh, run.work, {run.policy(), /*check_links=*/true, run.strategy.pass.seed});
    counts = round.run(Op{metric_, run.work.quality, &surface}, seeds);
    round.for_committed([&](const auto& plan, VertexHandle) { surface.on_swap(plan.edge[0], plan.edge[1]); });
    surface.write_labels(run.mesh);
  }
  state_.report(name, turn, counts, run.control.seconds() - start);
  return counts.winners;
}

template <class Metric>
std::size_t SurfacePasses<Metric>::swaps(const Turn& turn, const Worklist& list) {
  const Run& run = state_.run();
  const std::size_t n_listed = run.mesh.n_cells();
  std::size_t changes = swaps<SurfaceSwap<Metric>>("surface swap", /*inside=*/false, turn, list);
  if (!run.surface->has_interfaces()) return changes;
  // There are cells now that the list does not know.
  const Worklist left(run.mesh, run.policy(),
                      [&](CellHandle c) { return c.idx() < n_listed && list.has(c); });
  changes += swaps<InterfaceSwap<Metric>>("surface interface", /*inside=*/true, turn, left);
  return changes;
}

template <class Metric>
std::size_t SurfacePasses<Metric>::collapses(const Turn& turn, const Worklist& list) {
  using Op = SurfaceCollapse<Metric>;
  const Run& run = state_.run();
  SurfaceMesh& surface = *run.surface;
  const double start = run.control.seconds();
  const std::vector<VertexHandle> all = free_surface_vertices(run.mesh, surface, run.work, list);
  std::vector<VertexHandle> targets;
  const Op op{metric_, run.work.quality, &surface, {}};
  std::vector<VertexHandle> vertices;
  const par::Policy by_cost = run.policy().for_items_of(kMayGainNanoseconds);
  for (std::size_t i : par::compact<std::size_t>(
           by_cost, all.size(), [&](std::size_t k) { return op.may_gain(run.mesh, all[k]); }))
    vertices.push_back(all[i]);
  drop_pinched(run.mesh, run.work, vertices);
  std::vector<typename Op::Seed> seeds;
  for (VertexHandle v : vertices) {
    const auto first = static_cast<std::uint32_t>(targets.size());
    surface.collapse_targets(v, targets);
    const auto n = static_cast<std::uint32_t>(targets.size()) - first;
    if (n > 0) seeds.push_back({v, first, n});
  }
  RoundCounts counts;
  const auto has_target = [&](VertexHandle v) {
    std::vector<VertexHandle> only = {v};
    drop_pinched(run.mesh, run.work, only);
    if (!only.empty()) surface.collapse_targets(v, targets);
    return !targets.empty();
  };
  // A round in which none of the legal collapses gains counts, too: the clock salts the ranks of later ones.
  if (!seeds.empty() || std::any_of(all.begin(), all.end(), has_target)) {
    Round<Op> round(run.mesh, run.work, {run.policy(), /*check_links=*/true, run.strategy.pass.seed});
    counts = round.run(Op{metric_, run.work.quality, &surface, targets}, seeds);
    round.for_committed(
        [&](const auto& plan, VertexHandle) { surface.on_collapse(plan.seed.vertex, plan.onto); });
    surface.write_labels(run.mesh);
  }
  state_.report("surface node", turn, counts, run.control.seconds() - start);
  return counts.winners;
}

template <class Metric>
std::size_t SurfacePasses<Metric>::moves(const Turn& turn, const Worklist& list) {
  const Run& run = state_.run();
  SurfaceMesh& surface = *run.surface;
  const double start = run.control.seconds();
  std::vector<VertexHandle> vertices = free_surface_vertices(run.mesh, surface, run.work, list);
  const std::vector<VertexHandle> bound = take_bound(surface, vertices);
  RoundCounts counts;
  if (!bound.empty()) counts = periodic_moves(bound);
  if (!vertices.empty()) {
    SurfaceSearch search{&surface};
    const PassEffort& effort = run.strategy.pass;
    const bool many =
        vertices.size() > std::min(effort.many_moves, run.mesh.n_vertices() / effort.many_moves_share);
    // By the surface's own mode: one that may move by nothing is flat.
    if (many && surface.options().mode == SurfaceMode::kFree) search.gain = effort.move_gain;
    counts += hfr::smooth_pass(run.mesh, run.work, search, metric_, vertices, run.policy());
    surface.on_move(run.mesh, vertices);
  }
  state_.report("surface smooth", turn, counts, run.control.seconds() - start);
  return counts.winners;
}

template <class Metric>
RoundCounts SurfacePasses<Metric>::periodic_moves(std::span<const VertexHandle> first_of_orbits) {
  const Run& run = state_.run();
  SurfaceMesh& surface = *run.surface;
  RoundCounts counts;
  counts.rounds = 1;
  ++run.work.clock;
  Star star;
  for (VertexHandle first : first_of_orbits) {
    const auto orbit = surface.orbit(first);
    ++counts.seeds;
    const auto is_partly_known = [&](VertexHandle v) {
      return !run.work.pinched.empty() && run.work.pinched[v.idx()];
    };
    if (std::any_of(orbit.begin(), orbit.end(), is_partly_known)) continue;
    const auto plan =
        PeriodicSmooth<Metric>{metric_, run.work.quality, &surface, run.work.floor}.evaluate(run.mesh, orbit);
    if (!plan) continue;
    ++counts.candidates;
    ++counts.winners;
    std::vector<CellHandle> cells;
    for (std::size_t i = 0; i < orbit.size(); ++i) {
      run.mesh.set_point(orbit[i], plan->targets[i]);
      run.mesh.gather_star(orbit[i], star);
      cells.insert(cells.end(), star.cells.begin(), star.cells.begin() + star.size);
    }
    for (CellHandle c : cells) {
      const auto& v = run.mesh.cell(c).v;
      run.work.quality[c.idx()] =
          metric_(run.mesh.point(v[0]), run.mesh.point(v[1]), run.mesh.point(v[2]), run.mesh.point(v[3]));
      run.work.pending[c.idx()] = 0xff;
      for (VertexHandle u : v) run.work.changed[u.idx()] = run.work.clock;
    }
    if (!run.work.all_touched) run.work.touch(cells);
    surface.on_move(run.mesh, orbit);
  }
  return counts;
}

template <class Metric>
std::size_t SurfacePasses<Metric>::iterate(const Turn& turn) {
  const Run& run = state_.run();
  const Ops ops = run.strategy.pass.ops;
  const std::uint32_t since = run.work.clock;
  std::size_t changes = 0;
  const auto look = [&](Looked kind, auto&& pass) {
    if (run.control.stopped()) return;
    if (run.is_part()) {
      changes += look_in_parts(kind, turn);
      if (state_.n_invalid() > 0) state_.count(turn.focus);
      return;
    }
    const Worklist list = state_.changed_since(std::exchange(looked_[kind], run.work.clock), turn.focus);
    if (!list.cells().empty()) changes += pass(list);
    if (state_.n_invalid() > 0) state_.count(turn.focus);
  };
  if (has(ops, Ops::kEdge)) look(kSwaps, [&](const Worklist& list) { return swaps(turn, list); });
  if (turn.removes_vertices && has(ops, Ops::kNode))
    look(kCollapses, [&](const Worklist& list) { return collapses(turn, list); });
  if (has(ops, Ops::kSmooth)) look(kMoves, [&](const Worklist& list) { return moves(turn, list); });
  if (changes > 0) look_for_folds(since);
  state_.count(turn.focus);
  return changes;
}

template <class Metric>
void SurfacePasses<Metric>::look_for_folds(std::uint32_t since) {
  const Run& run = state_.run();
  if (run.findings.is_folded) return;
  // Before all cells are positive they are not wound, and looked at once they are.
  const bool are_positive = state_.n_invalid() == 0;
  if (run.is_part()) {
    run.findings.is_folded = run.ranks->is_folded_since(since, are_positive);
    return;
  }
  const auto has_changed = [&](std::size_t v) {
    return run.work.frozen[v] && run.work.changed[v] > since && !run.mesh.is_deleted(VertexHandle(v));
  };
  const auto changed = par::compact<VertexHandle>(run.policy(), run.mesh.n_vertices(), has_changed);
  run.findings.is_folded = is_folded_at(run.mesh, changed, run.policy()) ||
                           (are_positive && is_wound_at(run.mesh, changed, run.policy()));
  // Of a pinched vertex a walk sees a part alone, and the parts may go through each other.
  const std::vector<std::uint8_t>& pinched = run.work.pinched;
  const auto is_pinched = [&](VertexHandle v) { return !pinched.empty() && pinched[v.idx()] != 0; };
  const auto has_changed_pinched = [&](VertexHandle v) { return is_pinched(v) && has_changed(v.idx()); };
  if (!run.findings.is_folded && std::any_of(changed.begin(), changed.end(), is_pinched))
    run.findings.is_folded = !folded_faces(run.mesh, run.policy(), has_changed_pinched).empty() ||
                             (are_positive && covers_twice(run.mesh, run.policy(), has_changed_pinched));
}

template <class Metric>
void SurfacePasses<Metric>::restore_volume(const VolumeEffort& effort) {
  const Run& run = state_.run();
  SurfaceMesh& surface = *run.surface;
  std::vector<VertexHandle> vertices;
  if (!run.is_part()) {
    const Worklist all(run.mesh, run.policy(), [](CellHandle) { return true; });
    vertices = free_surface_vertices(run.mesh, surface, run.work, all);
    take_bound(surface, vertices);  // those of periodic patches stay
  }
  const auto pass = [&](const Turn& turn) {
    if (run.is_part())
      return run.ranks->surface_pass(*run.surface, look_of(SurfacePass::kOffset, turn, 0))
          .value_or(RoundCounts{});
    const RoundCounts counts = hfr::smooth_pass(run.mesh, run.work, SurfaceOffset{&surface, state_.worst()},
                                                metric_, vertices, run.policy());
    surface.on_move(run.mesh, vertices);
    return counts;
  };
  for (int i = 1; i <= effort.passes && std::abs(surface.volume_gain()) > effort.enough; ++i) {
    const double start = run.control.seconds();
    const RoundCounts counts = pass({.iteration = i});
    look_for_folds(run.work.clock - 1);
    state_.count(Focus{});
    state_.report("surface volume", {.iteration = i}, counts, run.control.seconds() - start);
    if (counts.winners == 0) break;
  }
}

template class SurfacePasses<VolumeLength>;
template class SurfacePasses<Untangling>;
template class SurfacePasses<MinSine2>;
template class SurfacePasses<MinDihedral>;
template class SurfacePasses<CustomMetric>;

}  // namespace hfr
