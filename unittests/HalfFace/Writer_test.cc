// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Writer.hh"

#include <gtest/gtest.h>

#include <type_traits>

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
