// SPDX-License-Identifier: BSD-3-Clause
// An operator that the library does not know, written against the contract alone.
#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/FaceSwap.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/Seeds.hh"

namespace hfr::test {
namespace {

/// 2-3 swaps, but only of faces with all corners within a ball.
struct SwapInBall : FaceSwap<VolumeLength> {
  Vec3 centre;
  double radius = 0;

  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const {
    for (VertexHandle v : mesh.halfface_vertices(seed))
      if (norm(mesh.point(v) - centre) > radius) return std::nullopt;
    return FaceSwap::evaluate(mesh, seed);
  }
};
static_assert(LocalOperator<SwapInBall>);

/// Splits a cell into four at its middle: makes more cells than it takes and a vertex.
struct SplitCell {
  using Seed = CellHandle;
  struct Plan : PlanBase {
    CellHandle seed;
    Vec3 middle;
  };
  VolumeLength metric;

  void scope(const TetMesh&, Seed seed, Scope& out) const {
    out.clear();
    out.push_back(seed);
  }
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const {
    Plan plan;
    plan.seed = seed;
    plan.old_worst = 0;
    plan.new_worst = 1;  // wanted for its own sake
    plan.n_dead = 1;
    plan.n_born = 4;
    plan.adds_vertex = true;
    for (VertexHandle v : mesh.cell(seed).v) plan.middle = plan.middle + 0.25 * mesh.point(v);
    return plan;
  }
  void commit(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    out.clear();
    out.dead.push_back(plan.seed);
    for (int k = 0; k < 4; ++k) {
      const auto f = mesh.halfface_vertices(halfface_of(plan.seed, k));
      out.born.push_back({f[0], f[1], f[2], Cavity::kNewVertex});
    }
    out.new_vertex = plan.middle;
  }
  Tet identity(const TetMesh& mesh, Seed seed) const { return sorted(mesh.cell(seed).v); }
};
static_assert(LocalOperator<SplitCell>);

struct NoIdentity {
  using Seed = CellHandle;
  struct Plan : PlanBase {
    CellHandle seed;
  };
  VolumeLength metric;
  void scope(const TetMesh&, Seed, Scope&) const;
  std::optional<Plan> evaluate(const TetMesh&, Seed) const;
  void commit(const TetMesh&, const Plan&, Cavity&) const;
};
static_assert(!LocalOperator<NoIdentity>);

struct PlanThatAllocates {
  using Seed = CellHandle;
  struct Plan : PlanBase {
    CellHandle seed;
    std::vector<int> more;
  };
  VolumeLength metric;
  void scope(const TetMesh&, Seed, Scope&) const;
  std::optional<Plan> evaluate(const TetMesh&, Seed) const;
  void commit(const TetMesh&, const Plan&, Cavity&) const;
  Tet identity(const TetMesh&, Seed) const;
};
static_assert(!LocalOperator<PlanThatAllocates>);

TEST(OwnOperator, SwapsOnlyInItsBall) {
  TetMesh mesh = jittered(6, 0.4, 1);
  const TetMesh before = mesh;
  Workspace work;
  work.attach(mesh, {});
  work.set_qualities(mesh, VolumeLength{}, {});
  SwapInBall op;
  op.quality = work.quality;
  op.centre = {0.5, 0.5, 0.5};
  op.radius = 0.4;
  const Worklist list(mesh, {}, [](CellHandle) { return true; });
  Round<SwapInBall> round(mesh, work, {{3, 1}, true, 1});
  const RoundCounts counts = round.run(op, face_seeds(mesh, list, {}));
  EXPECT_GT(counts.winners, 5U);
  ASSERT_EQ(check(mesh), Ok);
  std::size_t outside = 0;
  for (std::size_t i = 0; i < before.n_cells(); ++i) {
    bool far = false;
    int near = 0;
    for (VertexHandle v : before.cell(C(i)).v) near += norm(before.point(v) - op.centre) <= op.radius ? 1 : 0;
    far = near < 3;
    if (!far) continue;
    ++outside;
    EXPECT_EQ(before.cell(C(i)).v, mesh.cell(C(i)).v);
  }
  EXPECT_GT(outside, 300U);
}

TEST(OwnOperator, SplitsEveryCellOfABoxInOneRound) {
  TetMesh one;
  for (const int threads : {1, 2, 3, 7}) {
    TetMesh mesh = integer_box(3, 0.2, 1);
    const Int128 volume = exact_volume6(mesh);
    const std::size_t n = mesh.n_cells();
    const std::size_t n_vertices = mesh.n_vertices();
    Workspace work;
    work.attach(mesh, {});
    work.set_qualities(mesh, VolumeLength{}, {});
    std::vector<CellHandle> seeds;
    for (CellHandle c : mesh.cells()) seeds.push_back(c);
    Round<SplitCell> round(mesh, work, {{threads, 1}, false, 1});
    EXPECT_EQ(round.run(SplitCell{}, seeds).winners, n);
    ASSERT_EQ(check(mesh), Ok);
    EXPECT_EQ(mesh.n_cells(), 4 * n);
    EXPECT_EQ(mesh.n_vertices(), n_vertices + n);
    // Quarters of integers: four times the coordinates are integers again.
    for (VertexHandle v : mesh.vertices()) mesh.set_point(v, 4.0 * mesh.point(v));
    EXPECT_TRUE(exact_volume6(mesh) == 64 * volume);
    if (threads == 1)
      one = mesh;
    else
      EXPECT_TRUE(identical(one, mesh)) << threads << " threads";
  }
}

}  // namespace
}  // namespace hfr::test
