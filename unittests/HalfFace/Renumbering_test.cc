// SPDX-License-Identifier: BSD-3-Clause
// Garbage collection and reordering: everything follows, and the maps say where it went.
#include <gtest/gtest.h>

#include <bit>

#include "HalfFace/Check.hh"
#include "HalfFace/Reorder.hh"
#include "Meshes.hh"
#include "Oracle.hh"

namespace hfr {
namespace {

/// Regions, labels and fixed vertices everywhere, as functions of position.
void decorate(TetMesh& mesh) {
  for (CellHandle c : mesh.cells()) mesh.set_region(c, mesh.point(mesh.cell(c).v[0]).x > 0.5 ? 2 : 1);
  mesh.labels().vertices.assign(mesh.n_vertices(), 0);
  for (VertexHandle v : mesh.boundary_vertices()) {
    mesh.labels().vertices[v.idx()] = 1 + static_cast<int>(10 * mesh.point(v).z);
    mesh.set_fixed(v);
  }
  for (FaceHandle f : mesh.boundary_faces())
    mesh.labels().faces.set(mesh.face_vertices(f), static_cast<int>(f.idx()));
  for (EdgeHandle e : mesh.boundary_edges())
    mesh.labels().edges.set(mesh.edge_vertices(e), static_cast<int>(e.idx()));
}

/// What `after` says of each thing is what `before` said of it under its old handle.
void expect_followed(const TetMesh& before, const TetMesh& after, const GarbageMap& map) {
  ASSERT_EQ(map.vertices.size(), before.n_vertices());
  ASSERT_EQ(map.cells.size(), before.n_cells());
  std::size_t vertices = 0;
  for (VertexHandle v : before.vertices()) {
    const VertexHandle w = map.vertices[v.idx()];
    if (!w.is_valid()) continue;
    ++vertices;
    EXPECT_EQ(before.point(v), after.point(w));
    EXPECT_EQ(before.labels().vertex(v), after.labels().vertex(w));
    EXPECT_EQ(before.is_fixed(v), after.is_fixed(w));
  }
  EXPECT_EQ(vertices, after.n_vertices());
  std::size_t cells = 0;
  for (CellHandle c : before.cells()) {
    const CellHandle d = map.cells[c.idx()];
    ASSERT_TRUE(d.is_valid());
    ++cells;
    EXPECT_EQ(before.region(c), after.region(d));
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(map.vertices[before.cell(c).v[k].idx()], after.cell(d).v[k]);
  }
  EXPECT_EQ(cells, after.n_cells());
  const auto renamed = [&](auto vertices_of_thing) {
    for (VertexHandle& v : vertices_of_thing) v = map.vertices[v.idx()];
    return vertices_of_thing;
  };
  for (const auto& entry : after.labels().faces.entries())
    EXPECT_TRUE(after.find_face(entry.vertices).is_valid());
  for (FaceHandle f : before.faces()) {
    const int* old_label = before.labels().faces.find(before.face_vertices(f));
    const int* new_label = after.labels().faces.find(renamed(before.face_vertices(f)));
    ASSERT_EQ(old_label == nullptr, new_label == nullptr);
    if (old_label) {
      EXPECT_EQ(*old_label, *new_label);
    }
  }
  for (EdgeHandle e : before.edges()) {
    const int* old_label = before.labels().edges.find(before.edge_vertices(e));
    const int* new_label = after.labels().edges.find(renamed(before.edge_vertices(e)));
    ASSERT_EQ(old_label == nullptr, new_label == nullptr);
    if (old_label) {
      EXPECT_EQ(*old_label, *new_label);
    }
  }
}

TEST(CollectGarbage, ClosesGapsInTheOldOrder) {
  TetMesh mesh = test::kuhn_box(3);
  decorate(mesh);
  for (Index c = 1; c < mesh.n_cells(); c += 4) mesh.delete_cell(CellHandle(c));
  mesh.delete_vertex(VertexHandle(37));
  const TetMesh before = mesh;
  const GarbageMap map = mesh.collect_garbage();
  EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
  expect_followed(before, mesh, map);
  EXPECT_FALSE(map.vertices[37].is_valid());
  EXPECT_FALSE(map.cells[1].is_valid());
  EXPECT_TRUE(mesh.free_cells().empty());
  EXPECT_EQ(mesh.n_cells(), before.n_logical_cells());
  CellHandle last;
  for (CellHandle c : map.cells) {
    if (!c.is_valid()) continue;
    EXPECT_TRUE(!last.is_valid() || last < c);
    last = c;
  }
}

TEST(CollectGarbage, SameForAnyNumberOfThreads) {
  TetMesh original = test::kuhn_box(6);
  decorate(original);
  for (Index c = 1; c < original.n_cells(); c += 5) original.delete_cell(CellHandle(c));
  TetMesh serial = original;
  serial.collect_garbage();
  for (int threads : {2, 3, 7}) {
    TetMesh mesh = original;
    mesh.collect_garbage({.policy = {.threads = threads, .serial_below = 1}});
    ASSERT_EQ(mesh.n_cells(), serial.n_cells());
    for (CellHandle c : mesh.cells()) {
      EXPECT_EQ(mesh.cell(c).v, serial.cell(c).v);
      EXPECT_EQ(mesh.cell(c).mate, serial.cell(c).mate);
    }
  }
}

TEST(CollectGarbage, KeepsUnusedVerticesUnlessAsked) {
  TetMesh mesh = test::single_cell();
  mesh.add_vertex({1, 1, 1});
  mesh.collect_garbage();
  EXPECT_EQ(mesh.n_vertices(), 5U);
  const GarbageMap map = mesh.collect_garbage({.drop_unused_vertices = true});
  EXPECT_EQ(mesh.n_vertices(), 4U);
  EXPECT_FALSE(map.vertices[4].is_valid());
  EXPECT_EQ(check(mesh), Ok);
}

TEST(CollectGarbage, NothingToDoIsTheIdentity) {
  TetMesh mesh = test::torn_box(3, 0.5, 4);
  const TetMesh before = mesh;
  const GarbageMap map = mesh.collect_garbage();
  for (CellHandle c : before.cells()) {
    EXPECT_EQ(map.cells[c.idx()], c);
    EXPECT_EQ(mesh.cell(c).mate, before.cell(c).mate);
  }
}

TEST(CollectGarbage, KeepsWhatWasReservedAndNotMuchMore) {
  TetMesh mesh = test::kuhn_box(6);
  mesh.reserve_cells(mesh.n_cells() + mesh.n_cells() / 16);
  mesh.delete_cell(CellHandle(7));
  const std::size_t before = mesh.memory_bytes();
  mesh.collect_garbage();
  const std::size_t spare = mesh.n_cells() / 20 * sizeof(Cell);
  EXPECT_GE(mesh.memory_bytes() + spare / 2, before) << "the next repair would have to reserve again";
  for (std::size_t i = 0; i < mesh.n_cells(); ++i)
    if (i % 2 == 0) mesh.delete_cell(CellHandle(i));
  mesh.collect_garbage();
  EXPECT_LT(mesh.memory_bytes(), before * 3 / 4) << "half of the mesh is gone";
}

TEST(CollectGarbage, EverythingGone) {
  TetMesh mesh = test::single_cell();
  for (Index v = 0; v < 4; ++v) mesh.delete_vertex(VertexHandle(v));
  mesh.collect_garbage();
  EXPECT_EQ(mesh.n_vertices() + mesh.n_cells(), 0U);
  EXPECT_EQ(check(mesh), Ok);
}

TEST(CollectGarbage, CellsByHandAfterwardsFindTheirNeighbours) {
  TetMesh mesh = test::kuhn_box(2);
  const auto v = mesh.cell(CellHandle(7)).v;
  mesh.delete_cell(CellHandle(7));
  mesh.collect_garbage();
  mesh.add_cell(v[0], v[1], v[2], v[3]);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(mesh.n_faces(), test::kuhn_box(2).n_faces());
}

TEST(Reorder, EverythingFollows) {
  for (SpaceCurve curve : {SpaceCurve::kHilbert, SpaceCurve::kMorton}) {
    TetMesh mesh = test::kuhn_box(3);
    decorate(mesh);
    mesh.delete_cell(CellHandle(17));
    const TetMesh before = mesh;
    const GarbageMap map = reorder(mesh, {.curve = curve});
    EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
    expect_followed(before, mesh, map);
  }
}

TEST(Reorder, SameForAnyNumberOfThreadsAndOnceIsEnough) {
  TetMesh before = test::kuhn_box(8);
  for (std::size_t c = 5; c < before.n_cells(); c += 31) before.delete_cell(CellHandle(c));
  TetMesh serial = before;
  const GarbageMap expected = reorder(serial);
  for (int threads : {2, 3, 7}) {
    TetMesh mesh = before;
    const GarbageMap found = reorder(mesh, {.policy = {.threads = threads, .serial_below = 1}});
    EXPECT_EQ(found.vertices, expected.vertices);
    EXPECT_EQ(found.cells, expected.cells);
    for (CellHandle c : mesh.cells()) EXPECT_EQ(mesh.cell(c).v, serial.cell(c).v);
  }
  TetMesh again = serial;
  const GarbageMap map = reorder(again);
  for (std::size_t c = 0; c < map.cells.size(); ++c) EXPECT_EQ(map.cells[c], CellHandle(c));
}

TEST(Reorder, CellsAloneLeaveVerticesWhereTheyAreAndCanBePutBack) {
  TetMesh mesh = test::kuhn_box(4);
  const TetMesh before = mesh;
  const GarbageMap map = reorder(mesh, {.curve = SpaceCurve::kMorton, .vertices = false});
  EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
  for (VertexHandle v : mesh.vertices()) EXPECT_EQ(mesh.point(v), before.point(v));
  std::size_t moved = 0;
  for (CellHandle c : before.cells()) {
    EXPECT_EQ(mesh.cell(map.cells[c.idx()]).v, before.cell(c).v);
    moved += map.cells[c.idx()] != c ? 1 : 0;
  }
  EXPECT_GT(moved, mesh.n_cells() / 4);
  restore_cell_order(mesh, map.cells);
  for (CellHandle c : before.cells()) {
    EXPECT_EQ(mesh.cell(c).v, before.cell(c).v);
    EXPECT_EQ(mesh.cell(c).mate, before.cell(c).mate);
  }
  mesh.delete_cell(CellHandle(0));
  mesh.collect_garbage();
  EXPECT_THROW(restore_cell_order(mesh, map.cells), InvalidInput);
}

TEST(OrderCells, GivesThemTheHandlesOfTheirPlaces) {
  TetMesh mesh = test::kuhn_box(2);
  const TetMesh before = mesh;
  std::vector<CellHandle> order;
  for (std::size_t i = mesh.n_cells(); i-- > 0;) order.push_back(CellHandle(i));
  order_cells(mesh, order);
  EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
  for (std::size_t i = 0; i < order.size(); ++i)
    EXPECT_EQ(mesh.cell(CellHandle(i)).v, before.cell(order[i]).v);
  const auto is_refused = [&](std::vector<CellHandle> other) {
    EXPECT_THROW(order_cells(mesh, other), InvalidInput);
    return mesh.cell(CellHandle(0)).v == before.cell(order[0]).v;
  };
  EXPECT_TRUE(is_refused({order.begin(), order.end() - 1}));
  order[1] = order[2];
  EXPECT_TRUE(is_refused(order));
  order[1] = CellHandle(order.size());
  EXPECT_TRUE(is_refused(order));
  mesh.delete_cell(CellHandle(0));
  EXPECT_THROW(order_cells(mesh, order), InvalidInput);
}

TEST(IsScattered, TellsARandomOrderFromThatOfACurve) {
  generate::Arrays box = generate::box({40, 40, 40});
  EXPECT_FALSE(is_scattered(build(box.points, box.cells)));
  for (std::size_t i = box.cells.size(); i > 1; --i)
    std::swap(box.cells[i - 1],
              box.cells[static_cast<std::size_t>(generate::random_unit(1, i) * static_cast<double>(i))]);
  TetMesh mesh = build(box.points, box.cells);
  for (int threads : {1, 3}) EXPECT_TRUE(is_scattered(mesh, {.threads = threads}));
  reorder(mesh, {.vertices = false});
  EXPECT_FALSE(is_scattered(mesh));
}

TEST(Reorder, MeshWithoutExtent) {
  TetMesh mesh = build(std::vector<Vec3>(4), std::vector<test::Corners>{{0, 1, 2, 3}});
  EXPECT_NO_THROW(reorder(mesh));
  TetMesh empty;
  EXPECT_NO_THROW(reorder(empty));
}

TEST(CurvePlace, HilbertVisitsNeighboursAndEachPlaceOnce) {
  std::map<std::uint64_t, std::array<int, 3>> order;
  for (std::uint32_t x = 0; x < 8; ++x)
    for (std::uint32_t y = 0; y < 8; ++y)
      for (std::uint32_t z = 0; z < 8; ++z)
        order[curve_place(SpaceCurve::kHilbert, x, y, z)] = {static_cast<int>(x), static_cast<int>(y),
                                                             static_cast<int>(z)};
  ASSERT_EQ(order.size(), 512U);
  EXPECT_EQ(order.rbegin()->first, 511U);
  const std::array<int, 3>* last = nullptr;
  for (const auto& [place, at] : order) {
    if (last) {
      EXPECT_EQ(std::abs(at[0] - (*last)[0]) + std::abs(at[1] - (*last)[1]) + std::abs(at[2] - (*last)[2]),
                1);
    }
    last = &at;
  }
}

TEST(CurvePlace, MortonInterleavesBits) {
  EXPECT_EQ(curve_place(SpaceCurve::kMorton, 1, 0, 0), 4U);
  EXPECT_EQ(curve_place(SpaceCurve::kMorton, 3, 1, 2), 0b101110U + 0U);
  EXPECT_EQ(std::popcount(curve_place(SpaceCurve::kMorton, 0x1fffff, 0x1fffff, 0x1fffff)), 63);
}

}  // namespace
}  // namespace hfr
