// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Unfold.hh"

#include <gtest/gtest.h>

#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

Vec3 unfolded(const TetMesh& mesh, VertexHandle v, int steps) {
  Star star;
  mesh.gather_star(v, star);
  std::vector<HalfFaceHandle> link;
  for (std::size_t i = 0; i < static_cast<std::size_t>(star.size); ++i)
    link.push_back(halfface_of(star.cells[i], star.corners[i]));
  return mesh.point(v) + unfold(StarForm(mesh, v, link), steps);
}

TEST(Unfold, VertexFarOutsideOfItsStarComesBack) {
  Engine engine(3);
  int inverted = 0;
  for (int i = 0; i < 300; ++i) {
    TetMesh mesh = octahedron();
    mesh.set_point(V(0), random_point(engine, -4, 4));
    inverted += n_inverted(mesh) > 0 ? 1 : 0;
    mesh.set_point(V(0), unfolded(mesh, V(0), 40));
    EXPECT_EQ(n_inverted(mesh), 0U) << i;
    EXPECT_LT(norm(mesh.point(V(0))), 0.05);
  }
  EXPECT_GT(inverted, 250);
}

TEST(Unfold, BestPlaceStays) {
  const TetMesh mesh = octahedron();
  EXPECT_LT(norm(unfolded(mesh, V(0), 5)), 1e-9);
}

TEST(Unfold, StarsOfTangledBoxesLoseInversions) {
  int before = 0;
  int after = 0;
  for (std::uint64_t s = 1; s <= 20; ++s) {
    TetMesh mesh = jittered(4, 0.6, s);
    const auto frozen = frozen_vertices(mesh);
    for (VertexHandle v : mesh.vertices()) {
      if (frozen[v.idx()]) continue;
      const Vec3 place = mesh.point(v);
      before += static_cast<int>(n_inverted(mesh));
      mesh.set_point(v, unfolded(mesh, v, 10));
      after += static_cast<int>(n_inverted(mesh));
      mesh.set_point(v, place);
    }
  }
  EXPECT_GT(before, 1000);
  EXPECT_LT(after, before - 300);
}

TEST(Unfold, ScaleAndPlaceOfTheMeshDoNotMatter) {
  TetMesh mesh = octahedron({1.7, 0.3, -0.2});
  const Vec3 here = unfolded(mesh, V(0), 4);
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) mesh.set_point(V(i), 1024.0 * mesh.point(V(i)));
  const Vec3 there = unfolded(mesh, V(0), 4);
  EXPECT_TRUE(there == 1024.0 * here);
}

}  // namespace
}  // namespace hfr::test
