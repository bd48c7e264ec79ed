// SPDX-License-Identifier: BSD-3-Clause
// Splits, collapses and exchanges by hand: after each of them the mesh passes check(), and what it became is
// compared with the same done to arrays.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "HalfFace/Check.hh"
#include "HalfFace/Geometry.hh"
#include "HalfFace/Writer.hh"
#include "Meshes.hh"
#include "Oracle.hh"

namespace hfr {
namespace {

using test::vector_of;

double volume_of(const TetMesh& mesh) {
  double sum = 0;
  for (CellHandle c : mesh.cells()) sum += volume(mesh, c);
  return sum;
}

/// The cells as sorted vertices.
std::set<std::array<VertexHandle, 4>> tets(const TetMesh& mesh) {
  std::set<std::array<VertexHandle, 4>> all;
  for (CellHandle c : mesh.cells()) all.insert(AnyOrder::key(mesh.cell(c).v));
  return all;
}

/// All vertices have incident cells where the oracle finds cells, and counting starts anew: low-level
/// writing.
void outdate(TetMesh& mesh) { TetMesh::Writer(mesh).cell(*mesh.cells().begin()); }

TEST(SplitEdge, EveryEdgeOfEveryMeshIsCutWithItsCells) {
  for (const auto& [name, original] : test::suite()) {
    TetMesh mesh = original;
    const double before = volume_of(mesh);
    const Rule worst = check(original).rule;
    const test::Oracle oracle(original);
    for (const auto& [edge, cells] : oracle.edges()) {
      const EdgeHandle e = mesh.find_edge(edge[0], edge[1]);
      if (!e.is_valid()) continue;  // the ring is cut already, or hangs on vertices in several parts
      const std::size_t ring = mesh.edge_cells(e).count();
      const std::size_t n = mesh.n_logical_cells();
      const Vec3 middle = 0.5 * (mesh.point(edge[0]) + mesh.point(edge[1]));
      const VertexHandle m = mesh.split_edge(e);
      EXPECT_EQ(mesh.point(m), middle);
      EXPECT_EQ(mesh.n_logical_cells(), n + ring);
      EXPECT_EQ(mesh.vertex_cells(m).count(), 2 * ring);
      ASSERT_TRUE(check(mesh, {.last = Rule::kDuplicateEdge})) << name << " " << check(mesh);
      if (mesh.n_cells() > 2000) break;
    }
    EXPECT_NEAR(volume_of(mesh), before, 1e-12);
    EXPECT_EQ(check(mesh).rule, worst) << name;
  }
}

TEST(SplitFaceAndCell, AllOfThemOfEveryMesh) {
  for (const auto& [name, original] : test::suite()) {
    TetMesh mesh = original;
    const double before = volume_of(mesh);
    std::size_t n = mesh.n_logical_cells();
    for (CellHandle c : vector_of(original.cells())) {
      const VertexHandle m = mesh.split_cell(c);
      EXPECT_EQ(mesh.n_logical_cells(), n += 3);
      EXPECT_EQ(mesh.vertex_cells(m).count(), 4U);
    }
    ASSERT_EQ(check(mesh).rule, check(original).rule) << name;
    const test::Oracle oracle(original);
    for (const auto& [face, cells] : oracle.faces()) {
      const FaceHandle f = mesh.find_face(face);
      if (!f.is_valid()) continue;
      const VertexHandle m =
          mesh.split_face(f, (1.0 / 3) * (mesh.point(face[0]) + mesh.point(face[1]) + mesh.point(face[2])));
      EXPECT_EQ(mesh.n_logical_cells(), n += 2 * cells.size());
      EXPECT_EQ(mesh.is_boundary(m), cells.size() == 1);
    }
    EXPECT_EQ(check(mesh).rule, check(original).rule) << name;
    EXPECT_NEAR(volume_of(mesh), before, 1e-12);
  }
}

TEST(SplitEdge, UsesFreedSlotsAndARingOfAnySize) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<test::Corners> cells;
  constexpr Index kRing = 300;  // more than a Ring and a Star hold
  for (Index i = 0; i < kRing; ++i) {
    const double angle = 6.283185307179586 * i / kRing;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % kRing});
  }
  TetMesh mesh = build(points, cells);
  mesh.delete_cell(CellHandle(17));
  mesh.split_edge(mesh.find_edge(VertexHandle(0), VertexHandle(1)));
  EXPECT_EQ(mesh.n_cells(), 2 * kRing - 2);
  EXPECT_EQ(mesh.n_logical_cells(), mesh.n_cells());
  EXPECT_EQ(check(mesh), Ok);
}

