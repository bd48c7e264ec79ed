/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_UNTANGLE_H
#define HFR_KERNELS_UNTANGLE_H

#include "dihedral.h"
#include "volume_length.h"

/* Volume-length for a positive cell, and for the others 6V over a volume of the mesh's own size.
 * Volume-length of an inverted cell rises towards 0 when a vertex runs off to infinity; a signed volume
 * falls, and over one vertex's position the smallest of them is concave, so that raising it leads out of the
 * inversion (Freitag & Plassmann, Local simplicial mesh improvement via linear programming, 2000).
 * Cells with an angle below `floor_value` (see damage.h) count as that many times their volume, so that a
 * search finds what may be had rather than what is refused afterwards. */
#define HFR_BELOW_FLOOR 1048576.0
HFR_FN double hfr_untangle_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d, double per_volume,
                                    double floor_value) {
  const hfr_real3 u = hfr_sub3(b, a);
  const hfr_real3 v = hfr_sub3(c, a);
  const hfr_real3 w = hfr_sub3(d, a);
  const double det = hfr_dot3(u, hfr_cross3(v, w));
  const double decision = hfr_volume_length_of(det, hfr_edge_sum2(u, v, w));
  if (decision > 0.0) return decision;
  const double volume = hfr_min(det, 0.0) * per_volume;
  const int is_below = floor_value > -HFR_INFINITY && hfr_min_dihedral_decision(a, b, c, d) < floor_value;
  return is_below ? HFR_BELOW_FLOOR * volume : volume;
}

#endif
