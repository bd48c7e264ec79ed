// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_VERTEX_COLOURS_HH
#define HFR_SCHEDULER_VERTEX_COLOURS_HH

#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Scheduler/StarTable.hh"

namespace hfr {

/// Numbers 0 … size-1 grouped by colour: two vertices of one cell never share a colour, so all of a group may
/// move at the same time. First-fit in the order of `vertices`, which ascends, for any number of threads. A
/// vertex without a star has no neighbours and is in no group.
std::vector<std::vector<std::uint32_t>> colour_vertices(const TetMesh& mesh,
                                                        std::span<const VertexHandle> vertices,
                                                        const StarTable& stars, par::Policy policy = {});

}  // namespace hfr

#endif
