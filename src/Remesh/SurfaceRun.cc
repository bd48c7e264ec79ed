// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/SurfaceRun.hh"

#include <algorithm>
#include <map>
#include <vector>

#include "HalfFace/Errors.hh"
#include "Remesh/Run.hh"
#include "Remesh/StuckCells.hh"
#include "Remesh/Surfaces.hh"
#include "Surface/HeldCells.hh"
#include "Surface/PlanarUnfold.hh"
#include "Surface/SurfaceMesh.hh"
#include "Surface/SurfaceUnfold.hh"

namespace hfr {
namespace {

/// What rounding leaves of a proof, no tuning: degrees by which planes that are flat to rounding may turn. In
/// flat mode a wedge that is negative by more than this stays negative.
constexpr double kPlanar = 1e-6;

/// What the boundary encloses; interfaces take no part.
double enclosed_volume(const TetMesh& mesh) {
  std::vector<Triangle> boundary;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);  // seen from inside
    boundary.push_back({mesh.point(f[0]), mesh.point(f[2]), mesh.point(f[1])});
  }
  return enclosed_volume(boundary);
}

std::map<int, double> region_volumes(const TetMesh& mesh) {
  struct Sum {
    double value = 0, lost = 0;  // Kahan's
  };
  std::map<int, Sum> sums;
  if (!mesh.has_regions()) return {};
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const Vec3 a = mesh.point(v[0]);
    Sum& sum = sums[mesh.region(c)];
    const double term =
        dot(mesh.point(v[1]) - a, cross(mesh.point(v[2]) - a, mesh.point(v[3]) - a)) / 6.0 - sum.lost;
    const double next = sum.value + term;
    sum.lost = (next - sum.value) - term;
    sum.value = next;
  }
  std::map<int, double> volumes;
  for (const auto& [region, sum] : sums) volumes[region] = sum.value;
  return volumes;
}

PassReport unfolding_report(const char* op, std::size_t n_folded, std::size_t n_moved) {
  PassReport pass;
  pass.stage = "unfold";
  pass.op = op;
  pass.iteration = 1;
  pass.seeds = pass.candidates = n_folded;
  pass.winners = n_moved;
  return pass;
}

}  // namespace

struct SurfaceRun::Impl {
  par::Policy policy;
  bool measure = false;
  std::vector<Triangle> input;   // before plane walls were opened, where they were looked at
  std::vector<Triangle> before;  // and after
  double volume = 0;
  std::map<int, double> regions;  // their volumes
  double bound = 0;               // largest distance allowed
  double unfold_needs = 0;        // and what folds would take
  std::unique_ptr<SurfaceMesh> surface;
};

SurfaceRun::SurfaceRun(TetMesh& mesh, const ImproveOptions& options, bool unfold,
                       std::vector<PassReport>& passes, const std::function<bool()>& stopped)
    : impl_(new Impl) {
  if (options.surface.mode == SurfaceMode::kFrozen) return;
  impl_->policy = options.policy;
  impl_->measure = options.statistics;
  if (unfold) {  // which keeps the shape: what is measured is against the layers that add up to it
    if (impl_->measure) impl_->input = surface_triangles(mesh, options.policy);
    const PlanarUnfolding done = unfold_planes(mesh, options.surface, options.policy, stopped);
    if (done.n_moved > 0)
      passes.push_back(report_of(done));
    else
      impl_->input.clear();
  }
  if (impl_->measure) {
    impl_->before = surface_triangles(mesh, options.policy);
    impl_->volume = enclosed_volume(mesh);
    impl_->regions = region_volumes(mesh);
  }
  SurfaceOptions wanted = options.surface;
  impl_->bound = SurfaceMesh::allowed_distance(mesh, wanted, options.policy);
  if (unfold) {
    const SurfaceUnfolding done = unfold_surface(mesh, options.surface, options.policy, stopped);
    if (done.n_folded > 0) passes.push_back(report_of(done));
    impl_->unfold_needs = done.needs;
    // What is left of the distance; the surface is taken as it is now.
    if (done.n_moved > 0 && wanted.mode == SurfaceMode::kFree)
      wanted.hausdorff = impl_->bound - done.distance;
  }
  impl_->surface = std::make_unique<SurfaceMesh>(mesh, wanted, options.policy);
}

PassReport report_of(const SurfaceUnfolding& unfolding) {
  return unfolding_report("surface unfold", unfolding.n_folded, unfolding.n_moved);
}
PassReport report_of(const PlanarUnfolding& unfolding) {
  return unfolding_report("plane unfold", unfolding.n_folded, unfolding.n_moved);
}

SurfaceMesh* SurfaceRun::get() const { return impl_->surface.get(); }

