// SPDX-License-Identifier: BSD-3-Clause
// What stands in for PartSurface in a build without OpenMesh, where every surface is frozen.
#include "Distributed/PartSurface.hh"
#include "HalfFace/Errors.hh"

namespace hfr::mpi {

struct PartSurface::Impl {};
PartSurface::PartSurface(DistributedMesh&, const SurfaceOptions&, bool, par::Policy) {
  throw InvalidInput(
      "this hfremesh was built without OpenMesh and can only leave the surface as it is: use --surface frozen, "
      "or build with -DHFR_SURFACE=ON");
}
PartSurface::~PartSurface() = default;
SurfaceMesh* PartSurface::get() const { return nullptr; }
std::optional<RoundCounts> PartSurface::pass(const Ranks::SurfaceLook&, const Worklist&) {
  return std::nullopt;
}
SurfaceReport PartSurface::report() const { return {}; }

}  // namespace hfr::mpi
