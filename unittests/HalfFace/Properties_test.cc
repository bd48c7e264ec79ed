// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Properties.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "HalfFace/Check.hh"
#include "HalfFace/Reorder.hh"
#include "HalfFace/Writer.hh"
#include "Meshes.hh"
#include "Oracle.hh"

namespace hfr {
namespace {

template <class Property, class Key>
concept Indexable = requires(Property p, Key key) {
  p[key];
};
static_assert(Indexable<VertexProperty<int>, VertexHandle> && Indexable<CellProperty<int>, CellHandle>);
static_assert(!Indexable<VertexProperty<int>, CellHandle> && !Indexable<CellProperty<int>, VertexHandle>);
static_assert(!Indexable<VertexProperty<int>, std::size_t> && !Indexable<VertexProperty<int>, int>);
static_assert(!Indexable<CellProperty<bool>, HalfFaceHandle>);

TEST(Property, RequestedTwiceIsTheSame) {
  TetMesh mesh = test::kuhn_box(1);
  auto height = mesh.request_vertex_property<double>("height", 1.5);
  EXPECT_EQ(height[VertexHandle(3)], 1.5);
  height[VertexHandle(3)] = 7;
  const auto again = mesh.request_vertex_property<double>("height", 0.0);
  EXPECT_EQ(again[VertexHandle(3)], 7);
  EXPECT_EQ(again[VertexHandle(2)], 1.5);
  EXPECT_EQ(again.default_value(), 1.5);
  EXPECT_EQ(mesh.properties().vertices.names(), std::vector<std::string>{"height"});
}

TEST(Property, KindsDoNotShareNames) {
  TetMesh mesh = test::kuhn_box(1);
  mesh.request_vertex_property<int>("n");
  mesh.request_cell_property<std::string>("n", "x");
  mesh.request_edge_property<double>("n");
  mesh.request_halfedge_property<float>("n");
  mesh.request_face_property<char>("n");
  mesh.request_halfface_property<long>("n");
  mesh.request_mesh_property<bool>("n");
  EXPECT_EQ(mesh.request_cell_property<std::string>("n")[CellHandle(5)], "x");
}

TEST(Property, OtherTypeIsRefusedAndBothAreNamed) {
  TetMesh mesh = test::kuhn_box(1);
  mesh.request_cell_property<double>("stress");
  try {
    mesh.request_cell_property<int>("stress");
    FAIL() << "no exception";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("\"stress\""), testing::HasSubstr("double"),
                                             testing::HasSubstr("int")));
  }
}

TEST(Property, GrowsWithTheMeshByItsDefault) {
  TetMesh mesh = test::single_cell();
  auto mark = mesh.request_vertex_property<bool>("mark", true);
  auto weight = mesh.request_cell_property<int>("weight", 4);
  mark[VertexHandle(0)] = false;
  const VertexHandle v = mesh.add_vertex({1, 1, 1});
  const CellHandle c = mesh.add_cell(VertexHandle(1), VertexHandle(2), VertexHandle(3), v);
  EXPECT_TRUE(mark[v]);
  EXPECT_FALSE(mark[VertexHandle(0)]);
  EXPECT_EQ(weight[c], 4);
  EXPECT_EQ(weight.size(), 2U);
  weight.fill(9);
  EXPECT_THAT(weight.values(), testing::ElementsAre(9, 9));
}

TEST(Property, CopyOfAMeshHasItsOwnValues) {
  TetMesh mesh = test::kuhn_box(1);
  auto height = mesh.request_vertex_property<int>("height", 0);
  auto crease = mesh.request_edge_property<int>("crease", 0);
  auto title = mesh.request_mesh_property<std::string>("title", "box");
  height[VertexHandle(1)] = 1;
  crease[{VertexHandle(0), VertexHandle(1)}] = 1;
  TetMesh copy = mesh;
  height[VertexHandle(1)] = 2;
  crease[{VertexHandle(0), VertexHandle(1)}] = 2;
  *title = "changed";
  EXPECT_EQ(copy.request_vertex_property<int>("height")[VertexHandle(1)], 1);
  EXPECT_EQ(copy.request_edge_property<int>("crease").get({VertexHandle(1), VertexHandle(0)}), 1);
  EXPECT_EQ(*copy.request_mesh_property<std::string>("title"), "box");
  copy = mesh;
  EXPECT_EQ(copy.request_vertex_property<int>("height")[VertexHandle(1)], 2);
  const TetMesh moved = std::move(mesh);
  EXPECT_EQ(height.size(), moved.n_vertices());
}

