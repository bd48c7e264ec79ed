// SPDX-License-Identifier: BSD-3-Clause
// Compiled, not run: every shared header must be plain OpenCL C 1.2, in any order of inclusion.
#include "kernels/base.h"
#include "kernels/dihedral.h"
#include "kernels/shape.h"
#include "kernels/star_newton.h"
#include "kernels/star_volume_length.h"
#include "kernels/tet_volume.h"
#include "kernels/triangle.h"
#include "kernels/untangle.h"
#include "kernels/volume_length.h"

__kernel void evaluate(__global const double* points, __global double* values) {
  const size_t i = get_global_id(0);
  hfr_real3 p[4];
  for (size_t k = 0; k < 4; ++k) {
    const size_t at = 12 * i + 3 * k;
    p[k] = hfr_make3(points[at], points[at + 1], points[at + 2]);
  }
  const hfr_tet_frame frame = hfr_make_frame(p[0], p[1], p[2], p[3]);
  double sum = hfr_volume_length_report(hfr_volume_length_decision(p[0], p[1], p[2], p[3]));
  sum += hfr_min_sin2_of(frame) + hfr_min_dihedral_of(frame) + hfr_max_dihedral_of(frame);
  sum += hfr_scaled_jacobian_decision(p[0], p[1], p[2], p[3]) +
         hfr_radius_ratio_decision(p[0], p[1], p[2], p[3]);
  sum += hfr_edge_ratio_decision(p[0], p[1], p[2], p[3]) + hfr_volume_decision(p[0], p[1], p[2], p[3]);
  sum += hfr_dihedral_cos_sin(frame, 3).sine + (double)hfr_orient_sign(p[0], p[1], p[2], p[3]);
  values[i] = sum + hfr_triangle_min_sin2(p[0], p[1], p[2]);
}
