// SPDX-License-Identifier: BSD-3-Clause
// What stands in, in a build without OpenMesh, for src/Surface and for the files of this folder that need it:
// every surface is frozen.
#include "HalfFace/Errors.hh"
#include "Operators/Metrics.hh"
#include "Remesh/ImproveTriangles.hh"
#include "Remesh/PassState.hh"
#include "Remesh/StuckCells.hh"
#include "Remesh/SurfacePasses.hh"
#include "Remesh/SurfaceRun.hh"
#include "Surface/FeatureLabels.hh"

namespace hfr {

FeatureLabels label_features(TetMesh&, SurfaceOptions, par::Policy) {
  throw InvalidInput(
      "this hfremesh was built without OpenMesh and finds no features: build it with -DHFR_SURFACE=ON");
}

TriangleResult improve_triangles(TriangleMesh&, const TriangleOptions&) {
  throw InvalidInput(
      "this hfremesh was built without OpenMesh and cannot improve a surface without cells: build it "
      "with -DHFR_SURFACE=ON");
}

template <class Metric>
std::size_t SurfacePasses<Metric>::iterate(const Turn&) {
  return 0;
}
template <class Metric>
std::size_t SurfacePasses<Metric>::split(const Turn&) {
  return 0;
}
template <class Metric>
void SurfacePasses<Metric>::restore_volume(const VolumeEffort&) {}
template class SurfacePasses<VolumeLength>;
template class SurfacePasses<Untangling>;
template class SurfacePasses<MinSine2>;
template class SurfacePasses<MinDihedral>;
template class SurfacePasses<CustomMetric>;

struct SurfaceRun::Impl {};
SurfaceRun::SurfaceRun(TetMesh&, const ImproveOptions& options, bool, std::vector<PassReport>&,
                       const std::function<bool()>&) {
  HFR_REQUIRE(options.surface.mode == SurfaceMode::kFrozen,
              "this hfremesh was built without OpenMesh and can only leave the surface as it is: "
              "use --surface frozen, or build with -DHFR_SURFACE=ON");
}
SurfaceRun::~SurfaceRun() = default;
SurfaceMesh* SurfaceRun::get() const { return nullptr; }
SurfaceReport SurfaceRun::report(const TetMesh&) const { return {}; }

PartOfSurface::PartOfSurface(const TetMesh&, const SurfaceMesh*, std::span<const VertexHandle>) {}
SurfaceMesh* PartOfSurface::get() const { return nullptr; }
void rebuild_surface(const Run&) {}

FlatSurface::FlatSurface(const Run&) {}
SurfaceMesh* FlatSurface::get() const { return nullptr; }

SurfaceCopy::SurfaceCopy(const SurfaceMesh*) {}
void SurfaceCopy::put_back(SurfaceMesh*) const {}

HeldCells held_cells(const TetMesh&, const std::vector<StuckCell>& stuck, double,
                     std::span<const HalfFaceHandle>, const ImproveOptions&) {
  HeldCells held;
  held.cells = cells_held_back(stuck).size();
  return held;
}
void blame_features(const TetMesh&, std::span<StuckCell>, double, const SurfaceOptions&, par::Policy) {}
void blame_features(const Run&, std::span<StuckCell>, double) {}

}  // namespace hfr