/// A box with everything attached that can be.
struct Attached {
  explicit Attached(TetMesh m) : mesh(std::move(m)) {
    for (FaceHandle f : mesh.boundary_faces()) mesh.labels().faces.set(mesh.face_vertices(f), 7);
    for (CellHandle c : mesh.cells()) mesh.set_region(c, mesh.point(mesh.cell(c).v[0]).x < 0.4 ? 1 : 2);
    for (CellHandle c : mesh.cells()) stress[c] = mesh.region(c) + 0.5;
    for (HalfFaceHandle h : mesh.halffaces()) flux.set(mesh, h, 3.0);
    for (HalfEdgeHandle e : mesh.halfedges())
      sign.set(mesh, e, mesh.from_vertex(e) < mesh.to_vertex(e) ? 1 : -1);
  }
  void expect_right() {
    for (FaceHandle f : mesh.faces())
      EXPECT_EQ(mesh.labels().faces.find(mesh.face_vertices(f)) != nullptr, mesh.is_boundary(f));
    for (CellHandle c : mesh.cells()) EXPECT_EQ(stress[c], mesh.region(c) + 0.5);
    EXPECT_EQ(check(mesh), Ok) << check(mesh);
  }
  TetMesh mesh;
  CellProperty<double> stress = mesh.request_cell_property<double>("stress", -1);
  HalfFaceProperty<double> flux = mesh.request_halfface_property<double>("flux", -1);
  HalfEdgeProperty<int> sign = mesh.request_halfedge_property<int>("sign", 0);
};

TEST(Splits, KeepLabelsLocksRegionsAndProperties) {
  Attached box(test::kuhn_box(2));
  TetMesh& mesh = box.mesh;
  const auto e = vector_of(mesh.boundary_edges()).front();
  const auto ends = mesh.edge_vertices(e);
  mesh.labels().edges.set({ends[1], ends[0]}, 4);
  mesh.set_fixed(e);
  const VertexHandle m = mesh.split_edge(e, mesh.point(ends[0]));
  EXPECT_EQ(*mesh.labels().edges.find({ends[0], m}), 4);
  EXPECT_EQ(*mesh.labels().edges.find({m, ends[1]}), 4);
  EXPECT_EQ(mesh.labels().edges.entries()[0].vertices, (std::array{ends[1], m}))
      << "the first part keeps the direction and the place in the order";
  EXPECT_EQ(mesh.labels().edges.size(), 2U);
  EXPECT_EQ(mesh.locks().edges.size(), 2U);
  EXPECT_EQ(box.sign.get({ends[0], m}), ends[0] < ends[1] ? 1 : -1);
  EXPECT_EQ(box.sign.get({m, ends[0]}), ends[0] < ends[1] ? -1 : 1);
  box.expect_right();

  const FaceHandle f = vector_of(mesh.boundary_faces()).back();
  const auto corners = mesh.face_vertices(f);
  mesh.set_fixed(f);
  const std::size_t n_labels = mesh.labels().faces.size();
  const VertexHandle n = mesh.split_face(f);
  EXPECT_EQ(mesh.labels().faces.size(), n_labels + 2);
  EXPECT_EQ(mesh.locks().faces.size(), 3U);
  EXPECT_EQ(box.flux.get({n, corners[1], corners[2]}), 3.0);
  EXPECT_EQ(box.flux.get({n, corners[2], corners[1]}), -1.0) << "there is no half-face on that side";
  box.expect_right();
  mesh.split_cell(vector_of(mesh.cells()).back());
  box.expect_right();
}