TEST(Property, RemovedKeepsItsValuesForWhoHoldsThem) {
  TetMesh mesh = test::single_cell();
  auto p = mesh.request_cell_property<int>("p", 3);
  EXPECT_TRUE(mesh.properties().cells.remove("p"));
  EXPECT_FALSE(mesh.properties().cells.remove("p"));
  EXPECT_EQ(p[CellHandle(0)], 3);
  EXPECT_NO_THROW(mesh.request_cell_property<double>("p"));
}

TEST(Property, GettingMakesNone) {
  TetMesh mesh = test::kuhn_box(1);
  mesh.request_vertex_property<double>("heat", 2.0);
  mesh.request_edge_property<int>("crease", 1);
  EXPECT_FALSE(mesh.get_vertex_property<double>("haet").has_value());
  EXPECT_FALSE(mesh.get_cell_property<double>("heat").has_value());
  EXPECT_FALSE(mesh.get_face_property<int>("crease") || mesh.get_halfface_property<int>("crease") ||
               mesh.get_halfedge_property<int>("crease") || mesh.get_mesh_property<int>("crease"));
  EXPECT_EQ(mesh.properties().vertices.names().size(), 1U);
  ASSERT_TRUE(mesh.get_vertex_property<double>("heat").has_value());
  (*mesh.get_vertex_property<double>("heat"))[VertexHandle(1)] = 5;
  EXPECT_EQ(mesh.request_vertex_property<double>("heat")[VertexHandle(1)], 5);
  EXPECT_THROW(static_cast<void>(mesh.get_vertex_property<int>("heat")), InvalidInput);
}

TEST(Property, OfAConstMeshIsReadOnly) {
  TetMesh mesh = test::kuhn_box(1);
  mesh.request_cell_property<int>("n", 1)[CellHandle(2)] = 8;
  mesh.request_edge_property<int>("crease", 1);
  *mesh.request_mesh_property<int>("version") = 3;
  const TetMesh& fixed = mesh;
  const auto n = fixed.get_cell_property<int>("n");
  ASSERT_TRUE(n.has_value());
  auto copy = *n;
  static_assert(std::same_as<decltype(copy[CellHandle(2)]), const int&>);
  static_assert(!std::is_convertible_v<CellProperty<const int>, CellProperty<int>>);
  static_assert(std::is_convertible_v<CellProperty<int>, CellProperty<const int>>);
  EXPECT_EQ(copy[CellHandle(2)], 8);
  EXPECT_EQ(copy.values().size(), mesh.n_cells());
  EXPECT_EQ(fixed.get_edge_property<int>("crease")->get({VertexHandle(0), VertexHandle(1)}), 1);
  EXPECT_EQ(**fixed.get_mesh_property<int>("version"), 3);
  EXPECT_FALSE(fixed.get_cell_property<int>("m").has_value());
}

TEST(Property, AtChecksTheHandle) {
  TetMesh mesh = test::kuhn_box(1);
  auto n = mesh.request_cell_property<int>("n", 1);
  n.at(CellHandle(2)) = 4;
  EXPECT_EQ(std::as_const(n).at(CellHandle(2)), 4);
  EXPECT_THROW(n.at(CellHandle(mesh.n_cells())), InvalidInput);
  EXPECT_THROW(n.at(CellHandle()), InvalidInput);
}

TEST(Property, WithoutANameFollowsTheMeshAndGoesWithItsLastHandle) {
  TetMesh mesh = test::single_cell();
  const std::size_t before = mesh.memory_bytes();
  {
    auto mark = mesh.request_vertex_property<int>();
    auto other = mesh.request_vertex_property<int>();
    mark[VertexHandle(2)] = 7;
    EXPECT_EQ(other[VertexHandle(2)], 0) << "each is one of its own";
    const VertexHandle v = mesh.add_vertex({1, 1, 1});
    EXPECT_EQ(mark[v], 0);
    mesh.delete_vertex(v);
    mesh.collect_garbage();
    EXPECT_EQ(mark.size(), 4U);
    EXPECT_EQ(mark[VertexHandle(2)], 7);
    EXPECT_TRUE(mesh.properties().vertices.names().empty());
    EXPECT_FALSE(mesh.properties().vertices.remove("")) << "nobody can ask for one of them";
    mesh.add_vertex({1, 1, 2});
    EXPECT_EQ(mark.size(), 5U);
    mesh.delete_vertex(VertexHandle(4));
    mesh.collect_garbage();
    TetMesh copy = mesh;
    EXPECT_FALSE(copy.properties().vertices.empty()) << "restore() brings the values back";
    copy.collect_garbage();
    EXPECT_TRUE(copy.properties().vertices.empty());
    EXPECT_FALSE(copy.get_vertex_property<int>("").has_value());
  }
  mesh.collect_garbage();
  EXPECT_TRUE(mesh.properties().vertices.empty());
  EXPECT_LE(mesh.properties().memory_bytes(), before);
}

