// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Improve.hh"

#include <gtest/gtest.h>

#include "IO/Hash.hh"
#include "Operators/LimitMeshes.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/Survey.hh"

namespace hfr::test {
namespace {

TEST(Improve, InvertedCellsOfACavityAreRepaired) {
  TetMesh mesh = small_cavity();
  const auto boundary = boundary_of(mesh);
  const double before = volume(mesh);
  const std::size_t inverted = n_inverted(mesh);
  ASSERT_GT(inverted, 5U);
  const Result result = improve(mesh, serial());
  EXPECT_TRUE(result.changed);
  EXPECT_TRUE(result.goal_reached);
  EXPECT_TRUE(result.invalid_cells.empty());
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(n_inverted(mesh), 0U);
  EXPECT_NEAR(volume(mesh), before, 1e-12);
  EXPECT_TRUE(boundary_of(mesh) == boundary);
  expect_dense(mesh);
  EXPECT_EQ(result.before.inverted.size(), inverted);
  EXPECT_EQ(result.after.inverted.size(), 0U);
  EXPECT_EQ(result.after.cells, mesh.n_cells());
  EXPECT_NEAR(result.after.overlap, 0, 1e-12);
  EXPECT_GT(result.after.min_dihedral.min, 10);
  EXPECT_NEAR(result.after.min_dihedral.min, smallest_dihedral(mesh, {}), 1e-9);
}

TEST(Improve, RegionsLabelsAndWhatIsFixedSurvive) {
  for (const double jitter : {0.3, 0.5}) {
    TetMesh mesh = labelled_box(6, jitter, 3);
    const auto volumes = region_volumes(mesh);
    const auto boundary = boundary_of(mesh);
    const auto frozen = frozen_places(mesh);
    const auto faces = places_of(mesh, mesh.labels().faces);
    const auto edges = places_of(mesh, mesh.labels().edges);
    const auto vertices = vertex_labels(mesh);
    ASSERT_EQ(volumes.size(), 2U);
    ASSERT_GT(edges.size(), 5U);
    ASSERT_GT(vertices.size(), 10U);
    const Result result = improve(mesh, serial());
    EXPECT_TRUE(result.changed);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_EQ(n_inverted(mesh), 0U);
    for (const auto& [region, sum] : region_volumes(mesh)) EXPECT_NEAR(sum, volumes.at(region), 1e-12);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
    EXPECT_EQ(frozen_places(mesh), frozen) << "boundary, interface or labelled edges moved";
    EXPECT_EQ(places_of(mesh, mesh.labels().faces), faces);
    EXPECT_EQ(places_of(mesh, mesh.labels().edges), edges);
    EXPECT_EQ(vertex_labels(mesh), vertices);
    expect_dense(mesh);
  }
}

TEST(Improve, UsersFieldsSurvive) {
  TetMesh mesh = small_cavity(8);
  auto origin = mesh.request_vertex_property<Vec3>("origin");
  for (VertexHandle v : mesh.vertices()) origin[v] = mesh.point(v);
  auto density = mesh.request_cell_property<double>("density", 1.5);
  density.fill(2.5);
  const auto frozen = frozen_vertices(mesh);
  const Result result = improve(mesh, serial());
  ASSERT_TRUE(result.changed);
  ASSERT_EQ(origin.size(), mesh.n_vertices());
  ASSERT_EQ(density.size(), mesh.n_cells());
  std::size_t boundary = 0;
  for (VertexHandle v : mesh.boundary_vertices()) {
    ++boundary;
    EXPECT_EQ(origin[v], mesh.point(v)) << "a value went to another vertex";
  }
  EXPECT_EQ(boundary, 6U * 64 + 2);
  for (VertexHandle v : mesh.vertices()) EXPECT_LT(norm(origin[v] - mesh.point(v)), 0.4);
  for (CellHandle c : mesh.cells()) EXPECT_EQ(density[c], 2.5);
}

TEST(Improve, GoalThatIsMetCostsNothingAndChangesNothing) {
  TetMesh mesh = jittered(6, 0.05, 1);
  const std::uint64_t hash = io::mesh_hash(mesh);
  ImproveOptions options = serial();
  options.min_dihedral = 20;
  const Result result = improve(mesh, options);
  EXPECT_FALSE(result.changed);
  EXPECT_TRUE(result.goal_reached);
  EXPECT_EQ(result.stop, Stop::kGoal);
  EXPECT_TRUE(result.passes.empty());
  EXPECT_EQ(io::mesh_hash(mesh), hash);
}

TEST(Improve, GoalWithinReachIsReachedAndNoMoreIsDone) {
  TetMesh mesh = small_cavity();
  ImproveOptions options = serial();
  options.min_dihedral = 12;
  const Result result = improve(mesh, options);
  EXPECT_TRUE(result.goal_reached);
  EXPECT_EQ(result.stop, Stop::kGoal);
  EXPECT_GE(smallest_dihedral(mesh, {}), 12);
  // Work follows damage: most of the mesh is as it was.
  const TetMesh before = small_cavity();
  std::set<Place> places;
  for (VertexHandle v : before.vertices()) places.insert(place_of(before, v));
  std::size_t same = 0;
  for (VertexHandle v : mesh.vertices()) same += places.contains(place_of(mesh, v)) ? 1 : 0;
  EXPECT_GT(same, before.n_vertices() / 2);
}

/// Stages of a run towards a goal that is reached, in the order in which they began.
std::vector<std::string> stages_towards(double goal, double jitter) {
  TetMesh mesh = jittered(7, jitter, 1);
  ImproveOptions options = serial();
  options.min_dihedral = goal;
  const Result result = improve(mesh, options);
  EXPECT_TRUE(result.goal_reached) << goal;
  EXPECT_GE(smallest_dihedral(mesh, {}), goal);
  std::vector<std::string> stages;
  for (const PassReport& pass : result.passes)
    if (std::find(stages.begin(), stages.end(), pass.stage) == stages.end()) stages.push_back(pass.stage);
  return stages;
}

TEST(Improve, AllCellsAreWorkedOnFirstWhereManyMissTheGoalAndLastWhereThatWasMissing) {
  EXPECT_EQ(stages_towards(30, 0.2), (std::vector<std::string>{"polish"})) << "8 % miss it";
  EXPECT_EQ(stages_towards(35, 0.2).at(0), "bulk") << "24 % miss it, none by much";
  const auto missed = stages_towards(37.5, 0.1);
  EXPECT_EQ(missed.at(0), "polish");
  EXPECT_EQ(missed.back(), "bulk");
}

TEST(Improve, AskingForMoreThanCanBeHadGivesNoLessThanAskingForWhatCan) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    generate::Arrays arrays = generate::cylinder(3, 8);
    generate::jitter_inner(arrays, 0.4, seed);
    const auto worst_for = [&](double goal) {
      TetMesh mesh = build(arrays.points, arrays.cells);
      ImproveOptions options;
      options.min_dihedral = goal;
      return improve(mesh, options).after.min_dihedral.min;
    };
    EXPECT_GE(worst_for(30), 30);
    EXPECT_GE(worst_for(45), 30) << "seed " << seed;
  }
}

