// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_SHARED_VOLUME_HH
#define HFR_TRANSFER_SHARED_VOLUME_HH

#include <array>

#include "HalfFace/TetMesh.hh"

namespace hfr {

using TetPoints = std::array<Vec3, 4>;

inline TetPoints points_of(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell_vertices(c);
  return {mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])};
}

/// Six times the signed volume.
inline double volume6(const TetPoints& t) { return dot(t[1] - t[0], cross(t[2] - t[0], t[3] - t[0])); }

/// A tetrahedron, whichever way round it is, as what other ones are cut by: its four planes.
class TetPlanes {
 public:
  TetPlanes() = default;
  explicit TetPlanes(const TetPoints& t);

  /// Six times its volume, not signed; 0 for one that is flat up to rounding.
  double whole() const { return whole_; }
  /// Volumes, that add up to whole(), of p with each three of its corners: entry k is positive where p lies
  /// on the side of corner k of the plane of the others.
  std::array<double, 4> coordinates(Vec3 p) const {
    const Vec3 x = p - origin_;
    const double u1 = dot(x, normal_[0]), u2 = dot(x, normal_[1]), u3 = dot(x, normal_[2]);
    return {whole_ - u1 - u2 - u3, u1, u2, u3};
  }
  /// The same, with 0 for what may be rounding: of a corner that both tetrahedra have, for one.
  std::array<double, 4> rounded_coordinates(Vec3 p) const;
  /// Whether one of its planes has all of the other tetrahedron on its outer side.
  bool is_apart_from(const TetPoints& other) const;

 private:
  Vec3 origin_;
  std::array<Vec3, 3> normal_;
  std::array<double, 3> slack_{};  // rounding of a coordinate, for each unit of distance
  double whole_ = 0;
};

/// What a tetrahedron shares with another one, `b`: a volume, and whether it reaches beyond the plane of `b`
/// opposite each corner. Beyond none that it does not reach beyond lies anything of it.
struct Shared {
  double volume = 0;
  std::array<bool, 4> reaches_beyond{};
};
Shared share(const TetPoints& a, const TetPlanes& b);
/// Volume that two tetrahedra have in common; 0 where one is flat. Exact but for rounding: `a` is cut by the
/// four planes of `b` in turn, each into at most three pieces.
double shared_volume(const TetPoints& a, const TetPlanes& b);
inline double shared_volume(const TetPoints& a, const TetPoints& b) { return shared_volume(a, TetPlanes(b)); }

}  // namespace hfr

#endif
