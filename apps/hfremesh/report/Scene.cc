// SPDX-License-Identifier: BSD-3-Clause
#include "Scene.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hfr::view {
namespace {

constexpr double kRadians = std::numbers::pi / 180;
constexpr double kTurn = 28 * kRadians;       // of the eye about the vertical
constexpr double kElevation = 22 * kRadians;  // of the eye above the horizon
constexpr double kDistance = 5;               // of the eye, in radii
constexpr double kFlat = 0.5;                 // of the other two extents

Vec3 axis(int i) { return {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0}; }

struct Seen {
  double x, y, w;  ///< w: larger for what is nearer
};

Seen seen(const Scene& s, Vec3 p) {
  const Vec3 d = p - s.centre;
  const double w = 1 / (kDistance * s.radius - dot(d, s.axes[2]));
  return {dot(d, s.axes[0]) * w, dot(d, s.axes[1]) * w, w};
}

}  // namespace

Scene scene_of(const TetMesh& mesh) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  const auto is_used = [&](std::size_t i) { return mesh.incident_cell(VertexHandle(i)).is_valid(); };
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    if (!is_used(i)) continue;
    const Vec3 p = mesh.point(VertexHandle(i));
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Scene s;
  s.centre = 0.5 * (low + high);
  s.radius = std::max(0.5 * norm(high - low), std::numeric_limits<double>::min());
  const Vec3 extent = high - low;
  const int up = extent.z < kFlat * std::min(extent.x, extent.y) ? 1 : 2;
  const int other = up == 2 ? 1 : 2;
  const int right = extent.x >= extent[other] ? 0 : other;
  // The third axis points at the eye, so that right, up and it are a right-handed system.
  const Vec3 r = axis(right), u = axis(up);
  const Vec3 front = cross(r, u);
  const Vec3 eye =
      std::cos(kElevation) * (std::cos(kTurn) * front + std::sin(kTurn) * r) + std::sin(kElevation) * u;
  const Vec3 x = (1 / norm(cross(u, eye))) * cross(u, eye);
  s.axes = {x, cross(eye, x), eye};
  s.cut_normal = front;
  s.cut = dot(front, s.centre);
  s.frame = {Vec3{kFar, kFar, 0}, Vec3{-kFar, -kFar, 0}};
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    if (!is_used(i)) continue;
    const Seen at = seen(s, mesh.point(VertexHandle(i)));
    s.frame[0] = {std::min(s.frame[0].x, at.x), std::min(s.frame[0].y, at.y), 0};
    s.frame[1] = {std::max(s.frame[1].x, at.x), std::max(s.frame[1].y, at.y), 0};
  }
  return s;
}

Projection::Projection(const Scene& scene, double width, double height) : scene_(scene) {
  constexpr double kMargin = 0.96;
  const Vec3 size = scene.frame[1] - scene.frame[0];
  scale_ = kMargin * std::min(width / std::max(size.x, 1e-12), height / std::max(size.y, 1e-12));
  x_ = 0.5 * width - 0.5 * scale_ * (scene.frame[0].x + scene.frame[1].x);
  y_ = 0.5 * height + 0.5 * scale_ * (scene.frame[0].y + scene.frame[1].y);
}

std::array<double, 3> Projection::operator()(Vec3 p) const {
  const Seen at = seen(scene_, p);
  return {x_ + scale_ * at.x, y_ - scale_ * at.y, at.w * scene_.radius};
}

}  // namespace hfr::view
