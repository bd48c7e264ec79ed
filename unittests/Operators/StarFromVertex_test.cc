// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/StarFromVertex.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/VertexCollapse.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<StarFromVertex<Cluster::kEdge, VolumeLength>>);
static_assert(LocalOperator<StarFromVertex<Cluster::kFace, VolumeLength>>);
static_assert(LocalOperator<StarFromVertex<Cluster::kNode, VolumeLength>>);

constexpr double kRounding = 1e-12;  // the same cell in another order of vertices

/// Compares one seed with brute force; true when there is a plan.
template <Cluster kCluster>
bool agrees_with_brute_force(const TetMesh& mesh, const std::vector<double>& quality,
                             const std::vector<std::uint8_t>& frozen,
                             typename StarFromVertex<kCluster, VolumeLength>::Seed seed) {
  const StarFromVertex<kCluster, VolumeLength> op{{}, quality, frozen};
  Scope scope;
  op.scope(mesh, seed, scope);
  if (scope.empty()) {
    EXPECT_FALSE(op.evaluate(mesh, seed));
    return false;
  }
  const std::vector<CellHandle> cells(scope.begin(), scope.end());
  double old_worst = std::numeric_limits<double>::infinity();
  for (CellHandle c : cells) old_worst = std::min(old_worst, quality[c.idx()]);
  const double best = best_star(mesh, cells, VolumeLength{});
  const auto plan = op.evaluate(mesh, seed);
  if (!plan) {
    EXPECT_LE(best, old_worst + kRounding);
    return false;
  }
  EXPECT_NEAR(plan->new_worst, best, kRounding);
  cavity_of(op, mesh, *plan);
  return true;
}

struct Sample {
  TetMesh mesh;
  std::vector<double> quality;
  std::vector<std::uint8_t> frozen;
  explicit Sample(std::uint64_t seed, double jitter = 0.33)
      : mesh(jittered(4, jitter, seed)),
        quality(qualities(mesh, VolumeLength{})),
        frozen(frozen_vertices(mesh)) {}
};

TEST(StarFromVertex, EdgeClustersAgreeWithBruteForceAndNeverBeatEdgeRemoval) {
  int accepted = 0;
  int beaten = 0;
  for (std::uint64_t s = 1; s <= 60; ++s) {
    const Sample sample(s);
    const EdgeRemoval<VolumeLength> strong{{}, sample.quality};
    for (EdgeHandle e : all_edges(sample.mesh)) {
      const StarFromVertex<Cluster::kEdge, VolumeLength>::Seed seed{C(e.idx() / 6),
                                                                    static_cast<std::uint8_t>(e.idx() % 6)};
      if (!agrees_with_brute_force<Cluster::kEdge>(sample.mesh, sample.quality, sample.frozen, seed))
        continue;
      ++accepted;
      const StarFromVertex<Cluster::kEdge, VolumeLength> star{{}, sample.quality, sample.frozen};
      const auto theirs = star.evaluate(sample.mesh, seed);
      const auto ours = strong.evaluate(sample.mesh, e);
      ASSERT_TRUE(ours) << "edge removal contains every fan";
      EXPECT_GE(ours->new_worst, theirs->new_worst - kRounding);
      beaten += ours->new_worst > theirs->new_worst + kRounding ? 1 : 0;
      EXPECT_EQ(star.identity(sample.mesh, seed), strong.identity(sample.mesh, e));
    }
  }
  EXPECT_GT(accepted, 300);
  EXPECT_GT(beaten, 10) << "the optimal triangulation is never better than a fan";
}

