// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Round.hh"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <tuple>

#include "HalfFace/Check.hh"
#include "Operators/AnyOf.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/Metrics.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/StarFromVertex.hh"
#include "Operators/VertexCollapse.hh"
#include "Operators/VertexInsertion.hh"
#include "Quality/Damage.hh"
#include "Scheduler/Rank.hh"
#include "Scheduler/Seeds.hh"

namespace hfr::test {
namespace {

/// Claims what it is told to and moves its vertex far away: shows which candidates a round selects.
struct Marker {
  using Seed = VertexHandle;
  struct Plan : PlanBase {
    VertexHandle seed;
  };
  static constexpr Vec3 kMark = {1000, 1000, 1000};

  VolumeLength metric;
  const std::vector<std::vector<CellHandle>>* scopes = nullptr;
  const std::vector<double>* old_worst = nullptr;

  void scope(const TetMesh&, Seed seed, Scope& out) const {
    out.clear();
    for (CellHandle c : (*scopes)[seed.idx()]) out.push_back(c);
  }
  std::optional<Plan> evaluate(const TetMesh&, Seed seed) const {
    if (seed.idx() % 5 == 0) return std::nullopt;  // not every seed is a candidate
    Plan plan;
    plan.seed = seed;
    plan.old_worst = (*old_worst)[seed.idx()];
    plan.new_worst = plan.old_worst + 1;
    return plan;
  }
  void cavity(const TetMesh&, const Plan& plan, Cavity& out) const {
    out.clear();
    out.moved = plan.seed;
    out.target = kMark;
  }
  Tet identity(const TetMesh&, Seed seed) const {
    return {seed, VertexHandle(), VertexHandle(), VertexHandle()};
  }
};
static_assert(LocalOperator<Marker>);

struct Candidate {
  std::uint64_t key = 0;
  Tet identity{};
  std::set<CellHandle> scope;
  std::vector<Tet> removed, created;
  std::set<std::vector<VertexHandle>> made;  ///< edges and faces that the removed cells do not have
};

template <class T>
bool share_an_item(const std::set<T>& a, const std::set<T>& b) {
  return std::any_of(a.begin(), a.end(), [&](const T& item) { return b.contains(item); });
}

std::set<std::vector<VertexHandle>> edges_and_faces(const std::vector<Tet>& tets) {
  std::set<std::vector<VertexHandle>> all;
  for (const Tet& t : tets) {  // vertices ascending
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) all.insert({t[i], t[j]});
      std::vector<VertexHandle> face(t.begin(), t.end());
      face.erase(face.begin() + static_cast<std::ptrdiff_t>(i));
      all.insert(face);
    }
  }
  return all;
}

/// The lexicographically first independent set, by taking the smallest and striking out what shares a cell
/// with it or makes the same edge or face.
std::vector<Candidate> first_independent_set(std::vector<Candidate> left) {
  std::vector<Candidate> winners;
  while (!left.empty()) {
    const auto first = std::min_element(left.begin(), left.end(), [](const auto& a, const auto& b) {
      return std::pair(a.key, a.identity) < std::pair(b.key, b.identity);
    });
    winners.push_back(*first);
    const Candidate& winner = winners.back();
    std::erase_if(left, [&](const Candidate& candidate) {
      return share_an_item(candidate.scope, winner.scope) || share_an_item(candidate.made, winner.made);
    });
  }
  return winners;
}

