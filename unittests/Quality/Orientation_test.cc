// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "Quality/Metrics.hh"
#include "Quality/Tets.hh"

namespace hfr {
namespace {

using test::Tet;
__extension__ typedef __int128 Int128;
using IntPoint = std::array<std::int64_t, 3>;

// Exact for coordinates below 2^40: the determinant stays below 2^127.
int exact_sign(const std::array<IntPoint, 4>& p) {
  std::array<std::array<Int128, 3>, 3> m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) m[i][k] = static_cast<Int128>(p[i + 1][k]) - p[0][k];
  const Int128 det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
                     m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
                     m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (det > 0) - (det < 0);
}

Tet scaled(const std::array<IntPoint, 4>& p, double unit) {
  Tet t;
  for (std::size_t i = 0; i < 4; ++i)
    t[i] = {unit * static_cast<double>(p[i][0]), unit * static_cast<double>(p[i][1]),
            unit * static_cast<double>(p[i][2])};
  return t;
}

int orientation_of(const Tet& t) { return orientation(t[0], t[1], t[2], t[3]); }

// Four points of one lattice plane, the last one lifted by a few units in the last place.
class LatticePlanes {
 public:
  std::array<IntPoint, 4> next(std::int64_t lift) {
    const IntPoint origin = vector(std::int64_t{1} << 36);
    const IntPoint e1 = vector(std::int64_t{1} << 18);
    const IntPoint e2 = vector(std::int64_t{1} << 18);
    std::array<std::array<std::int64_t, 2>, 4> in_plane;
    for (auto& [i, j] : in_plane) {
      i = number(std::int64_t{1} << 18);
      j = number(std::int64_t{1} << 18);
    }
    // one base triangle in three is a needle, of which a lift of one unit is lost in rounding
    if (number(1) == 0)
      for (std::size_t k = 0; k < 2; ++k)
        in_plane[2][k] = 2 * in_plane[1][k] - in_plane[0][k] + number(std::int64_t{1} << 6);
    std::array<IntPoint, 4> p;
    for (std::size_t v = 0; v < 4; ++v)
      for (std::size_t k = 0; k < 3; ++k)
        p[v][k] = origin[k] + in_plane[v][0] * e1[k] + in_plane[v][1] * e2[k];
    p[3][static_cast<std::size_t>(number(1) + 1)] += lift;
    return p;
  }

 private:
  std::int64_t number(std::int64_t limit) {
    return std::uniform_int_distribution<std::int64_t>(-limit, limit)(engine_);
  }
  IntPoint vector(std::int64_t limit) {
    const std::int64_t x = number(limit);
    const std::int64_t y = number(limit);
    return {x, y, number(limit)};
  }
  std::mt19937_64 engine_{29};
};

TEST(Orientation, PointsOfOnePlaneAreFlatHoweverItLies) {
  LatticePlanes planes;
  int noisy = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto p = planes.next(0);
    ASSERT_EQ(exact_sign(p), 0);
    const Tet t = scaled(p, 0x1p-40);
    noisy += hfr_orient6(to_real3(t[0]), to_real3(t[1]), to_real3(t[2]), to_real3(t[3])) != 0.0;
    ASSERT_EQ(orientation_of(t), 0);
    for (const Metric metric : kMetrics) ASSERT_EQ(quality(metric, t[0], t[1], t[2], t[3]), 0.0);
  }
  EXPECT_GT(noisy, 10000) << "the generator no longer provokes rounding";
}

TEST(Orientation, LiftOfSomeUnitsInTheLastPlaceIsNeverGivenTheWrongSign) {
  LatticePlanes planes;
  int decided = 0;
  int undecided = 0;
  for (int i = 0; i < 40000; ++i) {
    const std::int64_t lift = i % 2 == 0 ? 1 : -(std::int64_t{1} << (i % 32));
    const auto p = planes.next(lift);
    const int exact = exact_sign(p);
    const int found = orientation_of(scaled(p, 0x1p-40));
    if (found != 0) {
      ASSERT_EQ(found, exact);
    }
    decided += found != 0;
    undecided += found == 0 && exact != 0;
  }
  EXPECT_GT(decided, 10000) << "the bound calls clear cells flat";
  EXPECT_GT(undecided, 1000) << "the generator no longer comes near the bound";
}

TEST(Orientation, PositiveDecisionMeansExactlyPositive) {
  LatticePlanes planes;
  int positive = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto p = planes.next(std::int64_t{1} << (i % 36));
    const int exact = exact_sign(p);
    const Tet t = scaled(p, 0x1p-40);
    for (const Metric metric : kMetrics) {
      const double value = quality(metric, t[0], t[1], t[2], t[3]);
      if (value > 0.0) {
        ASSERT_EQ(exact, 1) << metric_name(metric);
      } else if (value < 0.0) {
        ASSERT_EQ(exact, -1) << metric_name(metric);
      }
      positive += value > 0.0;
    }
  }
  EXPECT_GT(positive, 10000);
}

TEST(Orientation, CheapTestForFlatnessNeverContradictsTheBound) {
  LatticePlanes planes;
  int far = 0;
  for (int i = 0; i < 40000; ++i) {
    const Tet t = scaled(planes.next(std::int64_t{1} << (i % 38)), 0x1p-40);
    const hfr_real3 a = to_real3(t[0]);
    const hfr_real3 b = to_real3(t[1]);
    const hfr_real3 c = to_real3(t[2]);
    const hfr_real3 d = to_real3(t[3]);
    const double det = hfr_orient6(a, b, c, d);
    const double sum2 = hfr_edge_sum2(hfr_sub3(b, a), hfr_sub3(c, a), hfr_sub3(d, a));
    if (!hfr_is_far_from_flat(det, sum2)) continue;
    ++far;
    ASSERT_GT(std::abs(det), hfr_orient6_bound(a, b, c, d));
  }
  EXPECT_GT(far, 1000);
}

TEST(Orientation, CoordinatesOutOfRangeAreFlat) {
  const double huge = 1e200;
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(orientation({0, 0, 0}, {huge, 0, 0}, {0, huge, 0}, {0, 0, huge}), 0);
  EXPECT_EQ(orientation({0, 0, 0}, {inf, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0);
  EXPECT_EQ(orientation({0, 0, 0}, {nan, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0);
  EXPECT_EQ(orientation({0, 0, 0}, {1e-150, 0, 0}, {0, 1e-150, 0}, {0, 0, 1e-150}), 0);
}

}  // namespace
}  // namespace hfr
