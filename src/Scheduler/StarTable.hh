// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_STAR_TABLE_HH
#define HFR_SCHEDULER_STAR_TABLE_HH

#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// Stars of some vertices in one array, for passes that leave the topology alone: built where it is used and
/// thrown away after (the paper's "generated at the time of use").
class StarTable {
 public:
  StarTable() = default;
  /// `vertices` ascending; `star_size` as star_sizes() has it, of any size. Only a vertex that no cell has
  /// has an empty star.
  StarTable(const TetMesh& mesh, std::span<const VertexHandle> vertices,
            std::span<const std::uint32_t> star_size, par::Policy policy = {});

  std::size_t size() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  /// Half-faces opposite vertex number i, one a cell of its star, ascending.
  std::span<const HalfFaceHandle> link(std::size_t i) const {
    return {links_.data() + begin_[i], links_.data() + begin_[i + 1]};
  }

 private:
  void walk_stars(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy);
  /// The stars of the vertices with these numbers.
  void sweep_cells(const TetMesh& mesh, std::span<const VertexHandle> vertices,
                   std::span<const std::uint32_t> numbers, par::Policy policy);

  std::vector<std::size_t> begin_;
  std::vector<HalfFaceHandle> links_;
};

}  // namespace hfr

#endif
