// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartSearch.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "Distributed/CutoutRound.hh"
#include "Distributed/Labelled.hh"
#include "Distributed/Parts.hh"
#include "Operators/ClusterSearch.hh"
#include "Remesh/PassState.hh"
#include "Scheduler/Round.hh"

namespace hfr::test {
namespace {

struct Effort {
  double degrees = 12;
  std::uint64_t max_points = 14, max_nodes = 300;
  std::uint8_t depth = 2;
  double gain = 1.02;
};

RoundCounts search(Whole& w, const Effort& effort) {
  using Op = ClusterSearch<MinSine2>;
  std::vector<Op::Seed> seeds;
  for (CellHandle c : w.mesh.cells())
    if (w.work.quality[c.idx()] < dihedral_decision(effort.degrees)) seeds.emplace_back(c);
  RoundOptions options;
  options.check_links = false;
  Round<Op> round(w.mesh, w.work, options);
  const Op op{MinSine2{}, w.work.quality, effort.gain, effort.max_points, effort.max_nodes};
  return round.run(op, seeds);
}

RoundCounts search(mpi::DistributedMesh& m, const Effort& effort) {
  const double below = dihedral_decision(effort.degrees);
  const Worklist list(m.part(), {}, [&](CellHandle c) { return m.work().quality[c.idx()] < below; });
  const Ranks::Search search{{PassKind::kCluster, Metric::kMinSine, below, 0, 1, kNoLimit, kNoLimit},
                             effort.gain,
                             effort.max_points,
                             effort.max_nodes};
  return mpi::search_in_parts(m, search, list, effort.depth);
}

TEST(PartSearch, RoundsAreThoseOfSharedMemory) {
  for (const std::uint8_t depth : {1, 2})
    expect_same_for_parts(valid_box(6, 0.45, depth), MinSine2{}, 3, 20,
                          [&](auto& m) { return search(m, {.degrees = 10, .depth = depth}); });
}

/// Regions are no clusters of their own, and what is labelled stays.
TEST(PartSearch, RoundsAreThoseOfSharedMemoryWhereThingsAreLabelledOrFixed) {
  const TetMesh input = io::assemble(labelled(valid_box(6, 0.45, 3), 3, {}));
  ASSERT_TRUE(input.has_regions());
  ASSERT_FALSE(input.labels().faces.empty());
  expect_same_for_parts(input, MinSine2{}, 2, 20, [](auto& m) { return search(m, {}); });
}

/// Joins the two tips of a double cone, kTop and kBottom, whose bases are the triangles of vertices 2 to 4
/// and 5 to 7, at any price.
struct JoinTips {
  static constexpr Index kTop = 0, kBottom = 1, kCluster = 8;  // the cluster has the first vertices
  using Seed = CellSeed;
  struct Plan : PlanBase {
    Seed seed;
  };
  MinSine2 metric;

  void scope(const TetMesh& mesh, const Seed&, Scope& out) const {
    out.clear();
    for (CellHandle c : mesh.cells())
      if (std::ranges::all_of(mesh.cell(c).v, [](VertexHandle v) { return v.idx() < kCluster; }))
        out.push_back(c);
  }
  std::optional<Plan> evaluate(const TetMesh&, const Seed& seed) const {
    Plan plan;
    plan.seed = seed;
    plan.n_removed = 6;
    plan.n_created = 9;
    plan.old_worst = 0.1;
    plan.new_worst = 0.2;
    return plan;
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    out.clear();
    Scope cells;
    scope(mesh, plan.seed, cells);
    for (CellHandle c : cells) out.removed.push_back(c);
    for (Index i = 0; i < 3; ++i) {
      const VertexHandle top(kTop), bottom(kBottom), a(2 + i), next_a(2 + (i + 1) % 3), b(5 + i),
          last_b(5 + (i + 2) % 3);
      for (Tet t : {Tet{top, bottom, a, next_a}, Tet{bottom, a, b, next_a}, Tet{bottom, a, last_b, b}}) {
        if (orientation(mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2]), mesh.point(t[3])) < 0)
          std::swap(t[2], t[3]);
        out.created.push_back(t);
      }
    }
  }
  Tet identity(const TetMesh& mesh, const Seed& seed) const {
    Tet names = mesh.cell(seed.cell).v;
    std::sort(names.begin(), names.end());
    return names;
  }
};
static_assert(LocalOperator<JoinTips>);

