// SPDX-License-Identifier: BSD-3-Clause
// The passes of a stage over the surface. A round evaluates and commits in parallel; the surface mesh follows
// afterwards, one winner at a time in rank order.
#include <algorithm>
#include <cmath>
#include <map>

#include "Remesh/Stage.hh"
#ifdef HFR_HAS_SURFACE
#include "Surface/InterfaceSwap.hh"
#include "Surface/PeriodicSmooth.hh"
#include "Surface/SurfaceCollapse.hh"
#include "Surface/SurfaceMesh.hh"
#include "Surface/SurfaceSmooth.hh"
#include "Surface/SurfaceSplit.hh"
#include "Surface/SurfaceSwap.hh"
#endif

namespace hfr {

#ifdef HFR_HAS_SURFACE
namespace {

enum Looked : std::size_t { kSwaps, kCollapses, kMoves, kSplits };

// Where so many vertices of a curved surface are looked at, or one in so many of the mesh, the worst cell of
// a star has to rise by this factor for its vertex to move: moves cost far more there than inside, and each
// calls for others.
constexpr std::size_t kManyMoves = 300;
constexpr std::size_t kManyMovesShare = 8;
constexpr double kMoveGain = 1.05;

/// About how long SurfaceCollapse::may_gain() takes.
constexpr double kMayGainNanoseconds = 1'000;

/// Vertices of the surface in the listed cells that are of one of two kinds, ascending.
std::vector<VertexHandle> free_vertices(const TetMesh& mesh, const SurfaceMesh& surface,
                                        const Workspace& work, const Worklist& list) {
  std::vector<VertexHandle> vertices;
  std::vector<std::uint8_t> seen(mesh.n_vertices(), 0);
  for (Index c : list.cells()) {
    for (VertexHandle v : mesh.cell(CellHandle(c)).v) {
      if (!work.frozen[v.idx()] || seen[v.idx()]) continue;  // the surface is frozen for what works inside
      seen[v.idx()] = 1;
      const SurfaceKind kind = surface.freedom(v).kind;
      if (kind == SurfaceKind::kFacet || kind == SurfaceKind::kCurve) vertices.push_back(v);
    }
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

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
Worklist Stage<Metric>::changed_since(std::uint32_t since, Focus focus) {
  const auto has_changed = [&](CellHandle c) {
    for (VertexHandle v : mesh_.cell(c).v)
      if (work_.changed[v.idx()] > since) return true;
    return false;
  };
  if (focus.everything()) return Worklist(mesh_, options_.policy, has_changed);
  return Worklist(mesh_, options_.policy, poor(focus.below), has_changed);
}

template <class Metric>
template <class Allow>
std::vector<EdgeHandle> Stage<Metric>::surface_edges(const Worklist& list, bool inside, Allow&& allow) const {
  std::vector<EdgeHandle> seeds;
  for (Index c : list.cells()) {
    const auto& v = mesh_.cell(CellHandle(c)).v;
    for (Index e = 0; e < 6; ++e) {
      const VertexHandle a = v[kEdgeCorners[e][0]];
      const VertexHandle b = v[kEdgeCorners[e][1]];
      if (!work_.frozen[a.idx()] || !work_.frozen[b.idx()]) continue;  // not of the surface
      bool smallest = true;                                            // of the listed cells round the edge
      const auto look = [&](CellHandle other, VertexHandle, VertexHandle) {
        smallest = smallest && (!list.has(other) || other.idx() >= c);
        return smallest;
      };
      const bool closed = mesh_.walk_ring(CellHandle(c), static_cast<int>(e), look);
      if (!smallest || closed != inside) continue;
      if (!closed) mesh_.walk_ring_back(CellHandle(c), static_cast<int>(e), look);
      if (smallest && allow(a, b)) seeds.push_back(EdgeHandle(6 * c + e));
    }
  }
  return seeds;
}

template <class Metric>
std::size_t Stage<Metric>::surface_splits(int iteration, Focus focus) {
  using Op = SurfaceSplit<Metric>;
  SurfaceMesh& surface = *control_.surface();
  const double start = control_.seconds();
  const std::uint32_t since = looked_at_surface_[kSplits];
  looked_at_surface_[kSplits] = work_.clock;
  std::vector<typename Op::Seed> seeds;
  for (EdgeHandle e : surface_edges(changed_since(since, focus), /*inside=*/false,
                                    [&](VertexHandle a, VertexHandle b) { return surface.may_split(a, b); }))
    seeds.push_back(typename Op::Seed(e));
  RoundCounts counts;
  if (!seeds.empty()) {
    RoundOptions round_options{options_.policy, /*check_links=*/true, options_.seed};
    round_options.may_gain = may_gain(mesh_.n_logical_cells());
    Round<Op> round(mesh_, work_, round_options);
    const Op op{metric_, work_.quality, &surface};
    // The ends of the edges are asked for before the cells that name them are gone.
    std::map<Index, std::array<VertexHandle, 2>> ends;
    for (const auto& seed : seeds) ends[seed.edge.idx()] = mesh_.edge_vertices(seed.edge);
    counts = round.run(op, seeds);
    if (counts.held_back > 0) control_.note_cell_bound(options_.max_cells);
    round.for_committed([&](const auto& plan, VertexHandle middle) {
      const auto [a, b] = ends.at(plan.seed.edge.idx());
      surface.was_split(a, b, middle, plan.place);
      work_.frozen[middle.idx()] = 1;  // for what works inside
    });
    surface.write_labels(mesh_);
  }
  count(focus);
  report("surface split", iteration, counts, control_.seconds() - start);
  return counts.winners;
}

template <class Metric>
template <class Op>
std::size_t Stage<Metric>::surface_swaps(const char* name, bool inside, int iteration, const Worklist& list) {
  SurfaceMesh& surface = *control_.surface();
  const double start = control_.seconds();
  const std::vector<EdgeHandle> seeds =
      surface_edges(list, inside, [&](VertexHandle a, VertexHandle b) { return surface.may_swap(a, b); });
  RoundCounts counts;
  if (!seeds.empty()) {
    Round<Op> round(mesh_, work_, {options_.policy, /*check_links=*/true, options_.seed});
    counts = round.run(Op{metric_, work_.quality, &surface}, seeds);
    round.for_committed([&](const auto& plan, VertexHandle) { surface.swapped(plan.edge[0], plan.edge[1]); });
    surface.write_labels(mesh_);
  }
  report(name, iteration, counts, control_.seconds() - start);
  return counts.winners;
}

template <class Metric>
std::size_t Stage<Metric>::surface_swaps(int iteration, const Worklist& list) {
  const std::size_t n_listed = mesh_.n_cells();
  std::size_t changes = surface_swaps<SurfaceSwap<Metric>>("surface swap", /*inside=*/false, iteration, list);
  if (!control_.surface()->has_interfaces()) return changes;
  // There are cells now that the list does not know.
  const Worklist left(mesh_, options_.policy,
                      [&](CellHandle c) { return c.idx() < n_listed && list.has(c); });
  changes += surface_swaps<InterfaceSwap<Metric>>("surface interface", /*inside=*/true, iteration, left);
  return changes;
}

template <class Metric>
std::size_t Stage<Metric>::surface_collapses(int iteration, const Worklist& list) {
  using Op = SurfaceCollapse<Metric>;
  SurfaceMesh& surface = *control_.surface();
  const double start = control_.seconds();
  const std::vector<VertexHandle> all = free_vertices(mesh_, surface, work_, list);
  std::vector<VertexHandle> targets;
  const Op op{metric_, work_.quality, &surface, {}};
  std::vector<VertexHandle> vertices;
  const par::Policy by_cost = options_.policy.for_items_of(kMayGainNanoseconds);
  for (std::size_t i : par::compact<std::size_t>(by_cost, all.size(),
                                                 [&](std::size_t k) { return op.may_gain(mesh_, all[k]); }))
    vertices.push_back(all[i]);
  drop_pinched(mesh_, work_.star_size, vertices, options_.policy);
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
    drop_pinched(mesh_, work_.star_size, only, options_.policy);
    if (!only.empty()) surface.collapse_targets(v, targets);
    return !targets.empty();
  };
  // A round in which none of the legal collapses gains counts, too: the clock salts the ranks of later ones.
  if (!seeds.empty() || std::any_of(all.begin(), all.end(), has_target)) {
    Round<Op> round(mesh_, work_, {options_.policy, /*check_links=*/true, options_.seed});
    counts = round.run(Op{metric_, work_.quality, &surface, targets}, seeds);
    round.for_committed(
        [&](const auto& plan, VertexHandle) { surface.collapsed(plan.seed.vertex, plan.onto); });
    surface.write_labels(mesh_);
  }
  report("surface node", iteration, counts, control_.seconds() - start);
  return counts.winners;
}

template <class Metric>
std::size_t Stage<Metric>::surface_moves(int iteration, const Worklist& list) {
  SurfaceMesh& surface = *control_.surface();
  const double start = control_.seconds();
  std::vector<VertexHandle> vertices = free_vertices(mesh_, surface, work_, list);
  const std::vector<VertexHandle> bound = take_bound(surface, vertices);
  RoundCounts counts;
  if (!bound.empty()) counts = periodic_moves(bound);
  if (!vertices.empty()) {
    SurfaceSearch search{&surface};
    const bool many = vertices.size() > std::min(kManyMoves, mesh_.n_vertices() / kManyMovesShare);
    if (surface.options().mode == SurfaceMode::kFree && many) search.gain = kMoveGain;
    counts += hfr::smooth_pass(mesh_, work_, search, metric_, vertices, options_.policy);
    surface.moved(mesh_, vertices);
  }
  report("surface smooth", iteration, counts, control_.seconds() - start);
  return counts.winners;
}

template <class Metric>
RoundCounts Stage<Metric>::periodic_moves(std::span<const VertexHandle> first_of_orbits) {
  SurfaceMesh& surface = *control_.surface();
  RoundCounts counts;
  counts.rounds = 1;
  ++work_.clock;
  Star star;
  for (VertexHandle first : first_of_orbits) {
    const auto orbit = surface.orbit(first);
    ++counts.seeds;
    const auto is_partly_known = [&](VertexHandle v) {
      return !work_.pinched.empty() && work_.pinched[v.idx()];
    };
    if (std::any_of(orbit.begin(), orbit.end(), is_partly_known)) continue;
    const auto plan =
        PeriodicSmooth<Metric>{metric_, work_.quality, &surface, work_.floor}.evaluate(mesh_, orbit);
    if (!plan) continue;
    ++counts.candidates;
    ++counts.winners;
    std::vector<CellHandle> cells;
    for (std::size_t i = 0; i < orbit.size(); ++i) {
      mesh_.set_point(orbit[i], plan->targets[i]);
      mesh_.gather_star(orbit[i], star);
      cells.insert(cells.end(), star.cells.begin(), star.cells.begin() + star.size);
    }
    for (CellHandle c : cells) {
      const auto& v = mesh_.cell(c).v;
      work_.quality[c.idx()] =
          metric_(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), mesh_.point(v[3]));
      work_.pending[c.idx()] = 0xff;
      for (VertexHandle u : v) work_.changed[u.idx()] = work_.clock;
    }
    if (!work_.all_touched) work_.touch(cells);
    surface.moved(mesh_, orbit);
  }
  return counts;
}

template <class Metric>
std::size_t Stage<Metric>::surface_pass(int iteration, Focus focus, bool with_node) {
  std::size_t changes = 0;
  const auto run = [&](Looked kind, auto&& pass) {
    if (control_.stopped()) return;
    const std::uint32_t since = looked_at_surface_[kind];
    looked_at_surface_[kind] = work_.clock;
    const Worklist list = changed_since(since, focus);
    if (!list.cells().empty()) changes += (this->*pass)(iteration, list);
    if (n_invalid_ > 0) count(focus);
  };
  using Pass = std::size_t (Stage::*)(int, const Worklist&);
  if (has(options_.ops, Ops::kEdge)) run(kSwaps, static_cast<Pass>(&Stage::surface_swaps));
  if (with_node && has(options_.ops, Ops::kNode)) run(kCollapses, &Stage::surface_collapses);
  if (has(options_.ops, Ops::kSmooth)) run(kMoves, &Stage::surface_moves);
  count(focus);
  return changes;
}

template <class Metric>
void Stage<Metric>::restore_volume() {
  constexpr int kMaxPasses = 8;
  constexpr double kEnough = 5e-5;  // of the volume
  SurfaceMesh& surface = *control_.surface();
  const Worklist all(mesh_, options_.policy, [](CellHandle) { return true; });
  std::vector<VertexHandle> vertices = free_vertices(mesh_, surface, work_, all);
  take_bound(surface, vertices);  // those of periodic patches stay
  for (int i = 1; i <= kMaxPasses && std::abs(surface.volume_gain()) > kEnough; ++i) {
    const double start = control_.seconds();
    const RoundCounts counts =
        hfr::smooth_pass(mesh_, work_, SurfaceOffset{&surface, worst_}, metric_, vertices, options_.policy);
    surface.moved(mesh_, vertices);
    count(Focus{});
    report("surface volume", i, counts, control_.seconds() - start);
    if (counts.winners == 0) break;
  }
}

#else

template <class Metric>
void Stage<Metric>::restore_volume() {}

template <class Metric>
std::size_t Stage<Metric>::surface_splits(int, Focus) {
  return 0;
}

template <class Metric>
std::size_t Stage<Metric>::surface_pass(int, Focus, bool) {
  return 0;  // without OpenMesh every surface is frozen
}

#endif

template void Stage<MinSine2>::restore_volume();
template void Stage<MinDihedral>::restore_volume();
#define HFR_INSTANTIATE(Metric)                                                   \
  template std::size_t Stage<Metric>::surface_splits(int iteration, Focus focus); \
  template std::size_t Stage<Metric>::surface_pass(int iteration, Focus focus, bool with_node);
HFR_INSTANTIATE(VolumeLength)
HFR_INSTANTIATE(Untangling)
HFR_INSTANTIATE(MinSine2)
HFR_INSTANTIATE(MinDihedral)
HFR_INSTANTIATE(CustomMetric)

}  // namespace hfr
