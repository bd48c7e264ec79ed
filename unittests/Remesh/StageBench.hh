// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_REMESH_STAGE_BENCH_HH
#define HFR_UNITTESTS_REMESH_STAGE_BENCH_HH

#include "Remesh/Run.hh"
#include "Remesh/Survey.hh"

namespace hfr::test {

/// A mesh and all that a stage needs to run on it by itself, within no bounds on cells but those of the
/// options.
class StageBench {
 public:
  StageBench(TetMesh& mesh, const ImproveOptions& options, SurfaceMesh* surface = nullptr)
      : lone_(mesh, resolve(options, survey(mesh, options.policy), mesh.n_logical_cells())),
        run(lone_.run(surface).within(CellBounds{options.min_cells, options.max_cells})) {}

  RunControl& control() { return run.control; }
  Findings& findings() { return run.findings; }

 private:
  LoneRun lone_;

 public:
  Run run;
};

}  // namespace hfr::test

#endif
