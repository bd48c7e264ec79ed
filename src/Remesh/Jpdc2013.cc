// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, A CPU-GPU framework for optimizing the quality of large meshes, JPDC 73 (2013): DYNAMIC
// IMPROVE MESH with its star-form operators, for tables that compare like with like.
#include "Remesh/Pipeline.hh"
#include "Remesh/Stage.hh"

namespace hfr {
namespace {

constexpr int kPaperIterations = 3;  // "three were enough to eliminate all inverted elements"

}  // namespace

void run_jpdc2013(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control) {
  Stage<VolumeLength> stage(mesh, work, options, control, VolumeLength{}, "jpdc2013");
  const int limit = options.iterations > 0 ? options.iterations : kPaperIterations;
  for (int i = 1; i <= limit && !control.stopped(); ++i) {
    stage.look_again();  // the paper visits every element in every iteration
    std::size_t changes = 0;
    if (has(options.ops, Ops::kEdge)) changes += stage.template star_pass<Cluster::kEdge>(i);
    if (has(options.ops, Ops::kFace)) changes += stage.template star_pass<Cluster::kFace>(i);
    if (has(options.ops, Ops::kNode)) changes += stage.template star_pass<Cluster::kNode>(i);
    if (has(options.ops, Ops::kSmooth)) changes += stage.smooth_pass(i, Focus{});
    if (changes == 0) break;
  }
  stage.to_host();
}

}  // namespace hfr