TEST(Splits, OfOneFanLeaveTheLabelToTheOthers) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  TetMesh mesh = build(points, std::vector<test::Corners>{{0, 1, 2, 3}, {0, 1, 4, 5}});
  const std::array edge = {VertexHandle(0), VertexHandle(1)};
  mesh.labels().edges.set(edge, 4);
  mesh.set_fixed(mesh.find_edge(edge[0], edge[1]));
  const VertexHandle m = mesh.split_edge(mesh.find_edge(edge[0], edge[1]));
  ASSERT_EQ(mesh.n_logical_cells(), 3U);
  // Which of the cells is cut goes by the incident cell of the ends.
  const CellHandle whole(mesh.cell(CellHandle(0)).has(edge[0]) && mesh.cell(CellHandle(0)).has(edge[1]) ? 0
                                                                                                        : 1);
  const EdgeHandle other = mesh.edge_in_cell(
      whole, static_cast<int>(
                 kEdgeOfCorners[mesh.cell(whole).own_corner(edge[0])][mesh.cell(whole).own_corner(edge[1])]));
  ASSERT_TRUE(mesh.exists(other));
  EXPECT_TRUE(mesh.is_fixed(other));
  ASSERT_TRUE(mesh.labels().edges.find(edge));
  for (VertexHandle end : edge) {
    EXPECT_EQ(*mesh.labels().edges.find({end, m}), 4);
    EXPECT_TRUE(mesh.is_fixed(mesh.find_edge(end, m)));
  }
  // No fan is left with the whole edge once it is cut as well.
  mesh.split_edge(other);
  EXPECT_FALSE(mesh.labels().edges.find(edge));
}

/// Two wedges with a whole fan each round one axle, of so many cells together.
TetMesh two_fans(int n) {
  std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 1}};
  std::vector<test::Corners> cells;
  for (const double start : {0.1, 3.2}) {
    const auto first = static_cast<Index>(points.size());
    for (int i = 0; i <= n / 2; ++i)
      points.push_back({std::cos(start + 2.8 * i / (n / 2)), std::sin(start + 2.8 * i / (n / 2)), 0.5});
    for (int i = 0; i < n / 2; ++i)
      cells.push_back({0, 1, first + static_cast<Index>(i), first + static_cast<Index>(i) + 1});
  }
  return build(points, cells);
}

TEST(Fans, OfOneEdgeAreOneNeighbourAndTwoEdges) {
  for (const int n : {8, 600}) {  // few enough for a star, and too many
    const TetMesh mesh = two_fans(n);
    const VertexHandle hub(0), end(1);
    std::size_t n_end = 0, n_all = 0;
    for (VertexHandle w : mesh.vertex_vertices(hub)) {
      n_end += w == end ? 1U : 0U;
      ++n_all;
    }
    if (n > 256) {
      EXPECT_EQ(n_end, 1U) << n;
      EXPECT_EQ(n_all, mesh.n_vertices() - 1) << n;
    }
    EXPECT_EQ(mesh.valence(hub), n_all) << n;
    const EdgeHandle one(6 * 0 + kEdgeOfCorners[0][1]),
        two(6 * static_cast<Index>(n / 2) + kEdgeOfCorners[0][1]);
    ASSERT_TRUE(mesh.exists(one) && mesh.exists(two));
    for (FaceHandle f : mesh.edge_faces(one)) {
      EXPECT_TRUE(mesh.is_incident(f, one));
      EXPECT_FALSE(mesh.is_incident(f, two)) << "a face of the other fan";
    }
  }
}

TEST(Splits, NewVertexHasTheDataOfTheNearest) {
  TetMesh mesh = test::single_cell();
  auto heat = mesh.request_vertex_property<int>("heat", 0);
  for (VertexHandle v : mesh.vertices()) heat[v] = static_cast<int>(v.idx()) + 1;
  mesh.set_fixed(VertexHandle(1));
  const EdgeHandle e = mesh.find_edge(VertexHandle(0), VertexHandle(1));
  const VertexHandle m = mesh.split_edge(e, Vec3{0.9, 0, 0});
  EXPECT_EQ(heat[m], 2);
  EXPECT_FALSE(mesh.is_fixed(m));
  EXPECT_THROW(mesh.split_cell(CellHandle(9)), InvalidInput);
  EXPECT_THROW(mesh.split_edge(EdgeHandle(6 * 9)), InvalidInput);
  EXPECT_THROW(mesh.split_face(FaceHandle(4 * 9)), InvalidInput);
}

