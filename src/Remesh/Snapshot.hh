// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_SNAPSHOT_HH
#define HFR_REMESH_SNAPSHOT_HH

#include <memory>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Run.hh"
#include "Remesh/SurfaceRun.hh"

namespace hfr {

/// A mesh in the middle of a run, with the run's surface, to come back to: 40 bytes a cell, none where
/// the run's checkpoint keeps the same mesh.
class Snapshot {
 public:
  explicit Snapshot(const Run& run);
  /// Not of a run over a mesh in parts.
  const TetMesh& mesh() const { return *mesh_.mesh; }
  /// With a line in the report. Once only, in the run that it is of.
  void put_back(const Run& run);

 private:
  MeshCopy mesh_;  // the checkpoint may have it, too
  SurfaceCopy surface_;
  Revision revision_;
  bool may_cover_twice_;  // see Findings
  bool is_trusted_;       // see Checkpoint
};

}  // namespace hfr

#endif
