// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {
namespace {

constexpr double kMaxCuts = 64;  // of one triangle's edges

double largest_distance(std::span<const Triangle> from, const InputSurface& to, double spacing,
                        par::Policy policy) {
  return par::reduce(
      policy, from.size(), 0.0,
      [&](std::size_t i) {
        const Triangle& t = from[i];
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, norm(t[(k + 1) % 3] - t[k]));
        const double cuts = std::clamp(std::ceil(longest / spacing), 1.0, kMaxCuts);
        double largest = 0;
        for (double u = 0; u <= cuts; ++u) {
          for (double v = 0; u + v <= cuts; ++v) {
            const Vec3 x = t[0] + (u / cuts) * (t[1] - t[0]) + (v / cuts) * (t[2] - t[0]);
            largest = std::max(largest, to.nearest(x).distance);
          }
        }
        return largest;
      },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace

SurfaceDistance surface_distance(std::span<const Triangle> from, std::span<const Triangle> to, double spacing,
                                 par::Policy policy) {
  HFR_REQUIRE(spacing > 0, "the spacing of sample points must be positive");
  if (from.empty() || to.empty()) return {};
  return {largest_distance(from, InputSurface(to), spacing, policy),
          largest_distance(to, InputSurface(from), spacing, policy)};
}

std::vector<Triangle> surface_triangles(const TetMesh& mesh, par::Policy policy) {
  const surface::Arrays arrays = surface::gather(mesh, {}, policy);
  std::vector<Triangle> triangles;
  triangles.reserve(arrays.faces.size());
  for (const auto& f : arrays.faces) triangles.push_back(surface::corners(mesh.points(), f));
  return triangles;
}

}  // namespace hfr
