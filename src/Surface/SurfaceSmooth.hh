// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_SMOOTH_HH
#define HFR_SURFACE_SURFACE_SMOOTH_HH

#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Smooth.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// Smoothing of a vertex on the surface: within its planar facet or along its straight edge, in free mode
/// normal to the star's area vector, which keeps the volume, or along its feature curve. Towards an angle by
/// the ascent of MaxMinForm with its gradients cut down to the directions that are free, otherwise, and where
/// a cell is inverted, by a search over directions at a radius that is halved.
struct SurfaceSearch {
  const SurfaceMesh* surface = nullptr;
  int halvings = 4;
  int iterations = 20;
  /// By what factor the worst decision value of a star without inverted cells must rise.
  double gain = 1;

  template <class Metric>
  std::optional<Move> operator()(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                                 const Metric& metric, std::span<const double> quality) const;
};

/// Moves a vertex of a facet outwards by surface->outward(), where no cell gets poorer by more than a trifle
/// and none as poor as `worst`: a pass of it over all vertices brings the volume back.
struct SurfaceOffset {
  const SurfaceMesh* surface = nullptr;
  double worst = 0;

  template <class Metric>
  std::optional<Move> operator()(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                                 const Metric& metric, std::span<const double> quality) const;
};

template <class Metric>
using SurfaceSmooth = Smooth<SurfaceSearch, Metric>;

}  // namespace hfr

#endif
