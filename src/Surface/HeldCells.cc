// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/HeldCells.hh"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "Quality/Metrics.hh"
#include "Surface/Features.hh"

namespace hfr {
namespace {

using surface::corners;
using surface::scaled_normal;
using surface::unit;

/// The surface as one mode sees it.
class View {
 public:
  using Named = std::function<VertexHandle(VertexHandle)>;

  View(const TetMesh& mesh, const SurfaceOptions& options, SurfaceMode mode, par::Policy policy)
      : View(surface::gather(mesh, options, policy), options, mode, {}) {}
  /// `named`: what the arrays call a vertex of the mesh, where it is only a part.
  View(surface::Arrays arrays, SurfaceOptions options, SurfaceMode mode, Named named)
      : tilts_(mode == SurfaceMode::kFree), named_(std::move(named)), arrays_(std::move(arrays)) {
    options.mode = mode;
    features_ = surface::find_features(arrays_, options, surface::allowed_distance(arrays_, options));
  }

  /// True when something of the cell's surface may change, and nothing that stays is too narrow for it.
  bool lets_change(const TetMesh& mesh, CellHandle c, double degrees) const {
    return !(narrowest_feature(mesh, c, /*for_good=*/false).degrees < degrees) && may_change(mesh, c);
  }
  FeatureCeiling ceiling(const TetMesh& mesh, CellHandle c) const {
    return narrowest_feature(mesh, c, /*for_good=*/tilts_);
  }

 private:
  bool may_change(const TetMesh& mesh, CellHandle c) const {
    const auto& v = mesh.cell(c).v;
    return std::any_of(v.begin(), v.end(),
                       [&](VertexHandle w) {
                         const SurfaceKind kind = features_.motion_constraint[name(w).idx()].kind;
                         return kind == SurfaceKind::kFacet || kind == SurfaceKind::kCurve;
                       }) ||
           std::any_of(kEdgeCorners.begin(), kEdgeCorners.end(), [&](const auto& ends) {
             const surface::Edge* e = edge(name(v[ends[0]]), name(v[ends[1]]));
             return e && e->manifold && !e->feature && !arrays_.locked[e->f[0]] && !arrays_.locked[e->f[1]];
           });
  }
  /// The feature edge of the cell whose faces leave it least. `for_good`: only features whose faces stay as
  /// they are count.
  FeatureCeiling narrowest_feature(const TetMesh& mesh, CellHandle c, bool for_good) const {
    FeatureCeiling narrowest;
    const auto& v = mesh.cell(c).v;
    const std::array<double, 6> own =
        dihedrals(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
    for (std::size_t k = 0; k < kEdgeCorners.size(); ++k) {
      const surface::Edge* e = edge(name(v[kEdgeCorners[k][0]]), name(v[kEdgeCorners[k][1]]));
      if (!e || !e->manifold || !e->feature) continue;
      if (for_good && !(stays(e->f[0]) && stays(e->f[1]))) continue;
      const double inside = angle_inside(*e);
      const double left = is_inside(mesh, c, *e) ? inside : 360 - inside;
      // Where the faces lie on one another, as at the front of a crack, rounding may take all for nothing.
      // The wedge has room for the cell.
      const double room = left < own[k] ? 360 - left : left;
      if (room < narrowest.degrees) narrowest = {room, e->a, e->b};
    }
    return narrowest;
  }
  bool stays(std::uint32_t face) const {
    if (arrays_.locked[face] && arrays_.fixed[face]) return true;
    const auto& v = arrays_.faces[face];
    for (std::size_t k = 0; k < 3; ++k) {
      const surface::Edge* e = edge(v[k], v[(k + 1) % 3]);
      if (features_.motion_constraint[v[k].idx()].kind != SurfaceKind::kFixed || !e || !e->feature)
        return false;
    }
    return true;
  }
  VertexHandle name(VertexHandle v) const { return named_ ? named_(v) : v; }
  const surface::Edge* edge(VertexHandle a, VertexHandle b) const {
    if (b < a) std::swap(a, b);
    const auto& edges = features_.edges;
    const auto at =
        std::lower_bound(edges.begin(), edges.end(), std::pair(a, b),
                         [](const surface::Edge& e, const std::pair<VertexHandle, VertexHandle>& w) {
                           return std::pair(e.a, e.b) < w;
                         });
    return at != edges.end() && at->a == a && at->b == b ? &*at : nullptr;
  }
  /// Is the cell on the side from which the faces at e are seen from inside? Not in the larger region, at an
  /// edge of an interface.
  bool is_inside(const TetMesh& mesh, CellHandle c, const surface::Edge& e) const {
    return !arrays_.interface[e.f[0]] || mesh.region(c) == arrays_.regions[e.f[0]][0];
  }
  /// Degrees between the two faces at e, through the inside: below 180 where the surface is convex.
  double angle_inside(const surface::Edge& e) const {
    const Triangle f = corners(arrays_.points, arrays_.faces[e.f[0]]);
    const Triangle g = corners(arrays_.points, arrays_.faces[e.f[1]]);
    const Vec3 n = unit(scaled_normal(f));
    const Vec3 m = unit(scaled_normal(g));
    const double turn = std::atan2(norm(cross(n, m)), dot(n, m)) * (180.0 / std::numbers::pi);
    const bool convex = dot(g[(e.k[1] + 2U) % 3] - f[e.k[0]], n) <= 0;
    return convex ? 180 - turn : 180 + turn;
  }

  bool tilts_;   // whether facets may leave their planes
  Named named_;  // none where all is known by the handles of the mesh
  surface::Arrays arrays_;
  surface::Features features_;
};

}  // namespace

std::vector<FreedBy> freed_by(const TetMesh& mesh, std::span<const CellHandle> cells, double degrees,
                              const SurfaceOptions& options, par::Policy policy) {
  std::vector<FreedBy> found;
  if (cells.empty()) return found;
  const View flat(mesh, options, SurfaceMode::kFlat, policy);
  const View free(mesh, options, SurfaceMode::kFree, policy);
  found.reserve(cells.size());
  for (CellHandle c : cells)
    found.push_back(flat.lets_change(mesh, c, degrees)   ? FreedBy::kFlat
                    : free.lets_change(mesh, c, degrees) ? FreedBy::kFree
                                                         : FreedBy::kShape);
  return found;
}

std::vector<FeatureCeiling> feature_ceilings(const TetMesh& mesh, std::span<const CellHandle> cells,
                                             const SurfaceOptions& options, par::Policy policy) {
  std::vector<FeatureCeiling> ceilings(cells.size());
  if (cells.empty() || options.mode == SurfaceMode::kFrozen) return ceilings;
  const View view(mesh, options, options.mode, policy);
  for (std::size_t i = 0; i < cells.size(); ++i) ceilings[i] = view.ceiling(mesh, cells[i]);
  return ceilings;
}

std::vector<FeatureCeiling> feature_ceilings(const TetMesh& part, std::span<const CellHandle> cells,
                                             const SurfaceOptions& options, surface::Arrays arrays,
                                             const std::function<VertexHandle(VertexHandle)>& named) {
  std::vector<FeatureCeiling> ceilings(cells.size());
  if (cells.empty()) return ceilings;
  const View view(std::move(arrays), options, options.mode, named);
  for (std::size_t i = 0; i < cells.size(); ++i) ceilings[i] = {view.ceiling(part, cells[i]).degrees, {}, {}};
  return ceilings;
}

}  // namespace hfr