TEST(Round, SelectsTheFirstIndependentSetOverRandomScopes) {
  Engine engine(1);
  std::size_t n_winners = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const TetMesh original = jittered(4, 0.1, 1);
    std::vector<std::vector<CellHandle>> scopes(original.n_vertices());
    std::vector<double> old_worst(original.n_vertices());
    for (std::size_t i = 0; i < scopes.size(); ++i) {
      std::set<CellHandle> cells;
      const std::size_t size = 1 + engine() % 12;
      while (cells.size() < size) cells.insert(C(engine() % original.n_cells()));
      scopes[i].assign(cells.begin(), cells.end());
      old_worst[i] = uniform(engine, 1e-3, 1);
    }
    const Marker op{{}, &scopes, &old_worst};
    const RoundOptions options{{}, false, engine()};
    Workspace work;
    work.attach(original, {});
    std::vector<Candidate> candidates;
    for (VertexHandle v : original.vertices()) {
      if (v.idx() % 5 == 0) continue;
      const Tet identity = op.identity(original, v);
      candidates.push_back({priority(old_worst[v.idx()], identity, options.seed + work.clock),
                            identity,
                            {scopes[v.idx()].begin(), scopes[v.idx()].end()},
                            {},
                            {},
                            {}});
    }
    std::set<VertexHandle> expected;
    for (const Candidate& winner : first_independent_set(candidates)) expected.insert(winner.identity[0]);
    n_winners += expected.size();
    for (const int threads : {1, 3}) {
      TetMesh mesh = original;
      Workspace mine = work;
      const auto seeds = all_vertices(mesh);
      Round<Marker> round(mesh, mine, {{threads, 1}, false, options.seed});
      const RoundCounts counts = round.run(op, seeds);
      EXPECT_EQ(counts.seeds, 125U);
      EXPECT_EQ(counts.candidates, 100U);
      EXPECT_EQ(counts.winners, expected.size());
      std::set<VertexHandle> found;
      for (VertexHandle v : mesh.vertices())
        if (mesh.point(v) == Marker::kMark) found.insert(v);
      EXPECT_EQ(found, expected);
    }
  }
  EXPECT_GT(n_winners, 60U * 20U);
}

/// Inverted cells, inverted or flat ones, and six times the volume of the former, from the cells' corners.
std::tuple<int, int, double> damage_of_tet(const TetMesh& mesh, const Tet& t) {
  const Vec3 a = mesh.point(t[0]);
  const Vec3 b = mesh.point(t[1]);
  const Vec3 c = mesh.point(t[2]);
  const Vec3 d = mesh.point(t[3]);
  const int sign = orientation(a, b, c, d);
  return {sign < 0, sign <= 0, sign < 0 ? -dot(b - a, cross(c - a, d - a)) : 0.0};
}

bool damages_more(const TetMesh& mesh, const Cavity& cavity) {
  std::array<std::tuple<int, int, double>, 2> sum{};
  const auto add = [&](std::size_t side, const Tet& t) {
    const auto [inverted, invalid, overlap] = damage_of_tet(mesh, t);
    std::get<0>(sum[side]) += inverted;
    std::get<1>(sum[side]) += invalid;
    std::get<2>(sum[side]) += overlap;
  };
  for (CellHandle c : cavity.removed) add(0, mesh.cell(c).v);
  for (const Tet& t : cavity.created) add(1, t);
  const auto& [inverted, invalid, overlap] = sum[0];
  const auto& [new_inverted, new_invalid, new_overlap] = sum[1];
  if (new_inverted > inverted || new_invalid > invalid) return true;
  return new_inverted == inverted && new_overlap > overlap;
}

template <class Op>
std::optional<Candidate> candidate_of(const TetMesh& mesh, const Op& op, typename Op::Seed seed,
                                      std::uint64_t salt) {
  const auto plan = op.evaluate(mesh, seed);
  if (!plan) return std::nullopt;
  Cavity cavity;
  op.cavity(mesh, *plan, cavity);
  Star scratch;
  if (!admissible(mesh, cavity, true, scratch)) return std::nullopt;
  std::ptrdiff_t more_invalid = 0;
  for (const Tet& t : cavity.created) more_invalid += quality_of(mesh, t, op.metric) > 0 ? 0 : 1;
  for (CellHandle c : cavity.removed) more_invalid -= quality_of(mesh, mesh.cell(c).v, op.metric) > 0 ? 0 : 1;
  if (more_invalid > 0 || damages_more(mesh, cavity)) return std::nullopt;
  Candidate candidate;
  candidate.identity = op.identity(mesh, seed);
  if constexpr (requires { Op::kRankByGain; })
    candidate.key = priority_by_gain(plan->old_worst, plan->new_worst, candidate.identity, salt);
  else
    candidate.key = priority(plan->old_worst, candidate.identity, salt);
  Scope scope;
  op.scope(mesh, seed, scope);
  candidate.scope.insert(scope.begin(), scope.end());
  for (CellHandle c : cavity.removed) candidate.removed.push_back(sorted(mesh.cell(c).v));
  for (const Tet& t : cavity.created) candidate.created.push_back(sorted(t));
  candidate.made = edges_and_faces(candidate.created);
  for (const auto& old : edges_and_faces(candidate.removed)) candidate.made.erase(old);
  return candidate;
}

