// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_REORDER_HH
#define HFR_HALFFACE_REORDER_HH

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// A curve that fills a box; what is near on it is near in space.
enum class SpaceCurve {
  kHilbert,  ///< consecutive places are neighbours
  kMorton    ///< bits of the coordinates interleaved: quicker to compute, with jumps
};

struct ReorderOptions {
  SpaceCurve curve = SpaceCurve::kHilbert;
  par::Policy policy = {};
};

/// Renumbers vertices along the curve and cells by where their centres are on it, so that what is near in
/// space is near in memory; deleted vertices and cells go. Labels, properties, regions and status follow.
/// Returns where each vertex and cell went. Ties keep the old order, so the result depends on mesh and curve
/// alone.
GarbageMap reorder(TetMesh& mesh, const ReorderOptions& options = {});

/// Place on the curve of the point whose coordinates are x, y, z: 21 bits each.
std::uint64_t curve_place(SpaceCurve curve, std::uint32_t x, std::uint32_t y, std::uint32_t z);

}  // namespace hfr

#endif