TEST(Moved, MeshIsEmptyWhateverWasDeleted) {
  TetMesh mesh = test::single_cell();
  mesh.delete_vertex(mesh.add_vertex({1, 1, 1}));
  ASSERT_TRUE(mesh.needs_garbage_collection());
  TetMesh other = std::move(mesh);
  EXPECT_EQ(mesh.n_logical_vertices(), 0U);  // NOLINT(bugprone-use-after-move)
  EXPECT_FALSE(mesh.needs_garbage_collection());
  EXPECT_EQ(other.n_logical_vertices(), 4U);
  mesh = std::move(other);
  EXPECT_EQ(mesh.n_logical_vertices(), 4U);
  EXPECT_TRUE(mesh.needs_garbage_collection());
}

TEST(TupleMap, ErasedEntryGivesItsPlaceToTheLastOne) {
  const auto edge = [](Index a, Index b) { return std::array{VertexHandle(a), VertexHandle(b)}; };
  TupleMap<2, int> map;
  for (Index i = 0; i < 4; ++i) map.set(edge(i, i + 1), static_cast<int>(i));
  EXPECT_TRUE(map.erase_unordered(edge(2, 1)));
  EXPECT_FALSE(map.erase_unordered(edge(1, 2)));
  ASSERT_EQ(map.size(), 3U);
  EXPECT_EQ(map.entries()[1].value, 3);
  EXPECT_EQ(*map.find(edge(3, 4)), 3);
  EXPECT_TRUE(map.erase_unordered(edge(2, 3)));  // the last one
  EXPECT_EQ(*map.find(edge(0, 1)), 0);
  EXPECT_EQ(*map.find(edge(3, 4)), 3);
  EXPECT_EQ(map.find(edge(2, 3)), nullptr);
  EXPECT_EQ(map.size(), 2U);
}

