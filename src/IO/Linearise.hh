// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_LINEARISE_HH
#define HFR_IO_LINEARISE_HH

#include <vector>

#include "IO/MeshData.hh"

namespace hfr::io {

/// Leaves out the points that second-order elements had on their edges, once the elements are linear: those
/// of `midside` (in any order, repeats allowed, out of range ignored) that no cell, triangle or edge of
/// `mesh` has as a corner. Everything that belongs to a point follows; the others keep their order. Labels
/// of which only zeros are left go.
void drop_midside_points(MeshData& mesh, const std::vector<Index>& midside);

}  // namespace hfr::io

#endif
