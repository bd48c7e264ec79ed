// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Metrics.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "Quality/Tets.hh"

namespace hfr {
namespace {

using test::RandomTets;
using test::regular_tet;
using test::swapped;
using test::Tet;
using Real = long double;

// Each metric once more, from its definition and by another way than the kernels go.
struct Reference {
  struct V {
    Real x, y, z;
  };
  std::array<V, 4> p;

  explicit Reference(const Tet& t) {
    for (std::size_t i = 0; i < 4; ++i) p[i] = {t[i].x, t[i].y, t[i].z};
  }
  static V sub(V a, V b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  static V scaled(Real s, V a) { return {s * a.x, s * a.y, s * a.z}; }
  static Real dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static V cross(V a, V b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
  Real length(std::size_t i, std::size_t j) const { return std::sqrt(dot(sub(p[i], p[j]), sub(p[i], p[j]))); }
  Real volume() const { return -dot(sub(p[0], p[3]), cross(sub(p[1], p[3]), sub(p[2], p[3]))) / 6; }
  std::array<Real, 6> lengths() const {
    return {length(0, 1), length(0, 2), length(0, 3), length(1, 2), length(1, 3), length(2, 3)};
  }
  // Heron
  Real area(std::size_t i, std::size_t j, std::size_t k) const {
    const Real a = length(i, j);
    const Real b = length(j, k);
    const Real c = length(k, i);
    const Real s = (a + b + c) / 2;
    return std::sqrt(s * (s - a) * (s - b) * (s - c));
  }
  // Angle between the other two corners, seen along the edge.
  Real dihedral(std::size_t i, std::size_t j, std::size_t k, std::size_t l) const {
    const V e = sub(p[j], p[i]);
    const auto flat = [&](V w) { return sub(w, scaled(dot(w, e) / dot(e, e), e)); };
    const V u = flat(sub(p[k], p[i]));
    const V v = flat(sub(p[l], p[i]));
    const Real angle = std::acos(dot(u, v) / std::sqrt(dot(u, u) * dot(v, v)));
    return std::copysign(angle * 180 / std::numbers::pi_v<Real>, volume());
  }
  std::array<Real, 6> dihedrals() const {
    return {dihedral(0, 1, 2, 3), dihedral(0, 2, 1, 3), dihedral(0, 3, 1, 2),
            dihedral(1, 2, 0, 3), dihedral(1, 3, 0, 2), dihedral(2, 3, 0, 1)};
  }
  // Distance to the point that is equally far from all four corners (Cramer's rule).
  Real circumradius() const {
    const V u = sub(p[1], p[0]);
    const V v = sub(p[2], p[0]);
    const V w = sub(p[3], p[0]);
    const V r = {dot(u, u) / 2, dot(v, v) / 2, dot(w, w) / 2};
    const auto det = [](V a, V b, V c) { return dot(a, cross(b, c)); };
    const V cx = {u.x, v.x, w.x};
    const V cy = {u.y, v.y, w.y};
    const V cz = {u.z, v.z, w.z};
    const V centre = scaled(1 / det(cx, cy, cz), V{det(r, cy, cz), det(cx, r, cz), det(cx, cy, r)});
    return std::sqrt(dot(centre, centre));
  }
  Real value(Metric metric) const {
    const auto l = lengths();
    const auto angles = dihedrals();
    Real square_sum = 0;
    for (const Real x : l) square_sum += x * x;
    const Real sign = std::copysign(Real{1}, volume());
    const auto smaller = [](Real a, Real b) { return std::abs(a) < std::abs(b); };
    switch (metric) {
      case Metric::kVolumeLength:
        return 6 * std::sqrt(Real{2}) * volume() / std::pow(square_sum / 6, Real{1.5});
      case Metric::kMinDihedral:
        return *std::min_element(angles.begin(), angles.end(), smaller);
      case Metric::kMaxDihedral:
        return *std::max_element(angles.begin(), angles.end(), smaller);
      case Metric::kMinSine: {
        Real least = 1;
        for (const Real a : angles)
          least = std::min(least, std::sin(std::abs(a) * std::numbers::pi_v<Real> / 180));
        return sign * least;
      }
      case Metric::kMeanRatio:
        return sign * 12 * std::pow(3 * std::abs(volume()), Real{2} / 3) / square_sum;
      case Metric::kRadiusRatio: {
        const Real areas = area(0, 1, 2) + area(0, 1, 3) + area(0, 2, 3) + area(1, 2, 3);
        return 3 * (3 * volume() / areas) / circumradius();
      }
      case Metric::kScaledJacobian: {
        const Real corner =
            std::max({l[0] * l[1] * l[2], l[0] * l[3] * l[4], l[1] * l[3] * l[5], l[2] * l[4] * l[5]});
        return 6 * volume() * std::sqrt(Real{2}) / corner;
      }
      case Metric::kEdgeRatio:
        return sign * *std::min_element(l.begin(), l.end()) / *std::max_element(l.begin(), l.end());
      case Metric::kVolume:
        return volume();
    }
    return 0;
  }
};

double reported(Metric metric, const Tet& t) { return reported_quality(metric, t[0], t[1], t[2], t[3]); }
double decided(Metric metric, const Tet& t) { return quality(metric, t[0], t[1], t[2], t[3]); }

class EveryMetric : public testing::TestWithParam<Metric> {};
INSTANTIATE_TEST_SUITE_P(Metrics, EveryMetric, testing::ValuesIn(kMetrics), [](const auto& instance) {
  std::string name(metric_name(instance.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryMetric, AgreesWithItsDefinitionOnRandomCells) {
  RandomTets tets(17);
  int positive = 0;
  for (int i = 0; i < 20000; ++i) {
    const Tet t = tets.next();
    const auto expected = static_cast<double>(Reference(t).value(GetParam()));
    positive += expected > 0;
    const double found = reported(GetParam(), t);
    ASSERT_NEAR(found, expected, 1e-9 * std::max(1.0, std::abs(expected))) << "tet " << i;
  }
  EXPECT_GT(positive, 5000);
  EXPECT_LT(positive, 15000);
}

TEST_P(EveryMetric, IsPositiveForTheRegularCellAndNegativeForItsMirror) {
  EXPECT_GT(decided(GetParam(), regular_tet()), 0.0);
  EXPECT_DOUBLE_EQ(decided(GetParam(), swapped(regular_tet())), -decided(GetParam(), regular_tet()));
}

TEST_P(EveryMetric, EvenPermutationsKeepTheValueAndOddOnesFlipTheSign) {
  RandomTets tets(3);
  for (int i = 0; i < 300; ++i) {
    const Tet t = tets.next();
    const double value = decided(GetParam(), t);
    std::array<std::size_t, 4> order = {0, 1, 2, 3};
    do {
      int inversions = 0;
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b) inversions += order[a] > order[b];
      const double sign = inversions % 2 == 0 ? 1.0 : -1.0;
      const Tet permuted = {{t[order[0]], t[order[1]], t[order[2]], t[order[3]]}};
      ASSERT_NEAR(sign * decided(GetParam(), permuted), value, 1e-11 * std::abs(value) + 1e-15);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST_P(EveryMetric, TranslationAndScaleDoNotMatter) {
  RandomTets tets(5);
  for (int i = 0; i < 300; ++i) {
    const Tet t = tets.next();
    for (const double scale : {1.0 / 1024, 1.0, 65536.0}) {
      Tet moved = t;
      for (Vec3& p : moved) p = scale * p;
      const double factor = GetParam() == Metric::kVolume ? scale * scale * scale : 1.0;
      // powers of two scale exactly
      ASSERT_EQ(decided(GetParam(), moved), factor * decided(GetParam(), t));
    }
    Tet moved = t;
    for (Vec3& p : moved) p = p + Vec3{3, -2, 5};
    const double value = decided(GetParam(), t);
    if (std::abs(value) > 1e-3) {
      ASSERT_NEAR(decided(GetParam(), moved), value, 1e-9);
    }
  }
}

TEST_P(EveryMetric, FlatAndCollapsedCellsAreZeroAndNeverNaN) {
  const Vec3 a{0, 0, 0};
  const Vec3 b{1, 0, 0};
  const Vec3 c{0, 1, 0};
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Tet> cells = {
      {{a, b, c, {1, 1, 0}}},                                    // four corners of a square
      {{a, b, c, {0.25, 0.25, 0}}},                              // a corner inside the opposite face
      {{a, b, c, b}},                                            // two corners alike
      {{a, a, a, a}},                                            // one point
      {{a, b, {2, 0, 0}, {3, 0, 0}}},                            // on a line
      {{a, {0.1, 0.3, 0.7}, {0.2, 0.6, 1.4}, {0.3, 0.9, 2.1}}},  // on a line, with rounding
      {{a, 1e-200 * b, 1e-200 * c, {0, 0, 1e-200}}},             // squares underflow
      {{a, {inf, 0, 0}, c, {0, 0, 1}}},                          // infinite
  };
  for (const Tet& cell : cells) {
    const double value = decided(GetParam(), cell);
    EXPECT_LE(value, 0.0);
    EXPECT_FALSE(std::isnan(value));
    EXPECT_FALSE(std::isnan(reported(GetParam(), cell)));
  }
}

TEST_P(EveryMetric, DecisionAndReportAreMonotoneInversesOfEachOther) {
  RandomTets tets(11);
  std::vector<double> decisions;
  for (int i = 0; i < 2000; ++i) decisions.push_back(decided(GetParam(), tets.next()));
  std::sort(decisions.begin(), decisions.end());
  const bool falls = GetParam() == Metric::kMaxDihedral;
  for (std::size_t i = 0; i + 1 < decisions.size(); ++i) {
    const double low = report_value(GetParam(), decisions[i]);
    const double high = report_value(GetParam(), decisions[i + 1]);
    if (falls && (decisions[i] < 0) == (decisions[i + 1] < 0)) {
      EXPECT_GE(low, high);
    }
    if (!falls) {
      EXPECT_LE(low, high);
    }
    const double back = decision_value(GetParam(), low);
    EXPECT_NEAR(back, decisions[i], 1e-12 * std::max(1.0, std::abs(decisions[i])));
  }
}

TEST_P(EveryMetric, NameLeadsBack) { EXPECT_EQ(metric_from_name(metric_name(GetParam())), GetParam()); }

TEST(Metrics, RegularCellHasTheValuesOfTheLiterature) {
  const Tet t = regular_tet();
  const double angle = std::acos(1.0 / 3.0) * 180 / std::numbers::pi;
  EXPECT_NEAR(reported(Metric::kVolumeLength, t), 1.0, 1e-14);
  EXPECT_NEAR(reported(Metric::kMinDihedral, t), angle, 1e-12);
  EXPECT_NEAR(reported(Metric::kMaxDihedral, t), angle, 1e-12);
  EXPECT_NEAR(reported(Metric::kMinSine, t), 2 * std::sqrt(2.0) / 3, 1e-14);
  EXPECT_NEAR(reported(Metric::kMeanRatio, t), 1.0, 1e-14);
  EXPECT_NEAR(reported(Metric::kRadiusRatio, t), 1.0, 1e-14);
  EXPECT_NEAR(reported(Metric::kScaledJacobian, t), 1.0, 1e-14);
  EXPECT_NEAR(reported(Metric::kEdgeRatio, t), 1.0, 1e-14);
  EXPECT_NEAR(reported(Metric::kVolume, t), std::sqrt(2.0) / 12, 1e-15);
}

TEST(Metrics, CubeCornerHasRightAnglesAtItsLegs) {
  const auto found = dihedrals({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  const double slant = std::atan(std::sqrt(2.0)) * 180 / std::numbers::pi;
  for (const std::size_t leg : {0U, 1U, 2U}) EXPECT_NEAR(found[leg], 90.0, 1e-12);
  for (const std::size_t edge : {3U, 4U, 5U}) EXPECT_NEAR(found[edge], slant, 1e-12);
}

TEST(Metrics, DihedralsOfAFlatSquareAreZeroOrStraight) {
  auto found = dihedrals({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  std::sort(found.begin(), found.end());
  EXPECT_THAT(found, testing::ElementsAre(0, 0, 0, 0, 180, 180));
}

TEST(Metrics, SmallestDihedralIgnoresObtuseAngles) {
  // A wide cell: its sine is small because of angles near 180 degrees only in part.
  const Tet t = {{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.4, 0.3}}};
  const auto angles = dihedrals(t[0], t[1], t[2], t[3]);
  const double least = *std::min_element(angles.begin(), angles.end());
  const double largest = *std::max_element(angles.begin(), angles.end());
  ASSERT_GT(largest, 95.0);
  EXPECT_NEAR(reported(Metric::kMinDihedral, t), least, 1e-12);
  EXPECT_NEAR(reported(Metric::kMaxDihedral, t), largest, 1e-12);
}

TEST(Metrics, AngleGoalIsMetExactlyAtItsDecisionValue) {
  const double goal = decision_value(Metric::kMinDihedral, 30.0);
  EXPECT_NEAR(goal, 0.25, 1e-15);
  EXPECT_NEAR(report_value(Metric::kMaxDihedral, decision_value(Metric::kMaxDihedral, 150.0)), 150.0, 1e-12);
  EXPECT_NEAR(report_value(Metric::kMaxDihedral, decision_value(Metric::kMaxDihedral, 80.0)), 80.0, 1e-12);
}

TEST(Metrics, DihedralDecisionIsTheSquareOfTheSine) {
  EXPECT_NEAR(dihedral_decision(30), 0.25, 1e-15);
  EXPECT_NEAR(dihedral_decision(60), 0.75, 1e-15);
  EXPECT_NEAR(dihedral_decision(20), decision_value(Metric::kMinDihedral, 20), 1e-15);
}

TEST(Metrics, MeasureAnglesWhereTheDecisionIsASquaredSineOfOne) {
  const auto regular = regular_tet();
  std::size_t n_of_angles = 0;
  for (Metric metric : kMetrics) {
    with_metric(metric, [&](const auto& decision) {
      if (!kMeasuresAngles<std::remove_cvref_t<decltype(decision)>>) return;
      ++n_of_angles;
      const double angle = dihedrals(regular[0], regular[1], regular[2], regular[3])[0];
      EXPECT_NEAR(std::abs(decision(regular[0], regular[1], regular[2], regular[3])),
                  dihedral_decision(angle), 1e-15);
    });
  }
  EXPECT_EQ(n_of_angles, 2U);
  static_assert(!kMeasuresAngles<VolumeLength> && !kMeasuresAngles<CustomMetric>);
}

TEST(Metrics, UnknownNameListsTheNames) {
  try {
    metric_from_name("aspect");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'aspect'"));
    for (const Metric metric : kMetrics)
      EXPECT_THAT(error.what(), testing::HasSubstr(std::string(metric_name(metric))));
  }
}

TEST(CustomMetricTest, NeverCallsAnInvertedCellGood) {
  const CustomMetric always_one([](Vec3, Vec3, Vec3, Vec3) { return 1.0; });
  const CustomMetric nan([](Vec3, Vec3, Vec3, Vec3) { return std::nan(""); });
  const CustomMetric depth(
      [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return quality(Metric::kVolume, a, b, c, d); });
  const Tet good = regular_tet();
  const Tet bad = swapped(good);
  EXPECT_EQ(always_one(good[0], good[1], good[2], good[3]), 1.0);
  EXPECT_EQ(always_one(bad[0], bad[1], bad[2], bad[3]), 0.0);
  EXPECT_EQ(nan(good[0], good[1], good[2], good[3]), 0.0);
  EXPECT_LT(depth(bad[0], bad[1], bad[2], bad[3]), 0.0);
  EXPECT_THROW(CustomMetric(nullptr), InvalidInput);
}

static_assert(TetMetric<VolumeLength>);
static_assert(TetMetric<CustomMetric>);

}  // namespace
}  // namespace hfr
