/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_NEWTON_STEP_H
#define HFR_KERNELS_NEWTON_STEP_H

#include "star_newton.h"

/* Newton's method on a star; star_newton.h has what it needs of each cell. */
#define HFR_NEWTON_ITERATIONS 6   /* at most; most stars need three */
#define HFR_NEWTON_ENOUGH 0.995   /* a step that lowers the largest m by less ends the search */
#define HFR_NEWTON_MAX_HALVINGS 5 /* of a step that does not lower it */

/* Sums over the cells of a star, in the order of the cells. */
HFR_FN hfr_newton_share hfr_newton_zero(void) {
  hfr_newton_share s;
  s.gradient = hfr_make3(0.0, 0.0, 0.0);
  s.xx = s.xy = s.xz = s.yy = s.yz = s.zz = 0.0;
  return s;
}

HFR_FN hfr_newton_share hfr_newton_sum(hfr_newton_share a, hfr_newton_share b) {
  a.gradient =
      hfr_make3(a.gradient.x + b.gradient.x, a.gradient.y + b.gradient.y, a.gradient.z + b.gradient.z);
  a.xx += b.xx;
  a.xy += b.xy;
  a.xz += b.xz;
  a.yy += b.yy;
  a.yz += b.yz;
  a.zz += b.zz;
  return a;
}

/* Solution of Hessian * step = -gradient by LDL^T; `ok` is 0 when the matrix is not positive definite. */
typedef struct hfr_newton_step {
  hfr_real3 step;
  int ok;
} hfr_newton_step;

HFR_FN hfr_newton_step hfr_newton_solve(hfr_newton_share h) {
  hfr_newton_step result;
  const double d0 = h.xx;
  const double l1 = h.xy / d0;
  const double l2 = h.xz / d0;
  const double d1 = h.yy - l1 * h.xy;
  const double e = h.yz - l1 * h.xz;
  const double l3 = e / d1;
  const double d2 = h.zz - l2 * h.xz - l3 * e;
  const double y0 = -h.gradient.x;
  const double y1 = -h.gradient.y - l1 * y0;
  const double y2 = -h.gradient.z - l2 * y0 - l3 * y1;
  result.ok = (d0 > 0.0) & (d1 > 0.0) & (d2 > 0.0);
  result.step.z = y2 / d2;
  result.step.y = y1 / d1 - l3 * result.step.z;
  result.step.x = y0 / d0 - l1 * result.step.y - l2 * result.step.z;
  return result;
}

/* The search: `place`, an hfr_real3, becomes the displacement that lowers the largest m as far as the method
 * takes it. A macro, because C++ looks at several cells an instruction and OpenCL C at one after the other.
 *
 * LARGEST(x, ceiling): the largest m with the vertex moved by x, or anything >= ceiling.
 *
 * SHARES(x, m_max): sum of the cells' shares with the vertex moved by x, in the order of the cells. */
#define HFR_NEWTON_SEARCH(iterations, LARGEST, SHARES, place)                                         \
  do {                                                                                                \
    int iteration, halving;                                                                           \
    double now;                                                                                       \
    (place) = hfr_make3(0.0, 0.0, 0.0);                                                               \
    now = LARGEST((place), HFR_INFINITY);                                                             \
    for (iteration = 0; iteration < (iterations); ++iteration) {                                      \
      const hfr_newton_step newton = hfr_newton_solve(SHARES((place), now));                          \
      hfr_real3 candidate = (place);                                                                  \
      double length = 1.0, next = now;                                                                \
      int enough;                                                                                     \
      if (!newton.ok) break;                                                                          \
      for (halving = 0; halving <= HFR_NEWTON_MAX_HALVINGS; ++halving, length *= 0.5) {               \
        candidate = hfr_make3((place).x + length * newton.step.x, (place).y + length * newton.step.y, \
                              (place).z + length * newton.step.z);                                    \
        next = LARGEST(candidate, now);                                                               \
        if (next < now) break;                                                                        \
      }                                                                                               \
      if (!(next < now)) break;                                                                       \
      enough = next > HFR_NEWTON_ENOUGH * now;                                                        \
      (place) = candidate;                                                                            \
      now = next;                                                                                     \
      if (enough) break;                                                                              \
    }                                                                                                 \
  } while (0)

#endif
