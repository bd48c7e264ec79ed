// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Remesh: surfaces as lists of triangles, compared.
#ifndef HFR_REMESH_SURFACES_HH
#define HFR_REMESH_SURFACES_HH

#include <array>
#include <vector>

#include "Parallel/Parallel.hh"
#include "Remesh/Improve.hh"

namespace hfr {

/// What closed surfaces enclose, positive when the triangles are seen from outside; right to the last digits.
double enclosed_volume(const std::vector<std::array<Vec3, 3>>& triangles);
/// The part of a report that is measured on the triangles alone. Needs OpenMesh's build.
void measure_surfaces(const std::vector<std::array<Vec3, 3>>& before,
                      const std::vector<std::array<Vec3, 3>>& after, double volume_before,
                      double volume_after, par::Policy policy, SurfaceReport& report);

}  // namespace hfr

#endif
