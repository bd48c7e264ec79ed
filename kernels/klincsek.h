/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_KLINCSEK_H
#define HFR_KERNELS_KLINCSEK_H

#include "order.h"

#define HFR_MAX_RING 32 /* cells of a ring, or vertices of a polygon, that is looked at */

/* Klincsek's dynamic programme over the sides (i, j) of a polygon of n vertices: the triangulation whose
 * worst triangle is best. A macro, because C++ has the metric as a template argument and OpenCL C as a
 * function.
 *
 * best, apex: arrays of stride*stride doubles and bytes, scratch; apex[i*stride + j] is the third vertex of
 * the triangle on side (i, j) wherever that side is reached.
 *
 * floor_value: what has to be beaten; sides that do not are given up.
 *
 * VALUE(i, k, j, top): worst of what triangle (i, k, j) stands for, or anything <= top once it is no better.
 *
 * result: a double variable; the worst of the best triangulation, or floor_value where none beats it. */
#define HFR_KLINCSEK(n, stride, best, apex, floor_value, VALUE, result)                                 \
  do {                                                                                                  \
    int side_i, side_j, third, width;                                                                   \
    for (side_i = 0; side_i + 1 < (n); ++side_i) (best)[side_i * (stride) + side_i + 1] = HFR_INFINITY; \
    for (width = 2; width < (n); ++width) {                                                             \
      for (side_i = 0; side_i + width < (n); ++side_i) {                                                \
        double top = (floor_value);                                                                     \
        side_j = side_i + width;                                                                        \
        for (third = side_i + 1; third < side_j; ++third) {                                             \
          const double sides =                                                                          \
              hfr_lesser((best)[side_i * (stride) + third], (best)[third * (stride) + side_j]);         \
          double worst;                                                                                 \
          if (!(sides > top)) continue;                                                                 \
          worst = hfr_lesser(sides, VALUE(side_i, third, side_j, top));                                 \
          if (worst > top) {                                                                            \
            top = worst;                                                                                \
            (apex)[side_i * (stride) + side_j] = (unsigned char)third;                                  \
          }                                                                                             \
        }                                                                                               \
        (best)[side_i * (stride) + side_j] = top > (floor_value) ? top : -HFR_INFINITY;                 \
      }                                                                                                 \
    }                                                                                                   \
    (result) = hfr_greater((floor_value), (best)[(n)-1]);                                               \
  } while (0)

#endif
