/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_CANDIDATES_H
#define HFR_KERNELS_CANDIDATES_H

#include "order.h"

/* Candidate positions of D'Amato & Venere (2013), section 3.3. */

#define HFR_CANDIDATE_HALVINGS 10 /* of the radius */
#define HFR_CANDIDATE_DIRECTIONS 14
#define HFR_DIAGONAL 0.57735026918962576 /* 1/sqrt(3): all directions have length 1 */

/* Direction i: the axes, then the diagonals of the cube. */
HFR_FN hfr_real3 hfr_candidate_direction(int i) {
  const double sign = (i & 1) ? -1.0 : 1.0;
  const int k = i - 6;
  if (i < 2) return hfr_make3(sign, 0.0, 0.0);
  if (i < 4) return hfr_make3(0.0, sign, 0.0);
  if (i < 6) return hfr_make3(0.0, 0.0, sign);
  return hfr_make3((k & 1) ? -HFR_DIAGONAL : HFR_DIAGONAL, (k & 2) ? -HFR_DIAGONAL : HFR_DIAGONAL,
                   (k & 4) ? -HFR_DIAGONAL : HFR_DIAGONAL);
}

/* Where candidates may lie, relative to the vertex, and how far from it they begin. */
typedef struct hfr_section {
  double length_sum;   /* over the star's edges, one counted once a face that it bounds */
  hfr_real3 low, high; /* box of the star, the vertex at the origin */
} hfr_section;

HFR_FN hfr_section hfr_section_zero(void) {
  hfr_section s;
  s.length_sum = 0.0;
  s.low = hfr_make3(0.0, 0.0, 0.0);
  s.high = hfr_make3(0.0, 0.0, 0.0);
  return s;
}

/* Adds link vertex p, relative to the moving one, and the link edge of length |edge| that begins there. */
HFR_FN hfr_section hfr_section_add(hfr_section s, hfr_real3 p, hfr_real3 edge) {
  s.length_sum += HFR_SQRT(hfr_dot3(p, p)) + HFR_SQRT(hfr_dot3(edge, edge));
  s.low = hfr_make3(hfr_lesser(s.low.x, p.x), hfr_lesser(s.low.y, p.y), hfr_lesser(s.low.z, p.z));
  s.high = hfr_make3(hfr_greater(s.high.x, p.x), hfr_greater(s.high.y, p.y), hfr_greater(s.high.z, p.z));
  return s;
}

/* Half the mean length of the edges, in a star of n cells. */
HFR_FN double hfr_section_radius(hfr_section s, double n) { return 0.5 * s.length_sum / (6.0 * n); }

HFR_FN int hfr_section_contains(hfr_section s, hfr_real3 x) {
  return (x.x >= s.low.x) & (x.x <= s.high.x) & (x.y >= s.low.y) & (x.y <= s.high.y) & (x.z >= s.low.z) &
         (x.z <= s.high.z);
}

/* Candidate i round a place; no candidate unless the section contains it. Outside the box of the star no cell
 * can be right, but the quality of an inverted cell may rise on the way to infinity. */
HFR_FN hfr_real3 hfr_candidate(hfr_real3 place, double radius, int i) {
  const hfr_real3 d = hfr_candidate_direction(i);
  return hfr_make3(place.x + radius * d.x, place.y + radius * d.y, place.z + radius * d.z);
}

/* The search: `place`, an hfr_real3, becomes the displacement that raises the star's worst as far as
 * candidates take it. A macro, because C++ looks at all candidates at once and OpenCL C at one after the
 * other.
 *
 * worst_now: smallest decision value of the star as it is.
 *
 * LOOK(place, radius, best, next): statement that lets `best` be the largest of itself and of the worst
 * values of the candidates round `place`, and `next` the first candidate with that value where it has risen.
 */
#define HFR_CANDIDATE_SEARCH(halvings, start_radius, worst_now, LOOK, place) \
  do {                                                                       \
    double worst = (worst_now), radius = (start_radius);                     \
    int level = 0;                                                           \
    (place) = hfr_make3(0.0, 0.0, 0.0);                                      \
    while (level < (halvings)) {                                             \
      double best = worst;                                                   \
      hfr_real3 next = (place);                                              \
      LOOK((place), radius, best, next);                                     \
      if (best > worst) {                                                    \
        worst = best;                                                        \
        (place) = next;                                                      \
      } else {                                                               \
        radius *= 0.5;                                                       \
        ++level;                                                             \
      }                                                                      \
    }                                                                        \
  } while (0)

#endif
