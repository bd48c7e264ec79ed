// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_NEAR_VERTEX_HH
#define HFR_TRANSFER_NEAR_VERTEX_HH

#include <span>
#include <utility>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// A created vertex is looked for in the old mesh from an old vertex near it on: that of the nearest of its
/// neighbours that have one, as old vertices have themselves. Of several as near, that with the smallest
/// handle counts. Returns this neighbour; invalid where none has any yet. `star`: the cells round v;
/// has_one(u): of a neighbour.
template <class HasOne>
VertexHandle neighbour_with_near_vertex(const TetMesh& now, VertexHandle v, std::span<const CellHandle> star,
                                        HasOne&& has_one) {
  std::pair<double, VertexHandle> best;
  for (CellHandle c : star)
    for (VertexHandle u : now.cell(c).v) {
      if (u == v || !has_one(u)) continue;
      const Vec3 d = now.point(u) - now.point(v);
      const std::pair<double, VertexHandle> one(dot(d, d), u);
      if (!best.second.is_valid() || one < best) best = one;
    }
  return best.second;
}

}  // namespace hfr

#endif
