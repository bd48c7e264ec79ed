// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_SURFACE_MESHES_HH
#define HFR_UNITTESTS_SURFACE_MESHES_HH

#include <optional>
#include <vector>

#include "Remesh/Meshes.hh"

namespace hfr::test {

inline ImproveOptions with(SurfaceMode mode) {
  ImproveOptions options = serial();
  options.surface.mode = mode;
  return options;
}

/// Options of a surface alone.
inline SurfaceOptions flat_surface() {
  SurfaceOptions options;
  options.mode = SurfaceMode::kFlat;
  return options;
}

/// Changes that a run made to the surface.
inline std::size_t surface_changes(const Result& result) {
  std::size_t n = 0;
  for (const PassReport& pass : result.passes)
    if (pass.op.starts_with("surface")) n += pass.winners;
  return n;
}

/// Decision value of each cell in the default metric, and that of the worst.
inline std::vector<double> values(const TetMesh& mesh) { return qualities(mesh, VolumeLength{}); }
inline double worst(const TetMesh& mesh) { return worst_quality(mesh, VolumeLength{}); }

/// Evaluates one seed, checks the plan and commits it where it is admissible; the plan that was committed.
template <class Op>
std::optional<typename Op::Plan> try_on(const Op& op, TetMesh& mesh, typename Op::Seed seed) {
  const auto plan = op.evaluate(mesh, seed);
  if (!plan) return std::nullopt;
  const Cavity cavity = cavity_of(op, mesh, *plan);
  Star scratch;
  if (!admissible(mesh, cavity, true, scratch)) return std::nullopt;
  replace(mesh, cavity);
  return plan;
}

}  // namespace hfr::test

#endif
