// SPDX-License-Identifier: BSD-3-Clause
// G. Taubin, A signal processing approach to fair surface design, 1995, for the two-step filter.
#include "Operators/SmoothLaplacian.hh"

#include <algorithm>

#include "Operators/Metrics.hh"

namespace hfr {

template <class Metric>
std::optional<Move> LaplacianSearch::operator()(const TetMesh& mesh, VertexHandle v,
                                                std::span<const HalfFaceHandle> link, const Metric& metric,
                                                std::span<const double> quality) const {
  FixedVector<VertexHandle, 3 * Star::kCapacity> neighbours;
  for (HalfFaceHandle h : link)
    for (VertexHandle w : mesh.halfface_vertices(h)) neighbours.push_back(w);
  std::sort(neighbours.begin(), neighbours.end());
  const VertexHandle* const end = std::unique(neighbours.begin(), neighbours.end());
  const auto n = static_cast<double>(end - neighbours.begin());
  const Vec3 origin = mesh.point(v);
  Vec3 offset;
  for (const VertexHandle* w = neighbours.begin(); w != end; ++w) offset = offset + (mesh.point(*w) - origin);
  Move move;
  move.target = origin + (step / n) * offset;
  move.old_worst = worst_of(link, quality);
  move.new_worst = worst_with(mesh, v, link, move.target, metric, move.old_worst);
  if (!(move.new_worst > move.old_worst)) return std::nullopt;
  return move;
}

HFR_INSTANTIATE_SEARCH(LaplacianSearch)

}  // namespace hfr
