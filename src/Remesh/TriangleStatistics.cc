// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>

#include "Remesh/ImproveTriangles.hh"
#include "Remesh/Surfaces.hh"

namespace hfr {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// In degrees, the smallest and the largest.
std::array<double, 2> angles(const std::array<Vec3, 3>& t) {
  std::array<double, 2> found = {180, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 u = t[(k + 1) % 3] - t[k];
    const Vec3 v = t[(k + 2) % 3] - t[k];
    const double angle = std::atan2(norm(cross(u, v)), dot(u, v)) / kDegree;
    found = {std::min(found[0], angle), std::max(found[1], angle)};
  }
  return found;
}

void count_edges(const TriangleMesh& mesh, TriangleStatistics& s) {
  struct Edge {
    VertexHandle a, b;
    bool forth;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexHandle from = t[k];
      const VertexHandle to = t[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& x, const Edge& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].a == edges[i].a && edges[end].b == edges[i].b) ++end;
    if (end - i == 1)
      ++s.open_edges;
    else if (end - i > 2 || edges[i].forth == edges[i + 1].forth)
      ++s.non_manifold_edges;
    i = end;
  }
}

Distribution distribution(std::vector<double> values) {
  Distribution d;
  if (values.empty()) return d;
  double sum = 0;
  for (double v : values) sum += v;
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  d.min = values.front();
  d.max = values.back();
  d.mean = sum / n;
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    const auto rank = static_cast<std::size_t>(std::ceil(kPercentiles[i] / 100 * n));
    d.percentiles[i] = values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
  }
  return d;
}

}  // namespace

TriangleStatistics statistics(const TriangleMesh& mesh) {
  TriangleStatistics s;
  s.triangles = mesh.triangles.size();
  std::vector<std::uint8_t> used(mesh.points.size(), 0);
  std::vector<double> smallest;
  smallest.reserve(mesh.triangles.size());
  std::vector<std::array<Vec3, 3>> triangles;
  for (const auto& t : mesh.triangles) {
    for (VertexHandle v : t) used[v.idx()] = 1;
    triangles.push_back(corners(mesh, t));
    const auto [least, largest] = angles(triangles.back());
    smallest.push_back(least);
    s.max_angle = std::max(s.max_angle, largest);
    const Vec3 n =
        cross(triangles.back()[1] - triangles.back()[0], triangles.back()[2] - triangles.back()[0]);
    s.area += 0.5 * norm(n);
    if (n == Vec3{}) ++s.flat;
  }
  s.vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
  s.min_angle = distribution(std::move(smallest));
  count_edges(mesh, s);
  if (s.open_edges == 0 && s.non_manifold_edges == 0) s.volume = enclosed_volume(triangles);
  return s;
}

double enclosed_volume(const std::vector<std::array<Vec3, 3>>& triangles) {
  if (triangles.empty()) return 0;
  const Vec3 origin = triangles[0][0];
  double sum = 0;
  double lost = 0;  // Kahan's
  for (const auto& t : triangles) {
    const double term = dot(t[0] - origin, cross(t[1] - origin, t[2] - origin)) / 6.0 - lost;
    const double next = sum + term;
    lost = (next - sum) - term;
    sum = next;
  }
  return sum;
}

}  // namespace hfr
