// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/FaceSwap.hh"

#include <algorithm>

#include "Operators/Metrics.hh"

namespace hfr {

template <class Metric>
void FaceSwap<Metric>::scope(const TetMesh& mesh, Seed seed, Scope& out) const {
  out.clear();
  out.push_back(cell_of(seed));
  const HalfFaceHandle m = mesh.opposite_halfface(seed);
  if (m.is_valid()) out.push_back(cell_of(m));
}

template <class Metric>
std::optional<typename FaceSwap<Metric>::Plan> FaceSwap<Metric>::evaluate(const TetMesh& mesh,
                                                                          Seed seed) const {
  const HalfFaceHandle m = mesh.opposite_halfface(seed);
  if (!m.is_valid()) return std::nullopt;
  const VertexHandle above = mesh.halfface_opposite_vertex(seed);
  const VertexHandle below = mesh.halfface_opposite_vertex(m);
  if (above == below) return std::nullopt;  // two cells on the same four vertices: only in a folded mesh
  const double old_worst = std::min(quality[cell_of(seed).idx()], quality[cell_of(m).idx()]);
  const auto f = mesh.halfface_vertices(seed);
  const std::array<Vec3, 3> p = {mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2])};
  const Vec3 top = mesh.point(above);
  const Vec3 bottom = mesh.point(below);
  double new_worst = metric(bottom, top, p[0], p[1]);
  if (!(new_worst > old_worst)) return std::nullopt;
  new_worst = std::min(new_worst, metric(bottom, top, p[1], p[2]));
  if (!(new_worst > old_worst)) return std::nullopt;
  new_worst = std::min(new_worst, metric(bottom, top, p[2], p[0]));
  if (!(new_worst > old_worst)) return std::nullopt;
  Plan plan;
  plan.old_worst = old_worst;
  plan.new_worst = new_worst;
  plan.n_removed = 2;
  plan.n_created = 3;
  plan.seed = seed;
  return plan;
}

template <class Metric>
void FaceSwap<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  const HalfFaceHandle m = mesh.opposite_halfface(plan.seed);
  const VertexHandle above = mesh.halfface_opposite_vertex(plan.seed);
  const VertexHandle below = mesh.halfface_opposite_vertex(m);
  const auto f = mesh.halfface_vertices(plan.seed);
  out.clear();
  out.removed.push_back(cell_of(plan.seed));
  out.removed.push_back(cell_of(m));
  for (std::size_t i = 0; i < 3; ++i) out.created.push_back({below, above, f[i], f[(i + 1) % 3]});
}

template <class Metric>
Tet FaceSwap<Metric>::identity(const TetMesh& mesh, Seed seed) const {
  auto f = mesh.halfface_vertices(seed);
  std::sort(f.begin(), f.end());
  return {f[0], f[1], f[2], VertexHandle()};
}

HFR_INSTANTIATE_FOR_METRICS(FaceSwap)

}  // namespace hfr
