// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Errors.hh"
#include "Remesh/MeshMotion.hh"

namespace hfr {

void follow(const TetMesh&, std::span<const std::uint8_t>, bool, std::vector<Vec3>&) {
  throw InvalidInput("this build has no Eigen: motion of inner vertices has to be given");
}

}  // namespace hfr
