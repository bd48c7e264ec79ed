// SPDX-License-Identifier: BSD-3-Clause
// Freitag & Ollivier-Gooch, Tetrahedral mesh improvement using swapping and smoothing, 1997: maximise the
// smallest of the sines. Their step is the shortest vector in the convex hull of the gradients of the active
// functions. Here it is the proximal one, the d that maximises min(f + g·d) - d²/2u over all functions that
// are not far above the smallest: its dual is the same problem in the hull with a linear term, so that no
// tolerance decides what is active, and u takes the place of a line search. Only + - * / and comparisons.
#include "Operators/MaxMinForm.hh"

#include <cmath>

#include "Operators/ProximalStep.hh"
#include "Quality/Lowest.hh"
#include "Quality/Vectors.hh"

namespace hfr {
namespace {

constexpr double kFirstReach = 0.5;      // u in squared mean edges
constexpr double kSmallestReach = 1e-5;  // the ascent ends here
constexpr double kEnough = 2e-4;         // share of the value that a further step must promise
constexpr double kLevel = 0.01;          // of the promised gain: models this close to each other are level
constexpr double kFarAbove = 2;  // functions above this many times the smallest do not hold a step back
constexpr double kFarAboveFloor = 0.05;

constexpr std::size_t kBlock = detail::MaxMinBlock::kSize;
static_assert(kBlock == kLowestBlock);

using Block = detail::MaxMinBlock;
using Slopes = detail::MaxMinSlopes;
using detail::plus;
using detail::times;

HFR_FN hfr_real3 corner(const Block& b, std::size_t k, std::size_t i) {
  return {b.px[k][i], b.py[k][i], b.pz[k][i]};
}
HFR_FN hfr_real3 edge(const Block& b, std::size_t k, std::size_t i) {
  return {b.ex[k][i], b.ey[k][i], b.ez[k][i]};
}
HFR_FN hfr_real3 normal(const Block& b, std::size_t i) {
  return {b.normal_x[i], b.normal_y[i], b.normal_z[i]};
}

HFR_FN double length(hfr_real3 a) { return std::sqrt(hfr_dot3(a, a)); }

/// Lengths of the edges of the triangles.
HFR_FN void measure_block(const Block* b, double (*lengths)[kBlock]) {
  alignas(64) double row[3][kBlock];
  for (std::size_t i = 0; i < kBlock; ++i) {
    row[0][i] = length(hfr_sub3(corner(*b, 1, i), corner(*b, 0, i)));
    row[1][i] = length(hfr_sub3(corner(*b, 2, i), corner(*b, 1, i)));
    row[2][i] = length(hfr_sub3(corner(*b, 0, i), corner(*b, 2, i)));
  }
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < kBlock; ++i) lengths[k][i] = row[k][i];
}

HFR_FN void put(hfr_real3 a, double& x, double& y, double& z) {
  x = a.x;
  y = a.y;
  z = a.z;
}

/// Multiplies the corners and makes the rest of them.
HFR_FN void scale_block(Block* block, double s) {
  Block b = *block;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const hfr_real3 p0 = times(s, corner(b, 0, i));
    const hfr_real3 p1 = times(s, corner(b, 1, i));
    const hfr_real3 p2 = times(s, corner(b, 2, i));
    const hfr_real3 e0 = hfr_sub3(p1, p0);
    const hfr_real3 e1 = hfr_sub3(p2, p1);
    const hfr_real3 e2 = hfr_sub3(p0, p2);
    const hfr_real3 across = hfr_cross3(e0, hfr_sub3(p2, p0));
    put(p0, b.px[0][i], b.py[0][i], b.pz[0][i]);
    put(p1, b.px[1][i], b.py[1][i], b.pz[1][i]);
    put(p2, b.px[2][i], b.py[2][i], b.pz[2][i]);
    put(e0, b.ex[0][i], b.ey[0][i], b.ez[0][i]);
    put(e1, b.ex[1][i], b.ey[1][i], b.ez[1][i]);
    put(e2, b.ex[2][i], b.ey[2][i], b.ez[2][i]);
    b.e2[0][i] = hfr_dot3(e0, e0);
    b.e2[1][i] = hfr_dot3(e1, e1);
    b.e2[2][i] = hfr_dot3(e2, e2);
    put(across, b.normal_x[i], b.normal_y[i], b.normal_z[i]);
    b.q[i] = hfr_dot3(across, across);
  }
  *block = b;
}

