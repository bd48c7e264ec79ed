// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/StarForm.hh"

#include <gtest/gtest.h>

#include "Operators/Clusters.hh"
#include "Operators/Smooth.hh"

namespace hfr::test {
namespace {

std::vector<HalfFaceHandle> link_of(const TetMesh& mesh, VertexHandle v) {
  std::vector<HalfFaceHandle> link;
  for (CellHandle c : mesh.vertex_cells(v)) link.push_back(halfface_of(c, mesh.cell(c).corner(v)));
  return link;
}

TEST(StarForm, EqualsTheDirectQualityOfEveryCell) {
  Engine engine(8);
  int inverted = 0;
  for (const Vec3 offset : {Vec3{}, Vec3{1000, -2000, 3000}}) {
    TetMesh mesh = jittered(3, 0.45, 11);
    for (VertexHandle v : mesh.vertices()) mesh.set_point(v, mesh.point(v) + offset);
    for (VertexHandle v : mesh.vertices()) {
      const auto link = link_of(mesh, v);
      const StarForm star(mesh, v, link);
      for (int trial = 0; trial < 20; ++trial) {
        const Vec3 x = trial == 0 ? Vec3{} : random_point(engine, -0.4, 0.4);
        for (std::size_t i = 0; i < link.size(); ++i) {
          const double direct = quality_with(mesh, cell_of(link[i]), v, mesh.point(v) + x, VolumeLength{});
          const double form = hfr_star_decision(star.cells()[i], to_kernel(x));
          EXPECT_NEAR(form, direct, 1e-9) << "vertex " << v.idx();
          inverted += direct < 0 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(inverted, 1000);
}

TEST(StarForm, WorstStopsAtTheFloorAndIsExactAboveIt) {
  Engine engine(9);
  const TetMesh mesh = jittered(3, 0.2, 12);
  const VertexHandle v = V(21);  // inside
  const auto link = link_of(mesh, v);
  StarForm star(mesh, v, link);
  int stopped = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 x = random_point(engine, -0.2, 0.2);
    double exact = std::numeric_limits<double>::infinity();
    for (const hfr_star_cell& cell : star.cells())
      exact = std::min(exact, hfr_star_decision(cell, to_kernel(x)));
    const double floor = uniform(engine, -0.5, 0.5);
    const double found = star.worst(x, floor);
    if (exact > floor) {
      EXPECT_EQ(found, exact);
    } else {
      EXPECT_LE(found, floor);
      ++stopped;
    }
  }
  EXPECT_GT(stopped, 100);
  EXPECT_LT(stopped, 900);
}

}  // namespace
}  // namespace hfr::test
