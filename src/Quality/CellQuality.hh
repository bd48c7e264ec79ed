// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_CELL_QUALITY_HH
#define HFR_QUALITY_CELL_QUALITY_HH

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Quality/Metrics.hh"

namespace hfr {

/// What the literature prints for the cell: degrees, a ratio, a volume; see Metric. For many cells see
/// statistics() and with_metric().
inline double quality(const TetMesh& mesh, CellHandle c, Metric metric) {
  const auto& v = mesh.cell_vertices(c);
  return reported_quality(metric, mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
}

/// Decision value of the cell in a metric of one's own, such as CustomMetric.
template <TetMetric M>
double quality(const TetMesh& mesh, CellHandle c, const M& metric) {
  const auto& v = mesh.cell_vertices(c);
  return metric(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
}

/// +1 positive, -1 inverted, 0 flat: the volume hides in the rounding of its own coordinates.
inline int orientation(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell_vertices(c);
  return orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
}

}  // namespace hfr

#endif