/// What all six angles of a cell need: the side face over edge k of the triangle has the normal nk (outward,
/// length twice the area), whose square is qk; rk leads from corner k to the point.
struct Sides {
  hfr_real3 r0, r1, r2, n0, n1, n2;
  double q0, q1, q2;
  double det;
};

HFR_FN Sides sides_of(const Block& b, std::size_t i, hfr_real3 x) {
  Sides s;
  s.r0 = hfr_sub3(x, corner(b, 0, i));
  s.r1 = hfr_sub3(x, corner(b, 1, i));
  s.r2 = hfr_sub3(x, corner(b, 2, i));
  s.n0 = hfr_cross3(edge(b, 0, i), s.r0);
  s.n1 = hfr_cross3(edge(b, 1, i), s.r1);
  s.n2 = hfr_cross3(edge(b, 2, i), s.r2);
  s.q0 = hfr_dot3(s.n0, s.n0);
  s.q1 = hfr_dot3(s.n1, s.n1);
  s.q2 = hfr_dot3(s.n2, s.n2);
  s.det = hfr_dot3(normal(b, i), s.r0);
  return s;
}

/// sin² at the edges of the triangle, and at those from corner k to the point, which lie between sides k-1
/// and k; infinite where the angle does not count.
struct Sines2 {
  double base0, base1, base2, side0, side1, side2;
};

template <bool kAll>
HFR_FN Sines2 sines2_of(const Block& b, std::size_t i, const Sides& s) {
  const double det2 = s.det * s.det;
  Sines2 f;
  f.base0 = b.e2[0][i] * det2 / (b.q[i] * s.q0);
  f.base1 = b.e2[1][i] * det2 / (b.q[i] * s.q1);
  f.base2 = b.e2[2][i] * det2 / (b.q[i] * s.q2);
  f.side0 = hfr_dot3(s.r0, s.r0) * det2 / (s.q2 * s.q0);
  f.side1 = hfr_dot3(s.r1, s.r1) * det2 / (s.q0 * s.q1);
  f.side2 = hfr_dot3(s.r2, s.r2) * det2 / (s.q1 * s.q2);
  if constexpr (!kAll) {
    const hfr_real3 n = normal(b, i);
    f.base0 = hfr_dot3(n, s.n0) > 0 ? f.base0 : HFR_INFINITY;
    f.base1 = hfr_dot3(n, s.n1) > 0 ? f.base1 : HFR_INFINITY;
    f.base2 = hfr_dot3(n, s.n2) > 0 ? f.base2 : HFR_INFINITY;
    f.side0 = hfr_dot3(s.n2, s.n0) < 0 ? f.side0 : HFR_INFINITY;
    f.side1 = hfr_dot3(s.n0, s.n1) < 0 ? f.side1 : HFR_INFINITY;
    f.side2 = hfr_dot3(s.n1, s.n2) < 0 ? f.side2 : HFR_INFINITY;
  }
  return f;
}

/// Smallest sin² of n blocks of cells, the block *begin first; 0 once it is no better than floor ≥ 0, and
/// where a cell is not positive. *begin becomes the block that ended the search.
template <bool kAll>
HFR_FN double worst_of(const Block* blocks, std::size_t n, const hfr_real3* at, double floor,
                       std::size_t* begin) {
  const hfr_real3 x = *at;
  alignas(64) double worst[kBlock];
  for (std::size_t i = 0; i < kBlock; ++i) worst[i] = HFR_INFINITY;
  std::size_t at_block = *begin;
  for (std::size_t asked = 0; asked < n; ++asked) {
    const Block& b = blocks[at_block];
    int better = 0;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const Sides s = sides_of(b, i, x);
      const Sines2 f = sines2_of<kAll>(b, i, s);
      // Whatever is NaN is passed over.
      const double side = hfr_min(f.side0, hfr_min(f.side1, hfr_min(f.side2, worst[i])));
      const double all = hfr_min(f.base0, hfr_min(f.base1, hfr_min(f.base2, side)));
      worst[i] = s.det > 0 ? all : 0;
    }
    for (std::size_t i = 0; i < kBlock; ++i) better += worst[i] > floor ? 1 : 0;
    if (better < static_cast<int>(kBlock)) {
      *begin = at_block;
      return 0;
    }
    at_block = at_block + 1 == n ? 0 : at_block + 1;
  }
  return least_of_block(worst);
}

