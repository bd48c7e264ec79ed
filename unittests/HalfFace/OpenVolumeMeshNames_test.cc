// SPDX-License-Identifier: BSD-3-Clause
// A user of OpenVolumeMesh who comes over: a thin adapter has its names, and what one does with that library
// is done through it. What differs is said where it differs.
#include <gtest/gtest.h>

#include <algorithm>

#include "HalfFace/Check.hh"
#include "HalfFace/Geometry.hh"
#include "HalfFace/TetTopology.hh"
#include "Meshes.hh"

namespace hfr {
namespace {

using VH = VertexHandle;
using EH = EdgeHandle;
using HEH = HalfEdgeHandle;
using FH = FaceHandle;
using HFH = HalfFaceHandle;
using CH = CellHandle;

/// Names only: nothing here computes.
class TetrahedralMesh : public TetMesh {
 public:
  TetrahedralMesh() = default;
  explicit TetrahedralMesh(TetMesh mesh) : TetMesh(std::move(mesh)) {}

  Vec3 vertex(VH v) const { return point(v); }
  void set_vertex(VH v, Vec3 p) { set_point(v, p); }
  VH from_vertex_handle(HEH e) const { return from_vertex(e); }
  VH to_vertex_handle(HEH e) const { return to_vertex(e); }
  static HEH opposite_halfedge_handle(HEH e) { return opposite_halfedge(e); }
  HFH opposite_halfface_handle(HFH h) const { return opposite_halfface(h); }
  std::vector<VH> get_cell_vertices(CH c) const { return to_vector(cell_vertices(c)); }
  std::vector<VH> get_cell_vertices(CH c, VH v) const { return to_vector(cell_vertices(c, v)); }
  std::vector<VH> get_cell_vertices(HFH h) const { return to_vector(cell_vertices(h)); }
  std::vector<VH> get_halfface_vertices(HFH h) const { return to_vector(halfface_vertices(h)); }
  std::vector<VH> get_halfface_vertices(HFH h, VH from) const {
    return to_vector(halfface_vertices(h, from));
  }
  CH add_cell(const std::vector<VH>& v) { return TetMesh::add_cell(v[0], v[1], v[2], v[3]); }
  double length(EH e) const { return hfr::length(*this, e); }
  Vec3 vector(HEH e) const { return hfr::vector(*this, e); }
  Vec3 normal(HFH h) const { return hfr::normal(*this, h); }
  template <class H>
  Vec3 barycenter(H h) const {
    return hfr::barycenter(*this, h);
  }
  template <class H>
  bool is_valid(H h) const {
    return exists(h);
  }
  void swap_cell_indices(CH a, CH b) { swap_cells(a, b); }
  void swap_vertex_indices(VH a, VH b) { swap_vertices(a, b); }

