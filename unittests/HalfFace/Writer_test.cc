// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Writer.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "HalfFace/Generate.hh"

namespace hfr {
namespace {

// What a mesh offers by itself cannot break it: cells and the free list are read, not written, and what
// grows or empties arrays behind the back of the rest is not there.
template <class Mesh>
concept HandsOutItsCells = requires(Mesh& mesh, CellHandle c, VertexHandle v, HalfFaceHandle h) {
  requires !std::is_const_v<std::remove_reference_t<decltype(mesh.cell(c))>>;
}
|| requires(Mesh& mesh) { requires !std::is_const_v<std::remove_reference_t<decltype(mesh.free_cells())>>; }
|| requires(Mesh& mesh) { mesh.resize_cells(1); }
|| requires(Mesh& mesh, VertexHandle v) { mesh.mark_deleted(v); }
|| requires(Mesh& mesh, VertexHandle v, CellHandle c) { mesh.set_incident_cell(v, c); }
|| requires(Mesh& mesh, HalfFaceHandle h) { mesh.set_mate(h, h); };
static_assert(!HandsOutItsCells<TetMesh>);
struct AsABuilderSeesIt {
  Cell& cell(CellHandle);
};
static_assert(HandsOutItsCells<AsABuilderSeesIt>);

TEST(Writer, TwoMatesThatAreLetGoAreBoundaryAndJoinedAgainTheMeshIsWhole) {
  const generate::Arrays box = generate::box({2, 2, 2});
  TetMesh mesh = build(box.points, box.cells);
  HalfFaceHandle h;
  for (HalfFaceHandle inner : mesh.halffaces())
    if (!mesh.is_boundary(inner)) h = inner;
  const HalfFaceHandle m = mesh.opposite_halfface(h);
  TetMesh::Writer writer(mesh);
  writer.set_mate(h, HalfFaceHandle());
  EXPECT_TRUE(mesh.is_boundary(h));
  EXPECT_FALSE(mesh.is_boundary(m));
  EXPECT_FALSE(check(mesh));
  writer.set_mate(h, m);
  EXPECT_TRUE(check(mesh));
}

TEST(Writer, MoreCellsThanThereAreIndicesForAreRefused) {
  const generate::Arrays arrays = generate::box({2, 2, 2});
  TetMesh mesh = build(arrays.points, arrays.cells);
  const std::size_t n = mesh.n_cells();
  EXPECT_THROW(TetMesh::Writer(mesh).resize_cells(TetMesh::kMostCells + 1), ResourceLimit);
  EXPECT_EQ(mesh.n_cells(), n);
}

TEST(Writer, WhatNamesVerticesFollowsWhereOthersComeBetween) {
  const generate::Arrays box = generate::box({2, 3, 2});
  TetMesh mesh = build(box.points, box.cells);
  using V = VertexHandle;
  const std::size_t n = mesh.n_vertices();
  mesh.labels().vertices.assign(n, 0);
  mesh.labels().vertices[5] = 3;
  const auto corners = mesh.cell(CellHandle(7)).v;
  mesh.labels().faces.set({corners[0], corners[1], corners[2]}, 4);
  mesh.labels().edges.set({corners[2], corners[3]}, 5);
  mesh.set_fixed(V(2));
  auto index = mesh.request_vertex_property<int>("index", -1);
  for (std::size_t i = 0; i < n; ++i) index[V(i)] = static_cast<int>(i);
  // One before all, two in the middle, one at the end; then nothing before the last one.
  for (const std::vector<std::size_t>& gaps : {std::vector<std::size_t>{0, 6, 7, n + 3}, {n - 1}, {n}}) {
    TetMesh wider = mesh;
    std::vector<V> to;
    for (std::size_t place = 0; place < n + gaps.size(); ++place)
      if (std::find(gaps.begin(), gaps.end(), place) == gaps.end()) to.emplace_back(place);
    ASSERT_EQ(to.size(), n);
    TetMesh::Writer(wider).open_gaps(to, n + gaps.size());
    EXPECT_TRUE(check(wider)) << check(wider);
    ASSERT_EQ(wider.n_vertices(), n + gaps.size());
    const auto moved = *wider.get_vertex_property<int>("index");
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(wider.point(to[i]), mesh.point(V(i)));
      EXPECT_EQ(wider.incident_cell(to[i]), mesh.incident_cell(V(i)));
      EXPECT_EQ(wider.labels().vertex(to[i]), i == 5 ? 3 : 0);
      EXPECT_EQ(wider.is_fixed(to[i]), i == 2);
      EXPECT_EQ(moved[to[i]], static_cast<int>(i));
    }
    for (std::size_t gap : gaps) {
      EXPECT_FALSE(wider.incident_cell(V(gap)).is_valid());
      EXPECT_FALSE(wider.is_fixed(V(gap)));
      EXPECT_EQ(moved[V(gap)], -1);
      EXPECT_EQ(wider.labels().vertex(V(gap)), 0);
    }
    const auto now = [&](int k) { return to[corners[static_cast<std::size_t>(k)].idx()]; };
    EXPECT_EQ(wider.cell(CellHandle(7)).v, (std::array{now(0), now(1), now(2), now(3)}));
    ASSERT_TRUE(wider.labels().faces.find({now(0), now(1), now(2)}));
    ASSERT_TRUE(wider.labels().edges.find({now(2), now(3)}));
  }
}

TEST(Writer, AddingByHandSeesWhatWasWrittenInBetween) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const std::vector<std::array<Index, 4>> cells = {{0, 1, 2, 3}};
  TetMesh mesh = build(points, cells);
  using V = VertexHandle;
  const CellHandle other = mesh.add_cell(V(4), V(1), V(3), V(2));  // makes the table of faces
  ASSERT_TRUE(mesh.opposite_halfface(mesh.vertex_opposite_halfface(other, V(4))).is_valid());
  TetMesh::Writer writer(mesh);
  writer.set_mate(mesh.opposite_halfface(mesh.vertex_opposite_halfface(other, V(4))), HalfFaceHandle());
  writer.mark_deleted(other);
  writer.free_cells().push_back(other);
  writer.set_incident_cell(V(4), CellHandle());
  for (unsigned i = 0; i < 4; ++i) writer.set_incident_cell(V(i), CellHandle(0));
  ASSERT_TRUE(check(mesh));
  mesh.add_cell(V(4), V(1), V(3), V(2));  // refused if the table still had the face with two cells
  EXPECT_EQ(mesh.n_logical_cells(), 2U);
  EXPECT_TRUE(check(mesh));
}

}  // namespace
}  // namespace hfr
