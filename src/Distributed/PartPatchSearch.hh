// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_PATCH_SEARCH_HH
#define HFR_DISTRIBUTED_PART_PATCH_SEARCH_HH

#include <cstdint>
#include <functional>
#include <span>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/PartSurface.hh"
#include "Remesh/PatchPlace.hh"

namespace hfr::mpi {

/// See MeshInParts::search_patches(): all ranks search, on the same cutout of what lies within so many layers
/// of these cells, the worst first; each tries on some of the patches. What rank 0 puts back goes to all.
/// `surface`: of a run whose patches may change it; null elsewhere. Where one has, the caller rebuilds the
/// surface. All take part.
PatchesDone search_patches_in_parts(DistributedMesh& parts, std::span<const std::uint64_t> cells, int layers,
                                    const PartSurface* surface,
                                    const std::function<PatchesDone(PatchPlace&)>& search);

}  // namespace hfr::mpi

#endif