 private:
  template <std::size_t N>
  static std::vector<VH> to_vector(const std::array<VH, N>& a) {
    return {a.begin(), a.end()};
  }
};

/// Two cells on the two sides of one face.
TetrahedralMesh pair_of_cells() {
  TetrahedralMesh mesh;
  const VH v0 = mesh.add_vertex({0, 0, 0});
  const VH v1 = mesh.add_vertex({1, 0, 0});
  const VH v2 = mesh.add_vertex({0, 1, 0});
  const VH v3 = mesh.add_vertex({0, 0, 1});
  const VH v4 = mesh.add_vertex({0, 0, -1});
  mesh.add_cell({v0, v1, v2, v3});
  mesh.add_cell({v0, v2, v1, v4});
  return mesh;
}

TEST(OpenVolumeMeshNames, TwoCellsAndWhatTheyConsistOf) {
  const TetrahedralMesh mesh = pair_of_cells();
  EXPECT_EQ(mesh.n_vertices(), 5U);
  EXPECT_EQ(mesh.n_edges(), 9U);
  EXPECT_EQ(mesh.n_faces(), 7U);
  EXPECT_EQ(mesh.n_cells(), 2U);
  EXPECT_EQ(mesh.n_halfedges(), 18U);
  EXPECT_EQ(mesh.n_halffaces(), 8U) << "14 with OpenVolumeMesh: here the outer sides are not stored";
  EXPECT_EQ(mesh.n_logical_faces(), 7U);
  EXPECT_EQ(mesh.genus(), 0);
  EXPECT_EQ(mesh.boundary_faces().count(), 6U);
}

TEST(OpenVolumeMeshNames, ValencesAndNeighbours) {
  const TetrahedralMesh mesh = pair_of_cells();
  EXPECT_EQ(mesh.valence(VH(0)), 4U);
  EXPECT_EQ(mesh.valence(VH(3)), 3U);
  EXPECT_EQ(mesh.valence(mesh.find_edge(VH(0), VH(1))), 3U);
  EXPECT_EQ(mesh.vertex_cells(VH(0)).count(), 2U);
  EXPECT_EQ(mesh.vertex_faces(VH(0)).count(), 5U);
  EXPECT_EQ(mesh.vertex_vertices(VH(4)).count(), 3U);
  EXPECT_EQ(mesh.cell_cells(CH(0)).size(), 1U);
  EXPECT_EQ(mesh.edge_cells(mesh.find_edge(VH(1), VH(2))).count(), 2U);
  for (VH v : mesh.vertices()) EXPECT_TRUE(mesh.is_boundary(v));
}

TEST(OpenVolumeMeshNames, HalfFacesTurnAndMeet) {
  const TetrahedralMesh mesh = pair_of_cells();
  const HFH inner = mesh.find_halfface({VH(0), VH(1), VH(2)});
  ASSERT_TRUE(inner.is_valid());
  EXPECT_NE(mesh.incident_cell(inner), mesh.incident_cell(mesh.opposite_halfface_handle(inner)));
  EXPECT_FALSE(mesh.is_boundary(mesh.face_handle(inner)));
  for (VH v : mesh.get_halfface_vertices(inner)) EXPECT_EQ(mesh.get_halfface_vertices(inner, v)[0], v);
  EXPECT_EQ(mesh.get_halfface_vertices(inner, VH(1)), (std::vector{VH(1), VH(2), VH(0)}));
  EXPECT_THROW(mesh.get_halfface_vertices(inner, VH(4)), InvalidInput);
  const auto all = mesh.get_cell_vertices(inner);
  EXPECT_EQ(all[3], mesh.halfface_opposite_vertex(inner));
  EXPECT_EQ(mesh.get_cell_vertices(CH(1), VH(4))[0], VH(4));
  const HEH e = mesh.halfface_halfedges(inner)[0];
  const HFH side = mesh.adjacent_halfface_in_cell(inner, e);
  EXPECT_EQ(mesh.incident_cell(side), mesh.incident_cell(inner));
  EXPECT_EQ(mesh.next_halfedge_in_halfface(mesh.prev_halfedge_in_halfface(e, inner), inner), e);
  EXPECT_EQ(mesh.from_vertex_handle(e), mesh.to_vertex_handle(mesh.opposite_halfedge_handle(e)));
}

TEST(OpenVolumeMeshNames, Geometry) {
  const TetrahedralMesh mesh = pair_of_cells();
  EXPECT_DOUBLE_EQ(mesh.length(mesh.find_edge(VH(1), VH(2))), std::sqrt(2.0));
  EXPECT_EQ(mesh.vector(mesh.find_halfedge(VH(3), VH(0))), (Vec3{0, 0, -1}));
  EXPECT_FALSE(mesh.find_edge(VH(3), VH(4)).is_valid());
}

TEST(OpenVolumeMeshNames, DeletingIsDeferredAndCollected) {
  TetrahedralMesh mesh(test::kuhn_box(2));
  const FH f = mesh.cell_faces(CH(0))[0];
  EXPECT_FALSE(mesh.is_deleted(f));
  auto number = mesh.request_cell_property<int>("number");
  for (CH c : mesh.cells()) number[c] = static_cast<int>(c.idx());
  mesh.delete_vertex(VH(13));
  EXPECT_TRUE(mesh.is_deleted(VH(13)));
  EXPECT_EQ(mesh.n_vertices(), 27U);
  EXPECT_EQ(mesh.n_logical_vertices(), 26U);
  EXPECT_EQ(mesh.n_logical_cells(), 24U);
  mesh.collect_garbage();
  EXPECT_EQ(mesh.n_vertices(), 26U);
  EXPECT_EQ(number.size(), 24U);
  EXPECT_EQ(check(mesh), Ok);
}

TEST(OpenVolumeMeshNames, SplitsCollapsesAndSwaps) {
  TetrahedralMesh mesh = pair_of_cells();
  const VH middle = mesh.split_edge(mesh.find_edge(VH(1), VH(2)));
  EXPECT_EQ(mesh.n_logical_cells(), 4U);
  EXPECT_EQ(mesh.collapse_edge(mesh.find_halfedge(middle, VH(1))), VH(1));
  EXPECT_EQ(mesh.n_logical_cells(), 2U);
  mesh.collect_garbage();
  EXPECT_EQ(mesh.n_vertices(), 5U);
  const VH apex = mesh.split_face(mesh.find_face({VH(0), VH(1), VH(2)}));
  EXPECT_EQ(mesh.valence(apex), 5U);
  mesh.swap_vertex_indices(apex, VH(0));
  EXPECT_EQ(mesh.valence(VH(0)), 5U);
  mesh.swap_cell_indices(CH(0), CH(5));
  EXPECT_EQ(check(mesh), Ok);
  mesh.clear();
  EXPECT_EQ(mesh.n_cells() + mesh.n_vertices(), 0U);
}

TEST(OpenVolumeMeshNames, PropertiesSharedAnonymousAndAbsent) {
  TetrahedralMesh mesh = pair_of_cells();
  auto shared = mesh.request_face_property<std::string>("colour", "grey");
  const FH f = *mesh.faces().begin();
  shared.set(mesh, f, "red");
  EXPECT_EQ(mesh.get_face_property<std::string>("colour")->get(mesh, f), "red");
  EXPECT_FALSE(mesh.get_face_property<std::string>("color").has_value());
  auto anonymous = mesh.request_vertex_property<bool>();
  anonymous.at(VH(4)) = true;
  EXPECT_THROW(anonymous.at(VH(5)), InvalidInput);
  mesh.add_vertex({});
  EXPECT_FALSE(anonymous.at(VH(5)));
}

TEST(OpenVolumeMeshNames, TopologyOfOneCellByName) {
  const TetrahedralMesh mesh = pair_of_cells();
  const TetTopology t(mesh, CH(0), VH(3));
  EXPECT_EQ(t.a(), VH(3));
  EXPECT_EQ(mesh.from_vertex_handle(t.cd()), t.c());
  EXPECT_FALSE(mesh.is_boundary(t.opposite_a()));
}

}  // namespace
}  // namespace hfr
