// SPDX-License-Identifier: BSD-3-Clause
// G. Taubin, A signal processing approach to fair surface design, 1995, for the two-step filter.
#include "Operators/SmoothLaplacian.hh"

#include <algorithm>

#include "HalfFace/SpillArray.hh"
#include "Operators/Metrics.hh"

namespace hfr {

template <class Metric>
std::optional<Move> LaplacianSearch::operator()(const TetMesh& mesh, VertexHandle v,
                                                std::span<const HalfFaceHandle> link, const Metric& metric,
                                                std::span<const double> quality) const {
  SpillArray<VertexHandle, 3 * Star::kCapacity> neighbours(3 * link.size());
  VertexHandle* end = neighbours.data();
  for (HalfFaceHandle h : link)
    for (VertexHandle w : mesh.halfface_vertices(h)) *end++ = w;
  std::sort(neighbours.data(), end);
  end = std::unique(neighbours.data(), end);
  const auto n = static_cast<double>(end - neighbours.data());
  const Vec3 origin = mesh.point(v);
  Vec3 offset;
  for (const VertexHandle* w = neighbours.data(); w != end; ++w) offset = offset + (mesh.point(*w) - origin);
  Move move;
  move.target = origin + (step / n) * offset;
  move.old_worst = worst_of(link, quality);
  move.new_worst = worst_with(mesh, v, link, move.target, metric, move.old_worst);
  if (!(move.new_worst > move.old_worst)) return std::nullopt;
  return move;
}

HFR_INSTANTIATE_SEARCH(LaplacianSearch)

}  // namespace hfr
