// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "Operators/Cavity.hh"
#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {
namespace {

constexpr double kMaxCuts = 64;  // pieces, at most, into which the points cut an edge of a triangle

/// The largest distance of the points spread over some triangles. A point that is no further from some
/// triangle than another point is from the whole surface cannot be the one: the triangles that were near to
/// its neighbours are asked first, and then any, which takes less of a search than the nearest one where all
/// distances are small.
class Furthest {
 public:
  Furthest(const InputSurface& to, double spacing) : to_(to), spacing_(spacing) {}
  void look(const Triangle& t) {
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, norm(t[(k + 1) % 3] - t[k]));
    const double cuts = std::clamp(std::ceil(longest / spacing_), 1.0, kMaxCuts);
    for (double u = 0; u <= cuts; ++u) {
      for (double v = 0; u + v <= cuts; ++v) {
        const Vec3 x = t[0] + (u / cuts) * (t[1] - t[0]) + (v / cuts) * (t[2] - t[0]);
        if (is_near_again(x)) continue;
        if (const auto item = to_.any_within(x, largest_)) {
          remember(*item);
          continue;
        }
        const InputSurface::Hit hit = to_.nearest(x, recent_.empty() ? 0 : recent_[0]);
        remember(hit.item);
        largest_ = std::max(largest_, hit.distance);
      }
    }
  }
  double largest() const { return largest_; }

 private:
  /// Is one of the triangles that were near of late no further than the largest distance? What is_within()
  /// says is right but for rounding, which is all there is to measure where the shape is kept.
  bool is_near_again(Vec3 x) {
    for (std::size_t i = 0; i < recent_.size(); ++i) {
      if (!to_.is_within(x, largest_, recent_[i]) || to_.distance(x, recent_[i]) > largest_) continue;
      std::swap(recent_[i], recent_[i / 2]);  // the next point is likely to be there, too
      return true;
    }
    return false;
  }
  /// Notes a triangle that was near, in the place of the one that has been of no use for longest, more or
  /// less.
  void remember(std::size_t item) {
    if (!recent_.full()) recent_.push_back(item);
    recent_[recent_.size() - 1] = item;
    std::swap(recent_[recent_.size() - 1], recent_[recent_.size() / 2]);
  }

  const InputSurface& to_;
  double spacing_;
  FixedVector<std::size_t, 16> recent_;
  double largest_ = 0;
};

double largest_distance(std::span<const Triangle> from, const InputSurface& to, double spacing,
                        par::Policy policy) {
  const int n_parts = par::thread_count(policy, from.size());
  std::vector<double> largest(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    Furthest furthest(to, spacing);
    const std::size_t end = par::part_begin(from.size(), n_parts, part + 1);
    for (std::size_t i = par::part_begin(from.size(), n_parts, part); i < end; ++i) furthest.look(from[i]);
    largest[static_cast<std::size_t>(part)] = furthest.largest();
  });
  return *std::max_element(largest.begin(), largest.end());
}

}  // namespace

SurfaceDistance surface_distance(std::span<const Triangle> from, std::span<const Triangle> to, double spacing,
                                 par::Policy policy) {
  HFR_REQUIRE(spacing > 0, "the spacing of sample points must be positive");
  if (from.empty() || to.empty()) return {};
  return {largest_distance(from, InputSurface(to, /*exact=*/true), spacing, policy),
          largest_distance(to, InputSurface(from, /*exact=*/true), spacing, policy)};
}

std::vector<Triangle> surface_triangles(const TetMesh& mesh, par::Policy policy) {
  const surface::Arrays arrays = surface::gather(mesh, {}, policy);
  std::vector<Triangle> triangles;
  triangles.reserve(arrays.faces.size());
  for (const auto& f : arrays.faces) triangles.push_back(surface::corners(mesh.points(), f));
  return triangles;
}

}  // namespace hfr
