// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_UNFOLD_HH
#define HFR_SURFACE_SURFACE_UNFOLD_HH

#include <cstddef>
#include <functional>

#include "HalfFace/TetMesh.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {

struct Unfolding {
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
Unfolding unfold_surface(TetMesh& mesh, const SurfaceOptions& options, par::Policy policy = {},
                         const std::function<bool()>& stopped = {});

}  // namespace hfr

#endif
