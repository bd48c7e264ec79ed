// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_EDGE_LIST_HH
#define HFR_HALFFACE_EDGE_LIST_HH

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr {

/// All edges of a mesh, numbered by ascending handle, with their ends: for who goes over them often, or has a
/// value for each. The kernel stores no edges, so mesh.edges() seeks them anew each time; this is made by one
/// such pass and then read like an array. 12 bytes an edge with 32-bit indices. Right until the topology of
/// the mesh changes.
class EdgeList {
 public:
  explicit EdgeList(const TetMesh& mesh, par::Policy policy = {});

  std::size_t size() const { return edges_.size(); }
  bool empty() const { return edges_.empty(); }
  EdgeHandle operator[](std::size_t i) const { return edges_[i]; }
  const std::array<VertexHandle, 2>& vertices(std::size_t i) const { return vertices_[i]; }
  auto begin() const { return edges_.begin(); }
  auto end() const { return edges_.end(); }
  std::span<const EdgeHandle> handles() const { return edges_; }
  /// Number of an edge; size() when it is none of the list. O(log n).
  std::size_t index(EdgeHandle e) const {
    const auto at = std::lower_bound(edges_.begin(), edges_.end(), e);
    return at != edges_.end() && *at == e ? static_cast<std::size_t>(at - edges_.begin()) : size();
  }

 private:
  std::vector<EdgeHandle> edges_;
  std::vector<std::array<VertexHandle, 2>> vertices_;
};

}  // namespace hfr

#endif