TEST(StarFromVertex, FaceClustersAgreeWithBruteForceAndWithTheFaceSwap) {
  int accepted = 0;
  for (std::uint64_t s = 1; s <= 60; ++s) {
    const Sample sample(s, 0.5);
    const StarFromVertex<Cluster::kFace, VolumeLength> star{{}, sample.quality, sample.frozen};
    const FaceSwap<VolumeLength> swap{{}, sample.quality};
    for (HalfFaceHandle h : all_faces(sample.mesh)) {
      const StarFromVertex<Cluster::kFace, VolumeLength>::Seed seed{cell_of(h),
                                                                    static_cast<std::uint8_t>(corner_of(h))};
      if (!agrees_with_brute_force<Cluster::kFace>(sample.mesh, sample.quality, sample.frozen, seed))
        continue;
      ++accepted;
      const auto ours = swap.evaluate(sample.mesh, h);
      ASSERT_TRUE(ours);
      EXPECT_NEAR(ours->new_worst, star.evaluate(sample.mesh, seed)->new_worst, kRounding);
      EXPECT_EQ(star.identity(sample.mesh, seed), swap.identity(sample.mesh, h));
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(StarFromVertex, NodeClustersAgreeWithBruteForceAndWithVertexRemoval) {
  int accepted = 0;
  for (std::uint64_t s = 1; s <= 40; ++s) {
    const Sample sample(s);
    const StarFromVertex<Cluster::kNode, VolumeLength> star{{}, sample.quality, sample.frozen};
    const VertexCollapse<VolumeLength> removal{{}, sample.quality, sample.frozen};
    for (VertexHandle v : all_vertices(sample.mesh)) {
      const CellHandle c = sample.mesh.incident_cell(v);
      const StarFromVertex<Cluster::kNode, VolumeLength>::Seed seed{
          c, static_cast<std::uint8_t>(sample.mesh.cell(c).corner(v))};
      if (sample.frozen[v.idx()]) {
        EXPECT_FALSE(star.evaluate(sample.mesh, seed));
        continue;
      }
      const bool accepts =
          agrees_with_brute_force<Cluster::kNode>(sample.mesh, sample.quality, sample.frozen, seed);
      const auto ours = removal.evaluate(sample.mesh, v);
      EXPECT_EQ(ours.has_value(), accepts);
      if (!accepts) continue;
      ++accepted;
      const auto plan = star.evaluate(sample.mesh, seed);
      EXPECT_NEAR(ours->new_worst, plan->new_worst, kRounding);
      EXPECT_TRUE(plan->removes_vertex);
      EXPECT_EQ(star.identity(sample.mesh, seed), removal.identity(sample.mesh, v));
    }
  }
  EXPECT_GT(accepted, 40);
}

TEST(StarFromVertex, ApexesThatRebuildTheClusterAreNoPlans) {
  // The same cells in another order of vertices are better by the last bit about one time in three.
  for (std::uint64_t s = 1; s <= 3; ++s) {
    const Sample sample(s);
    const StarFromVertex<Cluster::kFace, VolumeLength> star{{}, sample.quality, sample.frozen};
    for (HalfFaceHandle h : all_faces(sample.mesh)) {
      const auto plan = star.evaluate(sample.mesh, {cell_of(h), static_cast<std::uint8_t>(corner_of(h))});
      if (!plan) continue;
      const auto f = sample.mesh.halfface_vertices(h);
      EXPECT_EQ(std::count(f.begin(), f.end(), plan->apex), 0) << "the plan changes nothing";
    }
  }
}

TEST(StarFromVertex, NewVertexInTheMiddleOfAnEdgeClusterJoinsTheMesh) {
  // A long edge in a flat wheel: every cell is thin, the middle is better, no fan is.
  Engine engine(7);
  int accepted = 0;
  for (int trial = 0; trial < 200; ++trial) {
    TetMesh mesh = random_spindle(4 + static_cast<std::size_t>(trial) % 5, engine);
    auto quality = qualities(mesh, VolumeLength{});
    const auto frozen = frozen_vertices(mesh);
    StarFromVertex<Cluster::kEdge, VolumeLength> op{{}, quality, frozen};
    op.insert = true;
    op.reconnect = false;
    const double before = volume(mesh);
    const double worst = worst_quality(mesh, VolumeLength{});
    const auto boundary = boundary_of(mesh);
    const EdgeHandle e = edge_between(mesh, V(0), V(1));
    const std::size_t n = mesh.n_vertices();
    if (!apply(op, mesh, {C(e.idx() / 6), static_cast<std::uint8_t>(e.idx() % 6)})) continue;
    ++accepted;
    ASSERT_EQ(check(mesh), Ok);
    EXPECT_EQ(mesh.n_vertices(), n + 1);
    EXPECT_TRUE(mesh.incident_cell(V(n)).is_valid());
    EXPECT_EQ(mesh.n_logical_cells(), 2 * (n - 2));
    EXPECT_NEAR(volume(mesh), before, 1e-12);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
    EXPECT_GT(worst_quality(mesh, VolumeLength{}), worst);
  }
  EXPECT_GT(accepted, 10);
}

TEST(StarFromVertex, NewVertexIsRefusedWhereCellsWouldStayInverted) {
  // Cutting inverted cells into smaller ones may raise the worst of them and never ends.
  Engine engine(8);
  int mended = 0;
  int refused = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const TetMesh mesh = random_spindle(4 + static_cast<std::size_t>(trial) % 5, engine, 0.5);
    const auto quality = qualities(mesh, VolumeLength{});
    const double worst = *std::min_element(quality.begin(), quality.end());
    if (worst > 0) continue;
    const auto frozen = frozen_vertices(mesh);
    StarFromVertex<Cluster::kEdge, VolumeLength> op{{}, quality, frozen};
    op.insert = true;
    op.reconnect = false;
    const EdgeHandle e = edge_between(mesh, V(0), V(1));
    const auto plan = op.evaluate(mesh, {C(e.idx() / 6), static_cast<std::uint8_t>(e.idx() % 6)});
    ++(plan ? mended : refused);
    EXPECT_TRUE(!plan || plan->new_worst > 0);
  }
  EXPECT_GT(mended, 10);
  EXPECT_GT(refused, 50);
}

TEST(StarFromVertex, WithoutReconnectingOrInsertingNothingIsTried) {
  const Sample sample(1);
  StarFromVertex<Cluster::kFace, VolumeLength> op{{}, sample.quality, sample.frozen};
  op.reconnect = false;
  for (HalfFaceHandle h : all_faces(sample.mesh))
    EXPECT_FALSE(op.evaluate(sample.mesh, {cell_of(h), static_cast<std::uint8_t>(corner_of(h))}));
}

}  // namespace
}  // namespace hfr::test