int adjacent_pairs(const TetMesh& mesh, const std::vector<Candidate>& winners) {
  std::map<CellHandle, std::size_t> owner;
  for (std::size_t w = 0; w < winners.size(); ++w)
    for (CellHandle c : winners[w].scope) owner[c] = w;
  int pairs = 0;
  for (const auto& [c, w] : owner)
    for (HalfFaceHandle m : mesh.cell(c).mate)
      if (m.is_valid() && owner.contains(cell_of(m)) && owner[cell_of(m)] > w) ++pairs;
  return pairs;
}

/// After a round: whole, cached values right, nothing claimed, incident cells live.
void expect_sound(const TetMesh& mesh, const Workspace& work) {
  ASSERT_EQ(check(mesh), Ok);
  EXPECT_EQ(work.quality, qualities(mesh, VolumeLength{}));
  EXPECT_EQ(work.star_size, star_sizes(mesh));
  for (std::uint32_t claim : work.claim) ASSERT_EQ(claim, kUnclaimed);
  for (VertexHandle v : mesh.vertices()) {
    ASSERT_TRUE(mesh.incident_cell(v).is_valid());
    ASSERT_TRUE(mesh.cell(mesh.incident_cell(v)).has(v));
  }
  std::set<CellHandle> free(mesh.free_cells().begin(), mesh.free_cells().end());
  EXPECT_EQ(free.size(), mesh.free_cells().size());
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) EXPECT_EQ(mesh.is_deleted(C(i)), free.contains(C(i)));
}

/// One round against the oracle; returns how many faces lay between two winners.
template <class Op, class Seeds>
int round_against_brute_force(TetMesh& mesh, Workspace& work, const Op& op, const Seeds& seeds,
                              par::Policy policy) {
  std::vector<Candidate> candidates;
  for (const auto& seed : seeds)
    if (auto candidate = candidate_of(mesh, op, seed, 1 + work.clock)) candidates.push_back(*candidate);
  const auto winners = first_independent_set(candidates);
  std::set<Tet> expected = tets_of(mesh);
  for (const Candidate& winner : winners) {
    for (const Tet& t : winner.removed) expected.erase(t);
    for (const Tet& t : winner.created) expected.insert(t);
  }
  const int adjacent = adjacent_pairs(mesh, winners);
  const std::vector<double> quality = work.quality;
  work.clear_touched();
  Round<Op> round(mesh, work, {policy, true, 1});
  const RoundCounts counts = round.run(op, std::span(seeds));
  const std::set<Index> touched(work.touched.begin(), work.touched.end());
  for (std::size_t i = 0; i < mesh.n_cells() && !work.all_touched; ++i) {
    const bool is_new = i >= quality.size() || quality[i] != work.quality[i];
    EXPECT_TRUE(!is_new || mesh.is_deleted(C(i)) || touched.contains(i)) << "cell " << i;
  }
  EXPECT_EQ(counts.candidates, candidates.size());
  EXPECT_EQ(counts.winners, winners.size());
  EXPECT_TRUE(tets_of(mesh) == expected);
  expect_sound(mesh, work);
  return adjacent;
}

struct Bench {
  TetMesh mesh;
  Workspace work;
  explicit Bench(double jitter, std::uint64_t seed, Index n = 5) : mesh(jittered(n, jitter, seed)) {
    work.attach(mesh, {});
    work.set_qualities(mesh, VolumeLength{}, {});
  }
  Worklist everything() const {
    return Worklist(mesh, {}, [](CellHandle) { return true; });
  }
};

TEST(Round, RingOfFaceAdjacentEdgeRemovalsInOneRoundLeavesValidMates) {
  int adjacent = 0;
  for (std::uint64_t s = 1; s <= 4; ++s) {
    Bench bench(0.35, s);
    const auto seeds = edge_seeds(bench.mesh, bench.everything(), {});
    const EdgeRemoval<VolumeLength> op{{}, bench.work.quality};
    adjacent += round_against_brute_force(bench.mesh, bench.work, op, seeds, {s % 2 ? 1 : 3, 1});
  }
  EXPECT_GT(adjacent, 100) << "winners no longer touch each other";
}

TEST(Round, RingOfFaceAdjacentSwapsInOneRoundLeavesValidMates) {
  int adjacent = 0;
  for (std::uint64_t s = 1; s <= 12; ++s) {
    Bench bench(0.6, s);
    const auto seeds = face_seeds(bench.mesh, bench.everything(), {});
    const FaceSwap<VolumeLength> op{{}, bench.work.quality};
    adjacent += round_against_brute_force(bench.mesh, bench.work, op, seeds, {s % 2 ? 1 : 3, 1});
  }
  EXPECT_GT(adjacent, 30);
}