TEST(Collapse, OfASplitEdgeGivesTheMeshBack) {
  for (const bool written : {false, true}) {
    TetMesh mesh = test::kuhn_box(3);
    const TetMesh before = mesh;
    const test::Oracle oracle(before);
    for (const auto& [edge, cells] : oracle.edges()) {
      const VertexHandle m = mesh.split_edge(mesh.find_edge(edge[0], edge[1]));
      if (written) outdate(mesh);
      ASSERT_EQ(mesh.collapse_edge(mesh.find_halfedge(m, edge[0])), edge[0]);
      ASSERT_EQ(check(mesh), Ok) << check(mesh);
      ASSERT_EQ(mesh.n_logical_cells(), before.n_cells());
    }
    EXPECT_EQ(tets(mesh), tets(before));
    EXPECT_EQ(mesh.n_logical_vertices(), before.n_vertices());
  }
}

TEST(Collapse, WhatEdgesComeToHaveIsTheirsAndNotThatOfOneThatIsGone) {
  TetMesh mesh = test::kuhn_box(1);
  auto p = mesh.request_edge_property<int>("p", -1);
  const EdgeHandle e = *mesh.edges().begin();
  const auto [a, b] = mesh.edge_vertices(e);
  p[std::array{a, b}] = 1;
  const VertexHandle m = mesh.split_edge(e);
  p[std::array{m, b}] = 2;
  ASSERT_EQ(mesh.collapse_edge(mesh.find_halfedge(m, a)), a);
  EXPECT_EQ((p[std::array{a, b}]), 2) << "the edge from the middle goes along";

  // An edge at the end that has none of its own keeps the default.
  mesh = test::kuhn_box(1);
  auto q = mesh.request_edge_property<int>("q", -1);
  const VertexHandle n = mesh.split_edge(*mesh.edges().begin());
  for (VertexHandle x : mesh.vertex_vertices(n)) q[std::array{n, x}] = 5;
  std::vector<std::array<VertexHandle, 2>> there, come;
  for (VertexHandle x : mesh.vertex_vertices(a)) there.push_back({a, x});
  for (VertexHandle x : mesh.vertex_vertices(n))
    if (x != a && !mesh.find_edge(a, x).is_valid()) come.push_back({a, x});
  ASSERT_EQ(mesh.collapse_edge(mesh.find_halfedge(n, a)), a);
  ASSERT_FALSE(come.empty());
  for (const auto& edge : come) EXPECT_EQ(q[edge], 5);
  std::erase_if(there, [&](const auto& edge) { return edge[1] == n; });
  for (const auto& edge : there) EXPECT_EQ(q[edge], -1);
}

/// The collapse done to arrays and built anew; nothing when build() or check() refuses it.
bool is_manifold_after(const TetMesh& mesh, VertexHandle v, VertexHandle w, int genus, std::size_t boundary) {
  std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
  std::vector<test::Corners> cells;
  for (CellHandle c : mesh.cells()) {
    test::Corners corners;
    for (std::size_t k = 0; k < 4; ++k) {
      const VertexHandle u = mesh.cell(c).v[k];
      corners[k] = (u == v ? w : u).idx();
    }
    if (!(mesh.cell(c).has(v) && mesh.cell(c).has(w))) cells.push_back(corners);
  }
  try {
    TetMesh built = build(points, cells);
    built.delete_vertex(v);
    built.collect_garbage({.drop_unused_vertices = true});
    return check(built) && built.genus() == genus && built.boundary_faces().count() == boundary;
  } catch (const InvalidInput&) {
    return false;
  }
}

