// SPDX-License-Identifier: BSD-3-Clause
// A ball falls through a box that is far longer than the ball is wide. Only the motion of the ball's surface
// is given; the vertices inside follow as those of an elastic body, and what that squeezes is repaired. Then
// steps too far to be taken at once, whose repairs are ended by a time limit and by a cancel: each is undone,
// and the mesh is as it was to the last bit. Ends with 1 where a step has left an inverted cell, or was not
// undone. Usage: example_falling_ball [N STEPS [FOLDER]]     6 N³ cells in the box round it
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <hfremesh/Remesh/Improve.hh>
#include <hfremesh/Remesh/Remesher.hh>

#include "Meshes.hh"

namespace {

/// The box round the ball made longer: what is above and below the middle is stretched.
hfr::TetMesh long_box(hfr::Index n, double length) {
  hfr::TetMesh mesh = example::box_round_ellipsoid(n, {0.35, 0.35, 0.35});
  for (hfr::VertexHandle v : mesh.vertices()) {
    hfr::Vec3 p = mesh.point(v);
    const double beyond = std::max(0.0, std::abs(p.z) - 0.5) / 0.5;
    p.z += (p.z < 0 ? -1 : 1) * beyond * (length - 1);
    mesh.set_point(v, p);
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto n = static_cast<hfr::Index>(argc > 2 ? std::atoi(argv[1]) : 10);
  const int n_steps = argc > 2 ? std::atoi(argv[2]) : 20;
  const double length = 3;  // half of the box's
  hfr::TetMesh mesh = long_box(n, length);
  hfr::improve(mesh);

  hfr::RemesherOptions options;
  options.improve.min_dihedral = 15;
  options.motion = hfr::Motion::kElastic;
  options.on_inversion = hfr::OnInversion::kSubsteps;
  hfr::Remesher remesher(mesh, options);
  const auto fall = [&](double by) {
    std::vector<hfr::Vec3> displacement(mesh.n_vertices());
    for (hfr::VertexHandle v : mesh.boundary_vertices()) {
      const hfr::Vec3 p = mesh.point(v);
      if (std::max(std::abs(p.x), std::abs(p.y)) < 0.9 && std::abs(p.z) < length - 0.1)
        displacement[v.idx()].z = by;
    }
    return displacement;
  };
  const example::Folder folder(argc > 3 ? argv[3] : nullptr);
  folder.write("before.vtu", mesh);
  double worst = 180;
  std::size_t n_repairs = 0, n_inverted = 0;
  const double way = 3.5;  // five diameters
  for (int i = 0; i < n_steps; ++i) {
    const double by = i < n_steps / 2 ? -way / n_steps : way / n_steps;  // and up again
    const hfr::StepResult step = remesher.step(fall(by));
    worst = std::min(worst, step.min_dihedral);
    n_repairs += step.repairs.size();
    n_inverted += step.n_inverted;
    if (i == n_steps / 2 - 1) folder.write("after.vtu", mesh);  // the deepest
  }
  std::printf("%d steps, %zu repairs: smallest angle %.2f degrees, %zu cells\n", n_steps, n_repairs, worst,
              mesh.n_cells());
  // A move that inverts cells, and a repair that is not let finish.
  options.on_inversion = hfr::OnInversion::kRepair;
  const auto is_undone = [&](const hfr::RemesherOptions& hasty, const char* how) {
    const std::vector<hfr::Vec3> before(mesh.points().begin(), mesh.points().end());
    hfr::Remesher again(mesh, hasty);
    const hfr::StepResult step = again.step(fall(-2.5));
    const bool as_before = std::ranges::equal(before, mesh.points());
    std::printf("%s: the step was %s, %zu inverted cells, points %s\n", how, step.undone ? "undone" : "done",
                step.n_inverted, as_before ? "as before" : "others than before");
    n_inverted += step.n_inverted;
    return step.undone && as_before;
  };
  hfr::RemesherOptions in_a_hurry = options;
  in_a_hurry.improve.time_limit = 1e-6;  // seconds, of each repair
  bool cancel = true;                    // what a signal handler might set
  hfr::RemesherOptions cancelled = options;
  cancelled.improve.cancel = [&] { return cancel; };
  const bool both = is_undone(in_a_hurry, "time limit") && is_undone(cancelled, "cancelled");
  return both && n_inverted == 0 ? 0 : 1;
} catch (const hfr::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
