// SPDX-License-Identifier: BSD-3-Clause
// Freitag & Ollivier-Gooch, Tetrahedral mesh improvement using swapping and smoothing, 1997: maximise the
// smallest of the sines. Their step is the shortest vector in the convex hull of the gradients of the active
// functions. Here it is the proximal one, the d that maximises min(f + g·d) - d²/2u over all functions that
// are not far above the smallest: its dual is the same problem in the hull with a linear term, so that no
// tolerance decides what is active, and u takes the place of a line search. Only + - * / and comparisons.
#include "Operators/MaxMinForm.hh"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hfr {
namespace {

constexpr double kFirstReach = 0.5;      // u in squared mean edges
constexpr double kSmallestReach = 1e-5;  // the ascent ends here
constexpr double kEnough = 2e-4;         // share of the value that a further step must promise
constexpr double kLevel = 0.1;           // of the promised gain: models this close to each other are level
constexpr double kFarAbove = 2;  // functions above this many times the smallest do not hold a step back
constexpr double kFarAboveFloor = 0.05;
constexpr int kMaxExchanges = 32;  // between weights, for one step

/// A step, and the smallest value that the linear models promise after it.
struct Step {
  Vec3 d;
  double promise = 0;
};

/// Maximises min(f + g·d) - d²/2u. The dual weights live on the simplex; weight goes from the function whose
/// model is largest to the one whose model is smallest until all that have weight are level (Mitchell,
/// Demyanov & Malozemov, 1974).
template <class Slopes>
Step proximal_step(const Slopes& f, double u) {
  std::array<double, 384> weight;
  std::array<std::uint16_t, kMaxExchanges + 1> support;
  std::size_t n_support = 1;
  std::size_t least = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    weight[i] = 0;
    if (f[i].value < f[least].value) least = i;
  }
  weight[least] = 1;
  support[0] = static_cast<std::uint16_t>(least);
  Step step{u * f[least].gradient, 0};
  const auto model = [&](std::size_t i) { return f[i].value + dot(f[i].gradient, step.d); };
  for (int k = 0;; ++k) {
    std::size_t low = 0;
    double low_value = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < f.size(); ++i) {
      const double m = model(i);
      if (m < low_value) {
        low_value = m;
        low = i;
      }
    }
    step.promise = low_value;
    std::size_t high = low;
    double high_value = low_value;
    for (std::size_t s = 0; s < n_support; ++s) {
      const std::size_t i = support[s];
      if (!(weight[i] > 0)) continue;
      const double m = model(i);
      if (m > high_value) {
        high_value = m;
        high = i;
      }
    }
    const double gap = high_value - low_value;
    const double now = f[least].value;
    const double gain = low_value - now;
    if (k == kMaxExchanges || !(gap > kLevel * gain && gap > kLevel * kEnough * now)) return step;
    const Vec3 across = f[low].gradient - f[high].gradient;
    const double curvature = u * norm2(across);
    const double share = gap < curvature * weight[high] ? gap / curvature : weight[high];
    if (std::find(support.begin(), support.begin() + static_cast<std::ptrdiff_t>(n_support), low) ==
        support.begin() + static_cast<std::ptrdiff_t>(n_support))
      support[n_support++] = static_cast<std::uint16_t>(low);
    weight[low] += share;
    weight[high] -= share;
    step.d = step.d + (u * share) * across;
  }
}

}  // namespace

void MaxMinForm::add(Vec3 a, Vec3 b, Vec3 c) {
  Link cell;
  cell.p = {a - origin_, b - origin_, c - origin_};
  unit_ = 0;
  cells_.push_back(cell);
}

void MaxMinForm::scale() {
  double sum = 0;
  for (const Link& cell : cells_)
    for (std::size_t i = 0; i < 3; ++i) sum += norm(cell.p[(i + 1) % 3] - cell.p[i]);
  unit_ = sum / (3.0 * static_cast<double>(cells_.size()));
  const double s = 1.0 / unit_;
  for (Link& cell : cells_) {
    for (Vec3& p : cell.p) p = s * p;
    for (std::size_t i = 0; i < 3; ++i) {
      cell.e[i] = cell.p[(i + 1) % 3] - cell.p[i];
      cell.e2[i] = norm2(cell.e[i]);
    }
    cell.normal = cross(cell.e[0], cell.p[2] - cell.p[0]);
    cell.q = norm2(cell.normal);
  }
}

namespace {

/// What all six angles of a cell need: the side face over edge i of the triangle has the normal n[i]
/// (outward, length twice the area), whose square is q[i]; r[i] leads from corner i to the point.
template <class Link>
struct Sides {
  std::array<Vec3, 3> r, n;
  std::array<double, 3> q;
  double det;

