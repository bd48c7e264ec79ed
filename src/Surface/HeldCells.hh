// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_HELD_CELLS_HH
#define HFR_SURFACE_HELD_CELLS_HH

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {

namespace surface {
struct Arrays;
}

/// The least that lets the surface of a cell change.
enum class FreedBy : std::uint8_t {
  kFlat,   ///< in flat mode one of its vertices may move, or one of its edges be swapped
  kFree,   ///< in free mode a vertex may move or an edge be swapped, in flat mode none
  kShape,  ///< in no mode; or two faces at one of its edges, which both modes keep, leave less than `degrees`
};

/// For each cell, what would free it. `options` give the feature angle, the distance and what is fixed, for
/// both modes; their own mode does not count. Cost: that of finding the features of the surface twice.
std::vector<FreedBy> freed_by(const TetMesh& mesh, std::span<const CellHandle> cells, double degrees,
                              const SurfaceOptions& options, par::Policy policy = {});

/// What the faces at a feature edge (a, b) leave the cells there.
struct FeatureCeiling {
  double degrees = 360;  ///< no cell at the edge has more; 360 without an edge
  VertexHandle a, b;
};
/// For each cell, the narrowest of its feature edges that options.mode is proven to keep: the two faces there
/// leave so much inside, and will in every mesh that keeps the features. In flat mode this is so at every
/// feature, in free mode, where facets may tilt, only where the faces themselves stay: both are fixed, or
/// have no vertex that may move and only feature edges. The features are those of the mesh as it is. None in
/// frozen mode.
std::vector<FeatureCeiling> feature_ceilings(const TetMesh& mesh, std::span<const CellHandle> cells,
                                             const SurfaceOptions& options, par::Policy policy = {});
/// The same of cells of a mesh in parts, by the surface of the whole; without the ends of edges. `named`:
/// what the arrays call a vertex of the part, invalid where they have none.
std::vector<FeatureCeiling> feature_ceilings(const TetMesh& part, std::span<const CellHandle> cells,
                                             const SurfaceOptions& options, surface::Arrays arrays,
                                             const std::function<VertexHandle(VertexHandle)>& named);

}  // namespace hfr

#endif
