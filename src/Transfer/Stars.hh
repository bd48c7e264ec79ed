// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_STARS_HH
#define HFR_TRANSFER_STARS_HH

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// The cells round some vertices, ascending: all that there are, also of a vertex whose cells do not connect
/// through faces. They come in the same order however the mesh was made.
class Stars {
 public:
  Stars() = default;
  /// `vertices`: in any order, also several times; invalid ones have none. O(mesh), unless there are none.
  Stars(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy);

  /// None of a vertex that was not asked for.
  std::span<const CellHandle> of(VertexHandle v) const {
    if (!v.is_valid() || v.idx() >= number_.size() || number_[v.idx()] == kNone) return {};
    const Index i = number_[v.idx()];
    return {cells_.data() + first_[i], cells_.data() + first_[i + 1]};
  }

 private:
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  std::vector<Index> number_;  // by vertex
  std::vector<std::size_t> first_;
  std::vector<CellHandle> cells_;
};

}  // namespace hfr

#endif
