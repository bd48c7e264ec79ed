// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_FEATURE_LABELS_HH
#define HFR_SURFACE_FEATURE_LABELS_HH

#include <cstddef>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Surface/SurfaceOptions.hh"

namespace hfr {

struct FeatureLabels {
  std::size_t edges = 0, corners = 0;  ///< that got a label
  int edge_label = 0, corner_label = 0;
};

/// Gives the feature edges of the surface a label, and the vertices in which they end, meet or turn another
/// one, named "feature" and "corner": one more than the largest there is of that dimension. What has a label
/// keeps it. In frozen mode the features are those of free mode. A labelled edge is a constraint of later
/// runs.
FeatureLabels label_features(TetMesh& mesh, SurfaceOptions options, par::Policy policy = {});

}  // namespace hfr

#endif
