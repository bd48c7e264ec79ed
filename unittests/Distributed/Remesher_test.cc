// SPDX-License-Identifier: BSD-3-Clause
// Meshes in parts that move step by step, beside hfr::Remesher over the whole.
#include "Distributed/Remesher.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "Distributed/Labelled.hh"
#include "Distributed/RankArrays.hh"
#include "HalfFace/Generate.hh"

namespace hfr::test {
namespace {

using mpi::RankArrays;

/// Every rank gives the cells of a slab of it.
RankArrays slab_of(const TetMesh& mesh, const mpi::Comm& comm) {
  RankArrays arrays;
  std::vector<std::uint8_t> is_needed(mesh.n_vertices(), 0);
  for (CellHandle c : mesh.cells()) {
    if (c.idx() * comm.n_ranks() / mesh.n_cells() != static_cast<std::size_t>(comm.rank())) continue;
    auto& corners = arrays.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = mesh.cell(c).v[k].idx();
      is_needed[mesh.cell(c).v[k].idx()] = 1;
    }
    arrays.regions.push_back(mesh.region(c));
  }
  for (VertexHandle v : mesh.vertices()) {
    if (is_needed[v.idx()] == 0) continue;
    arrays.vertex_number.push_back(v.idx());
    arrays.points.push_back(mesh.point(v));
  }
  return arrays;
}

/// Along a swirl about an axis of the unit cube, which leaves its surface where it is.
Vec3 swirl(Vec3 p, double dt) {
  constexpr double kPi = 3.141592653589793;
  const auto hump = [](double t) { return std::sin(kPi * t) * std::sin(kPi * t); };
  const double speed = dt * hump(p.z);
  return {speed * hump(p.x) * std::sin(2 * kPi * p.y), -speed * std::sin(2 * kPi * p.x) * hump(p.y), 0};
}

/// What hfr::Remesher says on all ranks, each of which has the whole, and the parts, step by step: the same.
/// Returns how many steps have repaired.
template <class Displacement>
int expect_same_steps(const TetMesh& input, const RemesherOptions& options, int n_steps,
                      Displacement&& displacement, int* n_refused = nullptr) {
  mpi::Comm comm(MPI_COMM_WORLD);
  TetMesh whole = input;
  Remesher alone(whole, options);
  mpi::Remesher together(comm, slab_of(input, comm), options);
  RankArrays mine = together.arrays();
  int n_repairs = 0;
  for (int step = 0; step < n_steps; ++step) {
    std::vector<Vec3> of_whole, of_mine;
    for (VertexHandle v : whole.vertices()) of_whole.push_back(displacement(step, whole.point(v)));
    for (const Vec3& p : mine.points) of_mine.push_back(displacement(step, p));
    for (std::size_t i = 0; i < of_mine.size(); ++i)
      if (mine.owner[i] != comm.rank()) of_mine[i] = {9, 9, 9};  // which does not count
    const StepResult a = alone.step(of_whole);
    const mpi::PartsStep b = together.step(of_mine);
    EXPECT_EQ(a.cause, b.cause) << "step " << step;
    EXPECT_EQ(a.changed, b.changed) << "step " << step;
    EXPECT_EQ(a.fraction, b.fraction) << "step " << step;
    EXPECT_EQ(a.min_dihedral, b.min_dihedral) << "step " << step;
    EXPECT_EQ(a.n_inverted, b.n_inverted) << "step " << step;
    EXPECT_EQ(a.refused.size(), b.refused.size()) << "step " << step;
    for (std::size_t i = 0; i < std::min(a.refused.size(), b.refused.size()); ++i)
      EXPECT_EQ(a.refused[i].idx(), b.refused[i]);
    EXPECT_EQ(a.repairs.size(), b.repair ? 1U : 0U);
    n_repairs += b.repair ? 1 : 0;
    if (n_refused) *n_refused += b.refused.empty() ? 0 : 1;
    mine = together.arrays();
    EXPECT_EQ(comm.sum(mine.cells.size()), whole.n_cells());
    bool same = true;
    for (std::size_t i = 0; i < mine.points.size(); ++i)
      same = same && mine.points[i] == whole.point(V(mine.vertex_number[i]));
    for (std::size_t i = 0; i < mine.cells.size(); ++i)
      for (std::size_t k = 0; k < 4; ++k)
        same = same && V(mine.cells[i][k]) == whole.cell(CellHandle(mine.cell_number[i])).v[k];
    EXPECT_TRUE(same) << "step " << step;
    EXPECT_TRUE(mpi::check(together.mesh()).is_good) << "step " << step;
  }
  return n_repairs;
}

RemesherOptions towards(double goal, double trigger) {
  RemesherOptions options;
  options.improve.min_dihedral = goal;
  options.improve.policy = {};
  options.triggers.min_dihedral = trigger;
  return options;
}

TEST(PartRemesher, StepsAreThoseOfSharedMemory) {
  const auto move = [](int step, Vec3 p) { return swirl(p, step % 4 == 3 ? 0 : 0.03); };
  const int n = expect_same_steps(valid_box(8, 0.1, 1), towards(15, 12), 14, move);
  EXPECT_GT(n, 3);
  EXPECT_LT(n, 14);
}

/// All cells are worked on, and scattered ones get other numbers.
TEST(PartRemesher, RepairsWithoutAGoalAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 12);
  options.improve.min_dihedral.reset();
  options.triggers.every = 3;
  const auto move = [](int, Vec3 p) { return swirl(p, 0.02); };
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 2), options, 7, move), 2);
}

