// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_SURFACE_STATISTICS_HH
#define HFR_QUALITY_SURFACE_STATISTICS_HH

#include <span>
#include <vector>

#include "Quality/Statistics.hh"

/// The part of statistics() that looks at faces which may not change; internal to this folder.
namespace hfr::detail {

struct SurfaceTotals {
  std::vector<PatchStatistics> patches;
  EdgeWedge surface_ceiling;
  EdgeWedge interface_ceiling;
  EdgeWedge angle_ceiling;
};

/// `constrained`: half-faces whose faces may not change, ascending. max_area bounds the area of a face.
SurfaceTotals gather_surface(const TetMesh& mesh, par::Policy policy,
                             std::span<const HalfFaceHandle> constrained, double max_area);

}  // namespace hfr::detail

#endif