TEST(Collapse, AcceptedWhereTheArraysStayAManifoldOfTheSameShape) {
  std::size_t accepted = 0, refused = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    TetMesh mesh = seed % 2 == 0 ? test::kuhn_box(2) : test::carved_ball(5);
    mesh.collect_garbage({.drop_unused_vertices = true});  // they count in genus()
    for (std::uint64_t step = 0; step < 60 && mesh.n_logical_cells() > 1; ++step) {
      const auto all = vector_of(mesh.halfedges());
      const HalfEdgeHandle e =
          all[static_cast<std::size_t>(generate::random_unit(seed, step) * static_cast<double>(all.size()))];
      const auto [v, w] = mesh.halfedge_vertices(e);
      std::size_t boundary = mesh.boundary_faces().count();
      if (mesh.is_boundary(e)) boundary -= 2;
      if (step % 7 == 0) outdate(mesh);
      const bool ok = mesh.is_collapse_ok(e);
      if (ok) {
        EXPECT_TRUE(is_manifold_after(mesh, v, w, mesh.genus(), boundary)) << seed << " " << step;
      }
      const std::size_t n = mesh.n_logical_cells() - (ok ? mesh.edge_cells(mesh.edge_handle(e)).count() : 0);
      EXPECT_EQ(mesh.collapse_edge(e), ok ? w : VertexHandle());
      EXPECT_EQ(mesh.is_deleted(v), ok);
      EXPECT_EQ(mesh.n_logical_cells(), n);
      ASSERT_EQ(check(mesh), Ok) << seed << " " << step << " " << check(mesh);
      ++(ok ? accepted : refused);
    }
  }
  EXPECT_GT(accepted, 100U) << "the walk no longer collapses";
  EXPECT_GT(refused, 10U) << "the walk no longer meets what must not be collapsed";
}

TEST(Collapse, RefusesWhatIsFixedOrLabelledOtherwise) {
  const auto inner = [](TetMesh& mesh) { return mesh.find_halfedge(VertexHandle(13), VertexHandle(12)); };
  TetMesh mesh = test::kuhn_box(2);
  ASSERT_TRUE(mesh.find_halfedge(VertexHandle(13), VertexHandle(12)).is_valid());
  EXPECT_TRUE(mesh.is_collapse_ok(inner(mesh)));
  mesh.set_fixed(VertexHandle(13));
  EXPECT_FALSE(mesh.collapse_edge(inner(mesh)).is_valid());
  mesh.set_fixed(VertexHandle(13), false);
  const EdgeHandle other = mesh.find_edge(VertexHandle(13), VertexHandle(14));
  mesh.set_fixed(other);
  EXPECT_FALSE(mesh.is_collapse_ok(inner(mesh)));
  mesh.set_fixed(other, false);
  mesh.labels().edges.set(mesh.edge_vertices(mesh.edge_handle(inner(mesh))), 1);
  EXPECT_FALSE(mesh.is_collapse_ok(inner(mesh))) << "the only labelled edge would go";
  mesh.labels().edges.set(mesh.edge_vertices(other), 1);
  EXPECT_EQ(mesh.collapse_edge(inner(mesh)), VertexHandle(12));
  ASSERT_EQ(mesh.labels().edges.size(), 1U);
  EXPECT_NE(mesh.labels().edges.find({VertexHandle(12), VertexHandle(14)}), nullptr);
  EXPECT_EQ(check(mesh), Ok) << check(mesh);

  TetMesh labelled = test::kuhn_box(2);
  labelled.labels().vertices.assign(labelled.n_vertices(), 3);
  EXPECT_FALSE(labelled.is_collapse_ok(inner(labelled)));
  TetMesh single = test::single_cell();
  for (HalfEdgeHandle e : vector_of(single.halfedges())) EXPECT_FALSE(single.is_collapse_ok(e));
}

TEST(Collapse, AlongALabelledBoundaryKeepsItLabelled) {
  Attached box(test::kuhn_box(3));
  std::size_t n = 0;
  for (int turn = 0; turn < 12; ++turn) {
    for (HalfEdgeHandle e : vector_of(box.mesh.boundary_halfedges()))
      if (box.mesh.is_collapse_ok(e)) {
        box.mesh.collapse_edge(e);
        ++n;
        break;
      }
    box.expect_right();
  }
  EXPECT_GT(n, 8U);
}