TEST(PartRemesher, MovesThatInvertAreRefusedOrMended) {
  RemesherOptions options = towards(15, 10);
  const auto move = [](int step, Vec3 p) { return swirl(p, step % 2 == 0 ? 0.25 : 0.01); };
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 3), options, 4, move), 2);
  options.on_inversion = OnInversion::kRefuse;
  int n_refused = 0;
  expect_same_steps(valid_box(6, 0.1, 3), options, 4, move, &n_refused);
  EXPECT_GE(n_refused, 1);
  EXPECT_LT(n_refused, 4);
}

#ifdef HFR_HAS_SURFACE
/// A body that is sheared, whose surface gives way.
TEST(PartRemesher, RepairsOfASurfaceThatMayChangeAreThoseOfSharedMemory) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    RemesherOptions options = towards(20, 17);
    options.improve.surface.mode = mode;
    const auto move = [](int step, Vec3 p) {
      return Vec3{0.3 * p.z * p.z + 0.02 * step * p.y, 0, 0.05 * p.x};
    };
    EXPECT_GE(expect_same_steps(valid_box(5, 0.15, 4), options, 3, move), 2);
  }
}
#endif

/// A wedge of the surface that nothing mends calls for one repair, and for another one once it is worse.
TEST(PartRemesher, WhatARepairHadToLeaveCallsForNoOther) {
  TetMesh mesh = valid_box(5, 0.1, 4);
  const auto flatten = [](int step, Vec3 p) {  // the whole box, but once
    return Vec3{0, 0, step == 0 ? -0.85 * p.z : step == 3 ? -0.5 * p.z : 0.0};
  };
  RemesherOptions options = towards(25, 20);
  options.improve.max_cells = mesh.n_cells();
  const int n = expect_same_steps(mesh, options, 5, flatten);
  EXPECT_GE(n, 2);
  EXPECT_LE(n, 3);
}

TEST(PartRemesher, RegionsStay) {
  const generate::Arrays box = generate::two_region_box({6, 6, 6});
  TetMesh mesh = build(box.points, box.cells);
  for (std::size_t c = 0; c < box.regions.size(); ++c) mesh.set_region(CellHandle(c), box.regions[c]);
  const auto move = [](int, Vec3 p) { return swirl(p, 0.03); };
  EXPECT_GE(expect_same_steps(mesh, towards(15, 12), 8, move), 1);
}

