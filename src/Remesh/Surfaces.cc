// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Surfaces.hh"

#include <algorithm>

#include "Surface/SurfaceMesh.hh"

namespace hfr {

namespace {

/// Of the mean edge: how far apart the points are by which surfaces are compared.
constexpr double kSpacing = 0.25;

double mean_edge(const std::vector<Triangle>& surface) {
  double sum = 0;
  for (const Triangle& t : surface)
    for (std::size_t k = 0; k < 3; ++k) sum += norm(t[(k + 1) % 3] - t[k]);
  return surface.empty() ? 0 : sum / (3.0 * static_cast<double>(surface.size()));
}

double diagonal(const std::vector<Triangle>& surface) {
  if (surface.empty()) return 0;
  Vec3 low = surface[0][0];
  Vec3 high = low;
  for (const Triangle& t : surface) {
    for (Vec3 p : t) {
      for (int d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], p[d]);
        high[d] = std::max(high[d], p[d]);
      }
    }
  }
  return norm(high - low);
}

}  // namespace

void measure_surfaces(const std::vector<std::array<Vec3, 3>>& before,
                      const std::vector<std::array<Vec3, 3>>& after, double volume_before,
                      double volume_after, par::Policy policy, SurfaceReport& report) {
  report.triangles_before = before.size();
  report.triangles_after = after.size();
  const double spacing = kSpacing * mean_edge(before);
  if (spacing > 0) report.hausdorff = surface_distance(before, after, spacing, policy).hausdorff();
  report.diagonal = diagonal(before);
  if (volume_before != 0) report.volume_change = (volume_after - volume_before) / volume_before;
}

}  // namespace hfr
