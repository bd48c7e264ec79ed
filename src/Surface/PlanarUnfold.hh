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
  std::size_t n_folded = 0;  ///< faces of plane facets that look the wrong way, or have no area
  std::size_t n_left = 0;    ///< of these, after it
  std::size_t n_moved = 0;   ///< vertices
};

/// Where a plane facet is folded over onto itself, as a wall whose vertices stayed while the body that ends
/// at it moved, its inner vertices move within the plane until all of its triangles look the same way. Then
/// they cover what the rim of the facet encloses, once, which is what the layers of the fold add up to: the
/// shape is that of the rim, and no distance is asked for, even where the fold reached out over the rim.
/// The rim stays, as does what is fixed or labelled otherwise; the vertices round one fold move if that
/// leaves none of it, else they stay. Cells may become inverted by it: to be done before these are mended.
/// Nothing is done in frozen mode. `stopped`, asked often: true ends it with the folds that are done.
PlanarUnfolding unfold_planes(TetMesh& mesh, const SurfaceOptions& options, par::Policy policy = {},
                              const std::function<bool()>& stopped = {});
/// The same of a surface as arrays: the points of all vertices, nothing where none moves.
std::optional<std::vector<Vec3>> unfold_planes(const surface::Arrays& arrays, const SurfaceOptions& options,
                                               const std::function<bool()>& stopped, PlanarUnfolding& done);

}  // namespace hfr

#endif
