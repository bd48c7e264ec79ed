// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_SURFACE_HH
#define HFR_DISTRIBUTED_PART_SURFACE_HH

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Remesh/Ranks.hh"
#include "Remesh/Result.hh"
#include "Scheduler/Seeds.hh"
#include "Surface/HeldCells.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {
class SurfaceMesh;
}

namespace hfr::mpi {

class Cutout;
struct WholeSurface;

/// The surface of a mesh in parts where it may change. Each rank holds all of it, which takes memory in
/// proportion to the faces of the whole's boundary and interfaces, and is told of all changes, in the order
/// in which the one of a mesh in shared memory hears of them. So what it answers is the same everywhere.
class PartSurface {
 public:
  /// Whether this build has it, which takes OpenMesh; else the constructor throws.
  static bool is_there();
  /// Takes the surface as it is now as the shape to keep; labels of faces have to be followed
  /// (DistributedMesh::follow_face_labels()). Without periodic patches. All take part.
  PartSurface(DistributedMesh& parts, const SurfaceOptions& options, par::Policy policy);
  ~PartSurface();
  PartSurface(const PartSurface&) = delete;
  PartSurface& operator=(const PartSurface&) = delete;

  /// As the part sees it.
  SurfaceMesh* get() const;
  /// `listed`: finds the cells of the part that the look is at, where the pass has no others. All take part.
  std::optional<RoundCounts> pass(const Ranks::SurfaceLook& look, const std::function<Worklist()>& listed);
  /// After cells have been replaced that nobody told of: see SurfaceMesh::rebuild(). All take part.
  void rebuild();
  /// As a cutout sees it, for as long as the cutout lives.
  std::shared_ptr<const SurfaceMesh> seen_from(const Cutout& cutout) const;
  /// Of these own cells of the part, by the features of the surface as it is now. All take part.
  static std::vector<FeatureCeiling> ceilings(DistributedMesh& parts, std::span<const CellHandle> cells,
                                              const SurfaceOptions& options);

 private:
  struct Impl;
  template <class Metric>
  class Passes;
  friend class PartSurfaceRun;
  /// `now`: what there is.
  PartSurface(DistributedMesh& parts, const WholeSurface& now, const SurfaceOptions& options,
              par::Policy policy);

  std::unique_ptr<Impl> impl_;
};

/// The surface of a run over a mesh in parts, as SurfaceRun: what it does before the first pass and says
/// after the last one.
class PartSurfaceRun {
 public:
  /// With `unfold`, folds of the surface are spread first, which moves vertices of the mesh: `passes`, as
  /// SurfaceRun has them. `measure`: report() is to say what has become of it. All take part.
  PartSurfaceRun(DistributedMesh& parts, const SurfaceOptions& options, bool measure, bool unfold,
                 par::Policy policy, std::vector<PassReport>& passes, const std::function<bool()>& stopped);
  ~PartSurfaceRun();
  PartSurfaceRun(const PartSurfaceRun&) = delete;
  PartSurfaceRun& operator=(const PartSurfaceRun&) = delete;

  PartSurface& surface() const;
  /// Without what regions have gained. All take part.
  SurfaceReport report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hfr::mpi

#endif