  Sides(const Link& cell, Vec3 x) {
    for (std::size_t i = 0; i < 3; ++i) {
      r[i] = x - cell.p[i];
      n[i] = cross(cell.e[i], r[i]);
      q[i] = norm2(n[i]);
    }
    det = dot(cell.normal, r[0]);
  }
  double base_sin2(const Link& cell, std::size_t i) const {
    return cell.e2[i] * (det * det) / (cell.q * q[i]);
  }
  bool base_is_acute(const Link& cell, std::size_t i) const { return dot(cell.normal, n[i]) > 0; }
  /// At the edge from corner i to the point, between sides i-1 and i.
  double side_sin2(std::size_t i) const { return norm2(r[i]) * (det * det) / (q[(i + 2) % 3] * q[i]); }
  bool side_is_acute(std::size_t i) const { return dot(n[(i + 2) % 3], n[i]) < 0; }
};

}  // namespace

/// Smallest sin² with the point at x, or anything ≤ floor once it is no better; 0 where a cell is not
/// positive.
double MaxMinForm::worst(Vec3 x, double floor) const {
  double worst = std::numeric_limits<double>::infinity();
  const bool all = angles_ == Angles::kAll;
  for (const Link& cell : cells_) {
    const Sides<Link> sides(cell, x);
    if (!(sides.det > 0)) return 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (all || sides.base_is_acute(cell, i)) worst = std::min(worst, sides.base_sin2(cell, i));
      if (all || sides.side_is_acute(i)) worst = std::min(worst, sides.side_sin2(i));
    }
    if (!(worst > floor)) return worst;
  }
  return worst;
}

/// Value and gradient of each sin² below a bound; the point stands at x, all cells positive.
void MaxMinForm::slopes(Vec3 x, double below, Slopes& out) const {
  out.clear();
  const bool all = angles_ == Angles::kAll;
  for (const Link& cell : cells_) {
    const Sides<Link> sides(cell, x);
    std::array<Vec3, 3> dq;  // half the gradients of q[i], over q[i]
    for (std::size_t i = 0; i < 3; ++i)
      dq[i] = (1.0 / sides.q[i]) * (cell.e2[i] * sides.r[i] - dot(cell.e[i], sides.r[i]) * cell.e[i]);
    const Vec3 rise = (1.0 / sides.det) * cell.normal;
    for (std::size_t i = 0; i < 3; ++i) {
      const double base = sides.base_sin2(cell, i);
      if (base < below && (all || sides.base_is_acute(cell, i)) && !out.full())
        out.push_back({base, (2.0 * base) * (rise - dq[i])});
      const double side = sides.side_sin2(i);
      if (side < below && (all || sides.side_is_acute(i)) && !out.full())
        out.push_back(
            {side, (2.0 * side) * ((1.0 / norm2(sides.r[i])) * sides.r[i] + rise - dq[(i + 2) % 3] - dq[i])});
    }
  }
  if (room_ == Room::kSpace) return;
  for (Slope& slope : out) {
    const Vec3 along = dot(slope.gradient, axis_) * axis_;
    slope.gradient = room_ == Room::kLine ? along : slope.gradient - along;
  }
}

Vec3 MaxMinForm::ascend(Vec3 start, int iterations) {
  if (cells_.empty()) return start;
  if (!(unit_ > 0)) scale();
  if (!hfr_is_normal_positive(unit_)) return start;
  Vec3 x = (1.0 / unit_) * (start - origin_);
  const Vec3 first = x;
  double now = worst(x, 0);
  if (!(now > 0)) return start;
  double u = kFirstReach;
  Slopes f;
  slopes(x, kFarAbove * now + kFarAboveFloor, f);
  for (int i = 0; i < iterations && u > kSmallestReach && !f.empty(); ++i) {
    const Step step = proximal_step(f, u);
    const double promise = step.promise - now;
    const Vec3 next_x = x + step.d;
    const double next = worst(next_x, now);
    if (!(next > now)) {
      u *= 0.25;
      continue;
    }
    const double gain = next - now;
    if (gain > 0.5 * promise) u *= 2.5;
    if (gain < 0.1 * promise) u *= 0.5;
    x = next_x;
    const bool enough = gain < kEnough * now && promise < 2 * kEnough * now;
    now = next;
    if (enough) break;
    slopes(x, kFarAbove * now + kFarAboveFloor, f);
  }
  return x == first ? start : origin_ + unit_ * x;
}

}  // namespace hfr