TEST(Improve, GoalOutOfReachIsReportedAsMissed) {
  TetMesh mesh = small_cavity(6);
  ImproveOptions options = serial();
  options.min_dihedral = 60;
  const Result result = improve(mesh, options);
  EXPECT_FALSE(result.goal_reached);
  EXPECT_NE(result.stop, Stop::kGoal);
  EXPECT_TRUE(result.invalid_cells.empty());
  EXPECT_EQ(check(mesh), Ok);
}

TEST(Improve, AnglesThatEqualTheGoalToTheLastBitsEndTheRun) {
  // All dihedrals of Kuhn's cut are exactly 45, 60 and 90 degrees; a goal of 45 sits on the rounding.
  for (const Index n : {1U, 2U, 4U}) {
    for (const bool with_goal : {false, true}) {
      TetMesh mesh = built(generate::box({n, n, n}));
      ImproveOptions options = serial();
      options.time_limit = 20;
      if (with_goal) options.min_dihedral = 45;
      const Result result = improve(mesh, options);
      EXPECT_NE(result.stop, Stop::kTimeLimit);
      EXPECT_GT(smallest_dihedral(mesh, {}), 44.999);
      EXPECT_EQ(check(mesh), Ok);
    }
  }
}

TEST(Improve, CellsThatNothingCanMendAreListed) {
  // One cell, all of it boundary, turned inside out after it was built.
  const std::vector<std::array<Index, 4>> cells = {{0, 1, 2, 3}};
  TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, cells);
  mesh.set_point(V(3), {0, 0, -1});
  const Result result = improve(mesh, serial());
  EXPECT_FALSE(result.changed);
  EXPECT_FALSE(result.goal_reached);
  EXPECT_EQ(result.invalid_cells, std::vector<CellHandle>{CellHandle(0)});
  EXPECT_EQ(check(mesh), Ok);
}

