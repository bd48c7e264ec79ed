// SPDX-License-Identifier: BSD-3-Clause
// Klingner & Shewchuk, Aggressive tetrahedral mesh improvement, 2007: their insertion on the boundary.
#include "Surface/SurfaceSplit.hh"

#include <algorithm>

#include "Operators/Dig.hh"
#include "Operators/EdgeRing.hh"
#include "Operators/MaxMinForm.hh"
#include "Operators/Metrics.hh"

namespace hfr {
namespace {

constexpr int kMaxDigs = 3;

/// The two boundary faces that the new vertex lies in: they are cut, not covered.
struct CutFaces {
  const TetMesh& mesh;
  VertexHandle a, b;

  bool operator()(HalfFaceHandle h) const {
    if (!mesh.is_boundary(h)) return false;
    const auto f = mesh.halfface_vertices(h);
    return std::count(f.begin(), f.end(), a) + std::count(f.begin(), f.end(), b) == 2;
  }
};

}  // namespace

template <class Metric>
void SurfaceSplit<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  seed.growth.cells(mesh, out);
}

template <class Metric>
auto SurfaceSplit<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  const auto [a, b] = mesh.edge_vertices(seed.edge);
  const CutFaces is_cut{mesh, a, b};
  Ring ring;
  if (!mesh.gather_ring(ring_start(seed.edge), ring) || ring.closed) return std::nullopt;
  GrownCells cells(mesh, ring.places[0].cell);
  for (std::size_t i = 0; i + 1 < static_cast<std::size_t>(ring.size); ++i)
    if (!cells.grow(halfface_of(ring.places[i].cell, ring.places[i].p))) return std::nullopt;

  FixedVector<std::array<VertexHandle, 3>, 2> faces;  // that are cut, seen from outside
  FixedVector<Triangle, 2> removed;
  Vec3 area;
  for (HalfFaceHandle h : cells.outer()) {
    if (!is_cut(h)) continue;
    const auto f = mesh.halfface_vertices(h);
    if (faces.full()) return std::nullopt;
    faces.push_back({f[0], f[2], f[1]});
    removed.push_back({mesh.point(f[0]), mesh.point(f[2]), mesh.point(f[1])});
    area = area + cross(removed[removed.size() - 1][1] - removed[removed.size() - 1][0],
                        removed[removed.size() - 1][2] - removed[removed.size() - 1][0]);
  }
  if (faces.size() != 2) return std::nullopt;
  const bool on_curve = surface->is_feature(a, b);
  Vec3 axis = on_curve ? mesh.point(b) - mesh.point(a) : area;
  const double length = norm(axis);
  if (!(length > 0)) return std::nullopt;
  axis = {axis.x / length, axis.y / length, axis.z / length};

  const detail::Digger<Metric, CutFaces> digger(mesh, metric, quality, max_cells,
                                                CellHandle(seed.edge.idx() / 6), is_cut, rim);
  const detail::Site best =
      digger.follow_up(digger.dig(cells, 0.5 * (mesh.point(a) + mesh.point(b))), kMaxDigs, /*gain=*/0,
                       {on_curve ? MaxMinForm::Room::kLine : MaxMinForm::Room::kPlane, axis});
  // Smaller inverted cells would look better in some metrics, and be cut again without end.
  if (!(best.new_worst > 0) || !(best.new_worst > std::max(gain * best.old_worst, best.old_worst)))
    return std::nullopt;
  FixedVector<Triangle, 4> created;
  for (std::size_t i = 0; i < 2; ++i) {
    for (VertexHandle end : {a, b}) {
      Triangle t = removed[i];
      for (std::size_t k = 0; k < 3; ++k)
        if (faces[i][k] == end) t[k] = best.place;
      created.push_back(t);
    }
  }
  if (!surface->keeps_shape(faces, removed, created)) return std::nullopt;
  return detail::plan_for(*this, mesh, seed, best);
}

template <class Metric>
void SurfaceSplit<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  const auto [a, b] = mesh.edge_vertices(plan.seed.edge);
  detail::fill_cavity(mesh, plan.seed.growth, plan.place, out, CutFaces{mesh, a, b});
  out.surface_is_held = true;
}

template <class Metric>
Tet SurfaceSplit<Metric>::identity(const TetMesh& mesh, const Seed& seed) const {
  return edge_identity(mesh, seed.edge);
}

HFR_INSTANTIATE_FOR_METRICS(SurfaceSplit)

}  // namespace hfr