TEST(SwapVertices, ExchangesEverythingButTheShape) {
  TetMesh mesh = test::torn_box(3, 0.6, 4);
  auto heat = mesh.request_vertex_property<int>("heat", 0);
  auto sign = mesh.request_halfedge_property<int>("sign", 0);
  std::vector<Vec3> centres;
  for (CellHandle c : mesh.cells()) centres.push_back(barycenter(mesh, c));
  for (VertexHandle v : mesh.vertices()) heat[v] = static_cast<int>(v.idx());
  const HalfEdgeHandle e = *mesh.halfedges().begin();
  const auto [a, b] = mesh.halfedge_vertices(e);
  sign.set(mesh, e, 5);
  mesh.labels().edges.set({a, b}, 2);
  const Rule rule = check(mesh).rule;
  const VertexHandle far(mesh.n_vertices() - 1);
  const Vec3 place = mesh.point(a);
  mesh.swap_vertices(a, far);
  EXPECT_EQ(mesh.point(far), place);
  EXPECT_EQ(heat[far], static_cast<int>(a.idx()));
  EXPECT_EQ(sign.get({far, b}), 5);
  EXPECT_NE(mesh.labels().edges.find({b, far}), nullptr);
  std::size_t i = 0;
  for (CellHandle c : mesh.cells()) EXPECT_EQ(barycenter(mesh, c), centres[i++]);
  EXPECT_EQ(check(mesh).rule, rule);
  mesh.swap_vertices(a, b);
  EXPECT_EQ(check(mesh).rule, rule);
}

TEST(SwapCells, ExchangesEverythingAlsoOfNeighbours) {
  TetMesh mesh = test::kuhn_box(2);
  auto heat = mesh.request_cell_property<int>("heat", 0);
  for (CellHandle c : mesh.cells()) heat[c] = static_cast<int>(c.idx());
  const auto whole = tets(mesh);
  for (std::uint64_t step = 0; step < 200; ++step) {
    const auto pick = [&](std::uint64_t salt) {
      return CellHandle(static_cast<Index>(generate::random_unit(salt, step) * 48));
    };
    const CellHandle a = pick(1);
    const auto near = mesh.cell_cells(a);
    const CellHandle b = step % 2 == 0 ? pick(2) : *near.begin();
    const auto of_a = mesh.cell(a).v;
    const int heat_of_a = heat[a];
    mesh.swap_cells(a, b);
    EXPECT_EQ(mesh.cell(b).v, of_a);
    EXPECT_EQ(heat[b], heat_of_a);
    ASSERT_EQ(check(mesh), Ok) << check(mesh);
  }
  EXPECT_EQ(tets(mesh), whole);
}

TEST(Clear, LeavesAnEmptyMeshThatCanBeFilledAgain) {
  TetMesh mesh = test::kuhn_box(2);
  mesh.set_region(CellHandle(3), 4);
  mesh.delete_cell(CellHandle(5));
  mesh.clear();
  EXPECT_EQ(mesh.n_vertices() + mesh.n_cells() + mesh.n_edges(), 0U);
  EXPECT_FALSE(mesh.has_regions());
  mesh.reserve_vertices(4);
  mesh.reserve_cells(1);
  const double* before = nullptr;
  std::array<VertexHandle, 4> v;
  for (int i = 0; i < 4; ++i) {
    v[static_cast<std::size_t>(i)] = mesh.add_vertex({double(i == 1), double(i == 2), double(i == 3)});
    if (!before) before = mesh.point_data();
  }
  EXPECT_EQ(mesh.point_data(), before) << "nothing moves in what was reserved";
  mesh.add_cell(v[0], v[1], v[2], v[3]);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_DOUBLE_EQ(volume(mesh, CellHandle(0)), 1.0 / 6);
}

}  // namespace
}  // namespace hfr