/// Values and gradients of the angles of a block of cells, rows in the order of the angles: base0, side0,
/// base1, …
struct SlopeRows {
  static constexpr std::size_t kRows = 6;
  alignas(64) double value[kRows * kBlock];
  double x[kRows * kBlock], y[kRows * kBlock], z[kRows * kBlock];

  HFR_FN void set(std::size_t row, std::size_t i, double f, hfr_real3 half_relative_gradient) {
    const hfr_real3 g = times(2.0 * f, half_relative_gradient);
    value[row * kBlock + i] = f;
    put(g, x[row * kBlock + i], y[row * kBlock + i], z[row * kBlock + i]);
  }
};

/// Half the gradient of q, over q.
HFR_FN hfr_real3 side_slope(double q, double e2, hfr_real3 e, hfr_real3 r) {
  return times(1.0 / q, hfr_sub3(times(e2, r), times(hfr_dot3(e, r), e)));
}
HFR_FN hfr_real3 side_gradient(hfr_real3 r, hfr_real3 rise, hfr_real3 before, hfr_real3 after) {
  return hfr_sub3(hfr_sub3(plus(times(1.0 / hfr_dot3(r, r), r), rise), before), after);
}

template <bool kAll>
HFR_FN void slopes_of(const Block* blocks, std::size_t n_cells, const hfr_real3* at, double below,
                      Slopes* out) {
  const hfr_real3 x = *at;
  std::size_t n = 0;
  for (std::size_t first = 0; first < n_cells; first += kBlock) {
    const Block& b = blocks[first / kBlock];
    SlopeRows rows;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const Sides s = sides_of(b, i, x);
      const Sines2 f = sines2_of<kAll>(b, i, s);
      const hfr_real3 dq0 = side_slope(s.q0, b.e2[0][i], edge(b, 0, i), s.r0);
      const hfr_real3 dq1 = side_slope(s.q1, b.e2[1][i], edge(b, 1, i), s.r1);
      const hfr_real3 dq2 = side_slope(s.q2, b.e2[2][i], edge(b, 2, i), s.r2);
      const hfr_real3 rise = times(1.0 / s.det, normal(b, i));
      rows.set(0, i, f.base0, hfr_sub3(rise, dq0));
      rows.set(1, i, f.side0, side_gradient(s.r0, rise, dq2, dq0));
      rows.set(2, i, f.base1, hfr_sub3(rise, dq1));
      rows.set(3, i, f.side1, side_gradient(s.r1, rise, dq0, dq1));
      rows.set(4, i, f.base2, hfr_sub3(rise, dq2));
      rows.set(5, i, f.side2, side_gradient(s.r2, rise, dq1, dq2));
    }
    const std::size_t end = n_cells - first < kBlock ? n_cells - first : kBlock;
    std::size_t taken[SlopeRows::kRows * kBlock];
    std::size_t n_taken = 0;
    for (std::size_t i = 0; i < end; ++i) {
      for (std::size_t row = 0; row < SlopeRows::kRows; ++row) {
        taken[n_taken] = row * kBlock + i;
        n_taken += rows.value[row * kBlock + i] < below ? 1 : 0;
      }
    }
    if (n_taken > Slopes::kCapacity - n) n_taken = Slopes::kCapacity - n;
    for (std::size_t t = 0; t < n_taken; ++t) {
      out->value[n] = rows.value[taken[t]];
      out->x[n] = rows.x[taken[t]];
      out->y[n] = rows.y[taken[t]];
      out->z[n] = rows.z[taken[t]];
      ++n;
    }
  }
  out->size = n;
  for (; n < out->padded(); ++n) {
    out->value[n] = HFR_INFINITY;
    out->x[n] = out->y[n] = out->z[n] = 0;
  }
}