TEST(Improve, AMeshWithoutCellsIsLeftAlone) {
  TetMesh mesh;
  const Result result = improve(mesh, serial());
  EXPECT_FALSE(result.changed);
  EXPECT_TRUE(result.goal_reached);
}

TEST(Improve, OneCellAloneIsLeftAlone) {
  TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, std::vector<Corners>{{0, 1, 2, 3}});
  const Result result = improve(mesh, serial());
  EXPECT_FALSE(result.changed);
  EXPECT_EQ(mesh.n_cells(), 1U);
}

TEST(Improve, PassesOfTheReportAddUp) {
  TetMesh mesh = small_cavity();
  const std::size_t before = mesh.n_cells();
  const Result result = improve(mesh, serial());
  std::size_t winners = 0;
  double seconds = 0;
  std::set<std::string> ops;
  for (const PassReport& pass : result.passes) {
    ops.insert(pass.op);
    EXPECT_LE(pass.candidates, pass.seeds);
    EXPECT_LE(pass.winners, pass.candidates);
    EXPECT_GE(pass.iteration, 1);
    EXPECT_TRUE(pass.seeds == 0 || pass.rounds > 0) << pass.stage << ' ' << pass.op;
    EXPECT_LE(pass.seconds_evaluate + pass.seconds_select + pass.seconds_commit, pass.seconds + 1e-9);
    winners += pass.winners;
    seconds += pass.seconds;
  }
  for (const char* op : {"edge", "face", "node", "smooth"}) EXPECT_TRUE(ops.contains(op)) << op;
  EXPECT_GT(winners, 100U);
  EXPECT_LE(seconds, result.seconds + 1e-9);
  EXPECT_EQ(result.passes.back().n_inverted, 0U);
  EXPECT_EQ(result.before.cells, before);
  EXPECT_EQ(result.after.cells, mesh.n_cells());
}

/// Within a run of passes in one metric the worst cell never gets worse.
void expect_monotone(const Result& result) {
  int steps = 0;
  for (std::size_t i = 1; i < result.passes.size(); ++i) {
    const PassReport& last = result.passes[i - 1];
    const PassReport& pass = result.passes[i];
    if (pass.stage != last.stage || pass.iteration < last.iteration) continue;
    ++steps;
    if (pass.op == "unfold" || last.op == "unfold") {  // fewer inverted cells are worth a worse one
      EXPECT_LE(pass.n_inverted, last.n_inverted) << pass.op;
      continue;
    }
    EXPECT_GE(pass.worst, last.worst) << pass.stage << ' ' << pass.op << ' ' << pass.iteration;
    EXPECT_TRUE(last.n_inverted > 0 || pass.n_inverted == 0) << "a cell was inverted by " << pass.op;
  }
  EXPECT_GT(steps, 2);
}

