// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface.
#ifndef HFR_SURFACE_STRAIGHT_EDGES_HH
#define HFR_SURFACE_STRAIGHT_EDGES_HH

#include <cstdint>
#include <span>
#include <vector>

#include "Surface/FaceStars.hh"
#include "Surface/PlaneFacets.hh"
#include "Surface/TrialPoints.hh"

namespace hfr::surface {

/// Straight edges between two facets, from corner to corner. Their inner vertices may slide along them, but
/// for held ones.
class StraightEdges {
 public:
  StraightEdges(const Arrays& arrays, std::span<const Edge> edges, const PlaneFacets& facets,
                double tolerance, const FaceStars& stars, std::span<const std::uint8_t> held);

  /// Puts vertices that have passed one another back in order along the edges of a facet, which has these
  /// faces, each between its ends. Returns the facets whose rims have changed, ascending.
  std::vector<std::uint32_t> unfold(std::span<const std::uint32_t> faces, TrialPoints& points) const;

 private:
  bool slides(VertexHandle v) const;
  std::vector<VertexHandle> chain_from(VertexHandle v, std::uint32_t edge) const;
  bool unfold(const std::vector<VertexHandle>& chain, TrialPoints& points) const;

  const Arrays& arrays_;
  std::span<const Edge> edges_;
  const PlaneFacets& facets_;
  double tolerance_;
  const FaceStars& stars_;
  std::span<const std::uint8_t> held_;
  std::vector<std::vector<std::uint32_t>> rim_;  // by vertex, the edges over which no facet goes on
};

}  // namespace hfr::surface

#endif