/// Also in their order, which no rank knows alone: the files are the same after repairs.
TEST(PartRemesher, LabelsStayInTheirOrder) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(6, 0.1, 5), 5, {2, 60, 60, 15, 40, 0, true}));
  comm.sum(0);
  mpi::DistributedMesh first(comm);
  mpi::read_ranges(first, path);
  mpi::Remesher together(comm, mpi::own_arrays(first), towards(15, 12));
  together.mesh().part().labels().names = first.part().labels().names;
  TetMesh whole = io::read(path);
  Remesher alone(whole, towards(15, 12));
  int n_changed = 0;
  for (int step = 0; step < 10; ++step) {
    std::vector<Vec3> of_whole, of_mine;
    for (VertexHandle v : whole.vertices()) of_whole.push_back(swirl(whole.point(v), 0.03));
    for (const Vec3& p : together.arrays().points) of_mine.push_back(swirl(p, 0.03));
    alone.step(of_whole);
    n_changed += together.step(of_mine).changed ? 1 : 0;
  }
  EXPECT_GE(n_changed, 2);
  mpi::write_vtu(together.mesh(), folder.path() / "parts.vtu");
  if (comm.rank() != 0) return;
  io::write(folder.path() / "whole.vtu", whole);
  EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
}

TEST(PartRemesher, WhatIsNotThereIsRefusedByName) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const RankArrays arrays = slab_of(valid_box(4, 0.1, 1), comm);
  const auto refusal = [&](auto&& change) {
    RemesherOptions options = towards(15, 10);
    change(options);
    try {
      mpi::Remesher remesher(comm, arrays, options);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal([](RemesherOptions&) {}), "");
  EXPECT_EQ(refusal([](RemesherOptions& o) { o.on_inversion = OnInversion::kSubsteps; }),
            "a Remesher in parts does not have sub-steps yet");
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.motion = Motion::kLaplace; }), testing::HasSubstr("follow"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.fields = {{.name = "u"}}; }), testing::HasSubstr("fields"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.ids = true; }), testing::HasSubstr("ids"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.triggers.motion = 1; }), testing::HasSubstr("motion"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.triggers.jacobian_ratio = 0.5; }),
              testing::HasSubstr("volume"));
  EXPECT_THAT(refusal([](RemesherOptions& o) {
                o.triggers.metrics = {{Metric::kMinSine, 0.1}};
              }),
              testing::HasSubstr("metrics"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.triggers.indicator_field = "bad"; }),
              testing::HasSubstr("indicator"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.improve.maps = true; }), testing::HasSubstr("maps"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.improve.time_limit = 1; }),
              testing::HasSubstr("time limits"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.improve.cancel = [] { return false; }; }),
              testing::HasSubstr("cancelled"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.improve.surface.fixed_vertices = {V(0)}; }),
              testing::HasSubstr("fixed patches, faces, edges and vertices"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.improve.surface.fixed_patches = {9}; }),
              testing::HasSubstr("fixed patches"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.triggers.min_dihedral = 20; }),
              testing::HasSubstr("must not be above the goal"));
}

TEST(PartRemesher, WrongDisplacementsAreRefusedOnAllRanks) {
  mpi::Comm comm(MPI_COMM_WORLD);
  for (const bool too_many : {true, false}) {
    const std::string line = [&]() -> std::string {
      mpi::Comm own(MPI_COMM_WORLD);
      mpi::Remesher remesher(own, slab_of(valid_box(4, 0.1, 1), own), towards(15, 10));
      std::vector<Vec3> displacement(remesher.arrays().points.size());
      if (own.rank() == own.size() - 1 && too_many) displacement.emplace_back();
      if (own.rank() == own.size() - 1 && !too_many)
        displacement[2].y = std::numeric_limits<double>::infinity();
      try {
        remesher.step(displacement);
      } catch (const mpi::RankFailed& failed) {
        return failed.what();
      } catch (const InvalidInput& error) {
        return own.fail(2, error.what()).what();
      }
      return "it was taken";
    }();
    EXPECT_THAT(line, testing::HasSubstr(too_many ? "displacement: has " : "is not finite"));
  }
}

}  // namespace
}  // namespace hfr::test