TEST(Round, VertexCollapsesGiveTheirSlotsAndVerticesBack) {
  std::size_t removed = 0;
  for (std::uint64_t s = 1; s <= 10; ++s) {
    Bench bench(0.45, s);
    const auto seeds = vertex_seeds(bench.mesh, bench.everything(), bench.work.frozen, {});
    const std::size_t before = bench.mesh.n_logical_vertices();
    const VertexCollapse<VolumeLength> op{{}, bench.work.quality, bench.work.frozen};
    round_against_brute_force(bench.mesh, bench.work, op, seeds, {s % 2 ? 1 : 3, 1});
    removed += before - bench.mesh.n_logical_vertices();
  }
  EXPECT_GT(removed, 15U);
}

TEST(Round, RemovalsThatWouldTakeAwayTooManyCellsAreGivenUpLastRanksFirst) {
  std::size_t held_back = 0, committed = 0;
  for (std::uint64_t s = 1; s <= 6; ++s) {
    Bench free(0.45, s);
    const auto run = [](Bench& bench, std::size_t may_lose, std::vector<VertexHandle>& removed) {
      RoundOptions options{{}, true, 1};
      options.may_lose = may_lose;
      const VertexCollapse<VolumeLength> op{{}, bench.work.quality, bench.work.frozen};
      Round<VertexCollapse<VolumeLength>> round(bench.mesh, bench.work, options);
      const auto seeds = vertex_seeds(bench.mesh, bench.everything(), bench.work.frozen, {});
      const RoundCounts counts = round.run(op, seeds);
      round.for_committed([&](const auto& plan, VertexHandle) { removed.push_back(plan.seed); });
      return counts;
    };
    const std::size_t n_before = free.mesh.n_logical_cells();
    std::vector<VertexHandle> all, some;
    run(free, n_before, all);
    const std::size_t n_lost = n_before - free.mesh.n_logical_cells();
    for (const std::size_t may_lose : {std::size_t{0}, n_lost / 2, n_lost}) {
      Bench bounded(0.45, s);
      some.clear();
      const RoundCounts counts = run(bounded, may_lose, some);
      EXPECT_EQ(check(bounded.mesh), Ok);
      EXPECT_GE(bounded.mesh.n_logical_cells() + may_lose, n_before);
      EXPECT_EQ(counts.winners + counts.held_back, all.size());
      EXPECT_EQ(counts.winners, some.size());
      if (may_lose == n_lost) {
        EXPECT_EQ(some, all);
      }
      if (!some.empty()) {
        EXPECT_EQ(some[0], all[0]);
      }
      held_back += counts.held_back;
      committed += may_lose == n_lost / 2 ? counts.winners : 0;
      for (std::uint32_t claim : bounded.work.claim) EXPECT_EQ(claim, kUnclaimed);
    }
  }
  EXPECT_GT(held_back, 20U);
  EXPECT_GT(committed, 5U);
}

using EdgeFaceOrNode = AnyOf<EdgeRemoval<VolumeLength>, FaceSwap<VolumeLength>, VertexCollapse<VolumeLength>>;
static_assert(LocalOperator<EdgeFaceOrNode>);

EdgeFaceOrNode edge_face_or_node(const Workspace& work) {
  return {{EdgeRemoval<VolumeLength>{{}, work.quality}, FaceSwap<VolumeLength>{{}, work.quality},
           VertexCollapse<VolumeLength>{{}, work.quality, work.frozen}}};
}

std::vector<EdgeFaceOrNode::Seed> seeds_of_all_kinds(const Bench& bench) {
  std::vector<EdgeFaceOrNode::Seed> seeds;
  for (EdgeHandle e : edge_seeds(bench.mesh, bench.everything(), {})) seeds.push_back(e);
  for (HalfFaceHandle h : face_seeds(bench.mesh, bench.everything(), {})) seeds.push_back(h);
  for (VertexHandle v : vertex_seeds(bench.mesh, bench.everything(), bench.work.frozen, {}))
    seeds.push_back(v);
  return seeds;
}

