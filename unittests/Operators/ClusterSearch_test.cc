// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/ClusterSearch.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<ClusterSearch<MinSine2>>);
static_assert(LocalOperator<ClusterSearch<VolumeLength>>);

template <class Metric>
using Seed = typename ClusterSearch<Metric>::Seed;

/// Every filling of a set of cells by positive cells on the same vertices, one after the other: no bound, no
/// order, no test for crossings.
template <class Metric>
class Oracle {
 public:
  Oracle(const TetMesh& mesh, const std::vector<CellHandle>& cells, const Metric& metric)
      : mesh_(mesh), metric_(metric) {
    std::set<VertexHandle> vertices;
    for (CellHandle c : cells) vertices.insert(mesh.cell(c).v.begin(), mesh.cell(c).v.end());
    vertices_.assign(vertices.begin(), vertices.end());
    for (const auto& f : outer_faces(mesh, cells)) open_.insert(turned(f));
    fill(std::numeric_limits<double>::infinity());
  }

  double best() const { return best_; }
  int n_fillings() const { return n_fillings_; }

 private:
  using Face = std::array<VertexHandle, 3>;
  static Face turned(Face f) {
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    return f;
  }
  void fill(double worst) {
    if (open_.empty()) {
      ++n_fillings_;
      best_ = std::max(best_, worst);
      return;
    }
    const Face f = *open_.begin();
    for (VertexHandle v : vertices_) {
      if (v == f[0] || v == f[1] || v == f[2]) continue;
      const Tet t = {f[0], f[1], f[2], v};
      const double q = quality_of(mesh_, t, metric_);
      if (!(q > 0)) continue;
      std::set<Face> open = open_;
      std::set<Face> used = used_;
      bool fits = true;
      for (const auto& k : kFaceCorners) {
        const Face inside = turned({t[k[0]], t[k[1]], t[k[2]]});
        fits = fits && used_.insert(inside).second;
        const Face outside = turned({inside[0], inside[2], inside[1]});
        if (open_.erase(inside) == 0) fits = open_.insert(outside).second && fits;
      }
      if (fits) fill(std::min(worst, q));
      open_ = open;
      used_ = used;
    }
  }

  const TetMesh& mesh_;
  const Metric& metric_;
  std::vector<VertexHandle> vertices_;
  std::set<Face> open_, used_;
  double best_ = -std::numeric_limits<double>::infinity();
  int n_fillings_ = 0;
};

std::vector<CellHandle> all_cells(const TetMesh& mesh) {
  const auto range = mesh.cells();
  return {range.begin(), range.end()};
}

template <class Metric>
class ClusterSearchMetrics : public testing::Test {};
using AllMetrics = testing::Types<VolumeLength, MinSine2, MinDihedral>;
TYPED_TEST_SUITE(ClusterSearchMetrics, AllMetrics);

TYPED_TEST(ClusterSearchMetrics, EveryFillingOfASpindleIsFound) {
  const TypeParam metric;
  Engine engine(7);
  int accepted = 0;
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const TetMesh mesh = random_spindle(3 + engine() % 4, engine);
    const auto quality = qualities(mesh, metric);
    if (n_inverted(mesh) > 0) continue;
    const Oracle<TypeParam> oracle(mesh, all_cells(mesh), metric);
    ASSERT_GE(oracle.n_fillings(), 1);
    ClusterSearch<TypeParam> op{metric, quality};
    op.max_nodes = 100000;
    const CellHandle seed(engine() % mesh.n_cells());
    const auto plan = op.evaluate(mesh, Seed<TypeParam>(seed));
    if (!plan) {
      ++refused;
      EXPECT_LE(oracle.best(), (1 + 2e-9) * *std::min_element(quality.begin(), quality.end()));
      continue;
    }
    ++accepted;
    Scope scope;
    op.scope(mesh, plan->seed, scope);
    const std::vector<CellHandle> cells(scope.begin(), scope.end());
    const Oracle<TypeParam> of_cavity(mesh, cells, metric);
    // Cells are valued in another order of corners here.
    EXPECT_NEAR(plan->new_worst, of_cavity.best(), 1e-12);
  }
  EXPECT_GT(accepted, 80);
  EXPECT_GT(refused, 40);
}

