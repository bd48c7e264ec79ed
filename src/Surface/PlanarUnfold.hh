// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_PLANAR_UNFOLD_HH
#define HFR_SURFACE_PLANAR_UNFOLD_HH

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Surface/Features.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {

struct PlanarUnfolding {
  std::size_t n_folded = 0;  ///< faces in folds of plane facets
  std::size_t n_left = 0;    ///< of these, after it
  std::size_t n_moved = 0;   ///< vertices
};

/// Where a plane facet is folded over onto itself, as a wall whose vertices stayed while the body that ends
/// at it moved, its inner vertices move within the plane until all of its triangles look the same way. Then
/// they cover what the rim of the facet encloses, once where it does not cross itself, which is what the
/// layers of the fold add up to: no distance is asked for, even where the fold reached out over the rim.
/// Where that leaves folds, vertices of straight edges between two facets are put back in order along them.
///
/// A facet is what hangs together over edges of two faces with the same labels in a plane: as exactly as flat
/// mode asks for; in free mode within the distance allowed, and 1e-6 of the mean edge. A fold is a set of
/// faces that look the other way than most of the area of their facet, with what has less than 1e-6 of the
/// area of a regular triangle there, if most of them are faces of inverted or flat cells: the two sides of a
/// slit are none, and their vertices stay. The vertices round a fold move if none of its faces is left folded
/// and no other comes to be; else they stay, as does what is fixed, periodic or of an interface. Cells may
/// become inverted by it: to be done before these are mended. Nothing is done in frozen mode. `stopped`,
/// asked often: true ends it with the folds that are done.
PlanarUnfolding unfold_planes(TetMesh& mesh, const SurfaceOptions& options, par::Policy policy = {},
                              const std::function<bool()>& stopped = {});
/// The same of a surface as arrays: the points of all vertices, nothing where none moves.
std::optional<std::vector<Vec3>> unfold_planes(const surface::Arrays& arrays, const SurfaceOptions& options,
                                               const std::function<bool()>& stopped, PlanarUnfolding& done);

}  // namespace hfr

#endif
