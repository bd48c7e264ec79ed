// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/MaxMinForm.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "Operators/Clusters.hh"
#include "Operators/ProximalStep.hh"

namespace hfr::test {
namespace {

TEST(MaxMinForm, StaysWhereACellIsNotPositive) {
  MaxMinForm form({});
  form.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Vec3 below{0.3, 0.3, -0.5};
  EXPECT_EQ(form.ascend(below, 20), below);
}

TEST(MaxMinForm, OneCellBecomesAsGoodAsItsTriangleAllows) {
  // Over an equilateral triangle the best cell is the regular one.
  MaxMinForm form({});
  form.add({0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0});
  const Vec3 apex = form.ascend({0.2, 0.1, 0.3}, 60);
  EXPECT_LT(norm(apex - Vec3{0.5, std::sqrt(0.75) / 3, std::sqrt(2.0 / 3.0)}), 0.05);
}

using Angles = MaxMinForm::Angles;
using Room = MaxMinForm::Room;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The same ascent, cell by cell and slope by slope: what the form must give to the last bit.
class ScalarForm {
 public:
  ScalarForm(Vec3 origin, Angles angles, Room room, Vec3 axis)
      : origin_(origin), all_(angles == Angles::kAll), room_(room), axis_(axis) {}

  void add(Vec3 a, Vec3 b, Vec3 c) { cells_.push_back({a - origin_, b - origin_, c - origin_}); }

  Vec3 ascend(Vec3 start, int iterations) {
    double sum = 0;
    for (const Corners3& p : cells_)
      for (std::size_t i = 0; i < 3; ++i) sum += norm(p[(i + 1) % 3] - p[i]);
    const double unit = sum / (3.0 * static_cast<double>(cells_.size()));
    scaled_ = cells_;
    for (Corners3& p : scaled_)
      for (Vec3& corner : p) corner = (1.0 / unit) * corner;
    const Vec3 first = (1.0 / unit) * (start - origin_);
    Vec3 x = first;
    double now = worst(x);
    if (!(now > 0)) return start;
    double u = 0.5;
    std::vector<Slope> f = slopes(x, 2 * now + 0.05);
    for (int i = 0; i < iterations && u > 1e-5 && !f.empty(); ++i) {
      const auto [d, level] = step(f, u);
      const double promise = level - now;
      const double next = worst(x + d);
      if (!(next > now)) {
        u *= 0.25;
        continue;
      }
      const double gain = next - now;
      if (gain > 0.5 * promise) u *= 2.5;
      if (gain < 0.1 * promise) u *= 0.5;
      x = x + d;
      const bool enough = gain < kEnough * now && promise < 2 * kEnough * now;
      now = next;
      if (enough) break;
      f = slopes(x, 2 * now + 0.05);
    }
    return x == first ? start : origin_ + unit * x;
  }

  int n_full = 0, n_nan = 0;  // how often slopes were left out, or a sin² was NaN

 private:
  using Corners3 = std::array<Vec3, 3>;
  struct Slope {
    double value;
    Vec3 gradient;
  };
  static constexpr double kEnough = 2e-4, kLevel = 0.01;

  /// sin² at the edges of the triangle and at those to x, in turn, and half the relative gradients; infinite
  /// where the angle does not count.
  std::array<Slope, 6> angles(const Corners3& p, Vec3 x) const {
    std::array<Vec3, 3> e, r, n, dq;
    std::array<double, 3> q;
    for (std::size_t i = 0; i < 3; ++i) {
      e[i] = p[(i + 1) % 3] - p[i];
      r[i] = x - p[i];
      n[i] = cross(e[i], r[i]);
      q[i] = norm2(n[i]);
      dq[i] = (1.0 / q[i]) * (norm2(e[i]) * r[i] - dot(e[i], r[i]) * e[i]);
    }
    const Vec3 normal = cross(e[0], p[2] - p[0]);
    const double det = dot(normal, r[0]);
    const Vec3 rise = (1.0 / det) * normal;
    std::array<Slope, 6> out;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t h = (i + 2) % 3;
      out[2 * i] = {norm2(e[i]) * (det * det) / (norm2(normal) * q[i]), rise - dq[i]};
      out[2 * i + 1] = {norm2(r[i]) * (det * det) / (q[h] * q[i]),
                        (1.0 / norm2(r[i])) * r[i] + rise - dq[h] - dq[i]};
      if (!all_ && !(dot(normal, n[i]) > 0)) out[2 * i].value = kInfinity;
      if (!all_ && !(dot(n[h], n[i]) < 0)) out[2 * i + 1].value = kInfinity;
    }
    return out;
  }

  double worst(Vec3 x) {
    double worst = kInfinity;
    for (const Corners3& p : scaled_) {
      if (!(dot(cross(p[1] - p[0], p[2] - p[0]), x - p[0]) > 0)) return 0;
      for (const Slope& f : angles(p, x)) {
        worst = std::min(worst, f.value);
        n_nan += std::isnan(f.value) ? 1 : 0;
      }
    }
    return worst;
  }

  std::vector<Slope> slopes(Vec3 x, double below) {
    std::vector<Slope> out;
    for (const Corners3& p : scaled_) {
      for (const Slope& f : angles(p, x)) {
        if (!(f.value < below)) continue;
        if (out.size() == 384) {
          ++n_full;
          return out;
        }
        const Vec3 gradient = (2.0 * f.value) * f.gradient;
        const Vec3 along = dot(gradient, axis_) * axis_;
        out.push_back({f.value, room_ == Room::kSpace  ? gradient
                                : room_ == Room::kLine ? along
                                                       : gradient - along});
      }
    }
    return out;
  }

