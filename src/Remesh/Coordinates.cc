// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Coordinates.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "HalfFace/Errors.hh"

namespace hfr {
namespace {

constexpr double kLargest = 1e30;
constexpr double kSmallest = 1e-25;
/// Distances of neighbouring doubles that an edge has to be long.
constexpr double kLeastSteps = 64;
/// Where the box is this many of them wide a cell, no cell is asked.
constexpr double kManySteps = 1e6;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr CoordinateBox kNoBox = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

double side(const CoordinateBox& box) {
  const Vec3 size = box.high - box.low;
  return std::max({size.x, size.y, size.z});
}

double largest(const CoordinateBox& box) {
  double value = 0;
  for (int i = 0; i < 3; ++i) value = std::max({value, std::abs(box.low[i]), std::abs(box.high[i])});
  return value;
}

bool has_nan(const CoordinateBox& box) {
  bool found = false;
  for (int i = 0; i < 3; ++i) found = found || std::isnan(box.low[i]) || std::isnan(box.high[i]);
  return found;
}

std::string number(double x) {
  std::ostringstream out;
  out.precision(3);
  out << x;
  return out.str();
}

double longest_edge(const TriangleMesh& mesh, std::size_t i) {
  const auto& t = mesh.triangles[i];
  double longest2 = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest2 = std::max(longest2, norm2(mesh.points[t[k].idx()] - mesh.points[t[(k + 1) % 3].idx()]));
  return std::sqrt(longest2);
}

/// n_shorter(least): elements without an edge of that length, of n.
template <class NShorter>
void require(const CoordinateBox& box, double n, const char* what, NShorter&& n_shorter) {
  const double far = largest(box), wide = side(box);
  HFR_REQUIRE(!has_nan(box), "there are coordinates that are no numbers");
  HFR_REQUIRE(far <= kLargest,
              "there are coordinates up to " + number(far) +
                  "; beyond 1e30 products of lengths are no numbers any more: scale the mesh");
  HFR_REQUIRE(
      wide == 0 || wide >= kSmallest,
      "the mesh is only " + number(wide) + " wide; below 1e-25 products of lengths vanish: scale the mesh");
  const double step = std::nextafter(far, 2 * far + 1) - far;
  if (wide == 0 || wide >= kManySteps * step * std::cbrt(n)) return;
  HFR_REQUIRE(2 * static_cast<double>(n_shorter(kLeastSteps * step)) <= n,
              "near coordinates of " + number(far) + " numbers are " + number(step) +
                  " apart, too coarse for most " + what + " of a mesh that is " + number(wide) +
                  " wide: move it towards the origin before it is written");
}

}  // namespace

CoordinateBox joined(CoordinateBox a, const CoordinateBox& b) {
  for (int i = 0; i < 3; ++i) {
    if (!(a.low[i] < b.low[i]) && !std::isnan(a.low[i])) a.low[i] = b.low[i];
    if (!(a.high[i] > b.high[i]) && !std::isnan(a.high[i])) a.high[i] = b.high[i];
  }
  return a;
}

CoordinateBox coordinate_box(const TetMesh& mesh, par::Policy policy) {
  return par::reduce(
      policy, mesh.n_vertices(), kNoBox,
      [&](std::size_t i) {
        const VertexHandle v(i);
        return mesh.incident_cell(v).is_valid() ? CoordinateBox{mesh.point(v), mesh.point(v)} : kNoBox;
      },
      joined);
}

double longest_edge(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  double longest2 = 0;
  for (const auto& e : kEdgeCorners)
    longest2 = std::max(longest2, norm2(mesh.point(v[e[0]]) - mesh.point(v[e[1]])));
  return std::sqrt(longest2);
}

void require_sound_coordinates(const CoordinateBox& box, std::size_t n_cells,
                               const std::function<std::size_t(double)>& n_shorter) {
  require(box, static_cast<double>(n_cells), "cells", n_shorter);
}

void require_sound_coordinates(const TetMesh& mesh, par::Policy policy) {
  if (mesh.n_logical_cells() == 0) return;
  require_sound_coordinates(coordinate_box(mesh, policy), mesh.n_logical_cells(), [&](double least) {
    return par::reduce(
        policy, mesh.n_cells(), std::size_t{0},
        [&](std::size_t i) -> std::size_t {
          const CellHandle c(i);
          return !mesh.is_deleted(c) && longest_edge(mesh, c) < least ? 1 : 0;
        },
        [](std::size_t a, std::size_t b) { return a + b; });
  });
}

void require_sound_coordinates(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return;
  CoordinateBox box = kNoBox;
  for (const auto& t : mesh.triangles)
    for (VertexHandle v : t) box = joined(box, {mesh.points[v.idx()], mesh.points[v.idx()]});
  require(box, static_cast<double>(mesh.triangles.size()), "triangles", [&](double least) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) n += longest_edge(mesh, i) < least ? 1 : 0;
    return n;
  });
}

}  // namespace hfr