TYPED_TEST(ClusterSearchMetrics, BestFillingOfACavityAmongOthersIsFound) {
  const TypeParam metric;
  int accepted = 0;
  int many = 0;
  for (std::uint64_t s = 1; s <= 80; ++s) {
    const TetMesh mesh = jittered(3, 0.24, s);
    if (n_inverted(mesh) > 0) continue;
    const auto quality = qualities(mesh, metric);
    ClusterSearch<TypeParam> op{metric, quality};
    op.max_nodes = 100000;
    op.max_points = 8;
    for (CellHandle c : mesh.cells()) {
      const auto plan = op.evaluate(mesh, Seed<TypeParam>(c));
      if (!plan) continue;
      Scope scope;
      op.scope(mesh, plan->seed, scope);
      const Oracle<TypeParam> oracle(mesh, {scope.begin(), scope.end()}, metric);
      EXPECT_NEAR(plan->new_worst, oracle.best(), 1e-12);
      ++accepted;
      many += oracle.n_fillings() > 3 ? 1 : 0;
    }
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(many, 20);
}

TYPED_TEST(ClusterSearchMetrics, AcceptedCavitiesKeepTheMeshWhole) {
  const TypeParam metric;
  int accepted = 0;
  int large = 0;
  for (std::uint64_t s = 1; s <= 8; ++s) {
    TetMesh mesh = integer_box(4, s % 2 == 0 ? 0.24 : 0.35, s);
    const auto boundary = boundary_of(mesh);
    const Int128 volume = exact_volume6(mesh);
    auto quality = qualities(mesh, metric);
    for (std::size_t i = 0; i < 384; i += 2) {
      if (mesh.is_deleted(C(i))) continue;
      const double worst = *std::min_element(quality.begin(), quality.end());
      const ClusterSearch<TypeParam> op{metric, quality, 1.0 + 1e-9, 14, 500};
      const auto plan = op.evaluate(mesh, Seed<TypeParam>(C(i)));
      if (!plan) continue;
      cavity_of(op, mesh, *plan);
      EXPECT_GT(plan->new_worst, 0);
      if (!apply(op, mesh, Seed<TypeParam>(C(i)))) continue;
      ++accepted;
      large += plan->n_removed > 6 ? 1 : 0;
      const CheckResult result = check(mesh);
      ASSERT_EQ(result, Ok);
      EXPECT_TRUE(exact_volume6(mesh) == volume);
      EXPECT_TRUE(boundary_of(mesh) == boundary);
      quality = qualities(mesh, metric);
      EXPECT_GE(*std::min_element(quality.begin(), quality.end()), worst);
    }
  }
  EXPECT_GT(accepted, 150);
  EXPECT_GT(large, 50);
}

TEST(ClusterSearch, InterfacesAndLabelledEdgesStay) {
  int accepted = 0;
  for (std::uint64_t s = 1; s <= 6; ++s) {
    TetMesh mesh = jittered(4, 0.24, s);
    for (CellHandle c : mesh.cells()) mesh.set_region(c, mesh.point(mesh.cell(c).v[0]).x > 0.5 ? 1 : 0);
    const auto quality = qualities(mesh, MinSine2{});
    const ClusterSearch<MinSine2> op{{}, quality};
    for (std::size_t i = 0; i < mesh.n_cells(); i += 3) {
      const auto plan = op.evaluate(mesh, Seed<MinSine2>(C(i)));
      if (!plan) continue;
      ++accepted;
      Scope scope;
      op.scope(mesh, plan->seed, scope);
      for (CellHandle d : scope) EXPECT_EQ(mesh.region(d), mesh.region(C(i)));
    }
  }
  EXPECT_GT(accepted, 50);
}

TEST(ClusterSearch, NothingIsGainedNoPlan) {
  const TetMesh mesh = jittered(3, 0.2, 1);
  const std::vector<double> quality(mesh.n_cells(), 0.9);  // better than any cell
  const ClusterSearch<MinSine2> op{{}, quality, 1.0 + 1e-9, 10, 200};
  for (CellHandle c : mesh.cells()) EXPECT_FALSE(op.evaluate(mesh, Seed<MinSine2>(c)));
}

TEST(ClusterSearch, NodesAreBounded) {
  const TetMesh mesh = jittered(5, 0.24, 2);
  const auto quality = qualities(mesh, MinSine2{});
  int with_few = 0;
  int with_many = 0;
  for (std::size_t i = 0; i < mesh.n_cells(); i += 9) {
    ClusterSearch<MinSine2> op{{}, quality};
    op.max_points = 12;
    with_many += op.evaluate(mesh, Seed<MinSine2>(C(i))) ? 1 : 0;
    op.max_nodes = 3;
    with_few += op.evaluate(mesh, Seed<MinSine2>(C(i))) ? 1 : 0;
  }
  EXPECT_GT(with_many, 2 * with_few);
}

}  // namespace
}  // namespace hfr::test
