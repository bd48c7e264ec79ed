// SPDX-License-Identifier: BSD-3-Clause
// The tree is Eigen's KdBVH: in double precision, with the same answer on every run, and it comes with the
// package that the points of the surface need anyway. (Embree works in single precision, nanoflann knows
// points only, Boost.Geometry has no triangles in space, and libigl is not packaged everywhere.)
#include "Surface/InputSurface.hh"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <unsupported/Eigen/BVH>

namespace hfr {
namespace {

using Box = Eigen::AlignedBox<double, 3>;
using Tree = Eigen::KdBVH<double, 3, int>;

Eigen::Vector3d eigen(Vec3 p) { return {p.x, p.y, p.z}; }

Vec3 scaled_normal(const std::array<Vec3, 3>& t) { return cross(t[1] - t[0], t[2] - t[0]); }

}  // namespace

// Ericson, Real-Time Collision Detection, 2005, section 5.1.5; written with differences only, so that equal
// coordinates stay equal.
Vec3 nearest_point(const std::array<Vec3, 3>& t, Vec3 x) {
  const Vec3 ab = t[1] - t[0];
  const Vec3 ac = t[2] - t[0];
  const Vec3 ax = x - t[0];
  const double d1 = dot(ab, ax);
  const double d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const Vec3 bx = x - t[1];
  const double d3 = dot(ab, bx);
  const double d4 = dot(ac, bx);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return d1 - d3 > 0 ? t[0] + (d1 / (d1 - d3)) * ab : t[0];
  const Vec3 cx = x - t[2];
  const double d5 = dot(ab, cx);
  const double d6 = dot(ac, cx);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return d2 - d6 > 0 ? t[0] + (d2 / (d2 - d6)) * ac : t[0];
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double sum = (d4 - d3) + (d5 - d6);
    return sum > 0 ? t[1] + ((d4 - d3) / sum) * (t[2] - t[1]) : t[1];
  }
  const double sum = va + vb + vc;
  return t[0] + (vb / sum) * ab + (vc / sum) * ac;
}

Vec3 nearest_point(const std::array<Vec3, 2>& s, Vec3 x) {
  const Vec3 along = s[1] - s[0];
  const double length2 = norm2(along);
  const double share = length2 > 0 ? dot(x - s[0], along) / length2 : 0.0;
  if (!(share > 0)) return s[0];
  return share < 1 ? s[0] + share * along : s[1];
}

struct InputSurface::Impl {
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<std::array<Vec3, 2>> segments;
  std::vector<Vec3> normals;
  Tree tree;

  template <class Items>
  void plant(const Items& items) {
    std::vector<int> numbers(items.size());
    std::vector<Box> boxes(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      numbers[i] = static_cast<int>(i);
      for (Vec3 p : items[i]) boxes[i].extend(eigen(p));
    }
    tree.init(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
  }

  struct Search {
    using Scalar = double;
    const Impl& surface;
    Vec3 x;
    Eigen::Vector3d place;
    const Vec3* side;  // of the normals that count, or null
    double limit2;     // boxes further away are left out
    Hit hit{{}, std::numeric_limits<double>::infinity(), 0};

    double minimumOnVolume(const Box& box) const {  // NOLINT(readability-identifier-naming): Eigen's name
      const double distance2 = box.squaredExteriorDistance(place);
      return distance2 > limit2 ? std::numeric_limits<double>::infinity() : distance2;
    }
    double minimumOnObject(int item) {  // NOLINT(readability-identifier-naming): Eigen's name
      const auto i = static_cast<std::size_t>(item);
      if (side && dot(surface.normals[i], *side) < 0) return std::numeric_limits<double>::infinity();
      const Vec3 p = surface.segments.empty() ? nearest_point(surface.triangles[i], x)
                                              : nearest_point(surface.segments[i], x);
      const double distance2 = norm2(p - x);
      if (distance2 < hit.distance) hit = {p, distance2, i};
      return distance2;
    }
  };

  Hit nearest(Vec3 x, const Vec3* side, double limit = std::numeric_limits<double>::infinity()) const {
    Search search{*this, x, eigen(x), side, limit * limit};
    Eigen::BVMinimize(tree, search);
    search.hit.distance = std::sqrt(search.hit.distance);
    return search.hit;
  }
};

InputSurface::InputSurface(std::span<const std::array<Vec3, 3>> triangles) : impl_(new Impl) {
  impl_->triangles.assign(triangles.begin(), triangles.end());
  for (const auto& t : triangles) {
    const Vec3 n = scaled_normal(t);
    const double length = norm(n);
    impl_->normals.push_back(length > 0 ? (1.0 / length) * n : Vec3{});
  }
  impl_->plant(impl_->triangles);
}

InputSurface::InputSurface(std::span<const std::array<Vec3, 2>> segments) : impl_(new Impl) {
  impl_->segments.assign(segments.begin(), segments.end());
  impl_->plant(impl_->segments);
}

InputSurface::~InputSurface() = default;
InputSurface::InputSurface(InputSurface&&) noexcept = default;
InputSurface& InputSurface::operator=(InputSurface&&) noexcept = default;

std::size_t InputSurface::size() const { return impl_->triangles.size() + impl_->segments.size(); }
Vec3 InputSurface::normal(std::size_t item) const { return impl_->normals[item]; }

InputSurface::Hit InputSurface::nearest(Vec3 x) const { return impl_->nearest(x, nullptr); }
InputSurface::Hit InputSurface::nearest_within(Vec3 x, double limit) const {
  Hit hit = impl_->nearest(x, nullptr, limit);
  if (hit.distance > limit) hit.distance = std::numeric_limits<double>::infinity();
  return hit;
}
InputSurface::Hit InputSurface::nearest_within(Vec3 x, double limit, Vec3 side) const {
  Hit hit = impl_->nearest(x, &side, limit);
  if (hit.distance > limit) hit.distance = std::numeric_limits<double>::infinity();
  return hit;
}

}  // namespace hfr
