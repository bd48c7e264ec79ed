// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Unfolding.hh"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Operators/Unfold.hh"
#include "Remesh/Strategy.hh"

namespace hfr {

bool Tangle::is_less_than(const Tangle& other) const {
  return n_invalid < other.n_invalid || overlap * kLargeRise < other.overlap;
}

double Unfolding::overlap_of(const TetMesh& mesh, CellHandle cell) {
  const auto& v = mesh.cell(cell).v;
  const Vec3 a = mesh.point(v[0]), b = mesh.point(v[1]), c = mesh.point(v[2]), d = mesh.point(v[3]);
  return orientation(a, b, c, d) <= 0 ? std::abs(dot(cross(b - a, c - a), d - a)) : -1;
}

Vec3 Unfolding::relaxation(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                           double over) {
  Vec3 sum;
  for (HalfFaceHandle h : link)
    for (VertexHandle u : mesh.halfface_vertices(h)) sum = sum + mesh.point(u);
  const Vec3 mean = (1.0 / (3.0 * static_cast<double>(link.size()))) * sum;
  return over * (mean - mesh.point(v));
}

Vec3 Unfolding::unfolded(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                         const UntangleEffort& effort) {
  return mesh.point(v) + unfold(StarForm(mesh, v, link), effort.newton_steps);
}

bool Unfolding::helps(const Workspace& work, const Damage& was, const Damage& is) {
  if (!work.holds_damage) return is.n_invalid() < was.n_invalid();
  return was.may_become(is, work.floor) &&
         (is.n_invalid() < was.n_invalid() || is.n_inverted() < was.n_inverted());
}

Box box_of(const TetMesh& mesh) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Box box{{kNone, kNone, kNone}, {-kNone, -kNone, -kNone}};
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    if (!mesh.incident_cell(VertexHandle(i)).is_valid()) continue;
    const Vec3 p = mesh.point(VertexHandle(i));
    for (int d = 0; d < 3; ++d) {
      box.low[d] = std::min(box.low[d], p[d]);
      box.high[d] = std::max(box.high[d], p[d]);
    }
  }
  return box;
}

}  // namespace hfr
