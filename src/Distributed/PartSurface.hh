// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_SURFACE_HH
#define HFR_DISTRIBUTED_PART_SURFACE_HH

#include <cstdint>
#include <memory>
#include <optional>

#include "Distributed/DistributedMesh.hh"
#include "Remesh/Ranks.hh"
#include "Remesh/Result.hh"
#include "Scheduler/Seeds.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {
class SurfaceMesh;
}

namespace hfr::mpi {

/// The surface of a mesh in parts where it may change. Each rank holds all of it, which takes memory in
/// proportion to the faces of the whole's boundary and interfaces, and is told of all changes, in the order
/// in which the one of a mesh in shared memory hears of them. So what it answers is the same everywhere.
class PartSurface {
 public:
  /// Throws InvalidInput for a build without OpenMesh, and for periodic patches, which are not there yet.
  /// `measure`: report() is to say what has become of it. All take part.
  PartSurface(DistributedMesh& parts, const SurfaceOptions& options, bool measure, par::Policy policy);
  ~PartSurface();
  PartSurface(const PartSurface&) = delete;
  PartSurface& operator=(const PartSurface&) = delete;

  /// As the part sees it.
  SurfaceMesh* get() const;
  /// `list`: cells of the part that the look is at. All take part.
  std::optional<RoundCounts> pass(const Ranks::SurfaceLook& look, const Worklist& list);
  /// See SurfaceRun::report(); without what regions have gained. All take part.
  SurfaceReport report() const;

 private:
  struct Impl;
  template <class Metric>
  class Passes;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hfr::mpi

#endif