TEST(Round, SeveralKindsCompeteInOneSelection) {
  int adjacent = 0;
  std::size_t n_kinds = 0;
  for (std::uint64_t s = 1; s <= 4; ++s) {
    Bench bench(0.45, s);
    const auto seeds = seeds_of_all_kinds(bench);
    const auto op = edge_face_or_node(bench.work);
    std::set<std::size_t> kinds;
    for (const auto& seed : seeds)
      if (op.evaluate(bench.mesh, seed)) kinds.insert(seed.index());
    n_kinds += kinds.size();
    adjacent += round_against_brute_force(bench.mesh, bench.work, op, seeds, {s % 2 ? 1 : 3, 1});
  }
  EXPECT_GT(adjacent, 100);
  EXPECT_EQ(n_kinds, 12U) << "not every kind had a candidate";
}

TEST(Round, TheLargestGainWinsAmongEquallyBadClusters) {
  Bench bench(0.45, 7);
  const auto op = edge_face_or_node(bench.work);
  const auto seeds = seeds_of_all_kinds(bench);
  // Of all candidates that hold the worst cell, none gains a step more than the one that is committed.
  const auto worst = static_cast<std::size_t>(
      std::min_element(bench.work.quality.begin(), bench.work.quality.end()) - bench.work.quality.begin());
  double best = 0;
  for (const auto& seed : seeds) {
    Scope scope;
    op.scope(bench.mesh, seed, scope);
    if (std::find(scope.begin(), scope.end(), C(worst)) == scope.end()) continue;
    if (!candidate_of(bench.mesh, op, seed, 1)) continue;
    best = std::max(best, op.evaluate(bench.mesh, seed)->new_worst);
  }
  ASSERT_GT(best, 0);
  std::vector<EdgeFaceOrNode::Seed> around;  // nothing else, so that nothing of higher rank is in the way
  for (const auto& seed : seeds) {
    Scope scope;
    op.scope(bench.mesh, seed, scope);
    if (std::find(scope.begin(), scope.end(), C(worst)) != scope.end()) around.push_back(seed);
  }
  const Tet gone = sorted(bench.mesh.cell(C(worst)).v);
  const auto before = tets_of(bench.mesh);
  Round<EdgeFaceOrNode> round(bench.mesh, bench.work, {{}, true, 1});
  EXPECT_EQ(round.run(op, around).winners, 1U);
  EXPECT_FALSE(tets_of(bench.mesh).contains(gone));
  double now = std::numeric_limits<double>::infinity();
  for (CellHandle c : bench.mesh.cells())
    if (!before.contains(sorted(bench.mesh.cell(c).v))) now = std::min(now, bench.work.quality[c.idx()]);
  EXPECT_GT(now, best * (1 - 1.0 / 16));
}

TEST(Round, WorstFirstCommitsTheWorstOfEveryNeighbourhood) {
  std::size_t n_winners = 0;
  int differs = 0;
  for (std::uint64_t s = 1; s <= 6; ++s) {
    Bench bench(0.45, s);
    const EdgeRemoval<VolumeLength> op{{}, bench.work.quality};
    const auto seeds = edge_seeds(bench.mesh, bench.everything(), {});
    // The paper's ASSIGNMENT: sort by the worst cell, take what is free.
    std::vector<std::tuple<double, std::uint64_t, Candidate>> order;
    for (EdgeHandle e : seeds)
      if (const auto candidate = candidate_of(bench.mesh, op, e, 1 + bench.work.clock))
        order.emplace_back(op.evaluate(bench.mesh, e)->old_worst, candidate->key, *candidate);
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
      return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
    });
    std::vector<Candidate> ranked;
    for (std::size_t i = 0; i < order.size(); ++i) {
      ranked.push_back(std::get<2>(order[i]));
      ranked.back().key = i;
    }
    std::set<Tet> expected = tets_of(bench.mesh);
    for (const Candidate& winner : first_independent_set(ranked)) {
      for (const Tet& t : winner.removed) expected.erase(t);
      for (const Tet& t : winner.created) expected.insert(t);
    }
    Bench by_buckets(0.45, s);
    for (const int threads : {1, 3}) {
      Bench mine(0.45, s);
      const EdgeRemoval<VolumeLength> mine_op{{}, mine.work.quality};
      Round<EdgeRemoval<VolumeLength>> round(mine.mesh, mine.work, {{threads, 1}, true, 1, true});
      n_winners += round.run(mine_op, seeds).winners;
      EXPECT_TRUE(tets_of(mine.mesh) == expected);
      expect_sound(mine.mesh, mine.work);
    }
    Round<EdgeRemoval<VolumeLength>> round(by_buckets.mesh, by_buckets.work, {{}, true, 1, false});
    round.run(EdgeRemoval<VolumeLength>{{}, by_buckets.work.quality}, seeds);
    differs += tets_of(by_buckets.mesh) == expected ? 0 : 1;
  }
  EXPECT_GT(n_winners, 200U);
  EXPECT_GT(differs, 3) << "buckets would have done the same";
}

