/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_DAMAGE_H
#define HFR_KERNELS_DAMAGE_H

#include "dihedral.h"
#include "order.h"
#include "tet_volume.h"

/* What is wrong with the cells of a cluster. The worst decision value alone does not tell: it may rise while
 * one inverted cell becomes three. */
typedef struct hfr_damage {
  int n_inverted;
  int n_flat;     /* the sign of the volume hides in rounding */
  double overlap; /* six times the volume of the inverted cells, summed in the order in which they came */
  double worst;   /* smallest decision value of the smallest dihedral */
} hfr_damage;

HFR_FN hfr_damage hfr_no_damage(void) {
  hfr_damage none;
  none.n_inverted = 0;
  none.n_flat = 0;
  none.overlap = 0.0;
  none.worst = HFR_INFINITY;
  return none;
}

/* `sum` with one more cell, its vertices in the order in which they are stored. */
HFR_FN hfr_damage hfr_damage_with(hfr_damage sum, hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const double det = hfr_orient6(a, b, c, d);
  const double bound = hfr_orient6_bound(a, b, c, d);
  const int inverted = det < -bound;
  sum.n_inverted += inverted;
  sum.n_flat += !inverted && !(det > bound);
  sum.overlap += inverted ? -det : 0.0;
  sum.worst = hfr_lesser(sum.worst, hfr_min_dihedral_decision(a, b, c, d));
  return sum;
}

/* Whether a cluster may be changed so that it has the damage `after`: never more inverted cells, never more
 * inverted and flat ones together, no more overlap unless fewer cells are inverted, and no angle below
 * `floor_value`, the worst one of the mesh when the run began, unless there was a smaller one. What each
 * cluster has above that is its own: held at its own worst angle, folded boundaries would not come open. */
HFR_FN int hfr_damage_may_become(hfr_damage before, hfr_damage after, double floor_value) {
  const int fewer = after.n_inverted < before.n_inverted;
  return after.n_inverted <= before.n_inverted &&
         after.n_inverted + after.n_flat <= before.n_inverted + before.n_flat &&
         (fewer || after.overlap <= before.overlap) &&
         (after.worst >= floor_value || after.worst >= before.worst);
}

#endif
