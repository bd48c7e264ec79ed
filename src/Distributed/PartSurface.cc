// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartSurface.hh"

#include <algorithm>
#include <array>
#include <utility>

#include "Distributed/Cutout.hh"
#include "Distributed/PartSurfaceImpl.hh"
#include "HalfFace/Errors.hh"
#include "Remesh/SurfaceRun.hh"
#include "Remesh/Surfaces.hh"
#include "Surface/Features.hh"
#include "Surface/PlanarUnfold.hh"
#include "Surface/SurfaceUnfold.hh"

namespace hfr::mpi {
namespace {

/// A face of the surface as ranks tell each other of it, and what they hold of it.
struct FaceRecord {
  std::uint64_t half_face = 0;  // 4 · number of the cell + corner
  std::array<std::uint64_t, 3> v{};
  std::array<std::int32_t, 2> regions{};
  std::int32_t patch = 0;
  std::uint8_t at_invalid = 0, inward = 0, interface = 0, fixed = 0, locked = 0;
};
struct PointRecord {
  std::uint64_t number = 0;
  Vec3 point;
};

template <class T, class Order>
void sort_and_unite(std::vector<T>& items, Order&& order) {
  std::ranges::sort(items, {}, order);
  const auto is_alike = [&](const T& a, const T& b) { return order(a) == order(b); };
  items.erase(std::unique(items.begin(), items.end(), is_alike), items.end());
}

}  // namespace

/// Faces first, of each rank's own cells; then points, then what is locked.
WholeSurface gather(DistributedMesh& parts, const SurfaceOptions& options) {
  const TetMesh& part = parts.part();
  Comm& comm = parts.comm();
  SurfaceOptions by_patch = options;  // what is named otherwise is fixed in the parts
  by_patch.fixed_vertices.clear();
  by_patch.fixed_edges.clear();
  by_patch.fixed_faces.clear();
  const surface::Arrays own = surface::gather_own(
      part, by_patch, [&](CellHandle c) { return parts.is_own(c); },
      [&](VertexHandle v) { return parts.is_own(v); });
  const auto number = [&](VertexHandle v) { return parts.number(v); };

  std::vector<FaceRecord> faces;
  std::vector<PointRecord> points;
  for (std::size_t i = 0; i < own.faces.size(); ++i) {
    const HalfFaceHandle h = own.halffaces[i];
    FaceRecord& f = faces.emplace_back();
    f.half_face = 4 * parts.number(cell_of(h)) + static_cast<std::uint64_t>(corner_of(h));
    for (std::size_t k = 0; k < 3; ++k) f.v[k] = number(own.faces[i][k]);
    f.regions = {own.regions[i][0], own.regions[i][1]};
    f.patch = own.patch[i];
    f.at_invalid = own.at_invalid[i];
    f.inward = own.inward[i];
    f.interface = own.interface[i];
    f.fixed = own.fixed[i];
    f.locked = own.locked[i];
    for (VertexHandle v : own.faces[i]) points.push_back({number(v), part.point(v)});
  }
  const auto by_number = [](const PointRecord& p) { return p.number; };
  sort_and_unite(points, by_number);
  faces = comm.all_gather(std::span<const FaceRecord>(faces));
  points = comm.all_gather(std::span<const PointRecord>(points));
  std::ranges::sort(faces, {}, [](const FaceRecord& f) { return f.half_face; });
  sort_and_unite(points, by_number);
  std::vector<std::uint64_t> vertices;
  for (VertexHandle v : own.locked_vertices) vertices.push_back(number(v));
  vertices = comm.all_gather(std::span<const std::uint64_t>(vertices));
  std::vector<std::array<std::uint64_t, 2>> edges;
  for (const auto& e : own.locked_edges) edges.push_back({number(e[0]), number(e[1])});
  edges = comm.all_gather(std::span<const std::array<std::uint64_t, 2>>(edges));

  WholeSurface whole;
  for (const PointRecord& p : points) {
    whole.numbers.push_back(p.number);
    whole.points.push_back(p.point);
  }
  surface::Arrays& arrays = whole.arrays;
  arrays.points = whole.points;
  arrays.halffaces.resize(faces.size());  // they are of no one mesh
  for (const FaceRecord& f : faces) {
    arrays.faces.push_back({whole.handle(f.v[0]), whole.handle(f.v[1]), whole.handle(f.v[2])});
    arrays.patch.push_back(f.patch);
    arrays.at_invalid.push_back(f.at_invalid);
    arrays.inward.push_back(f.inward);
    arrays.interface.push_back(f.interface);
    arrays.regions.push_back({f.regions[0], f.regions[1]});
    arrays.fixed.push_back(f.fixed);
    arrays.locked.push_back(f.locked);
  }
  const auto identity = [](const auto& item) { return item; };
  sort_and_unite(vertices, identity);
  for (std::uint64_t v : vertices)
    if (whole.handle(v).is_valid()) arrays.locked_vertices.push_back(whole.handle(v));
  for (const auto& e : edges) {
    const VertexHandle a = whole.handle(e[0]), b = whole.handle(e[1]);
    if (a.is_valid() && b.is_valid()) arrays.locked_edges.push_back({std::min(a, b), std::max(a, b)});
  }
  sort_and_unite(arrays.locked_edges, identity);
  return whole;
}

bool PartSurface::is_there() { return true; }

PartSurface::PartSurface(DistributedMesh& parts, const SurfaceOptions& options, par::Policy policy)
    : PartSurface(parts, gather(parts, options), options, policy) {}

PartSurface::PartSurface(DistributedMesh& parts, const WholeSurface& now, const SurfaceOptions& options,
                         par::Policy policy)
    : impl_(new Impl(parts)) {
  impl_->policy = policy;
  impl_->options = options;
  impl_->whole = std::make_unique<SurfaceMesh>(now.arrays, now.numbers, options);
  impl_->seen.emplace(*impl_->whole, parts);
}

PartSurface::~PartSurface() = default;

SurfaceMesh* PartSurface::get() const { return &impl_->seen->get(); }

void PartSurface::Impl::write_labels() {
  const SurfaceMesh::LabelChanges changes = whole->take_label_changes();
  const auto named = [&](const std::array<VertexHandle, 3>& f) {
    return LabelOrder::Face{whole->number_of(f[0]), whole->number_of(f[1]), whole->number_of(f[2])};
  };
  std::vector<LabelOrder::Face> gone;
  std::vector<DistributedMesh::LabelledFace> set;
  for (const auto& f : changes.gone) gone.push_back(named(f));
  for (const auto& one : changes.set) set.push_back({named(one.vertices), one.label});
  if (!gone.empty() || !set.empty()) parts.change_face_labels(gone, set);
}

void PartSurface::rebuild() {
  const WholeSurface now = gather(impl_->parts, impl_->options);
  impl_->whole->rebuild(now.arrays, now.numbers);
}

std::shared_ptr<const SurfaceMesh> PartSurface::seen_from(const Cutout& cutout) const {
  const auto seen = std::make_shared<SurfaceOf<Cutout>>(*impl_->whole, cutout);
  return {seen, &seen->get()};
}

std::vector<FeatureCeiling> PartSurface::ceilings(DistributedMesh& parts, std::span<const CellHandle> cells,
                                                  const SurfaceOptions& options) {
  WholeSurface now = gather(parts, options);
  return feature_ceilings(parts.part(), cells, options, std::move(now.arrays),
                          [&](VertexHandle v) { return now.handle(parts.number(v)); });
}

struct PartSurfaceRun::Impl {
  DistributedMesh& parts;
  par::Policy policy;
  SurfaceOptions options;
  std::unique_ptr<PartSurface> surface;
  std::vector<Triangle> input;   // before plane walls were opened, where they were looked at
  std::vector<Triangle> before;  // where it is to be measured
  double volume = 0;             // enclosed before
  double bound = 0;              // largest distance allowed
  double unfold_needs = 0;       // and what folds would take
};

PartSurfaceRun::PartSurfaceRun(DistributedMesh& parts, const SurfaceOptions& options, bool measure,
                               bool unfold, par::Policy policy, std::vector<PassReport>& passes,
                               const std::function<bool()>& stopped)
    : impl_(new Impl{parts, policy, options, {}, {}, {}, 0, 0, 0}) {
  WholeSurface now = gather(parts, options);
  const auto move = [&](const std::vector<Vec3>& points) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (const VertexHandle v = parts.vertex_at(now.numbers[i]); v.is_valid())
        parts.part().set_point(v, points[i]);
  };
  if (unfold) {  // which keeps the shape: what is measured is against the layers that add up to it
    if (measure) impl_->input = now.triangles(/*of_boundary=*/false);
    PlanarUnfolding done;
    if (const auto points = unfold_planes(now.arrays, options, stopped, done)) {
      move(*points);
      now = gather(parts, options);
      passes.push_back(report_of(done));
    } else {
      impl_->input.clear();
    }
  }
  if (measure) {
    impl_->before = now.triangles(/*of_boundary=*/false);
    impl_->volume = enclosed_volume(now.triangles(/*of_boundary=*/true));
  }
  SurfaceOptions wanted = options;
  impl_->bound = surface::allowed_distance(now.arrays, options);
  if (unfold) {
    SurfaceUnfolding done;
    if (const auto points = hfr::unfold(now.arrays, options, policy, stopped, done)) move(*points);
    if (done.n_folded > 0) passes.push_back(report_of(done));
    impl_->unfold_needs = done.needs;
    // What is left of the distance; the surface is taken as it is now.
    if (done.n_moved > 0 && wanted.mode == SurfaceMode::kFree)
      wanted.hausdorff = impl_->bound - done.distance;
    if (done.n_moved > 0) now = gather(parts, wanted);
  }
  impl_->surface.reset(new PartSurface(parts, now, wanted, policy));
}

PartSurfaceRun::~PartSurfaceRun() = default;
PartSurface& PartSurfaceRun::surface() const { return *impl_->surface; }

SurfaceReport PartSurfaceRun::report() const {
  const SurfaceMesh& surface = *impl_->surface->get();
  SurfaceReport report;
  report.mode = surface.options().mode;
  report.bound = impl_->bound;
  report.unfold_needs = impl_->unfold_needs;
  report.feature_edges = surface.n_feature_edges();
  if (impl_->before.empty()) return report;
  const WholeSurface now = gather(impl_->parts, impl_->options);
  const std::vector<Triangle> after = now.triangles(/*of_boundary=*/false);
  measure_surfaces(after == impl_->input ? after : impl_->before, after, impl_->volume,
                   enclosed_volume(now.triangles(/*of_boundary=*/true)), impl_->policy, report);
  return report;
}

}  // namespace hfr::mpi