/// Leaves the part of all gradients along the axis, or the part across it.
template <bool kAlong>
HFR_FN void cut_slopes(Slopes* f, const hfr_real3* axis) {
  const hfr_real3 a = *axis;
  for (std::size_t i = 0; i < f->size; ++i) {
    const hfr_real3 g = f->gradient(i);
    const hfr_real3 along = times(hfr_dot3(g, a), a);
    put(kAlong ? along : hfr_sub3(g, along), f->x[i], f->y[i], f->z[i]);
  }
}

hfr_real3 to_kernel(Vec3 a) { return {a.x, a.y, a.z}; }

}  // namespace

void MaxMinForm::add(Vec3 a, Vec3 b, Vec3 c) {
  blocks_.reserve(size_ / kBlock + 1);
  Block& block = blocks_[size_ / kBlock];
  const std::size_t i = size_++ % kBlock;
  put(to_kernel(a - origin_), block.px[0][i], block.py[0][i], block.pz[0][i]);
  put(to_kernel(b - origin_), block.px[1][i], block.py[1][i], block.pz[1][i]);
  put(to_kernel(c - origin_), block.px[2][i], block.py[2][i], block.pz[2][i]);
  unit_ = 0;
}

void MaxMinForm::scale() {
  Block& last = blocks_[n_blocks() - 1];
  for (std::size_t i = size_; i < n_blocks() * kBlock; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      put(corner(last, k, (size_ - 1) % kBlock), last.px[k][i % kBlock], last.py[k][i % kBlock],
          last.pz[k][i % kBlock]);
  }
  double sum = 0;
  double lengths[3][kBlock];
  for (std::size_t i = 0; i < size_; ++i) {
    if (i % kBlock == 0) with_widest_vectors<measure_block>(&blocks_[i / kBlock], &lengths[0]);
    for (std::size_t k = 0; k < 3; ++k) sum += lengths[k][i % kBlock];
  }
  unit_ = sum / (3.0 * static_cast<double>(size_));
  for (std::size_t b = 0; b < n_blocks(); ++b) with_widest_vectors<scale_block>(&blocks_[b], 1.0 / unit_);
}

/// Smallest sin² with the point at x, or anything ≤ floor once it is no better; 0 where a cell is not
/// positive. The floor is not negative.
double MaxMinForm::worst(Vec3 x, double floor) {
  const hfr_real3 at = to_kernel(x);
  return angles_ == Angles::kAll
             ? with_widest_vectors<worst_of<true>>(blocks_.data(), n_blocks(), &at, floor, &asked_first_)
             : with_widest_vectors<worst_of<false>>(blocks_.data(), n_blocks(), &at, floor, &asked_first_);
}

/// Value and gradient of each sin² below a bound; the point stands at x, all cells positive.
void MaxMinForm::slopes(Vec3 x, double below, Slopes& out) const {
  const hfr_real3 at = to_kernel(x);
  if (angles_ == Angles::kAll)
    with_widest_vectors<slopes_of<true>>(blocks_.data(), size_, &at, below, &out);
  else
    with_widest_vectors<slopes_of<false>>(blocks_.data(), size_, &at, below, &out);
  const hfr_real3 axis = to_kernel(axis_);
  if (room_ == Room::kPlane) with_widest_vectors<cut_slopes<false>>(&out, &axis);
  if (room_ == Room::kLine) with_widest_vectors<cut_slopes<true>>(&out, &axis);
}

Vec3 MaxMinForm::ascend(Vec3 start, int iterations) {
  if (size_ == 0) return start;
  if (!(unit_ > 0)) scale();
  if (!hfr_is_normal_positive(unit_)) return start;
  Vec3 x = (1.0 / unit_) * (start - origin_);
  const Vec3 first = x;
  double now = worst(x, 0);
  if (!(now > 0)) return start;
  double u = kFirstReach;
  Slopes f;
  slopes(x, kFarAbove * now + kFarAboveFloor, f);
  for (int i = 0; i < iterations && u > kSmallestReach && f.size > 0; ++i) {
    detail::MaxMinStep step;
    const Slopes* const slopes_now = &f;
    with_widest_lanes<detail::proximal_step<Lanes<8>>, detail::proximal_step<Lanes<4>>,
                      detail::proximal_step<Lanes<2>>>(slopes_now, u, kLevel, kEnough * now, &step);
    const double promise = step.promise - now;
    const Vec3 next_x = x + Vec3{step.d.x, step.d.y, step.d.z};
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