TEST(TupleMap, HoldsWhatASortedMapHolds) {
  TupleMap<2, int> map;
  std::map<std::pair<Index, Index>, int> expected;
  std::minstd_rand random(1);
  const auto draw = [&random](Index n) { return static_cast<Index>(random() % n); };
  const auto edge = [](std::pair<Index, Index> e) {
    return std::array{VertexHandle(e.second), VertexHandle(e.first)};
  };
  for (int i = 0; i < 20'000; ++i) {
    const std::pair<Index, Index> one = std::minmax({draw(40), 40 + draw(40)});
    const std::pair<Index, Index> other = std::minmax({draw(40), 40 + draw(40)});
    const Index what = draw(8);
    if (what < 5) {
      map.set(edge(one), i);
      expected[one] = i;
    } else if (what == 5) {
      EXPECT_EQ(map.erase(edge(one)), expected.erase(one) == 1);
    } else if (what == 6) {
      EXPECT_EQ(map.erase_unordered(edge(one)), expected.erase(one) == 1);
    } else if (!expected.contains(other)) {
      const auto found = expected.find(one);
      EXPECT_EQ(map.rekey(edge(one), edge(other)), found != expected.end());
      if (found == expected.end()) continue;
      expected[other] = found->second;
      expected.erase(one);
    }
    if (draw(4'000) == 0) {
      map.clear();
      expected.clear();
    }
  }
  EXPECT_GT(map.size(), 100U);
  ASSERT_EQ(map.size(), expected.size());
  for (Index a = 0; a < 40; ++a)
    for (Index b = 40; b < 80; ++b) {
      const auto found = expected.find({a, b});
      const int* value = map.find(edge({a, b}));
      ASSERT_EQ(value != nullptr, found != expected.end());
      if (value != nullptr) {
        EXPECT_EQ(*value, found->second);
      }
    }
}

TEST(TupleProperties, OrderCountsOnlyForDirectedThings) {
  TetMesh mesh = test::single_cell();
  const auto v = mesh.halfface_vertices(HalfFaceHandle(0));
  auto edge = mesh.request_edge_property<int>("e", -1);
  auto halfedge = mesh.request_halfedge_property<int>("he", -1);
  auto face = mesh.request_face_property<int>("f", -1);
  auto halfface = mesh.request_halfface_property<int>("hf", -1);
  edge[{v[0], v[1]}] = 1;
  halfedge[{v[0], v[1]}] = 2;
  face[v] = 3;
  halfface[v] = 4;
  EXPECT_EQ(edge.get({v[1], v[0]}), 1);
  EXPECT_EQ(halfedge.get({v[0], v[1]}), 2);
  EXPECT_EQ(halfedge.get({v[1], v[0]}), -1);
  EXPECT_EQ(face.get({v[1], v[0], v[2]}), 3);
  EXPECT_EQ(halfface.get({v[1], v[2], v[0]}), 4);
  EXPECT_EQ(halfface.get({v[1], v[0], v[2]}), -1);
  EXPECT_EQ(halfface.get(mesh, HalfFaceHandle(0)), 4);
  EXPECT_EQ(edge.get(mesh, mesh.find_edge(v[0], v[1])), 1);
  EXPECT_EQ(halfedge.get(mesh, mesh.find_halfedge(v[0], v[1])), 2);
  EXPECT_EQ(face.at(mesh, FaceHandle(0)), 3);
  EXPECT_EQ(edge.size(), 1U);
  EXPECT_TRUE(edge.erase({v[1], v[0]}));
  EXPECT_FALSE(edge.has({v[0], v[1]}));
}

/// Values that name what they belong to by position, which no renumbering changes.
struct Tracked {
  explicit Tracked(TetMesh& m)
      : mesh(m),
        vertex(m.request_vertex_property<Vec3>("at")),
        cell(m.request_cell_property<Vec3>("centre")),
        edge(m.request_edge_property<Vec3>("middle")),
        halfedge(m.request_halfedge_property<Vec3>("direction")),
        face(m.request_face_property<Vec3>("sum")),
        halfface(m.request_halfface_property<Vec3>("normal")) {}

  Vec3 centre(CellHandle c) const {
    Vec3 sum;
    for (VertexHandle v : mesh.cell(c).v) sum = sum + mesh.point(v);
    return sum;
  }
  template <std::size_t N>
  Vec3 sum(const std::array<VertexHandle, N>& vertices) const {
    Vec3 s;
    for (VertexHandle v : vertices) s = s + mesh.point(v);
    return s;
  }
  Vec3 direction(HalfEdgeHandle e) const {
    return mesh.point(mesh.to_vertex(e)) - mesh.point(mesh.from_vertex(e));
  }
  Vec3 normal(HalfFaceHandle h) const {
    const auto v = mesh.halfface_vertices(h);
    return cross(mesh.point(v[1]) - mesh.point(v[0]), mesh.point(v[2]) - mesh.point(v[0]));
  }

  void write() {
    for (VertexHandle v : mesh.vertices()) vertex[v] = mesh.point(v);
    for (CellHandle c : mesh.cells()) cell[c] = centre(c);
    for (EdgeHandle e : mesh.edges()) edge.set(mesh, e, sum(mesh.edge_vertices(e)));
    for (HalfEdgeHandle e : mesh.halfedges()) halfedge.set(mesh, e, direction(e));
    for (FaceHandle f : mesh.faces()) face.set(mesh, f, sum(mesh.face_vertices(f)));
    for (HalfFaceHandle h : mesh.halffaces()) halfface.set(mesh, h, normal(h));
  }
  void expect_right() const {
    ASSERT_EQ(vertex.size(), mesh.n_vertices());
    ASSERT_EQ(cell.size(), mesh.n_cells());
    const auto near = [](Vec3 a, Vec3 b) { EXPECT_LT(norm(a - b), 1e-12); };
    for (VertexHandle v : mesh.vertices()) near(vertex[v], mesh.point(v));
    for (CellHandle c : mesh.cells()) near(cell[c], centre(c));
    for (EdgeHandle e : mesh.edges()) near(edge.get(mesh, e), sum(mesh.edge_vertices(e)));
    for (HalfEdgeHandle e : mesh.halfedges()) near(halfedge.get(mesh, e), direction(e));
    for (FaceHandle f : mesh.faces()) near(face.get(mesh, f), sum(mesh.face_vertices(f)));
    for (HalfFaceHandle h : mesh.halffaces()) near(halfface.get(mesh, h), normal(h));
  }

  TetMesh& mesh;
  VertexProperty<Vec3> vertex;
  CellProperty<Vec3> cell;
  EdgeProperty<Vec3> edge;
  HalfEdgeProperty<Vec3> halfedge;
  FaceProperty<Vec3> face;
  HalfFaceProperty<Vec3> halfface;
};

TEST(Properties, FollowGarbageCollection) {
  TetMesh mesh = test::kuhn_box(3);
  Tracked tracked(mesh);
  tracked.write();
  for (Index c = 0; c < mesh.n_cells(); c += 3) mesh.delete_cell(CellHandle(c));
  mesh.delete_vertex(VertexHandle(21));
  mesh.collect_garbage({.drop_unused_vertices = true});
  tracked.expect_right();
  EXPECT_EQ(tracked.edge.size(), test::Oracle(mesh).edges().size())
      << "values of edges that are gone must go";
  EXPECT_EQ(tracked.halfface.size(), mesh.n_halffaces());
}

TEST(Properties, FollowReordering) {
  TetMesh mesh = test::carved_ball(6);
  Tracked tracked(mesh);
  tracked.write();
  reorder(mesh);
  tracked.expect_right();
  reorder(mesh, {.curve = SpaceCurve::kMorton});
  tracked.expect_right();
}

TEST(CopyCellData, GivesRegionStatusAndProperties) {
  TetMesh mesh = test::kuhn_box(1);
  auto p = mesh.request_cell_property<int>("p", 0);
  const CellHandle from(2);
  const CellHandle to(mesh.n_cells());
  mesh.set_region(from, 5);
  mesh.set_tagged(from);
  p[from] = 8;
  TetMesh::Writer(mesh).resize_cells(mesh.n_cells() + 1);
  mesh.copy_cell_data(from, to);
  EXPECT_EQ(mesh.region(to), 5);
  EXPECT_TRUE(mesh.is_tagged(to));
  EXPECT_FALSE(mesh.is_selected(to));
  EXPECT_EQ(p[to], 8);
}

TEST(CopyVertexData, GivesPropertiesAndNoConstraint) {
  TetMesh mesh = test::single_cell();
  auto p = mesh.request_vertex_property<int>("p", 0);
  p[VertexHandle(0)] = 8;
  mesh.set_fixed(VertexHandle(0));
  mesh.set_selected(VertexHandle(0));
  const VertexHandle v = mesh.add_vertex({});
  mesh.set_tagged(v);
  mesh.copy_vertex_data(VertexHandle(0), v);
  EXPECT_EQ(p[v], 8);
  EXPECT_TRUE(mesh.is_selected(v));
  EXPECT_FALSE(mesh.is_fixed(v));
  EXPECT_FALSE(mesh.is_tagged(v));
}

TEST(Locks, OfEdgesFacesAndPatchesAreSetAndTakenBack) {
  TetMesh mesh = test::kuhn_box(1);
  EXPECT_TRUE(mesh.locks().empty());
  const EdgeHandle e = *mesh.edges().begin();
  const FaceHandle f = *mesh.boundary_faces().begin();
  mesh.set_fixed(e);
  mesh.set_fixed(f);
  mesh.set_fixed_patch(3);
  EXPECT_TRUE(mesh.is_fixed(e) && mesh.is_fixed(f) && mesh.is_fixed_patch(3));
  EXPECT_EQ(std::ranges::count_if(mesh.edges(), [&](EdgeHandle x) { return mesh.is_fixed(x); }), 1);
  EXPECT_EQ(std::ranges::count_if(mesh.faces(), [&](FaceHandle x) { return mesh.is_fixed(x); }), 1);
  EXPECT_FALSE(mesh.is_fixed_patch(2));
  for (VertexHandle v : mesh.vertices()) EXPECT_FALSE(mesh.is_fixed(v)) << "that is another lock";
  mesh.set_fixed(e, false);
  mesh.set_fixed(f, false);
  mesh.set_fixed_patch(3, false);
  EXPECT_TRUE(mesh.locks().empty());
}

TEST(Locks, FollowTheirVerticesAndGoWithTheirLastCell) {
  TetMesh mesh = test::kuhn_box(2);
  const CellHandle first = *mesh.cells().begin();
  const CellHandle last(mesh.n_cells() - 1);
  for (CellHandle c : {first, last}) {
    for (FaceHandle f : mesh.cell_faces(c)) mesh.set_fixed(f);
    for (EdgeHandle e : mesh.cell_edges(c)) mesh.set_fixed(e);
  }
  std::vector<Vec3> corners;
  for (VertexHandle v : mesh.cell(last).v) corners.push_back(mesh.point(v));
  mesh.delete_cell(first);
  const std::size_t n_faces = mesh.locks().faces.size();
  EXPECT_LT(n_faces, 8U) << "the faces on the boundary are gone";
  EXPECT_GE(n_faces, 4U);
  mesh.delete_vertex(VertexHandle(0));
  const GarbageMap map = mesh.collect_garbage();
  const CellHandle kept = map.cells[last.idx()];
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(mesh.point(mesh.cell(kept).v[k]), corners[k]);
  for (FaceHandle f : mesh.cell_faces(kept)) EXPECT_TRUE(mesh.is_fixed(f));
  for (EdgeHandle e : mesh.cell_edges(kept)) EXPECT_TRUE(mesh.is_fixed(e));
  for (const auto& entry : mesh.locks().faces.entries())
    EXPECT_TRUE(mesh.find_face(entry.vertices).is_valid());
  for (const auto& entry : mesh.locks().edges.entries())
    EXPECT_TRUE(mesh.find_edge(entry.vertices[0], entry.vertices[1]).is_valid());
}

TEST(CellStatus, BitsAreIndependent) {
  TetMesh mesh = test::kuhn_box(1);
  const CellHandle c(1);
  EXPECT_FALSE(mesh.is_fixed(c) || mesh.is_selected(c) || mesh.is_tagged(c));
  mesh.set_selected(c);
  mesh.set_fixed(c);
  mesh.set_selected(c, false);
  EXPECT_TRUE(mesh.is_fixed(c));
  EXPECT_FALSE(mesh.is_selected(c) || mesh.is_tagged(c));
  EXPECT_FALSE(mesh.is_fixed(CellHandle(0)));
}

TEST(Property, HandlesNameTheValuesOfThatTimeAfterAMeshWasRestored) {
  TetMesh mesh = test::kuhn_box(2);
  auto height = mesh.request_vertex_property<double>("height", 1.5);
  auto flag = mesh.request_cell_property<bool>("flag");
  auto crease = mesh.request_edge_property<int>("crease");
  auto title = mesh.request_mesh_property<std::string>("title");
  auto first = mesh.request_cell_property<int>();
  auto second = mesh.request_cell_property<int>();
  const EdgeHandle e = mesh.edge_in_cell(CellHandle(3), 2);
  first[CellHandle(3)] = 1;
  second[CellHandle(3)] = 2;
  height[VertexHandle(4)] = 7;
  flag[CellHandle(3)] = true;
  crease.set(mesh, e, 5);
  *title = "then";
  const TetMesh then = mesh;

  auto late = mesh.request_cell_property<int>("late", -1);
  height[mesh.add_vertex({9, 9, 9})] = 8;
  height[VertexHandle(4)] = 2;
  crease.set(mesh, e, 6);
  *title = "now";
  mesh.delete_cell(CellHandle(3));
  mesh.collect_garbage();
  late.fill(3);

  mesh.restore(then);
  EXPECT_EQ(check(mesh), Ok);
  ASSERT_EQ(height.size(), then.n_vertices());
  ASSERT_EQ(flag.size(), then.n_cells());
  ASSERT_EQ(late.size(), then.n_cells());
  EXPECT_EQ(height[VertexHandle(4)], 7);
  EXPECT_TRUE(flag[CellHandle(3)]);
  EXPECT_EQ(crease.get(mesh, e), 5);
  EXPECT_EQ(*title, "then");
  EXPECT_EQ(first[CellHandle(3)], 1);
  EXPECT_EQ(second[CellHandle(3)], 2);
  EXPECT_EQ(late[CellHandle(0)], -1);
  height[VertexHandle(4)] = 11;  // the handle and the mesh mean the same values
  EXPECT_EQ(mesh.request_vertex_property<double>("height")[VertexHandle(4)], 11);
  EXPECT_EQ(std::as_const(mesh).points().size(), then.points().size());
}

}  // namespace
}  // namespace hfr
