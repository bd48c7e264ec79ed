// SPDX-License-Identifier: BSD-3-Clause
// In place of SurfacePasses.cc where there is no OpenMesh: every surface is frozen.
#include "Operators/Metrics.hh"
#include "Remesh/PassState.hh"
#include "Remesh/SurfacePasses.hh"

namespace hfr {

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

}  // namespace hfr