  static std::pair<Vec3, double> step(const std::vector<Slope>& f, double u) {
    auto slopes = std::make_unique<detail::MaxMinSlopes>();
    slopes->size = f.size();
    for (std::size_t i = 0; i < f.size(); ++i) {
      slopes->value[i] = f[i].value;
      const Vec3 g = f[i].gradient;
      slopes->x[i] = g.x, slopes->y[i] = g.y, slopes->z[i] = g.z;
    }
    const auto by_value = [](const Slope& a, const Slope& b) { return a.value < b.value; };
    const auto least = std::min_element(f.begin(), f.end(), by_value);
    detail::StepWeights w;
    w.size = 1;
    w.at[0] = static_cast<std::size_t>(least - f.begin());
    w.weight[0] = 1;
    for (int turn = 0;; ++turn) {
      const hfr_real3 d = w.step(*slopes, u);
      std::size_t low = 0;
      double low_value = kInfinity;
      for (std::size_t i = 0; i < f.size(); ++i) {
        if (!(slopes->model(i, d) < low_value)) continue;
        low_value = slopes->model(i, d);
        low = i;
      }
      const double gap = w.highest(*slopes, d, low_value) - low_value;
      const bool level =
          !(gap > kLevel * (low_value - least->value) && gap > kLevel * kEnough * least->value);
      if (turn == detail::kMostStepTurns || level || !take_in(*slopes, u, low, w))
        return {{d.x, d.y, d.z}, low_value};
    }
  }

  Vec3 origin_;
  bool all_;
  Room room_;
  Vec3 axis_;
  std::vector<Corners3> cells_, scaled_;
};

using Bits = std::array<std::uint64_t, 3>;

/// Random triangles round a place, positive as seen from there, that need not close. Some are so small that
/// all their angles are NaN. `alike` ones are faces of an octahedron, shaken a little.
struct RandomTriangles {
  std::vector<std::array<Vec3, 3>> all;

  RandomTriangles(Engine& engine, std::size_t n, Vec3 from, double size, bool alike) {
    while (all.size() < n) {
      const bool speck = uniform(engine, 0, 1) < 0.02;
      const Vec3 middle = random_point(engine, -1, 1);
      std::array<Vec3, 3> p;
      for (int k = 0; k < 3; ++k) {
        Vec3 tip;
        tip[k] = middle[k] > 0 ? 1 : -1;
        const Vec3 out = speck   ? 1e-100 * random_point(engine, -1, 1)
                         : alike ? tip + random_point(engine, -0.1, 0.1)
                                 : middle + random_point(engine, -0.7, 0.7);
        p[static_cast<std::size_t>(k)] = from + size * out;
      }
      const double det = dot(cross(p[1] - p[0], p[2] - p[0]), from - p[0]);
      if (det < 0) std::swap(p[1], p[2]);
      if (!speck && std::abs(det) < 0.05 * size * size * size) continue;
      all.push_back(p);
    }
  }
};

TEST(MaxMinFormProperty, AscentIsTheScalarOneToTheLastBit) {
  Engine engine(21);
  int n_full = 0;
  int n_nan = 0;
  for (const Angles angles : {Angles::kAll, Angles::kAcute}) {
    for (const Room room : {Room::kSpace, Room::kPlane, Room::kLine}) {
      int moved = 0;
      for (int round = 0; round < 200; ++round) {
        const bool alike = round % 20 == 0;
        const std::size_t n = alike ? (round % 40 == 0 ? 300 : 250) : 1 + engine() % 45;
        const Vec3 at = random_point(engine, -3, 3);
        const double size = round % 5 == 0 ? 1e-40 : round % 5 == 1 ? 1e40 : 0.7;
        const Vec3 direction = random_point(engine, -1, 1);
        const Vec3 axis = (1.0 / norm(direction)) * direction;
        const RandomTriangles triangles(engine, n, round % 5 < 2 ? Vec3{} : at, size, alike);
        const Vec3 start = round % 5 < 2 ? Vec3{} : at;
        MaxMinForm form(start, angles);
        form.confine(room, axis);
        ScalarForm scalar(start, angles, room, axis);
        for (const auto& p : triangles.all) {
          form.add(p[0], p[1], p[2]);
          scalar.add(p[0], p[1], p[2]);
        }
        for (int again = 0; again < 2; ++again) {  // the form remembers which cells were worst
          const Vec3 from = again ? start + (0.01 * size) * direction : start;
          const Vec3 expected = scalar.ascend(from, 12);
          const Vec3 found = form.ascend(from, 12);
          EXPECT_EQ(std::bit_cast<Bits>(found), std::bit_cast<Bits>(expected)) << n << " cells";
          moved += found == from ? 0 : 1;
        }
        n_full += scalar.n_full;
        n_nan += scalar.n_nan;
      }
      EXPECT_GT(moved, 100);
    }
  }
  EXPECT_GT(n_full, 10) << "no form has more slopes than there is room for";
  EXPECT_GT(n_nan, 20) << "no cell is so small that its angles are NaN";
}

}  // namespace
}  // namespace hfr::test
