// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/StarForm.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

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
          const double form = hfr_star_decision(star.cell(i), to_kernel(x));
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
  int better = 0;
  for (int round = 0; round < 300; ++round) {
    StarForm::Trials x, y, z, found;
    StarForm::Trials exact;
    exact.fill(std::numeric_limits<double>::infinity());
    for (std::size_t t = 0; t < x.size(); ++t) {
      const Vec3 p = random_point(engine, -0.2, 0.2);
      x[t] = p.x;
      y[t] = p.y;
      z[t] = p.z;
      for (std::size_t i = 0; i < star.size(); ++i)
        exact[t] = std::min(exact[t], hfr_star_decision(star.cell(i), to_kernel(p)));
    }
    const double floor = uniform(engine, -0.5, 0.7);
    star.worst(x, y, z, floor, found);
    const bool any = std::any_of(exact.begin(), exact.end(), [&](double q) { return q > floor; });
    for (std::size_t t = 0; t < x.size(); ++t) {
      if (any)
        EXPECT_EQ(found[t], exact[t]);
      else
        EXPECT_LE(found[t], floor);
    }
    ++(any ? better : stopped);
  }
  EXPECT_GT(stopped, 30);
  EXPECT_GT(better, 30);
}

TEST(StarForm, LargestMAndNewtonSharesAreThoseOfTheCellsInOrder) {
  Engine engine(10);
  int positive = 0;
  int not_positive = 0;
  const TetMesh mesh = jittered(4, 0.15, 13);
  for (VertexHandle v : mesh.vertices()) {
    const auto link = link_of(mesh, v);  // of 1 to 24 cells, so not all fill whole blocks
    const StarForm star(mesh, v, link);
    const Vec3 x = random_point(engine, -0.25, 0.25);
    double m_max = 0;
    for (std::size_t i = 0; i < star.size(); ++i)
      m_max = std::max(m_max, hfr_star_m(star.cell(i), to_kernel(x)));
    EXPECT_EQ(star.largest_m(to_kernel(x), std::numeric_limits<double>::infinity()), m_max);
    EXPECT_GE(star.largest_m(to_kernel(x), 0.5 * m_max), 0.5 * m_max);
    if (!(m_max < std::numeric_limits<double>::infinity())) {
      ++not_positive;
      continue;
    }
    ++positive;
    hfr_newton_share sum = {};
    for (std::size_t i = 0; i < star.size(); ++i) {
      const hfr_newton_share share = hfr_star_newton(star.cell(i), to_kernel(x), m_max);
      sum.gradient.x += share.gradient.x;
      sum.xy += share.xy;
      sum.zz += share.zz;
    }
    const hfr_newton_share found = star.newton(to_kernel(x), m_max);
    EXPECT_EQ(found.gradient.x, sum.gradient.x);
    EXPECT_EQ(found.xy, sum.xy);
    EXPECT_EQ(found.zz, sum.zz);
  }
  EXPECT_GT(positive, 50);
  EXPECT_GT(not_positive, 5);
}

}  // namespace
}  // namespace hfr::test
