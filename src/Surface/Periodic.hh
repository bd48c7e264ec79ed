// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface: which vertices of periodic patches move together.
#ifndef HFR_SURFACE_PERIODIC_HH
#define HFR_SURFACE_PERIODIC_HH

#include <vector>

#include "Surface/Features.hh"

namespace hfr::surface {

/// The vertices of options.periodic's patches in sets that move by the same step: a vertex and its match on
/// the other patch, and where patches meet the matches of both, ascending. Throws InvalidInput where a pair
/// has no faces, or does not match: one patch moved as a whole must have the vertices of the other, to 1e-9
/// of the diagonal, and its faces seen from the other side.
std::vector<std::vector<VertexHandle>> periodic_orbits(const Arrays& arrays, const SurfaceOptions& options);

}  // namespace hfr::surface

#endif
