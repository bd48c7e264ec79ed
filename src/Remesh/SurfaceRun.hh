// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_SURFACE_RUN_HH
#define HFR_REMESH_SURFACE_RUN_HH

#include <functional>
#include <memory>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Improve.hh"

namespace hfr {

class SurfaceMesh;
struct Run;

/// The surface of one run: made before its first pass unless it is frozen, and measured after its last.
class SurfaceRun {
 public:
  /// Throws InvalidInput where the surface is not to be frozen but the build has no OpenMesh. With `unfold`,
  /// folds of a surface that may change are spread first, which moves vertices of the mesh; see `passes`.
  SurfaceRun(TetMesh& mesh, const ImproveOptions& options, bool unfold, std::vector<PassReport>& passes,
             const std::function<bool()>& stopped);
  ~SurfaceRun();
  SurfaceRun(const SurfaceRun&) = delete;
  SurfaceRun& operator=(const SurfaceRun&) = delete;

  SurfaceMesh* get() const;
  /// What became of it; independent of the bounds that the operators kept to.
  SurfaceReport report(const TetMesh& mesh) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct PlanarUnfolding;
struct SurfaceUnfolding;
/// The line of a report on it.
PassReport report_of(const SurfaceUnfolding& unfolding);
PassReport report_of(const PlanarUnfolding& unfolding);

/// The part of a flat surface that a patch has, for the time of a try on a copy of it; see SurfaceMesh. None
/// where `whole` is null.
class PartOfSurface {
 public:
  PartOfSurface(const TetMesh& part, const SurfaceMesh* whole, std::span<const VertexHandle> vertices);
  PartOfSurface(const PartOfSurface&) = delete;
  PartOfSurface& operator=(const PartOfSurface&) = delete;

  SurfaceMesh* get() const;

 private:
  std::shared_ptr<SurfaceMesh> surface_;  // shared: a build without surfaces cannot delete one
};
/// After patches have been put back, or a run with a flat surface: the surface of the run as it is meshed
/// now, which keeps the shape that it has had to keep so far. Does nothing without one.
void rebuild_surface(const Run& run);

/// The surface of a free run before anything has changed it, as a flat one.
class FlatSurface {
 public:
  explicit FlatSurface(const Run& run);
  FlatSurface(const FlatSurface&) = delete;
  FlatSurface& operator=(const FlatSurface&) = delete;

  SurfaceMesh* get() const;

 private:
  std::shared_ptr<SurfaceMesh> flat_;
};

/// The surface of a run as it is now, to be put back together with the mesh. Nothing while it is frozen.
class SurfaceCopy {
 public:
  explicit SurfaceCopy(const SurfaceMesh* surface);
  void put_back(SurfaceMesh* surface) const;

 private:
  std::shared_ptr<const SurfaceMesh> copy_;
};

/// What the frozen surface holds back among the cells that are stuck below `degrees`. A cell that a fold of
/// the boundary makes invalid is freed by what frees a cell on the fold; `unfillable`: unfillable_faces().
HeldCells held_cells(const TetMesh& mesh, const std::vector<StuckCell>& stuck, double degrees,
                     std::span<const HalfFaceHandle> unfillable, const ImproveOptions& options);

/// With a surface that may change: proofs by faces that do not stay are taken back, and what the features
/// keep below the angle is said to be.
void blame_features(const TetMesh& mesh, std::span<StuckCell> stuck, double degrees,
                    const SurfaceOptions& options, par::Policy policy);
/// Of a run with a surface; where its mesh is in parts, all processes ask, each with its own cells.
void blame_features(const Run& run, std::span<StuckCell> stuck, double degrees);

}  // namespace hfr

#endif
