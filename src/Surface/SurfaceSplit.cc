// SPDX-License-Identifier: BSD-3-Clause
// Klingner & Shewchuk, Aggressive tetrahedral mesh improvement, 2007: their insertion on the boundary.
#include "Surface/SurfaceSplit.hh"

#include <algorithm>
#include <limits>

#include "Operators/MaxMinForm.hh"
#include "Operators/Metrics.hh"

namespace hfr {
namespace {

constexpr int kMaxDigs = 3;
constexpr int kAscent = 12;
constexpr std::size_t kPatience = 12;  // cells dug without finding a better cavity

/// The two boundary faces that the new vertex lies in: they are cut, not covered.
struct CutFaces {
  VertexHandle a, b;

  bool has(const TetMesh& mesh, HalfFaceHandle h) const {
    if (!mesh.is_boundary(h)) return false;
    const auto f = mesh.halfface_vertices(h);
    return std::count(f.begin(), f.end(), a) + std::count(f.begin(), f.end(), b) == 2;
  }
};

struct Site {
  Growth growth;
  Vec3 place;
  double old_worst = 0;
  double new_worst = -std::numeric_limits<double>::infinity();
};

/// The best cavity on the way of digging behind the worst outer face; see VertexInsertion.
template <class Metric>
Site dig(const TetMesh& mesh, const Metric& metric, std::span<const double> quality, const CutFaces& cut,
         GrownCells cells, Vec3 place, std::size_t max_cells) {
  Site best;
  double old_worst = std::numeric_limits<double>::infinity();
  for (CellHandle c : cells.cells()) old_worst = std::min(old_worst, quality[c.idx()]);
  std::size_t n_valued = 0;
  for (std::size_t idle = 0; idle < kPatience; ++idle) {
    for (std::size_t i = n_valued; i < cells.outer().size(); ++i) {
      const HalfFaceHandle h = cells.outer()[i];
      const auto f = mesh.halfface_vertices(h);
      cells.value(i) = cut.has(mesh, h) ? std::numeric_limits<double>::infinity()
                                        : metric(mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2]), place);
    }
    HalfFaceHandle worst_face;
    double worst = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cells.outer().size(); ++i) {
      if (!(cells.value(i) < worst)) continue;
      worst = cells.value(i);
      worst_face = cells.outer()[i];
    }
    if (worst > best.new_worst) {
      best = {cells.growth(), place, old_worst, worst};
      idle = 0;
    }
    if (cells.cells().size() >= max_cells || !worst_face.is_valid() || !cells.grow(worst_face)) break;
    n_valued = cells.n_kept();
    old_worst = std::min(old_worst, quality[cells.cells()[cells.cells().size() - 1].idx()]);
  }
  return best;
}

}  // namespace

template <class Metric>
void SurfaceSplit<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  seed.growth.cells(mesh, out);
}

