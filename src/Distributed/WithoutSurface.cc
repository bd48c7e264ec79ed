// SPDX-License-Identifier: BSD-3-Clause
// What stands in for PartSurface in a build without OpenMesh: reason_against() names surfaces that may
// change, so nobody comes here.
#include "Distributed/PartSurface.hh"
#include "HalfFace/Errors.hh"

namespace hfr::mpi {

namespace {

[[noreturn]] void refuse() { throw InternalError("a surface that may change in a build without OpenMesh"); }

}  // namespace

struct PartSurface::Impl {};
bool PartSurface::is_there() { return false; }
PartSurface::PartSurface(DistributedMesh&, const SurfaceOptions&, par::Policy) { refuse(); }
PartSurface::~PartSurface() = default;
SurfaceMesh* PartSurface::get() const { return nullptr; }
std::optional<RoundCounts> PartSurface::pass(const Ranks::SurfaceLook&, const std::function<Worklist()>&) {
  return std::nullopt;
}
void PartSurface::rebuild() {}
std::shared_ptr<const SurfaceMesh> PartSurface::seen_from(const Cutout&) const { return nullptr; }
std::vector<FeatureCeiling> PartSurface::ceilings(DistributedMesh&, std::span<const CellHandle> cells,
                                                  const SurfaceOptions&) {
  return std::vector<FeatureCeiling>(cells.size());
}

struct PartSurfaceRun::Impl {};
PartSurfaceRun::PartSurfaceRun(DistributedMesh&, const SurfaceOptions&, bool, bool, par::Policy,
                               std::vector<PassReport>&, const std::function<bool()>&) {
  refuse();
}
PartSurfaceRun::~PartSurfaceRun() = default;
PartSurface& PartSurfaceRun::surface() const { refuse(); }
SurfaceReport PartSurfaceRun::report() const { return {}; }

}  // namespace hfr::mpi
