// SPDX-License-Identifier: BSD-3-Clause
// Each fixed capacity of the operators with what it just holds, and with one more.
#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "Operators/ClusterSearch.hh"
#include "Operators/FanMerge.hh"
#include "Operators/GrownCells.hh"
#include "Operators/LimitMeshes.hh"
#include "Operators/Metrics.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/Smooth.hh"
#include "Operators/StarForm.hh"
#include "Operators/StarFromVertex.hh"
#include "Operators/Unfold.hh"
#include "Operators/VertexCollapse.hh"

namespace hfr::test {
namespace {

std::vector<HalfFaceHandle> link_of(const TetMesh& mesh, VertexHandle v) {
  std::vector<HalfFaceHandle> link;
  for (CellHandle c : mesh.vertex_cells(v)) link.push_back(halfface_of(c, mesh.cell(c).corner(v)));
  return link;
}

TEST(Capacities, StarFormHoldsMoreThan256Cells) {
  Engine engine(8);
  for (const Index n : {Index{128}, Index{129}, Index{300}}) {  // of 2n cells
    TetMesh mesh = built(hub(n));
    mesh.set_point(V(0), {0.1, -0.2, 0.4});
    const auto link = link_of(mesh, V(0));
    StarForm star(mesh, V(0), link);
    ASSERT_EQ(star.size(), 2 * n);
    for (int trial = 0; trial < 10; ++trial) {
      const Vec3 x = random_point(engine, -0.3, 0.3);
      double m_max = 0, worst = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < star.size(); ++i) {
        const double form = hfr_star_decision(star.cell(i), to_kernel(x));
        EXPECT_NEAR(form, quality_with(mesh, cell_of(link[i]), V(0), mesh.point(V(0)) + x, VolumeLength{}),
                    1e-9);
        worst = std::min(worst, form);
        m_max = std::max(m_max, hfr_star_m(star.cell(i), to_kernel(x)));
      }
      EXPECT_EQ(star.largest_m(to_kernel(x), std::numeric_limits<double>::infinity()), m_max);
      StarForm::Trials at_x, at_y, at_z, found;
      at_x.fill(x.x);
      at_y.fill(x.y);
      at_z.fill(x.z);
      star.worst(at_x, at_y, at_z, worst - 1, found);
      EXPECT_EQ(found[0], worst);
      star.worst(at_x, at_y, at_z, worst + 1, found);
      EXPECT_LE(found[0], worst + 1);
      if (!(worst > 0)) continue;
      double xx = 0;
      for (std::size_t i = 0; i < star.size(); ++i)
        xx += hfr_star_newton(star.cell(i), to_kernel(x), m_max).xx;
      EXPECT_EQ(star.newton(to_kernel(x), m_max).xx, xx);
    }
  }
}

TEST(Capacities, VertexOfMoreThan256CellsIsUnfolded) {
  for (const Index n : {Index{128}, Index{129}, Index{300}}) {
    TetMesh mesh = built(hub(n));
    mesh.set_point(V(0), {1.4, 0.3, -0.4});
    ASSERT_GT(n_inverted(mesh), 10U);
    mesh.set_point(V(0), mesh.point(V(0)) + unfold(StarForm(mesh, V(0), link_of(mesh, V(0))), 40));
    EXPECT_EQ(n_inverted(mesh), 0U) << n;
  }
}

TEST(Capacities, StarOf256CellsIsRemovedAndOneOf258LeftAlone) {
  for (const Index n : {Index{128}, Index{129}}) {
    TetMesh mesh = built(hub(n));
    mesh.set_point(V(0), {0.02, 0.01, 1.49});  // all but in vertex 2, above
    const auto quality = qualities(mesh, VolumeLength{});
    const auto frozen = constrained_vertices(mesh);
    const VertexCollapse<VolumeLength> removal{{}, quality, frozen};
    const StarFromVertex<Cluster::kNode, VolumeLength> star{{}, quality, frozen, false};
    const CellHandle incident_cell = mesh.incident_cell(V(0));
    const auto corner = static_cast<std::uint8_t>(mesh.cell(incident_cell).corner(V(0)));
    const auto plan = removal.evaluate(mesh, V(0));
    const auto same = star.evaluate(mesh, {incident_cell, corner});
    ASSERT_EQ(plan.has_value(), n == 128);
    ASSERT_EQ(same.has_value(), n == 128);
    if (!plan) continue;
    EXPECT_EQ(plan->n_removed, 256U);
    cavity_of(star, mesh, *same);
    replace(mesh, cavity_of(removal, mesh, *plan));
    EXPECT_EQ(check(mesh), Ok);
  }
}

TEST(Capacities, RingOf256CellsFitsAStarFromVertexAndOneOf257DoesNot) {
  for (const std::size_t n : {256U, 257U}) {
    std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      points.push_back({std::cos(angle), std::sin(angle), 0});
    }
    const TetMesh mesh = spindle(points);
    const auto quality = qualities(mesh, VolumeLength{});
    const std::vector<std::uint8_t> frozen(mesh.n_vertices(), 0);
    const StarFromVertex<Cluster::kEdge, VolumeLength> op{{}, quality, frozen, true};
    Scope scope;
    op.scope(mesh, {C(0), 0}, scope);
    EXPECT_EQ(scope.size(), n == 256 ? 256U : 0U);
    const auto plan = op.evaluate(mesh, {C(0), 0});
    EXPECT_TRUE(n == 256 || !plan);
    if (plan) cavity_of(op, mesh, *plan);
  }
}

