// SPDX-License-Identifier: BSD-3-Clause
// An operator that the library does not know, written against the contract alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <ranges>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "Operators/Clusters.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/LimitMeshes.hh"
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
    plan.n_removed = 1;
    plan.n_created = 4;
    plan.adds_vertex = true;
    for (VertexHandle v : mesh.cell(seed).v) plan.middle = plan.middle + 0.25 * mesh.point(v);
    return plan;
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    out.clear();
    out.removed.push_back(plan.seed);
    for (int k = 0; k < 4; ++k) {
      const auto f = mesh.halfface_vertices(halfface_of(plan.seed, k));
      out.created.push_back({f[0], f[1], f[2], Cavity::kNewVertex});
    }
    out.new_vertex = plan.middle;
  }
  Tet identity(const TetMesh& mesh, Seed seed) const { return sorted(mesh.cell(seed).v); }
};
static_assert(LocalOperator<SplitCell>);

/// Takes all cells of a vertex and makes the same again. A plan may say that it takes fewer, or makes more.
struct RewriteStar {
  using Seed = VertexHandle;
  struct Plan : PlanBase {
    VertexHandle seed;
  };
  VolumeLength metric;
  std::uint32_t n_hidden = 0, n_invented = 0;

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const {
    out.clear();
    for (CellHandle c : mesh.vertex_cells(seed)) out.push_back(c);
  }
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const {
    const auto n = static_cast<std::uint32_t>(std::ranges::distance(mesh.vertex_cells(seed)));
    Plan plan;
    plan.seed = seed;
    plan.old_worst = 0.1;
    plan.new_worst = 1;
    plan.n_removed = n - n_hidden;
    plan.n_created = n + n_invented;
    return plan;
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    out.clear();
    for (CellHandle c : mesh.vertex_cells(plan.seed)) {
      out.removed.push_back(c);
      out.created.push_back(mesh.cell(c).v);
    }
  }
  Tet identity(const TetMesh&, Seed seed) const {
    return {seed, VertexHandle(), VertexHandle(), VertexHandle()};
  }
};
static_assert(LocalOperator<RewriteStar>);