TEST(Improve, WorstNeverDropsOverThePasses) {
  for (std::uint64_t s = 1; s <= 4; ++s) {
    TetMesh mesh = jittered(7, 0.25 + 0.1 * static_cast<double>(s), s);
    expect_monotone(improve(mesh, serial()));
  }
}

TEST(Improve, EveryMetricRunsAndNeverLowersItsOwnWorst) {
  for (const Metric metric : kMetrics) {
    SCOPED_TRACE(metric_name(metric));
    TetMesh mesh = jittered(6, 0.35, 5);
    ImproveOptions options = serial();
    options.metric = metric_from_name(metric_name(metric));
    const Result result = improve(mesh, options);
    EXPECT_TRUE(result.goal_reached);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_NEAR(volume(mesh), 1, 1e-12);
    expect_monotone(result);
  }
}

TEST(Improve, EverySmootherRunsAndMends) {
  for (const char* name : {"newton", "candidates", "laplacian", "taubin"}) {
    SCOPED_TRACE(name);
    TetMesh mesh = small_cavity(8);
    ImproveOptions options = serial();
    options.smoother = smoother_from_name(name);
    const double before = smallest_dihedral(mesh, {});
    const Result result = improve(mesh, options);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_EQ(n_inverted(mesh), 0U);
    EXPECT_GT(smallest_dihedral(mesh, {}), before);
    expect_monotone(result);
  }
}

TEST(Improve, EveryOperatorByItselfKeepsTheMeshWhole) {
  for (const char* name : {"edge", "face", "node", "smooth", "insert", "cluster"}) {
    SCOPED_TRACE(name);
    TetMesh mesh = small_cavity(8);
    const auto boundary = boundary_of(mesh);
    const double before = volume(mesh);
    const double worst = worst_quality(mesh, VolumeLength{});
    const std::size_t inverted = n_inverted(mesh);
    ImproveOptions options = serial();
    options.ops = ops_from_list(name);
    const Result result = improve(mesh, options);
    EXPECT_TRUE(result.changed);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
    EXPECT_NEAR(volume(mesh), before, 1e-12);
    EXPECT_LE(n_inverted(mesh), inverted);
    EXPECT_TRUE(worst_quality(mesh, VolumeLength{}) >= worst || n_inverted(mesh) == 0);
    for (const PassReport& pass : result.passes) {
      if (pass.op == "undo") continue;  // what was put back, by no operator
      EXPECT_TRUE(pass.op == name || (pass.op == "unfold" && name == std::string("smooth"))) << pass.op;
    }
  }
}

TEST(Improve, VertexOfMoreThan256CellsMovesAndIsCounted) {
  TetMesh mesh = built(hub(150));
  const Vec3 off = {0.3, 0.2, 0.6};
  mesh.set_point(V(0), off);
  ImproveOptions options = serial();
  options.ops = Ops::kSmooth;
  const Result result = improve(mesh, options);
  EXPECT_FALSE(mesh.point(V(0)) == off);
  EXPECT_EQ(result.n_large_stars, 4U);
  TetMesh small = jittered(3, 0.2, 1);
  EXPECT_EQ(improve(small, serial()).n_large_stars, 0U);
}

TEST(Improve, InvertedCellsOfAVertexOfMoreThan256CellsAreUnfolded) {
  TetMesh mesh = built(hub(150));
  mesh.set_point(V(0), {1.4, 0.3, -0.4});
  ASSERT_GT(n_inverted(mesh), 10U);
  ImproveOptions options = serial();
  options.ops = Ops::kSmooth;
  improve(mesh, options);
  EXPECT_EQ(n_inverted(mesh), 0U);
}

}  // namespace
}  // namespace hfr::test