TEST(Round, InsertionsAddVerticesInRankOrder) {
  using Op = StarFromVertex<Cluster::kEdge, VolumeLength>;
  std::optional<TetMesh> one;
  for (const int threads : {1, 2, 3, 7}) {
    Bench bench(0.45, 3);
    Op op{{}, bench.work.quality, bench.work.frozen};
    op.insert = true;
    op.reconnect = false;
    std::vector<Op::Seed> seeds;
    for (EdgeHandle e : edge_seeds(bench.mesh, bench.everything(), {}))
      seeds.push_back({C(e.idx() / 6), static_cast<std::uint8_t>(e.idx() % 6)});
    const std::size_t n = bench.mesh.n_vertices();
    Round<Op> round(bench.mesh, bench.work, {{threads, 1}, true, 1});
    const RoundCounts counts = round.run(op, seeds);
    EXPECT_GT(counts.winners, 5U);
    EXPECT_EQ(bench.mesh.n_vertices(), n + counts.winners);
    EXPECT_EQ(bench.work.frozen.size(), bench.mesh.n_vertices());
    expect_sound(bench.mesh, bench.work);
    if (!one)
      one = bench.mesh;
    else
      EXPECT_TRUE(identical(*one, bench.mesh)) << threads << " threads";
  }
}

TEST(Round, FewSeedsThatAreDearAreSharedByTheirParts) {
  using Op = VertexInsertion<VolumeLength>;
  std::size_t n_winners = 0;
  for (const std::size_t n_seeds : {1U, 2U, 5U, 20U, 60U}) {
    std::optional<TetMesh> one;
    for (const int threads : {1, 2, 3, 7}) {
      Bench bench(0.45, n_seeds);
      std::vector<Op::Seed> seeds;
      for (std::size_t i = 0; i < n_seeds; ++i) seeds.emplace_back(C(i * bench.mesh.n_cells() / n_seeds));
      Round<Op> round(bench.mesh, bench.work, {{threads, 1000}, true, 1});
      const RoundCounts counts = round.run(Op{{}, bench.work.quality}, seeds);
      EXPECT_EQ(counts.seeds, n_seeds);
      expect_sound(bench.mesh, bench.work);
      if (!one) {
        one = bench.mesh;
        n_winners += counts.winners;
      }
      EXPECT_TRUE(identical(*one, bench.mesh)) << threads << " threads";
    }
  }
  EXPECT_GT(n_winners, 10U);
}

TEST(Round, SmoothingMayRunInRoundsToo) {
  Bench bench(0.4, 2);
  const SmoothCandidates<VolumeLength> op{{}, bench.work.quality, bench.work.frozen};
  const auto seeds = vertex_seeds(bench.mesh, bench.everything(), bench.work.frozen, {});
  const auto tets = tets_of(bench.mesh);
  Round<SmoothCandidates<VolumeLength>> round(bench.mesh, bench.work, {{3, 1}, true, 1});
  EXPECT_GT(round.run(op, seeds).winners, 3U);
  EXPECT_TRUE(tets_of(bench.mesh) == tets);
  expect_sound(bench.mesh, bench.work);
}

/// Edge, face and node rounds in turn, then one of all kinds, until little is left to do.
TetMesh run_rounds(double jitter, std::uint64_t seed, par::Policy policy, std::size_t* winners) {
  Bench bench(jitter, seed);
  *winners = 0;
  const auto run = [&](const auto& op, const auto& seeds) {
    const double before = *std::min_element(bench.work.quality.begin(), bench.work.quality.end());
    Round<std::remove_cvref_t<decltype(op)>> round(bench.mesh, bench.work, {policy, true, 9});
    *winners += round.run(op, std::span(seeds)).winners;
    expect_sound(bench.mesh, bench.work);
    EXPECT_GE(*std::min_element(bench.work.quality.begin(), bench.work.quality.end()), before);
  };
  for (int i = 0; i < 4; ++i) {
    run(EdgeRemoval<VolumeLength>{{}, bench.work.quality},
        edge_seeds(bench.mesh, bench.everything(), policy));
    run(FaceSwap<VolumeLength>{{}, bench.work.quality}, face_seeds(bench.mesh, bench.everything(), policy));
    run(VertexCollapse<VolumeLength>{{}, bench.work.quality, bench.work.frozen},
        vertex_seeds(bench.mesh, bench.everything(), bench.work.frozen, policy));
    run(edge_face_or_node(bench.work), seeds_of_all_kinds(bench));
  }
  return bench.mesh;
}