/// A double cone: a tip over a triangle, an octahedron between two triangles, a tip under the other. On each
/// tip stand three more cells, of which the last has no other vertex of the cone.
TetMesh double_cone() {
  std::vector<Vec3> points = {{0, 0, 0.5}, {0, 0, -0.5}};
  for (const double half : {0.0, 1.0})
    for (int i = 0; i < 3; ++i) {
      const double angle = (2 * i + half) * 1.0471975511965976;
      points.push_back({std::cos(angle), std::sin(angle), half > 0 ? -0.2 : 0.2});
    }
  std::vector<std::array<Index, 4>> cells = {{0, 2, 3, 4}, {1, 5, 6, 7}};
  const std::array<Index, 4> ring = {3, 5, 7, 4};  // round the diagonal from 2 to 6
  for (std::size_t i = 0; i < 4; ++i) cells.push_back({2, 6, ring[i], ring[(i + 1) % 4]});
  for (const Index tip : {Index{0}, Index{1}}) {
    const Index base = tip == 0 ? 2 : 5, first = static_cast<Index>(points.size());
    const double up = tip == 0 ? 1 : -1;
    points.insert(points.end(), {{0.9, 0.9, 0.8 * up}, {0.9, -0.1, 1.4 * up}, {0.1, 0.2, 2 * up}});
    cells.push_back({tip, base, base + 1, first});
    cells.push_back({tip, base, first, first + 1});
    cells.push_back({tip, first, first + 1, first + 2});
  }
  for (auto& c : cells)
    if (orientation(points[c[0]], points[c[1]], points[c[2]], points[c[3]]) < 0) std::swap(c[2], c[3]);
  return build(points, cells);
}

/// A cluster may join vertices that were more than two edges apart, and bring near what hangs on them: what
/// does so at the upper tip belongs to another rank than what does at the lower one, and neither has known of
/// the other.
TEST(PartSearch, PartsAreBroughtNearOverAnEdgeThatNoneHasSeenBefore) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Whole whole(double_cone(), MinSine2{});
  Whole cut = whole;
  std::vector<int> owner(whole.mesh.n_vertices(), 0);
  owner[JoinTips::kTop] = 1 % comm.size();
  owner.back() = 2 % comm.size();
  mpi::DistributedMesh parts(comm);
  parts.scatter(&cut.mesh, &cut.work, owner);
  expect_part_of(parts, whole);
  const std::vector<JoinTips::Seed> seeds = {JoinTips::Seed(C(2))};
  RoundOptions options;
  options.check_links = false;
  EXPECT_EQ(Round<JoinTips>(whole.mesh, whole.work, options).run({}, seeds).winners, 1U);
  EXPECT_EQ(check(whole.mesh), Ok);
  const std::uint64_t seed = 2;
  const Ranks::Look look{PassKind::kCluster, Metric::kMinSine, 1, 0, 1, kNoLimit, kNoLimit};
  const auto counts =
      mpi::round_on_cutout(parts, look, std::span(&seed, 1), 2, [](mpi::Cutout&) { return JoinTips{}; });
  EXPECT_EQ(counts.winners, 1U);
  expect_part_of(parts, whole);
  gather_from_nothing(parts, cut);
  if (comm.rank() == 0) expect_same(whole, cut);
}

