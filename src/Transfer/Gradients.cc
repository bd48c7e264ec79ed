// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Gradients.hh"

#include <algorithm>
#include <cmath>
#include <limits>

#include "HalfFace/Geometry.hh"
#include "Transfer/Stars.hh"

namespace hfr {
namespace {

// Of what three edges at right angles have: below it, they count as lying in one plane.
constexpr double kFlat = 1e-9;

/// Those of the neighbours in the order of their handles: sums of them are the same however the mesh is
/// stored.
std::vector<Gradients::Term> terms_of(const TetMesh& mesh, VertexHandle v, std::span<const CellHandle> star) {
  const Vec3 at = mesh.point(v);
  std::vector<VertexHandle> neighbours;
  for (CellHandle c : star)
    for (VertexHandle u : mesh.cell(c).v)
      if (u != v) neighbours.push_back(u);
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  std::vector<Gradients::Term> terms;
  double shortest = std::numeric_limits<double>::infinity();
  for (VertexHandle u : neighbours) {
    const Vec3 d = mesh.point(u) - at;
    const double length = norm(d);
    if (!(length > 0) || !std::isfinite(1 / length)) continue;
    shortest = std::min(shortest, length);
    terms.push_back({u, d});
  }
  // Σ (shortest/l)² e eᵀ with the edges' directions e, whose largest entry is of the order of 1.
  Vec3 x, y, z;
  for (Gradients::Term& term : terms) {
    const double length = norm(term.weight), share = shortest / length;
    const Vec3 e = (1 / length) * term.weight;
    const Vec3 weighted = (share * share) * e;
    x = x + e.x * weighted;
    y = y + e.y * weighted;
    z = z + e.z * weighted;
    term.weight = (1 / length) * weighted;
  }
  const Vec3 yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
  const double determinant = dot(x, yz), size = x.x + y.y + z.z;
  if (!(determinant > kFlat * size * size * size)) return {};
  for (Gradients::Term& term : terms) {
    const Vec3 w = term.weight;  // the matrix is symmetric: its adjugate has these rows, too
    term.weight = (1 / determinant) * Vec3{dot(yz, w), dot(zx, w), dot(xy, w)};
  }
  return terms;
}

}  // namespace

Gradients::Gradients(const TetMesh& old, std::span<const CellHandle> cells, par::Policy policy) {
  for (CellHandle c : cells)
    for (VertexHandle corner : old.cell_vertices(c)) vertices_.push_back(corner);
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  terms_.resize(vertices_.size());
  const Stars stars(old, vertices_, policy);
  constexpr double kNanoseconds = 1'000;  // a vertex, about
  par::for_each_dynamic(policy.for_items_of(kNanoseconds), vertices_.size(), 64, [&](std::size_t i) {
    terms_[i] = terms_of(old, vertices_[i], stars.of(vertices_[i]));
  });
}

std::span<const Gradients::Term> Gradients::terms(VertexHandle v) const {
  const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), v);
  if (found == vertices_.end() || *found != v) return {};
  return terms_[static_cast<std::size_t>(found - vertices_.begin())];
}

}  // namespace hfr