struct NoIdentity {
  using Seed = CellHandle;
  struct Plan : PlanBase {
    CellHandle seed;
  };
  VolumeLength metric;
  void scope(const TetMesh&, Seed, Scope&) const;
  std::optional<Plan> evaluate(const TetMesh&, Seed) const;
  void cavity(const TetMesh&, const Plan&, Cavity&) const;
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
  void cavity(const TetMesh&, const Plan&, Cavity&) const;
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

/// A round on vertex 0, the middle of a star of 2n cells. True where it throws the error, and then has left
/// mesh and workspace as they were.
template <class Error>
bool throws(const RewriteStar& op, Index n, par::Policy policy) {
  TetMesh mesh = built(hub(n));
  const TetMesh before = mesh;
  Workspace work;
  work.attach(mesh, policy);
  work.set_qualities(mesh, VolumeLength{}, policy);
  Round<RewriteStar> round(mesh, work, {policy, false, 1});
  const std::vector<VertexHandle> seeds = {V(0)};
  bool thrown = false;
  try {
    EXPECT_EQ(round.run(op, seeds).winners, 1U);
  } catch (const Error&) {
    thrown = true;
  }
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(identical(mesh, before));
  EXPECT_EQ(std::ranges::count(work.claim, kUnclaimed), static_cast<std::ptrdiff_t>(mesh.n_cells()));
  return thrown;
}

TEST(OwnOperator, ScopeOf256CellsIsWrittenAndOneOfMoreIsAnErrorThatChangesNothing) {
  for (const par::Policy policy : {par::Policy{1, 1}, par::Policy{4, 1}}) {
    EXPECT_FALSE(throws<Error>({}, 128, policy));
    EXPECT_TRUE(throws<ResourceLimit>({}, 129, policy));
    EXPECT_TRUE(throws<ResourceLimit>({}, 400, policy)) << "more than a cavity holds";
  }
}

TEST(OwnOperator, PlanThatCreatesMoreThan512CellsIsAnErrorThatChangesNothing) {
  RewriteStar op;
  op.n_invented = Cavity::kCapacity - 64 + 1;
  EXPECT_TRUE(throws<ResourceLimit>(op, 32, {}));
}

TEST(OwnOperator, PlanThatRemovesOtherCellsThanItsScopeHasIsAnErrorThatChangesNothing) {
  RewriteStar op;
  op.n_hidden = 1;
  EXPECT_TRUE(throws<InvalidInput>(op, 32, {}));
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

/// Splits an edge of the boundary at its middle, with all its cells.
struct SplitBoundaryEdge {
  using Seed = EdgeHandle;
  struct Plan : PlanBase {
    EdgeHandle seed;
  };
  VolumeLength metric;

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const {
    out.clear();
    for (CellHandle c : mesh.edge_cells(seed)) out.push_back(c);
  }
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const {
    Plan plan;
    plan.seed = seed;
    plan.new_worst = 1;  // wanted for its own sake
    for (CellHandle c : mesh.edge_cells(seed)) plan.n_removed += c.is_valid() ? 1 : 0;
    plan.n_created = 2 * plan.n_removed;
    plan.adds_vertex = true;
    return plan;
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    out.clear();
    const auto [a, b] = mesh.edge_vertices(plan.seed);
    for (CellHandle c : mesh.edge_cells(plan.seed)) out.removed.push_back(c);
    for (CellHandle c : out.removed)
      for (VertexHandle end : {a, b}) {
        Tet half = mesh.cell(c).v;
        std::replace(half.begin(), half.end(), end, Cavity::kNewVertex);
        out.created.push_back(half);
      }
    out.new_vertex = 0.5 * (mesh.point(a) + mesh.point(b));
  }
  Tet identity(const TetMesh& mesh, Seed seed) const { return edge_identity(mesh, seed); }
};
static_assert(LocalOperator<SplitBoundaryEdge>);

/// A box whose boundary faces are labelled by their side, 1 to 6.
TetMesh box_with_labelled_sides(Index n) {
  TetMesh mesh = built(generate::box({n, n, n}));
  for (HalfFaceHandle h : mesh.halffaces()) {
    if (!mesh.is_boundary(h)) continue;
    const auto f = mesh.halfface_vertices(h);
    for (int i = 0; i < 3; ++i)
      for (const double side : {0.0, 1.0})
        if (mesh.point(f[0])[i] == side && mesh.point(f[1])[i] == side && mesh.point(f[2])[i] == side)
          mesh.labels().faces.set(f, 1 + 2 * i + static_cast<int>(side));
  }
  return mesh;
}

void expect_sides_labelled(const TetMesh& mesh) {
  std::size_t n = 0;
  for (HalfFaceHandle h : mesh.halffaces()) {
    if (!mesh.is_boundary(h)) continue;
    ++n;
    const auto f = mesh.halfface_vertices(h);
    const int* const label = mesh.labels().faces.find(f);
    ASSERT_NE(label, nullptr);
    const int i = (*label - 1) / 2;
    const double side = (*label - 1) % 2;
    for (VertexHandle v : f) EXPECT_EQ(mesh.point(v)[i], side);
  }
  EXPECT_EQ(mesh.labels().faces.size(), n) << "and nothing else is labelled";
}

std::vector<EdgeHandle> boundary_edges(const TetMesh& mesh) {
  std::vector<EdgeHandle> edges;
  for (EdgeHandle e : mesh.edges())
    if (mesh.is_boundary(e)) edges.push_back(e);
  return edges;
}

TEST(OwnOperator, FacesOfSplitBoundaryEdgesInheritTheirLabels) {
  TetMesh one;
  for (const int threads : {1, 2, 5}) {
    TetMesh mesh = box_with_labelled_sides(4);
    const double before = volume(mesh);
    const std::size_t n_labels = mesh.labels().faces.size();
    Workspace work;
    work.attach(mesh, {});
    std::size_t winners = 0;
    for (int i = 0; i < 4; ++i) {
      work.set_qualities(mesh, VolumeLength{}, {});
      Round<SplitBoundaryEdge> round(mesh, work, {{threads, 1}, true, 1});
      winners += round.run(SplitBoundaryEdge{}, boundary_edges(mesh)).winners;
      ASSERT_EQ(check(mesh), Ok);
      expect_sides_labelled(mesh);
    }
    EXPECT_GT(winners, 200U);
    EXPECT_EQ(mesh.labels().faces.size(), n_labels + 2 * winners);
    EXPECT_NEAR(volume(mesh), before, 1e-12);
    for (VertexHandle v : mesh.vertices())
      EXPECT_EQ(work.frozen[v.idx()] != 0, mesh.is_boundary(v)) << "a new vertex of the surface must stay";
    if (threads == 1)
      one = mesh;
    else
      EXPECT_TRUE(identical(one, mesh));
  }
}

TEST(OwnOperator, ByItselfASplitKeepsLabelsToo) {
  TetMesh mesh = box_with_labelled_sides(2);
  for (EdgeHandle e : boundary_edges(mesh)) {
    if (mesh.is_deleted(C(e.idx() / 6)) || !mesh.exists(e) || !mesh.is_boundary(e)) continue;
    EXPECT_TRUE(apply(SplitBoundaryEdge{}, mesh, e));
    ASSERT_EQ(check(mesh), Ok);
  }
  expect_sides_labelled(mesh);
}

TEST(OwnOperator, FixedFacesAndEdgesAreNotSplit) {
  TetMesh mesh = box_with_labelled_sides(2);
  mesh.set_fixed_patch(1);
  std::size_t n_split = 0;
  for (EdgeHandle e : boundary_edges(mesh)) {
    if (!mesh.exists(e) || !mesh.is_boundary(e)) continue;
    const auto [a, b] = mesh.edge_vertices(e);
    const bool on_patch = mesh.point(a).x == 0 && mesh.point(b).x == 0;
    const bool done = apply(SplitBoundaryEdge{}, mesh, e);
    EXPECT_EQ(done, !on_patch);
    n_split += done ? 1 : 0;
  }
  EXPECT_GT(n_split, 10U);
  expect_sides_labelled(mesh);
}

/// The 2-2 swap of a flat pair of boundary faces, which no new vertex cuts.
struct SwapOnBoundary {
  using Seed = EdgeHandle;
  struct Plan : PlanBase {
    EdgeHandle seed;
  };
  VolumeLength metric;

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const {
    out.clear();
    for (CellHandle c : mesh.edge_cells(seed)) out.push_back(c);
  }
  std::optional<Plan> evaluate(const TetMesh&, Seed seed) const {
    Plan plan;
    plan.seed = seed;
    plan.new_worst = 1;
    plan.n_removed = plan.n_created = 2;
    return plan;
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    Scope cells;
    scope(mesh, plan.seed, cells);
    const auto [a, b] = mesh.edge_vertices(plan.seed);
    out.clear();
    for (CellHandle c : cells) out.removed.push_back(c);
    VertexHandle far;
    for (VertexHandle v : mesh.cell(cells[1]).v)
      if (!mesh.cell(cells[0]).has(v)) far = v;
    for (VertexHandle end : {a, b}) {
      Tet t = mesh.cell(cells[0]).v;
      std::replace(t.begin(), t.end(), end, far);
      out.created.push_back(t);
    }
  }
  Tet identity(const TetMesh& mesh, Seed seed) const { return edge_identity(mesh, seed); }
};

TEST(OwnOperator, LabelledFacesThatNothingInheritsFromDoNotGo) {
  for (const bool labelled : {false, true}) {
    TetMesh mesh = build({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
                         std::vector<Corners>{{0, 2, 1, 4}, {0, 1, 3, 4}});
    if (labelled) mesh.labels().faces.set({V(0), V(1), V(2)}, 5);
    EXPECT_EQ(apply(SwapOnBoundary{}, mesh, mesh.find_edge(V(0), V(1))), !labelled);
    EXPECT_EQ(check(mesh), Ok);
  }
}

}  // namespace
}  // namespace hfr::test
