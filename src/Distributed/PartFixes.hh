// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_FIXES_HH
#define HFR_DISTRIBUTED_PART_FIXES_HH

#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr::mpi {

/// What SurfaceOptions name as fixed, fixed in a mesh in parts for as long as a run takes: see FixedParts.
/// Vertices go by their numbers in the whole.
class PartFixes {
 public:
  /// Throws InvalidInput that names the first one that the mesh does not have, on all ranks. All take part.
  PartFixes(DistributedMesh& parts, const SurfaceOptions& options);
  PartFixes(const PartFixes&) = delete;
  PartFixes& operator=(const PartFixes&) = delete;

  /// Frees what the constructor has fixed, which leaves what was fixed before. No other rank is asked.
  void release();

 private:
  DistributedMesh& parts_;
  std::vector<LabelRecord> fresh_;
};

}  // namespace hfr::mpi

#endif
