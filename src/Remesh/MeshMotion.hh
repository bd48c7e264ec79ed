// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MESH_MOTION_HH
#define HFR_REMESH_MESH_MOTION_HH

#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// Fills in the displacement of the vertices whose `known` is 0 from that of the others: linear finite
/// elements on the cells of positive volume, each as stiff as it is small, so that motion is taken up where
/// cells are large. Three Laplace equations, or with `elastic` one of an isotropic body of Poisson's ratio
/// 0.3, whose cells also resist shear. Solved by conjugate gradients to 1e-8 of the right-hand side, on one
/// thread. A vertex that nothing holds stays.
///
/// Source of the stiffening by volume: Tezduyar, Behr, Mittal & Johnson, "Computation of unsteady
/// incompressible flows with the stabilized finite element methods" (1992).
/// Throws InvalidInput in a build without Eigen.
void follow(const TetMesh& mesh, std::span<const std::uint8_t> known, bool elastic,
            std::vector<Vec3>& displacement);

}  // namespace hfr

#endif
