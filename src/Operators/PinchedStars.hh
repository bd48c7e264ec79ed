// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_PINCHED_STARS_HH
#define HFR_OPERATORS_PINCHED_STARS_HH

#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// All cells of the vertices that a walk round them does not see whole; see is_pinched(). Good until the next
/// change of the mesh.
class PinchedStars {
 public:
  PinchedStars() = default;
  /// `pinched`: a byte per vertex; no vertex is meant where it is empty. O(cells), allocates as much as there
  /// is to list.
  PinchedStars(const TetMesh& mesh, std::span<const std::uint8_t> pinched, par::Policy policy);

  /// Ascending; empty for a vertex that is not listed.
  std::span<const CellHandle> cells(VertexHandle v) const;

 private:
  std::vector<VertexHandle> vertices_;  // ascending
  std::vector<std::size_t> begin_;
  std::vector<CellHandle> cells_;
};

}  // namespace hfr

#endif
