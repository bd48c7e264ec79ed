// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/CellBlock.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Quality/Metrics.hh"
#include "Quality/Tets.hh"

namespace hfr {
namespace {

using test::Tet;

constexpr double kDegrees = 180.0 / std::numbers::pi;

detail::CellBlock evaluated(const std::array<Tet, detail::CellBlock::kSize>& tets) {
  detail::CellBlock block;
  for (std::size_t i = 0; i < tets.size(); ++i)
    for (std::size_t corner = 0; corner < 4; ++corner) block.set_corner(corner, i, tets[i][corner]);
  evaluate(block);
  return block;
}

TEST(CellBlock, DecisionsAreTheBitsOfTheMetrics) {
  test::RandomTets random(2);
  for (int round = 0; round < 50; ++round) {
    std::array<Tet, detail::CellBlock::kSize> tets;
    for (Tet& t : tets) t = random.next();
    tets[7] = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};  // flat
    tets[9] = {{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}};  // one point
    const detail::CellBlock block = evaluated(tets);
    for (std::size_t i = 0; i < tets.size(); ++i) {
      const auto& [a, b, c, d] = tets[i];
      ASSERT_EQ(block.det[i], quality(Metric::kVolume, a, b, c, d));
      ASSERT_EQ(block.min_dihedral[i], quality(Metric::kMinDihedral, a, b, c, d));
      ASSERT_EQ(block.max_dihedral[i], quality(Metric::kMaxDihedral, a, b, c, d));
      ASSERT_EQ(block.volume_length[i], quality(Metric::kVolumeLength, a, b, c, d));
      ASSERT_EQ(block.q[i], reported_quality(Metric::kVolumeLength, a, b, c, d));
    }
  }
}

TEST(CellBlock, AnglesAgreeWithArcTangentsDownToSlivers) {
  test::RandomTets random(6);
  int checked = 0;
  for (int round = 0; round < 200; ++round) {
    std::array<Tet, detail::CellBlock::kSize> tets;
    for (Tet& t : tets) {
      t = random.next();
      for (Vec3& p : t) p.z *= std::pow(10.0, -6.0 * round / 200);  // flatter and flatter
    }
    const detail::CellBlock block = evaluated(tets);
    for (std::size_t i = 0; i < tets.size(); ++i) {
      if (block.min_dihedral[i] <= 0.0) continue;
      const auto angles = dihedrals(tets[i][0], tets[i][1], tets[i][2], tets[i][3]);
      double sum = 0.0;
      for (std::size_t edge = 0; edge < 6; ++edge) {
        sum += angles[edge];
        ASSERT_NEAR(block.cosine[edge][i], std::cos(angles[edge] / kDegrees), 1e-9);
      }
      ASSERT_NEAR(kDegrees * block.angle_sum[i], sum, 1e-5);
      ASSERT_NEAR(kDegrees * block.min_angle[i], *std::min_element(angles.begin(), angles.end()), 1e-9);
      ++checked;
    }
  }
  EXPECT_GT(checked, 5000);
}

}  // namespace
}  // namespace hfr