SurfaceReport SurfaceRun::report(const TetMesh& mesh) const {
  SurfaceReport report;
  if (!impl_->surface) return report;
  report.mode = impl_->surface->options().mode;
  report.bound = impl_->bound;
  report.unfold_needs = impl_->unfold_needs;
  report.feature_edges = impl_->surface->n_feature_edges();
  if (!impl_->measure) return report;
  const std::vector<Triangle> after = surface_triangles(mesh, impl_->policy);
  measure_surfaces(after == impl_->input ? after : impl_->before, after, impl_->volume, enclosed_volume(mesh),
                   impl_->policy, report);
  for (const auto& [region, volume] : region_volumes(mesh))
    report.regions.push_back({region, impl_->regions[region], volume});
  return report;
}

PartOfSurface::PartOfSurface(const TetMesh& part, const SurfaceMesh* whole,
                             std::span<const VertexHandle> vertices)
    : surface_(whole ? std::make_shared<SurfaceMesh>(part, *whole, vertices) : nullptr) {}
SurfaceMesh* PartOfSurface::get() const { return surface_.get(); }

void rebuild_surface(const Run& run) {
  if (run.surface && run.is_part())
    run.parts()->rebuild(*run.surface);
  else if (run.surface)
    run.surface->rebuild(run.mesh, run.policy());
}

FlatSurface::FlatSurface(const Run& run) {
  SurfaceOptions options = run.surface->options();
  options.mode = SurfaceMode::kFlat;
  flat_ = run.is_part() ? run.parts()->surface(options)
                        : std::make_shared<SurfaceMesh>(run.mesh, options, run.policy());
}
SurfaceMesh* FlatSurface::get() const { return flat_.get(); }

SurfaceCopy::SurfaceCopy(const SurfaceMesh* surface) {
  if (surface) copy_ = surface->copy();
}
void SurfaceCopy::put_back(SurfaceMesh* surface) const {
  if (surface) surface->take_back(*copy_);
}

SurfaceRun::~SurfaceRun() = default;

HeldCells held_cells(const TetMesh& mesh, const std::vector<StuckCell>& stuck, double degrees,
                     std::span<const HalfFaceHandle> unfillable, const ImproveOptions& options) {
  std::vector<CellHandle> cells = cells_held_back(stuck);
  HeldCells held;
  held.cells = cells.size();
  held.known = true;
  std::vector<CellHandle> folded;  // ascending, as `stuck` is
  for (const StuckCell& cell : stuck)
    if (cell.reason == StuckReason::kFoldedSurface) folded.push_back(cell.cell);
  if (!folded.empty())
    for (HalfFaceHandle h : unfillable) cells.push_back(cell_of(h));
  const std::vector<FreedBy> by_cell = freed_by(mesh, cells, degrees, options.surface, options.policy);
  FreedBy fold = FreedBy::kShape;
  for (std::size_t i = held.cells; i < by_cell.size(); ++i) fold = std::min(fold, by_cell[i]);
  for (std::size_t i = 0; i < held.cells; ++i) {
    const bool on_fold = std::binary_search(folded.begin(), folded.end(), cells[i]);
    const FreedBy by = on_fold ? std::min(by_cell[i], fold) : by_cell[i];
    if (by == FreedBy::kFlat) ++held.by_flat;
    if (by == FreedBy::kFree) ++held.by_free;
    if (by == FreedBy::kShape) ++held.by_shape;
  }
  return held;
}

namespace {

std::vector<CellHandle> cells_of(std::span<const StuckCell> stuck) {
  std::vector<CellHandle> cells;
  for (const StuckCell& cell : stuck) cells.push_back(cell.cell);
  return cells;
}

/// `ceilings`: of each of the cells.
void blame(std::span<StuckCell> stuck, std::span<const FeatureCeiling> ceilings, double degrees,
           const SurfaceOptions& options) {
  for (std::size_t i = 0; i < stuck.size(); ++i) {
    StuckReason& limit = stuck[i].reason;
    if (limit == StuckReason::kFoldedSurface) continue;
    // Planes and the edges between them stay in flat mode, and with them the order of the faces at an edge.
    const bool flat = options.mode == SurfaceMode::kFlat;
    if (flat && is_proof(limit) && stuck[i].ceiling < -kPlanar) continue;
    if (ceilings[i].degrees < degrees) {
      if (limit != StuckReason::kInputFeature) limit = StuckReason::kSurfaceFeature;
      stuck[i].ceiling = ceilings[i].degrees;
      stuck[i].a = ceilings[i].a;
      stuck[i].b = ceilings[i].b;
    } else {
      limit = StuckReason::kNotFound;
      stuck[i].ceiling = 180;
    }
  }
}

}  // namespace

void blame_features(const TetMesh& mesh, std::span<StuckCell> stuck, double degrees,
                    const SurfaceOptions& options, par::Policy policy) {
  blame(stuck, feature_ceilings(mesh, cells_of(stuck), options, policy), degrees, options);
}

void blame_features(const Run& run, std::span<StuckCell> stuck, double degrees) {
  const SurfaceOptions& options = run.surface->options();
  if (run.is_part())
    blame(stuck, run.parts()->feature_ceilings(cells_of(stuck), options), degrees, options);
  else
    blame_features(run.mesh, stuck, degrees, options, run.policy());
}

}  // namespace hfr
