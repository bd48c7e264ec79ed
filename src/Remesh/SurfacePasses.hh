// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_SURFACE_PASSES_HH
#define HFR_REMESH_SURFACE_PASSES_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/Handles.hh"
#include "Remesh/Ranks.hh"
#include "Remesh/Strategy.hh"

namespace hfr {

class PassState;
class SurfaceMesh;
class Worklist;
struct RoundCounts;
struct Turn;

/// The passes of a stage over the surface of its run. A round evaluates and commits in parallel; the surface
/// mesh follows afterwards, one winner at a time in rank order. Expects a run with a surface; without
/// OpenMesh there is none, and every pass does nothing (WithoutSurface.cc).
template <class Metric>
class SurfacePasses {
 public:
  SurfacePasses(PassState& state, Metric metric) : state_(state), metric_(metric) {}

  /// Swap, collapse and smooth, as the strategy allows. Returns the number of committed changes.
  std::size_t iterate(const Turn& turn);
  /// Splits edges of the surface.
  std::size_t split(const Turn& turn);
  /// Moves the surface as a whole until the volume is what it was, where no cell suffers.
  void restore_volume(const VolumeEffort& effort);
  /// Forgets what was looked at.
  void look_again() { looked_.fill(0); }

 private:
  enum Looked : std::size_t { kSwaps, kCollapses, kMoves, kSplits, kLooked };

  /// What all ranks do together where the mesh is in parts.
  Ranks::SurfaceLook look_of(SurfacePass pass, const Turn& turn, std::uint32_t since) const;
  std::size_t look_in_parts(Looked kind, const Turn& turn);
  std::size_t split_in_parts(const Turn& turn);

  std::size_t swaps(const Turn& turn, const Worklist& list);
  template <class Op>
  std::size_t swaps(const char* name, bool inside, const Turn& turn, const Worklist& list);
  std::size_t collapses(const Turn& turn, const Worklist& list);
  std::size_t moves(const Turn& turn, const Worklist& list);
  /// Moves the vertices of periodic patches, orbit by orbit: few, so one after the other.
  RoundCounts periodic_moves(std::span<const VertexHandle> first_of_orbits);
  /// See surface_edges().
  template <class Allow>
  std::vector<EdgeHandle> edges(const Worklist& list, bool inside, Allow&& allow) const;

  /// A surface that has changed may lie on or go through itself. `since`: clock of before the change.
  void look_for_folds(std::uint32_t since);

  PassState& state_;
  Metric metric_;
  std::array<std::uint32_t, kLooked> looked_{};  // clock at the last look of each
};

}  // namespace hfr

#endif
