// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_EIGEN_POINTS_HH
#define HFR_HALFFACE_EIGEN_POINTS_HH

#include <Eigen/Core>

#include "hfremesh/HalfFace/TetMesh.hh"

/// The points of a mesh as Eigen matrices and vectors, without copying. Needs Eigen 3.3, which the library
/// itself does not.
namespace hfr {

using PointMatrix = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// 3×n, a column a vertex, over the mesh's own storage; valid until a vertex is added or garbage is
/// collected.
inline Eigen::Map<PointMatrix> eigen_points(TetMesh& mesh) {
  return {mesh.point_data(), 3, static_cast<Eigen::Index>(mesh.n_vertices())};
}
inline Eigen::Map<const PointMatrix> eigen_points(const TetMesh& mesh) {
  return {mesh.point_data(), 3, static_cast<Eigen::Index>(mesh.n_vertices())};
}

/// One point by value.
inline Eigen::Vector3d to_eigen(Vec3 p) { return {p.x, p.y, p.z}; }
inline Vec3 from_eigen(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace hfr

#endif