TEST(Round, SameBitsForAnyNumberOfThreads) {
  for (const double jitter : {0.3, 0.6}) {
    std::size_t winners = 0;
    const TetMesh one = run_rounds(jitter, 4, {1, 1}, &winners);
    EXPECT_GT(winners, 100U);
    for (const int threads : {2, 3, 7}) {
      std::size_t others = 0;
      EXPECT_TRUE(identical(one, run_rounds(jitter, 4, {threads, 1}, &others))) << threads << " threads";
      EXPECT_EQ(others, winners);
    }
  }
}

TEST(Round, IncidentCellsOfTouchedVerticesAreTheSmallestCellMade) {
  Bench bench(0.35, 6);
  const TetMesh before = bench.mesh;
  Round<EdgeRemoval<VolumeLength>> round(bench.mesh, bench.work, {{3, 1}, true, 1});
  round.run({{}, bench.work.quality}, edge_seeds(bench.mesh, bench.everything(), {}));
  std::map<VertexHandle, CellHandle> smallest;
  for (CellHandle c : bench.mesh.cells()) {
    if (c.idx() < before.n_cells() && before.cell(c).v == bench.mesh.cell(c).v) continue;
    for (VertexHandle v : bench.mesh.cell(c).v) smallest.try_emplace(v, c);
  }
  EXPECT_GT(smallest.size(), 20U);
  for (VertexHandle v : before.vertices()) {
    const auto at = smallest.find(v);
    EXPECT_EQ(bench.mesh.incident_cell(v), at == smallest.end() ? before.incident_cell(v) : at->second);
  }
}

TEST(Round, ChangeStampsAndPendingBitsMarkWhatWasWritten) {
  Bench bench(0.35, 7);
  const TetMesh before = bench.mesh;
  std::fill(bench.work.pending.begin(), bench.work.pending.end(), 0);
  const std::uint32_t clock = bench.work.clock;
  Round<EdgeRemoval<VolumeLength>> round(bench.mesh, bench.work, {{}, true, 1});
  ASSERT_GT(round.run({{}, bench.work.quality}, edge_seeds(bench.mesh, bench.everything(), {})).winners, 10U);
  std::set<VertexHandle> touched;
  for (CellHandle c : bench.mesh.cells()) {
    const bool is_new = c.idx() >= before.n_cells() || before.cell(c).v != bench.mesh.cell(c).v;
    EXPECT_EQ(bench.work.pending[c.idx()] != 0, is_new);
    if (is_new) touched.insert(bench.mesh.cell(c).v.begin(), bench.mesh.cell(c).v.end());
  }
  for (VertexHandle v : bench.mesh.vertices())
    EXPECT_EQ(bench.work.changed[v.idx()] > clock, touched.contains(v));
}

/// Two folded bipyramids on the same two apexes, 3 and 4: swapping both would make the edge 3-4 twice.
TetMesh twin_bipyramids() {
  const double s = std::sqrt(0.75);
  std::vector<Vec3> points = {{1, 0, 0}, {-0.5, s, 0}, {-0.5, -s, 0}, {0, 0, 0.2}, {0, 0, -0.2}};
  for (int i = 0; i < 3; ++i) points.push_back(1.2 * points[static_cast<std::size_t>(i)]);
  return build(points, std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 1, 4}, {5, 6, 7, 3}, {5, 7, 6, 4}});
}

TEST(Round, TwoWinnersNeverMakeTheSameEdge) {
  for (const bool check_links : {true, false}) {  // all cells are positive, and the apexes pinched
    TetMesh mesh = twin_bipyramids();
    Workspace work;
    work.attach(mesh, {});
    work.set_qualities(mesh, VolumeLength{}, {});
    const Worklist list(mesh, {}, [](CellHandle) { return true; });
    Round<FaceSwap<VolumeLength>> round(mesh, work, {{}, check_links, 1});
    const RoundCounts counts = round.run({{}, work.quality}, face_seeds(mesh, list, {}));
    EXPECT_EQ(counts.candidates, 2U);
    EXPECT_EQ(counts.winners, 1U);
    EXPECT_EQ(ring_size(mesh, V(3), V(4)), 3U);
    EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
  }
}

