// SPDX-License-Identifier: BSD-3-Clause
// What stands in for this folder where OpenCL's headers were missing at build time.
#include "Device/Device.hh"
#include "Device/DeviceMesh.hh"
#include "HalfFace/Errors.hh"

namespace hfr {
namespace {

[[noreturn]] void refuse() {
  throw DeviceError("this build has no OpenCL: configure it with -DHFR_OPENCL=ON and 32-bit indices");
}

}  // namespace

struct DeviceMesh::Impl {};

std::vector<DeviceInfo> list_devices() { refuse(); }
DeviceMesh::DeviceMesh(const DeviceChoice&, DeviceTuning) { refuse(); }
DeviceMesh::~DeviceMesh() = default;
const DeviceInfo& DeviceMesh::info() const { refuse(); }
bool DeviceMesh::from_cache() const { refuse(); }
std::uint64_t DeviceMesh::bytes_needed(std::size_t, std::size_t) { refuse(); }
void DeviceMesh::require_room(std::size_t, std::size_t) const { refuse(); }
void DeviceMesh::upload(const TetMesh&, const Workspace&) { refuse(); }
void DeviceMesh::download(TetMesh&, Workspace&, par::Policy) { refuse(); }
std::size_t DeviceMesh::n_logical_cells() const { refuse(); }
RoundCounts DeviceMesh::round(Kind, const DeviceLook&, std::uint64_t, std::uint32_t, std::size_t) {
  refuse();
}
std::optional<RoundCounts> DeviceMesh::smooth(const DeviceLook&, bool, std::uint32_t) { refuse(); }
DeviceMesh::Tally DeviceMesh::tally() { refuse(); }
double DeviceMesh::smallest_dihedral() { refuse(); }
std::vector<double> DeviceMesh::qualities() { refuse(); }
std::vector<KernelTime> DeviceMesh::profile() { refuse(); }

}  // namespace hfr
