// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/SurfaceRun.hh"

#include <algorithm>
#include <cmath>

#include "HalfFace/Errors.hh"
#ifdef HFR_HAS_SURFACE
#include "Surface/SurfaceMesh.hh"
#endif

namespace hfr {

#ifdef HFR_HAS_SURFACE
namespace {

/// Of the mean edge: how far apart the points are by which surfaces are compared.
constexpr double kSpacing = 0.25;

/// What the boundary encloses; interfaces take no part.
double enclosed_volume(const TetMesh& mesh) {
  if (mesh.n_vertices() == 0) return 0;
  const Vec3 origin = mesh.points()[0];
  double sum = 0;
  double lost = 0;  // Kahan's: the volume is to be right to the last digits
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);  // seen from inside
    const Vec3 a = mesh.point(f[0]) - origin;
    const double term = dot(a, cross(mesh.point(f[2]) - origin, mesh.point(f[1]) - origin)) / 6.0 - lost;
    const double next = sum + term;
    lost = (next - sum) - term;
    sum = next;
  }
  return sum;
}

double mean_edge(const std::vector<Triangle>& surface) {
  double sum = 0;
  for (const Triangle& t : surface)
    for (std::size_t k = 0; k < 3; ++k) sum += norm(t[(k + 1) % 3] - t[k]);
  return surface.empty() ? 0 : sum / (3.0 * static_cast<double>(surface.size()));
}

double diagonal(const std::vector<Triangle>& surface) {
  if (surface.empty()) return 0;
  Vec3 low = surface[0][0];
  Vec3 high = low;
  for (const Triangle& t : surface) {
    for (Vec3 p : t) {
      for (int d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], p[d]);
        high[d] = std::max(high[d], p[d]);
      }
    }
  }
  return norm(high - low);
}

}  // namespace

struct SurfaceRun::Impl {
  par::Policy policy;
  bool measure = false;
  std::vector<Triangle> before;
  double volume = 0;
  std::unique_ptr<SurfaceMesh> surface;
};

SurfaceRun::SurfaceRun(const TetMesh& mesh, const ImproveOptions& options) : impl_(new Impl) {
  if (options.surface.mode == SurfaceMode::kFrozen) return;
  impl_->policy = options.policy;
  impl_->measure = options.statistics;
  if (impl_->measure) {
    impl_->before = surface_triangles(mesh, options.policy);
    impl_->volume = enclosed_volume(mesh);
  }
  impl_->surface = std::make_unique<SurfaceMesh>(mesh, options.surface, options.policy);
}

SurfaceMesh* SurfaceRun::get() const { return impl_->surface.get(); }

SurfaceReport SurfaceRun::report(const TetMesh& mesh) const {
  SurfaceReport report;
  if (!impl_->surface) return report;
  report.mode = impl_->surface->options().mode;
  report.bound = impl_->surface->hausdorff();
  report.feature_edges = impl_->surface->n_feature_edges();
  if (!impl_->measure) return report;
  const std::vector<Triangle> after = surface_triangles(mesh, impl_->policy);
  report.triangles_before = impl_->before.size();
  report.triangles_after = after.size();
  const double spacing = kSpacing * mean_edge(impl_->before);
  if (spacing > 0)
    report.hausdorff = surface_distance(impl_->before, after, spacing, impl_->policy).hausdorff();
  report.diagonal = diagonal(impl_->before);
  if (impl_->volume != 0) report.volume_change = (enclosed_volume(mesh) - impl_->volume) / impl_->volume;
  return report;
}

#else

struct SurfaceRun::Impl {};

SurfaceRun::SurfaceRun(const TetMesh&, const ImproveOptions& options) {
  HFR_REQUIRE(options.surface.mode == SurfaceMode::kFrozen,
              "this hfremesh was built without OpenMesh and can only leave the surface as it is: "
              "use --surface frozen, or build with -DHFR_SURFACE=ON");
}
SurfaceMesh* SurfaceRun::get() const { return nullptr; }
SurfaceReport SurfaceRun::report(const TetMesh&) const { return {}; }

#endif

SurfaceRun::~SurfaceRun() = default;

}  // namespace hfr