TEST(Capacities, CavityOf512CellsIsReplacedByAsMany) {
  TetMesh mesh = jittered(5, 0.2, 1);
  const auto before = tets_of(mesh);
  Cavity cavity;
  for (std::size_t c = 0; c < Cavity::kCapacity; ++c) {
    cavity.removed.push_back(C(c + 100));
    cavity.created.push_back(mesh.cell(C(c + 100)).v);
  }
  EXPECT_TRUE(cavity.removed.full());
  Star scratch;
  EXPECT_EQ(created_simplices(mesh, cavity).size(), 0U);
  EXPECT_TRUE(admissible(mesh, cavity, false, scratch));
  admissible(mesh, cavity, true, scratch);
  replace(mesh, cavity);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(tets_of(mesh) == before);
}

TEST(Capacities, CavityOf513CellsIsAnErrorInEveryBuild) {
  Cavity cavity;
  for (std::size_t c = 0; c < Cavity::kCapacity; ++c) {
    cavity.removed.push_back(C(c));
    cavity.created.push_back({V(0), V(1), V(2), V(3)});
  }
  EXPECT_THROW(cavity.removed.push_back(C(Cavity::kCapacity)), ResourceLimit);
  EXPECT_THROW(cavity.created.push_back({V(0), V(1), V(2), V(3)}), ResourceLimit);
  EXPECT_THROW(cavity.removed.resize(Cavity::kCapacity + 1), ResourceLimit);
  EXPECT_EQ(cavity.removed.size(), Cavity::kCapacity);
  EXPECT_EQ(cavity.created.size(), Cavity::kCapacity);
}

TEST(Capacities, LabelsOf32FacesAreInheritedAndThoseOf33Refused) {
  for (const Index n : {Index{32}, Index{33}}) {
    // n cells by themselves, each cut into three by a vertex on its labelled face.
    std::vector<Vec3> points;
    std::vector<Corners> cells;
    for (Index i = 0; i < n; ++i) {
      const double x = 2.0 * i;
      for (const Vec3 p : {Vec3{x, 0, 0}, Vec3{x + 1, 0, 0}, Vec3{x, 1, 0}, Vec3{x, 0, 1}})
        points.push_back(p);
      cells.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    }
    TetMesh mesh = build(points, cells);
    Cavity cavity;
    cavity.new_vertex = Vec3{0.3, 0.3, 0};
    for (CellHandle c : mesh.cells()) {
      const Tet t = mesh.cell(c).v;
      mesh.labels().faces.set({t[0], t[1], t[2]}, static_cast<int>(c.idx()) + 1);
      cavity.removed.push_back(c);
      for (std::size_t k = 0; k < 3; ++k) {
        cavity.created.push_back(t);
        cavity.created[cavity.created.size() - 1][k] = Cavity::kNewVertex;
      }
    }
    Heirs heirs;
    EXPECT_EQ(find_heirs(mesh, cavity, heirs), n == 32) << n;
    EXPECT_EQ(heirs.size(), kMostHeirs);
    Star scratch;
    EXPECT_FALSE(n == 33 && admissible(mesh, cavity, false, scratch));
  }
}

TEST(Capacities, MoreThan512NewEdgesAreAllListed) {
  TetMesh mesh = jittered(8, 0.2, 1);
  Cavity cavity;
  cavity.removed.push_back(C(0));
  for (Index i = 0; i < 100; ++i)
    cavity.created.push_back({V(4 * i), V(4 * i + 1), V(4 * i + 2), V(4 * i + 3)});
  std::set<Simplex> listed;
  for (const Simplex& simplex : created_simplices(mesh, cavity)) listed.insert(simplex);
  const Tet removed = mesh.cell(C(0)).v;
  std::size_t n_edges = 0;
  for (const Tet& t : cavity.created)
    for (const auto& e : kEdgeCorners) {
      const auto has = [&](VertexHandle v) {
        return std::find(removed.begin(), removed.end(), v) != removed.end();
      };
      if (has(t[e[0]]) && has(t[e[1]])) continue;
      ++n_edges;
      EXPECT_TRUE(listed.contains({t[e[0]], t[e[1]], VertexHandle()}));
    }
  EXPECT_GT(n_edges, 590U);
}