/// A search that comes to the rim is done again with more layers: that costs calls, and nothing else.
TEST(PartSearch, IsTheSameHoweverManyLayersAreTriedFirst) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const Whole input(valid_box(6, 0.45, 5), MinSine2{});
  std::optional<Whole> expected;
  std::vector<std::uint64_t> n_calls;
  for (const std::uint8_t depth : {6, 1}) {
    Whole cut = input;
    const auto owner =
        mpi::partition(comm, comm.rank() == 0 ? &cut.mesh : nullptr, mpi::Partition::kCoordinates);
    mpi::DistributedMesh parts(comm);
    parts.scatter(&cut.mesh, &cut.work, owner);
    const std::uint64_t before = comm.n_calls();
    EXPECT_GT(search(parts, {.depth = depth}).winners, 10U);
    n_calls.push_back(comm.n_calls() - before);
    gather_from_nothing(parts, cut);
    if (comm.rank() != 0) continue;
    EXPECT_EQ(check(cut.mesh), Ok);
    if (expected)
      expect_same(*expected, cut);
    else
      expected = std::move(cut);
  }
  EXPECT_LT(n_calls[0], n_calls[1]) << "no search has come to the rim";
}

/// Whatever does not come to the rim is what it is in the whole; with enough layers nothing does.
TEST(PartSearch, WhatStaysOffTheRimIsThatOfTheWhole) {
  using Op = ClusterSearch<MinSine2>;
  mpi::Comm comm(MPI_COMM_WORLD);
  Whole whole(valid_box(6, 0.45, 9), MinSine2{});
  mpi::DistributedMesh parts(comm);
  {
    Whole cut = whole;
    parts.scatter(&cut.mesh, &cut.work,
                  mpi::partition(comm, comm.rank() == 0 ? &cut.mesh : nullptr, mpi::Partition::kNumbers));
  }
  std::array<std::uint64_t, 6> n_met{}, n_same{};
  for (const std::uint8_t depth : {1, 2, 5})
    for (std::uint64_t i = 0; i < whole.mesh.n_cells(); i += 29) {
      mpi::Cutout cutout(parts, std::span(&i, 1), std::span(&depth, 1));
      if (cutout.centres().empty()) continue;
      const CellHandle seed = cutout.cell_at(i);
      const Op here{MinSine2{}, cutout.work().quality, 1.02, 14, 300, &cutout.rim()};
      const auto found = here.evaluate(cutout.mesh(), Op::Seed(seed));
      if (cutout.rim().has_met[seed.idx()] != 0) {
        ++n_met[depth];
        continue;
      }
      const Op there{MinSine2{}, whole.work.quality, 1.02, 14, 300};
      const auto expected = there.evaluate(whole.mesh, Op::Seed(CellHandle(i)));
      ASSERT_EQ(found.has_value(), expected.has_value());
      if (!found) continue;
      ++n_same[depth];
      EXPECT_EQ(found->new_worst, expected->new_worst);
      Cavity mine, theirs;
      here.cavity(cutout.mesh(), *found, mine);
      there.cavity(whole.mesh, *expected, theirs);
      ASSERT_EQ(mine.removed.size(), theirs.removed.size());
      for (std::size_t k = 0; k < mine.removed.size(); ++k)
        EXPECT_EQ(cutout.number(mine.removed[k]), theirs.removed[k].idx());
      ASSERT_EQ(mine.created.size(), theirs.created.size());
      for (std::size_t k = 0; k < mine.created.size(); ++k)
        for (std::size_t j = 0; j < 4; ++j)
          EXPECT_EQ(cutout.number(mine.created[k][j]), theirs.created[k][j].idx());
    }
  comm.sum(n_met);
  comm.sum(n_same);
  EXPECT_GT(n_met[1], 0U);
  EXPECT_GE(n_met[1], n_met[2]);
  EXPECT_EQ(n_met[5], 0U);
  EXPECT_GT(n_same[2], 10U);
}

}  // namespace
}  // namespace hfr::test