TEST(Round, EdgeOfAPartThatNoFaceConnectsIsNotMadeAgain) {
  for (const bool check_links : {true, false}) {
    TetMesh twins = twin_bipyramids();
    const std::vector<Vec3> points(twins.points().begin(), twins.points().end());
    TetMesh mesh = build(points, std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 1, 4}, {5, 6, 4, 3}});
    Workspace work;
    work.attach(mesh, {});
    work.set_qualities(mesh, VolumeLength{}, {});
    const Worklist list(mesh, {}, [](CellHandle) { return true; });
    Round<FaceSwap<VolumeLength>> round(mesh, work, {{}, check_links, 1});
    EXPECT_EQ(round.run({{}, work.quality}, face_seeds(mesh, list, {})).winners, 0U);
    EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
  }
}

Damage damage_of(const TetMesh& mesh) {
  Damage damage;
  for (CellHandle c : mesh.cells()) damage.add(mesh, c);
  return damage;
}

/// Rounds of one kind over tangled boxes, whose cells are on integers so that some are flat. Returns the
/// number of winners.
template <class MakeOp, class Seeds>
std::size_t expect_no_more_damage(MakeOp&& make_op, Seeds&& seeds_of) {
  std::size_t winners = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    TetMesh mesh = jittered(4, 0.9, seed);
    for (VertexHandle v : mesh.vertices()) {
      const Vec3 p = mesh.point(v);
      mesh.set_point(v, {std::round(12 * p.x), std::round(12 * p.y), std::round(12 * p.z)});
    }
    Workspace work;
    work.attach(mesh, {});
    for (int i = 0; i < 4; ++i) {
      auto op = make_op(work);
      work.set_qualities(mesh, op.metric, {});
      const Damage before = damage_of(mesh);
      Round<decltype(op)> round(mesh, work, {{}, true, seed});
      const Worklist list(mesh, {}, [](CellHandle) { return true; });
      winners += round.run(op, seeds_of(mesh, list, work)).winners;
      const Damage after = damage_of(mesh);
      EXPECT_LE(after.n_inverted(), before.n_inverted());
      EXPECT_LE(after.n_invalid(), before.n_invalid());
      const bool fewer = after.n_inverted() < before.n_inverted();
      EXPECT_TRUE(fewer || after.overlap() <= before.overlap() * (1 + 1e-12));
    }
    EXPECT_EQ(check(mesh), Ok);
  }
  return winners;
}

TEST(Round, InvertedAndFlatCellsNeverBecomeMore) {
  const auto edges = [](const TetMesh& mesh, const Worklist& list, const Workspace&) {
    return edge_seeds(mesh, list, {});
  };
  const auto faces = [](const TetMesh& mesh, const Worklist& list, const Workspace&) {
    return face_seeds(mesh, list, {});
  };
  const auto vertices = [](const TetMesh& mesh, const Worklist& list, const Workspace& work) {
    return vertex_seeds(mesh, list, work.frozen, {});
  };
  EXPECT_GT(expect_no_more_damage(
                [](Workspace& w) {
                  return EdgeRemoval<VolumeLength>{{}, w.quality};
                },
                edges),
            100U);
  EXPECT_GT(expect_no_more_damage(
                [](Workspace& w) {
                  return EdgeRemoval<Untangling>{{1e-3}, w.quality};
                },
                edges),
            100U);
  EXPECT_GT(expect_no_more_damage(
                [](Workspace& w) {
                  return FaceSwap<MinSine2>{{}, w.quality};
                },
                faces),
            50U);
  EXPECT_GT(expect_no_more_damage(
                [](Workspace& w) {
                  return VertexCollapse<VolumeLength>{{}, w.quality, w.frozen};
                },
                vertices),
            10U);
  EXPECT_GT(expect_no_more_damage(
                [](Workspace& w) {
                  return SmoothCandidates<VolumeLength>{{}, w.quality, w.frozen};
                },
                vertices),
            50U);
}

TEST(Round, NothingToDoChangesNothing) {
  Bench bench(0.0, 1);
  const TetMesh before = bench.mesh;
  Round<FaceSwap<VolumeLength>> round(bench.mesh, bench.work, {{}, true, 1});
  const RoundCounts counts = round.run({{}, bench.work.quality}, std::span<const HalfFaceHandle>());
  EXPECT_EQ(counts.seeds + counts.candidates + counts.winners, 0U);
  EXPECT_TRUE(identical(before, bench.mesh));
}

}  // namespace
}  // namespace hfr::test