TEST(Capacities, CellsGrowTo64AndNotBeyond) {
  const TetMesh mesh = jittered(5, 0.2, 2);
  GrownCells cells(mesh, C(300));
  for (std::size_t i = 0; i < cells.outer().size();
       i = cells.cells().size() < 64 ? i + 1 : cells.outer().size())
    if (cells.grow(cells.outer()[i])) i = static_cast<std::size_t>(-1);
  ASSERT_EQ(cells.cells().size(), Growth::kMaxCells);
  for (std::size_t i = 0; i < cells.outer().size(); ++i) EXPECT_FALSE(cells.grow(cells.outer()[i]));
  Scope scope;
  cells.growth().cells(mesh, scope);
  EXPECT_TRUE(std::ranges::equal(scope, cells.cells()));
}

/// Apexes 0 above and 1 below n triangles of a fan about a corner of a polygon.
TetMesh thin_lens(Index n) {
  std::vector<Vec3> points = {{0, 0, 0.02}, {0, 0, -0.02}};
  for (Index i = 0; i < n + 2; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n + 2);
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  std::vector<Corners> cells;
  for (Index i = 0; i < n; ++i) {
    cells.push_back({2, i + 3, i + 4, 0});
    cells.push_back({i + 3, 2, i + 4, 1});
  }
  return build(points, cells);
}

TEST(Capacities, ThirtyFacesAreRemovedTogetherAndNoMore) {
  std::size_t most = 0;
  for (const Index n : {Index{29}, Index{30}, Index{31}, Index{60}}) {
    const TetMesh mesh = thin_lens(n);
    const auto quality = qualities(mesh, MinSine2{});
    const MultiFaceRemoval<MinSine2> op{{}, quality};
    for (HalfFaceHandle h : all_faces(mesh)) {
      if (mesh.is_boundary(h)) continue;
      const auto plan = op.evaluate(mesh, typename MultiFaceRemoval<MinSine2>::Seed(h));
      if (!plan) continue;
      cavity_of(op, mesh, *plan);
      most = std::max<std::size_t>(most, plan->n_removed / 2);
    }
  }
  EXPECT_LE(most, FaceTree::kMaxFaces);
  EXPECT_GE(most, 20U) << "the lens no longer asks for many faces at once";
}

TEST(Capacities, RowsOfCellsRoundAnEdgeEndAtThirteen) {
  std::size_t most = 0;
  for (const Index k : {Index{12}, Index{13}, Index{14}, Index{40}, Index{70}}) {
    std::vector<Vec3> points = {{0, 0, -0.7}, {0, 0, 0.7}};
    for (Index i = 0; i <= k; ++i) {  // one stands all but behind the one before
      const bool behind = i == k / 2;
      const double angle = 1.8 * static_cast<double>(behind ? i - 1 : i) / static_cast<double>(k);
      const double radius = behind ? 1.2 : 1;
      points.push_back({radius * std::cos(angle), radius * std::sin(angle) + (behind ? 1e-9 : 0), 0});
    }
    std::vector<Corners> cells;
    for (Index i = 0; i < k; ++i) cells.push_back({0, 1, i + 2, i + 3});
    const TetMesh mesh = build(points, cells);
    const auto quality = qualities(mesh, MinSine2{});
    const FanMerge<MinSine2> op{{}, quality};
    for (CellHandle c : mesh.cells()) {
      const auto plan = op.evaluate(mesh, {c, 0, 0, 0});
      if (!plan) continue;
      cavity_of(op, mesh, *plan);
      most = std::max<std::size_t>(most, plan->n_removed);
    }
  }
  EXPECT_LE(most, 13U);
  EXPECT_GE(most, 3U);
}

TEST(Capacities, ClusterSearchAskedForMoreThan32PointsTakes32) {
  const TetMesh mesh = jittered(4, 0.4, 3);
  const auto quality = qualities(mesh, VolumeLength{});
  using Op = ClusterSearch<VolumeLength>;
  const auto search = [&](std::size_t points, CellHandle c) {
    return Op{{}, quality, 1.02, points, 400}.evaluate(mesh, typename Op::Seed(c));
  };
  std::size_t n = 0, most = 0;
  for (std::size_t i = 0; i < mesh.n_cells(); i += 7) {
    const auto at = search(32, C(i));
    const auto beyond = search(33, C(i));
    const auto far_beyond = search(1000, C(i));
    ASSERT_EQ(at.has_value(), beyond.has_value());
    ASSERT_EQ(at.has_value(), far_beyond.has_value());
    if (!at) continue;
    EXPECT_EQ(at->new_worst, beyond->new_worst);
    EXPECT_EQ(at->new_worst, far_beyond->new_worst);
    cavity_of(Op{{}, quality, 1.02, 32, 400}, mesh, *at);
    most = std::max<std::size_t>(most, at->n_removed);
    ++n;
  }
  EXPECT_GT(n, 3U);
  EXPECT_GT(most, 10U);
}

}  // namespace
}  // namespace hfr::test
