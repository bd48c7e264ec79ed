// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_PATCHES_HH
#define HFR_DISTRIBUTED_PART_PATCHES_HH

#include <cstdint>
#include <span>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Quality/Damage.hh"

namespace hfr::mpi {

/// Some vertices of a mesh in parts, joined where they share a cell: each patch goes by the smallest number
/// of its vertices. All ranks make one at the same time.
class PartPatches {
 public:
  /// `vertices`: those of the whole that this part knows of, ascending: all within one edge of own ones.
  PartPatches(const DistributedMesh& parts, std::span<const VertexHandle> vertices);

  /// Of a vertex within one edge of own ones; kNoNumber where it is in none.
  std::uint64_t of(VertexHandle v) const { return patch_[v.idx()]; }
  /// Of a cell, by any vertex of it that is in one.
  std::uint64_t of(CellHandle c) const;

 private:
  const DistributedMesh& parts_;
  std::vector<std::uint64_t> patch_;  // by vertex of the part
};

/// What moves of its vertices have made of a cell of a patch, or of several.
struct PatchChange {
  std::uint64_t patch = 0, cell = kNoNumber;
  Damage was, is;
};
/// On rank 0 the changes of all ranks, one for each patch, ascending; elsewhere none. Those of a patch are
/// joined in the order of its cells, since damage has sums. All take part.
std::vector<PatchChange> joined_on_first(Comm& comm, std::span<const PatchChange> mine);

}  // namespace hfr::mpi

#endif
