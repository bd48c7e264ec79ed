// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/FeatureLabels.hh"

#include <algorithm>

#include "Surface/Features.hh"

namespace hfr {

FeatureLabels label_features(TetMesh& mesh, SurfaceOptions options, par::Policy policy) {
  if (options.mode == SurfaceMode::kFrozen) options.mode = SurfaceMode::kFree;
  surface::Features found;
  {
    const surface::Arrays arrays = surface::gather(mesh, options, policy);
    found = surface::find_features(arrays, options, surface::allowed_distance(arrays, options));
  }
  FeatureLabels labels{.edge_label = 1, .corner_label = 1};
  Labels& all = mesh.labels();
  for (const auto& entry : all.edges.entries())
    labels.edge_label = std::max(labels.edge_label, entry.value + 1);
  for (int label : all.vertices) labels.corner_label = std::max(labels.corner_label, label + 1);
  for (const auto& [key, name] : all.names) {
    if (key.first == 0) labels.corner_label = std::max(labels.corner_label, key.second + 1);
    if (key.first == 1) labels.edge_label = std::max(labels.edge_label, key.second + 1);
  }
  std::vector<std::uint8_t> ends(mesh.n_vertices(), 0);
  for (const surface::Edge& e : found.edges) {
    if (!e.feature) continue;
    ends[e.a.idx()] = ends[e.b.idx()] = 1;
    if (all.edges.find({e.a, e.b})) continue;
    all.edges.set({e.a, e.b}, labels.edge_label);
    ++labels.edges;
  }
  for (VertexHandle v : mesh.vertices()) {
    if (!ends[v.idx()] || found.motion_constraint[v.idx()].kind != SurfaceKind::kFixed || all.vertex(v) != 0)
      continue;
    if (all.vertices.empty()) all.vertices.resize(mesh.n_vertices(), 0);
    all.vertices[v.idx()] = labels.corner_label;
    ++labels.corners;
  }
  if (labels.edges > 0) all.names.emplace(std::pair(1, labels.edge_label), "feature");
  if (labels.corners > 0) all.names.emplace(std::pair(0, labels.corner_label), "corner");
  return labels;
}

}  // namespace hfr