template <class Metric>
auto SurfaceSplit<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  const auto [a, b] = mesh.edge_vertices(seed.edge);
  const CutFaces cut{a, b};
  const auto& opposite = kEdgeOpposite[seed.edge.idx() % 6];
  Ring ring;
  if (!mesh.gather_ring({CellHandle(seed.edge.idx() / 6), opposite[0], opposite[1]}, ring) || ring.closed)
    return std::nullopt;
  GrownCells cells(mesh, ring.places[0].cell);
  for (std::size_t i = 0; i + 1 < static_cast<std::size_t>(ring.size); ++i)
    if (!cells.grow(halfface_of(ring.places[i].cell, ring.places[i].p))) return std::nullopt;

  FixedVector<std::array<VertexHandle, 3>, 2> faces;  // that are cut, seen from outside
  FixedVector<Triangle, 2> dead;
  Vec3 area;
  for (HalfFaceHandle h : cells.outer()) {
    if (!cut.has(mesh, h)) continue;
    const auto f = mesh.halfface_vertices(h);
    if (faces.full()) return std::nullopt;
    faces.push_back({f[0], f[2], f[1]});
    dead.push_back({mesh.point(f[0]), mesh.point(f[2]), mesh.point(f[1])});
    area = area + cross(dead[dead.size() - 1][1] - dead[dead.size() - 1][0],
                        dead[dead.size() - 1][2] - dead[dead.size() - 1][0]);
  }
  if (faces.size() != 2) return std::nullopt;
  const bool on_curve = surface->is_feature(a, b);
  Vec3 axis = on_curve ? mesh.point(b) - mesh.point(a) : area;
  const double length = norm(axis);
  if (!(length > 0)) return std::nullopt;
  axis = {axis.x / length, axis.y / length, axis.z / length};

  const auto dig_from = [&](const GrownCells& from, Vec3 place) {
    return dig(mesh, metric, quality, cut, from, place, std::min(max_cells, Growth::kMaxCells));
  };
  Site best = dig_from(cells, 0.5 * (mesh.point(a) + mesh.point(b)));
  for (int i = 1; i < kMaxDigs && best.new_worst > 0; ++i) {
    GrownCells now(mesh, best.growth.first);
    for (std::size_t k = 0; k < best.growth.n_steps; ++k)
      now.grow(halfface_of(now.cells()[best.growth.steps[k] / 4U], best.growth.steps[k] % 4));
    MaxMinForm form(best.place, MaxMinForm::kAnglesOf<Metric>);
    form.confine(on_curve ? MaxMinForm::Room::kLine : MaxMinForm::Room::kPlane, axis);
    for (HalfFaceHandle h : now.outer()) {
      if (cut.has(mesh, h)) continue;
      const auto f = mesh.halfface_vertices(h);
      form.add(mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2]));
    }
    const Vec3 moved = form.ascend(best.place, kAscent);
    if (moved == best.place) break;
    const Site next = dig_from(now, moved);
    if (!(next.new_worst > best.new_worst)) break;
    best = next;
  }
  // Smaller inverted cells would look better in some metrics, and be cut again without end.
  if (!(best.new_worst > 0) || !(best.new_worst > std::max(gain * best.old_worst, best.old_worst)))
    return std::nullopt;
  FixedVector<Triangle, 4> born;
  for (std::size_t i = 0; i < 2; ++i) {
    for (VertexHandle end : {a, b}) {
      Triangle t = dead[i];
      for (std::size_t k = 0; k < 3; ++k)
        if (faces[i][k] == end) t[k] = best.place;
      born.push_back(t);
    }
  }
  if (!surface->keeps_shape(faces, dead, born)) return std::nullopt;
  Plan plan;
  plan.seed = seed;
  plan.seed.growth = best.growth;
  plan.place = best.place;
  plan.old_worst = best.old_worst;
  plan.new_worst = best.new_worst;
  Cavity cavity;
  commit(mesh, plan, cavity);
  plan.n_dead = static_cast<std::uint32_t>(cavity.dead.size());
  plan.n_born = static_cast<std::uint32_t>(cavity.born.size());
  plan.adds_vertex = true;
  return plan;
}

template <class Metric>
void SurfaceSplit<Metric>::commit(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  const auto [a, b] = mesh.edge_vertices(plan.seed.edge);
  const CutFaces cut{a, b};
  Scope cells;
  plan.seed.growth.cells(mesh, cells);
  out.clear();
  for (CellHandle c : cells) out.dead.push_back(c);
  for (CellHandle c : cells) {
    for (HalfFaceHandle h : mesh.cell_halffaces(c)) {
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (m.is_valid() && std::find(cells.begin(), cells.end(), cell_of(m)) != cells.end()) continue;
      if (cut.has(mesh, h)) continue;
      const auto f = mesh.halfface_vertices(h);
      out.born.push_back({f[0], f[1], f[2], Cavity::kNewVertex});
    }
  }
  out.new_vertex = plan.place;
}

template <class Metric>
Tet SurfaceSplit<Metric>::identity(const TetMesh& mesh, const Seed& seed) const {
  return edge_identity(mesh, seed.edge);
}

HFR_INSTANTIATE_FOR_METRICS(SurfaceSplit)

}  // namespace hfr
