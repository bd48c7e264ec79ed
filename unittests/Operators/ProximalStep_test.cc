// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/ProximalStep.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

using Slopes = detail::MaxMinSlopes;

/// In which gradients lie; kFew: each is one of three, or their middle.
enum class Span { kSpace, kPlane, kLine, kPoint, kFew };

std::unique_ptr<Slopes> random_slopes(Engine& engine, std::size_t n, Span span, double spread) {
  auto f = std::make_unique<Slopes>();
  f->size = n;
  const Vec3 axis = random_point(engine, -1, 1), other = random_point(engine, -1, 1);
  const std::array<Vec3, 4> few = {axis, other, cross(axis, other), 0.5 * (axis + other)};
  for (std::size_t i = 0; i < n; ++i) {
    const double a = uniform(engine, -1, 1), b = uniform(engine, -1, 1);
    const Vec3 g = span == Span::kSpace   ? random_point(engine, -1, 1)
                   : span == Span::kPlane ? a * axis + b * other
                   : span == Span::kLine  ? a * axis
                   : span == Span::kPoint ? axis
                                          : few[engine() % 4];
    f->value[i] = 0.1 + spread * uniform(engine, 0, 1);
    f->x[i] = g.x, f->y[i] = g.y, f->z[i] = g.z;
  }
  for (std::size_t i = n; i < f->padded(); ++i) {
    f->value[i] = HFR_INFINITY;
    f->x[i] = f->y[i] = f->z[i] = 0;
  }
  return f;
}

double lowest_model(const Slopes& f, Vec3 d) {
  double least = HFR_INFINITY;
  for (std::size_t i = 0; i < f.size; ++i) least = std::min(least, f.model(i, {d.x, d.y, d.z}));
  return least;
}

/// What a step is to be largest in.
double objective(const Slopes& f, double u, Vec3 d) { return lowest_model(f, d) - norm2(d) / (2 * u); }

/// The same by another way: weight goes from the highest model to the lowest (Mitchell, Demyanov &
/// Malozemov, 1974), as often as it takes.
Vec3 slow_step(const Slopes& f, double u) {
  std::vector<double> weight(f.size, 0.0);
  weight[static_cast<std::size_t>(std::min_element(f.value.begin(), f.value.begin() + f.size) -
                                  f.value.begin())] = 1;
  const auto gradient = [&](std::size_t i) { return Vec3{f.x[i], f.y[i], f.z[i]}; };
  Vec3 d;
  for (int turn = 0; turn < 200'000; ++turn) {
    d = {};
    for (std::size_t i = 0; i < f.size; ++i) d = d + (u * weight[i]) * gradient(i);
    std::size_t low = 0, high = 0;
    double least = HFR_INFINITY, most = -HFR_INFINITY;
    for (std::size_t i = 0; i < f.size; ++i) {
      const double m = f.value[i] + dot(gradient(i), d);
      if (m < least) least = m, low = i;
      if (weight[i] > 0 && m > most) most = m, high = i;
    }
    if (!(most - least > 1e-9)) break;
    const double curvature = u * norm2(gradient(low) - gradient(high));
    const double share = std::min(weight[high], (most - least) / curvature);
    weight[low] += share;
    weight[high] -= share;
  }
  return d;
}

template <std::size_t kLanes>
detail::MaxMinStep step(const Slopes& f, double u, double level) {
  detail::MaxMinStep out;
  detail::proximal_step<Lanes<kLanes>>(&f, u, level, 1e-9, &out);
  return out;
}

TEST(ProximalStep, OneFunctionIsFollowedUphill) {
  Engine engine(3);
  const auto f = random_slopes(engine, 1, Span::kSpace, 0.2);
  const auto [d, promise] = step<2>(*f, 0.25, 1e-6);
  EXPECT_EQ(d.x, 0.25 * f->x[0]);
  EXPECT_EQ(d.y, 0.25 * f->y[0]);
  EXPECT_EQ(d.z, 0.25 * f->z[0]);
  EXPECT_EQ(promise, f->model(0, d));
}

TEST(ProximalStepProperty, NoStepIsBetter) {
  Engine engine(17);
  int several = 0;
  for (const Span span : {Span::kSpace, Span::kPlane, Span::kLine, Span::kPoint, Span::kFew}) {
    for (int round = 0; round < 60; ++round) {
      const std::size_t n = round % 10 == 0 ? Slopes::kCapacity : 1 + engine() % 40;
      const double u = std::pow(10.0, uniform(engine, -4, 1));
      // Values as close to each other as they are where an ascent ends, some of them the same.
      const auto f = random_slopes(engine, n, span, round % 3 == 0 ? 0 : round % 3 == 1 ? 1e-3 : 0.2);
      const auto [d, promise] = step<2>(*f, u, 1e-6);
      const Vec3 found{d.x, d.y, d.z}, expected = slow_step(*f, u);
      EXPECT_DOUBLE_EQ(promise, lowest_model(*f, found));
      EXPECT_GE(objective(*f, u, found), objective(*f, u, expected) - 1e-8) << n << " functions, u " << u;
      EXPECT_LE(objective(*f, u, found), objective(*f, u, expected) + 1e-6) << "the reference is at fault";
      several += n > 4 ? 1 : 0;
      const auto four = step<4>(*f, u, 1e-6).d, eight = step<8>(*f, u, 1e-6).d;
      EXPECT_TRUE(d.x == four.x && d.y == four.y && d.z == four.z);
      EXPECT_TRUE(d.x == eight.x && d.y == eight.y && d.z == eight.z);
    }
  }
  EXPECT_GT(several, 200);
}

TEST(ProximalStep, EndsWhereGradientsAreNoNumbers) {
  Engine engine(9);
  for (const double bad : {HFR_INFINITY, -HFR_INFINITY, std::nan("")}) {
    for (std::size_t at = 0; at < 5; ++at) {
      const auto f = random_slopes(engine, 5, Span::kSpace, 0.01);
      f->y[at] = bad;
      static_cast<void>(step<2>(*f, 0.5, 1e-6));
    }
  }
}

}  // namespace
}  // namespace hfr::test
