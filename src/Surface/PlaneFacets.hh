// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface.
#ifndef HFR_SURFACE_PLANE_FACETS_HH
#define HFR_SURFACE_PLANE_FACETS_HH

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "Surface/Features.hh"

namespace hfr::surface {

/// Sets of faces that hang together in one plane.
struct PlaneFacets {
  std::vector<std::uint32_t> number;   ///< per face, that of its facet
  std::vector<std::uint32_t> largest;  ///< per facet, the face whose plane it is
};

enum class Look {
  kAlike,      ///< as the largest face of the facet
  kEitherWay,  ///< so that what is folded over is in it, too
};

/// Grown from the largest face that is in none yet, over the manifold edges of these for which goes_over()
/// holds, to faces whose corners are all within `tolerance` of its plane.
PlaneFacets grow_facets(const Arrays& arrays, std::span<const Edge> edges, double tolerance, Look look,
                        const std::function<bool(const Edge&)>& goes_over);

}  // namespace hfr::surface

#endif
