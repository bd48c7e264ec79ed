// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_UNFOLD_HH
#define HFR_SURFACE_SURFACE_UNFOLD_HH

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Surface/Features.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {

struct SurfaceUnfolding {
  std::size_t n_folded = 0;  ///< faces that lay against the surface round them
  std::size_t n_left = 0;    ///< of these and others, after it
  std::size_t n_moved = 0;   ///< vertices
  double distance = 0;       ///< measured, of the new surface from the old one or the other way round
  double needs = 0;          ///< distance to allow for no fold to be left; 0 = not known, or none is
};

/// Where the surface is folded over onto itself, as by too strong a twist, its vertices are spread evenly and
/// put back onto it: a fold is three layers of triangles on one shape, and one of them is all that is needed.
/// Vertices on features that are no folds stay, and so do fixed ones. Nothing moves where that does not leave
/// fewer folds, or where the new surface would be further from the old one than options allow. Cells may
/// become inverted by it: to be done before these are mended. Nothing is done in frozen mode. `stopped`,
/// asked often: true ends it with what fits so far.
SurfaceUnfolding unfold_surface(TetMesh& mesh, const SurfaceOptions& options, par::Policy policy = {},
                                const std::function<bool()>& stopped = {});
/// The same of a surface as arrays: the points of all vertices, nothing where none moves.
std::optional<std::vector<Vec3>> unfold(const surface::Arrays& arrays, const SurfaceOptions& options,
                                        par::Policy policy, const std::function<bool()>& stopped,
                                        SurfaceUnfolding& done);

}  // namespace hfr

#endif
