// SPDX-License-Identifier: BSD-3-Clause
// Every algorithm that runs in parallel, under a shuffling scheduler, against the bits of one thread.
#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "HalfFace/Reorder.hh"
#include "Operators/AnyOf.hh"
#include "Operators/ClusterSearch.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/FanMerge.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothLaplacian.hh"
#include "Operators/SmoothMaxMin.hh"
#include "Operators/SmoothNewton.hh"
#include "Operators/VertexCollapse.hh"
#include "Operators/VertexInsertion.hh"
#include "Parallel/Sort.hh"
#include "Quality/FoldedFaces.hh"
#include "Quality/Statistics.hh"
#include "Scheduler/Rank.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/Seeds.hh"
#include "Scheduler/Select.hh"
#include "Scheduler/SmoothPass.hh"
#include "Shuffle/Seeds.hh"
#include "Shuffle/Shuffle.hh"

namespace hfr::test {
namespace {

constexpr std::uint64_t kSeeds = 200;

TEST(ShuffledAlgorithms, SortingScanningAndReducingGiveOneResult) {
  for_seeds(kSeeds, [](std::uint64_t seed) {
    Engine engine(seed);
    const par::Policy policy = policy_of(engine);
    std::vector<par::KeyIndex> keys(engine() % 3000), scratch;
    const std::uint64_t n_values = 1 + engine() % 9;  // few: many equal keys
    for (std::size_t i = 0; i < keys.size(); ++i)
      keys[i] = {(engine() % n_values) << (8 * (engine() % 8)), static_cast<std::uint32_t>(i)};
    auto expected = keys;
    par::stable_sort(kOneThread, expected, scratch);
    shuffle(seed);
    auto found = keys;
    par::stable_sort(policy, found, scratch);
    const auto same = [](const par::KeyIndex& a, const par::KeyIndex& b) {
      return a.key == b.key && a.index == b.index;
    };
    ASSERT_TRUE(std::ranges::equal(found, expected, same));
    const auto odd = [&](std::size_t i) { return keys[i].key % 2 == 1; };
    ASSERT_EQ(par::compact(policy, keys.size(), odd), par::compact(kOneThread, keys.size(), odd));
  });
}

/// Scopes of candidates that overlap at random.
ScopeList random_scopes(Engine& engine, std::size_t n_cells, par::Policy policy) {
  const std::size_t n = engine() % 400;
  std::vector<std::vector<CellHandle>> scopes(n);
  for (auto& scope : scopes) {
    std::set<CellHandle> cells;
    const std::size_t size = 1 + engine() % 12;
    while (cells.size() < size) cells.insert(C(engine() % n_cells));
    scope.assign(cells.begin(), cells.end());
  }
  return ScopeList(policy, n, [&](std::size_t i, Scope& out) {
    out.clear();
    for (CellHandle c : scopes[i]) out.push_back(c);
  });
}

TEST(ShuffledAlgorithms, ClaimsSelectWhatMarksSelect) {
  std::size_t n_winners = 0;
  for_seeds(kSeeds, [&](std::uint64_t seed) {
    Engine engine(seed);
    const par::Policy policy = policy_of(engine);
    shuffle(seed);
    const std::size_t n_cells = 20 + engine() % 1500;
    const ScopeList scopes = random_scopes(engine, n_cells, policy);
    std::vector<std::uint32_t> marks(n_cells, kUnclaimed), claims(n_cells, kUnclaimed);
    const auto winners = select_by_marking(scopes, marks);
    ASSERT_EQ(select_by_claims(policy, scopes, claims), winners);
    ASSERT_EQ(claims, marks);
    n_winners += winners.size();
    ASSERT_EQ(colour_clusters(policy, scopes, n_cells), colour_clusters(kOneThread, scopes, n_cells));
  });
  if (HasFatalFailure() || !counts_what_it_met(kSeeds)) return;
  EXPECT_GT(n_winners, 5'000U);
}

TEST(ShuffledAlgorithms, StarsAndColoursAreThoseOfOneThread) {
  std::size_t n_large = 0, n_switched = 0;
  for_seeds(kSeeds, [&](std::uint64_t seed) {
    Engine engine(seed);
    const par::Policy policy = policy_of(engine);
    const TetMesh mesh =
        seed % 8 == 0 ? built(neighbourly(70))
                      : limit_mesh(static_cast<Limit>(seed % static_cast<int>(Limit::kLimits)), engine);
    const double share = seed % 3 == 0 ? 0.03 : uniform(engine, 0.3, 1.0);
    std::vector<VertexHandle> vertices;
    const auto sizes = star_sizes(mesh);
    for (VertexHandle v : mesh.vertices()) {
      if (uniform(engine, 0, 1) > share) continue;
      vertices.push_back(v);
      n_large += sizes[v.idx()] > Star::kCapacity ? 1 : 0;
    }
    const StarTable one(mesh, vertices, sizes, kOneThread);
    const auto first_fit = colour_vertices(mesh, vertices, one, kOneThread);
    const auto constrained = constrained_vertices(mesh, kOneThread);
    shuffle(seed);
    ASSERT_EQ(star_sizes(mesh, policy), sizes);
    ASSERT_EQ(constrained_vertices(mesh, policy), constrained);
    const StarTable many(mesh, vertices, sizes, policy);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      ASSERT_TRUE(std::ranges::equal(one.link(i), many.link(i)));
    ASSERT_EQ(colour_vertices(mesh, vertices, many, policy), first_fit);
    n_switched += n_switches() > 0 ? 1 : 0;
  });
  if (HasFatalFailure() || !counts_what_it_met(kSeeds)) return;
  EXPECT_GT(n_large, 50U) << "vertices of more than 256 cells";
  EXPECT_GT(n_switched, kSeeds / 2);
}

/// A mesh and what rounds keep about it.
struct State {
  TetMesh mesh;
  Workspace work;
};

void expect_same(const State& one, const State& many) {
  ASSERT_TRUE(identical(one.mesh, many.mesh));
  ASSERT_EQ(one.work.quality, many.work.quality);
  ASSERT_EQ(one.work.pending, many.work.pending);
  ASSERT_EQ(one.work.claim, many.work.claim);
  ASSERT_EQ(one.work.changed, many.work.changed);
  ASSERT_EQ(one.work.star_size, many.work.star_size);
}

/// Two rounds of an operator; the winners.
template <class MakeOp, class Visit>
std::size_t run_rounds(State& state, const RoundOptions& options, MakeOp&& make_op, Visit&& visit) {
  std::size_t n = 0;
  for (int r = 0; r < 2; ++r) {
    const Worklist list(state.mesh, options.policy, [](CellHandle) { return true; });
    const auto op = make_op(state);
    Round<std::remove_const_t<decltype(op)>> round(state.mesh, state.work, options);
    n += round
             .run(op, list.cells().size(),
                  [&](std::size_t i, auto&& give) { visit(state, list, CellHandle(list.cells()[i]), give); })
             .winners;
  }
  return n;
}

template <class Metric>
std::size_t run_kind(State& state, std::uint64_t kind, const Metric& metric, const RoundOptions& options) {
  const auto edges = [](const State& s, const Worklist& list, CellHandle c, auto&& give) {
    visit_edge_seeds(s.mesh, list, c, give);
  };
  const auto faces = [](const State& s, const Worklist& list, CellHandle c, auto&& give) {
    visit_face_seeds(s.mesh, list, c, give);
  };
  switch (kind) {
    case 0:
      return run_rounds(
          state, options,
          [&](const State& s) {
            return EdgeRemoval<Metric>{metric, s.work.quality};
          },
          edges);
    case 1:
      return run_rounds(
          state, options,
          [&](const State& s) {
            return FaceSwap<Metric>{metric, s.work.quality};
          },
          faces);
    case 2:
      return run_rounds(
          state, options,
          [&](const State& s) {
            return MultiFaceRemoval<Metric>{metric, s.work.quality};
          },
          [](const State& s, const Worklist& list, CellHandle c, auto&& give) {
            visit_face_seeds(s.mesh, list, c,
                             [&](HalfFaceHandle h) { give(typename MultiFaceRemoval<Metric>::Seed(h)); });
          });
    case 3:
      return run_rounds(
          state, options,
          [&](const State& s) {
            return FanMerge<Metric>{metric, s.work.quality};
          },
          [](const State&, const Worklist&, CellHandle c, auto&& give) {
            for (std::uint8_t e = 0; e < 6; ++e) give(typename FanMerge<Metric>::Seed{c, e, 0, 0});
          });
    case 4:
      return run_rounds(
          state, options,
          [&](const State& s) {
            return VertexInsertion<Metric>{metric, s.work.quality, 1.02};
          },
          [](const State&, const Worklist&, CellHandle c, auto&& give) {
            if (c.idx() % 5 == 0) give(typename VertexInsertion<Metric>::Seed(c));
          });
    default: {
      Worklist list(state.mesh, options.policy, [](CellHandle) { return true; });
      auto seeds = vertex_seeds(state.mesh, list, state.work.frozen, options.policy);
      drop_pinched(state.mesh, state.work, seeds);
      Round<VertexCollapse<Metric>> round(state.mesh, state.work, options);
      return round.run({metric, state.work.quality, state.work.frozen}, seeds).winners;
    }
  }
}

TEST(ShuffledAlgorithms, RoundsOfEachOperatorAreThoseOfOneThread) {
  std::array<std::size_t, 6> n_winners{};
  for_seeds(kSeeds, [&](std::uint64_t seed) {
    Engine engine(seed);
    const par::Policy policy = policy_of(engine);
    State one{limit_mesh(static_cast<Limit>(engine() % static_cast<std::uint64_t>(Limit::kLimits)), engine),
              {}};
    one.work.attach(one.mesh, kOneThread);
    one.work.set_qualities(one.mesh, MinSine2{}, kOneThread);
    State many = one;
    const std::uint64_t kind = seed % n_winners.size();
    const bool check_links = worst_quality(one.mesh, MinSine2{}) <= 0 || engine() % 2 == 0;
    const std::size_t winners = run_kind(one, kind, MinSine2{}, {kOneThread, check_links, seed});
    shuffle(seed);
    ASSERT_EQ(run_kind(many, kind, MinSine2{}, {policy, check_links, seed}), winners);
    expect_same(one, many);
    n_winners[kind] += winners;
  });
  if (HasFatalFailure() || !counts_what_it_met(kSeeds)) return;
  for (std::size_t kind = 0; kind < n_winners.size(); ++kind)
    EXPECT_GT(n_winners[kind], 100U) << "operator " << kind;
}

TEST(ShuffledAlgorithms, SmoothingPassesAreThoseOfOneThread) {
  std::size_t n_moved = 0, n_large = 0;
  for_seeds(kSeeds, [&](std::uint64_t seed) {
    Engine engine(seed);
    const par::Policy policy = policy_of(engine);
    State one{limit_mesh(static_cast<Limit>(engine() % static_cast<std::uint64_t>(Limit::kLimits)), engine),
              {}};
    one.work.attach(one.mesh, kOneThread);
    std::vector<VertexHandle> vertices;
    for (VertexHandle v : one.mesh.vertices())
      if (!one.work.frozen[v.idx()]) vertices.push_back(v);
    const auto run = [&](State& state, const par::Policy& with) {
      const auto pass = [&](const auto& search, const auto& metric) {
        state.work.set_qualities(state.mesh, metric, with);
        const auto first = state.mesh.point(V(0));
        n_moved += smooth_pass(state.mesh, state.work, search, metric, vertices, with).winners;
        n_large += state.work.star_size[0] > Star::kCapacity && state.mesh.point(V(0)) != first ? 1 : 0;
      };
      if (seed % 3 == 0) pass(NewtonSearch{}, VolumeLength{});
      if (seed % 3 == 1) pass(CandidateSearch{}, VolumeLength{});
      if (seed % 3 == 2) pass(LaplacianSearch{}, VolumeLength{});
      pass(MaxMinSearch{}, MinSine2{});
    };
    State many = one;
    run(one, kOneThread);
    shuffle(seed);
    run(many, policy);
    expect_same(one, many);
  });
  if (HasFatalFailure() || !counts_what_it_met(kSeeds)) return;
  EXPECT_GT(n_moved, 10'000U);
  EXPECT_GT(n_large, 20U) << "moves of a vertex with more than 256 cells";
}

/// What statistics() sums up in parallel, as numbers.
std::vector<double> numbers(const Statistics& s) {
  std::vector<double> all = {s.mean_dihedral,
                             s.max_dihedral,
                             s.min_edge,
                             s.mean_edge,
                             s.max_edge,
                             s.volume,
                             s.absolute_volume,
                             s.enclosed_volume,
                             s.overlap,
                             s.surface_ceiling.degrees,
                             s.interface_ceiling.degrees,
                             s.box_low.x,
                             s.box_high.z,
                             static_cast<double>(s.boundary_faces)};
  for (const Distribution& d : {s.min_dihedral, s.volume_length, s.edge_length}) {
    all.insert(all.end(), d.percentiles.begin(), d.percentiles.end());
    all.insert(all.end(), {d.min, d.mean, d.max});
  }
  all.insert(all.end(), s.dihedral_histogram.begin(), s.dihedral_histogram.end());
  all.insert(all.end(), s.volume_length_histogram.begin(), s.volume_length_histogram.end());
  for (CellHandle c : s.inverted) all.push_back(static_cast<double>(c.idx()));
  for (CellHandle c : s.flat) all.push_back(-1.0 - static_cast<double>(c.idx()));
  all.push_back(static_cast<double>(s.worst_cell.idx()));
  return all;
}

TEST(ShuffledAlgorithms, BuildingMeasuringAndReorderingGiveOneResult) {
  for_seeds(kSeeds, [](std::uint64_t seed) {
    Engine engine(seed);
    const par::Policy policy = policy_of(engine);
    TetMesh mesh =
        limit_mesh(static_cast<Limit>(engine() % static_cast<std::uint64_t>(Limit::kLimits)), engine);
    std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
    std::vector<Corners> cells;
    for (CellHandle c : mesh.cells()) {
      cells.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) cells.back()[k] = mesh.cell(c).v[k].idx();
    }
    shuffle(seed);
    TetMesh one = build(points, cells, kOneThread);
    TetMesh many = build(points, cells, policy);
    ASSERT_TRUE(identical(one, many));
    ASSERT_EQ(numbers(statistics(one, kOneThread)), numbers(statistics(many, policy)));
    ASSERT_EQ(folded_faces(one, kOneThread), folded_faces(many, policy));
    ASSERT_EQ(constrained_vertices(one, kOneThread), constrained_vertices(many, policy));
    ASSERT_EQ(frozen_vertices(one, kOneThread), frozen_vertices(many, policy));
    ReorderOptions order;
    order.policy = kOneThread;
    reorder(one, order);
    order.policy = policy;
    reorder(many, order);
    ASSERT_TRUE(identical(one, many));
    for (std::size_t i = 0; i < one.n_cells(); i += 3) {
      one.delete_cell(C(i));
      many.delete_cell(C(i));
    }
    one.collect_garbage({true, kOneThread});
    many.collect_garbage({true, policy});
    ASSERT_TRUE(identical(one, many));
  });
}

}  // namespace
}  // namespace hfr::test
