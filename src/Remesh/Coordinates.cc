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

struct Box {
  Vec3 low, high;

  double side() const {
    const Vec3 size = high - low;
    return std::max({size.x, size.y, size.z});
  }
  double largest() const {
    double value = 0;
    for (int i = 0; i < 3; ++i) value = std::max({value, std::abs(low[i]), std::abs(high[i])});
    return value;
  }
  bool has_nan() const {
    bool found = false;
    for (int i = 0; i < 3; ++i) found = found || std::isnan(low[i]) || std::isnan(high[i]);
    return found;
  }
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Box kNoBox = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

/// A coordinate that is no number stays: it is to be refused.
Box joined(Box a, const Box& b) {
  for (int i = 0; i < 3; ++i) {
    if (!(a.low[i] < b.low[i]) && !std::isnan(a.low[i])) a.low[i] = b.low[i];
    if (!(a.high[i] > b.high[i]) && !std::isnan(a.high[i])) a.high[i] = b.high[i];
  }
  return a;
}

/// Of the vertices that have cells.
Box box_of(const TetMesh& mesh, par::Policy policy) {
  return par::reduce(
      policy, mesh.n_vertices(), kNoBox,
      [&](std::size_t i) {
        const VertexHandle v(i);
        return mesh.incident_cell(v).is_valid() ? Box{mesh.point(v), mesh.point(v)} : kNoBox;
      },
      joined);
}

std::string number(double x) {
  std::ostringstream out;
  out.precision(3);
  out << x;
  return out.str();
}

double longest_edge(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  double longest2 = 0;
  for (const auto& e : kEdgeCorners)
    longest2 = std::max(longest2, norm2(mesh.point(v[e[0]]) - mesh.point(v[e[1]])));
  return std::sqrt(longest2);
}

double longest_edge(const TriangleMesh& mesh, std::size_t i) {
  const auto& t = mesh.triangles[i];
  double longest2 = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest2 = std::max(longest2, norm2(mesh.points[t[k].idx()] - mesh.points[t[(k + 1) % 3].idx()]));
  return std::sqrt(longest2);
}

/// n_lost(least): elements without an edge of that length, of n.
template <class NLost>
void require(const Box& box, double n, const char* what, NLost&& n_lost) {
  const double largest = box.largest();
  const double side = box.side();
  HFR_REQUIRE(!box.has_nan(), "there are coordinates that are no numbers");
  HFR_REQUIRE(largest <= kLargest,
              "there are coordinates up to " + number(largest) +
                  "; beyond 1e30 products of lengths are no numbers any more: scale the mesh");
  HFR_REQUIRE(
      side == 0 || side >= kSmallest,
      "the mesh is only " + number(side) + " wide; below 1e-25 products of lengths vanish: scale the mesh");
  const double step = std::nextafter(largest, 2 * largest + 1) - largest;
  if (side == 0 || side >= kManySteps * step * std::cbrt(n)) return;
  HFR_REQUIRE(2 * static_cast<double>(n_lost(kLeastSteps * step)) <= n,
              "near coordinates of " + number(largest) + " numbers are " + number(step) +
                  " apart, too coarse for most " + what + " of a mesh that is " + number(side) +
                  " wide: move it towards the origin before it is written");
}

}  // namespace

void require_sound_coordinates(const TetMesh& mesh, par::Policy policy) {
  if (mesh.n_logical_cells() == 0) return;
  require(box_of(mesh, policy), static_cast<double>(mesh.n_logical_cells()), "cells", [&](double least) {
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
  Box box = kNoBox;
  for (const auto& t : mesh.triangles)
    for (VertexHandle v : t) box = joined(box, {mesh.points[v.idx()], mesh.points[v.idx()]});
  require(box, static_cast<double>(mesh.triangles.size()), "triangles", [&](double least) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) n += longest_edge(mesh, i) < least ? 1 : 0;
    return n;
  });
}

}  // namespace hfr
