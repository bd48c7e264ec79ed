// SPDX-License-Identifier: BSD-3-Clause
// No run ends worse than it began, however it ends.
#include "Remesh/Checkpoint.hh"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <stdexcept>

#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"
#include "IO/Assemble.hh"
#include "IO/Hash.hh"
#include "IO/MeshFile.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/Survey.hh"

namespace hfr::test {
namespace {

Standing standing(const TetMesh& mesh) { return standing_of(mesh, survey(mesh, {}), {}); }

/// With a hair's breadth for angles and volumes that are only rounded otherwise.
void expect_no_worse(const TetMesh& mesh, const Standing& before, const std::string& what) {
  const Standing now = standing(mesh);
  EXPECT_LE(now.n_inverted, before.n_inverted) << what;
  EXPECT_LE(now.n_inverted + now.n_flat, before.n_inverted + before.n_flat) << what;
  EXPECT_LE(now.overlap, before.overlap * (1 + 1e-9)) << what;
  EXPECT_GE(report_value(Metric::kMinDihedral, now.worst),
            report_value(Metric::kMinDihedral, before.worst) - 1e-9)
      << what;
  EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok) << what;
}

using Make = std::function<TetMesh()>;

/// Boxes with good worst angles that the bulk stage lowers on the way, and tangled meshes.
std::vector<std::pair<std::string, Make>> meshes() {
  return {{"box", [] { return jittered(3, 0.15, 2); }},
          {"poorer box", [] { return jittered(3, 0.25, 5); }},
          {"cylinder",
           [] {
             generate::Arrays arrays = generate::cylinder(2, 4, 1, 2, 40);
             generate::jitter_inner(arrays, 0.2, 1);
             return built(arrays);
           }},
          {"labelled box", [] { return labelled_box(3, 0.3, 3); }},
          {"tangled box", [] { return jittered(3, 0.5, 4); }},
          {"more tangled box", [] { return jittered(3, 0.7, 9); }},
          {"cavity", [] { return small_cavity(4); }}};
}

TEST(Checkpoint, StandingsAreComparedInEveryPart) {
  const Standing before{.n_inverted = 3, .n_flat = 1, .overlap = 0.5, .worst = -0.2};
  const auto with = [&](auto&& change) {
    Standing now = before;
    change(now);
    return now;
  };
  EXPECT_TRUE(is_no_worse(before, before));
  EXPECT_FALSE(is_better(before, before));
  EXPECT_FALSE(is_no_worse(with([](Standing& s) { ++s.n_inverted, --s.n_flat; }), before));
  EXPECT_FALSE(is_no_worse(with([](Standing& s) { ++s.n_flat; }), before));
  EXPECT_TRUE(is_no_worse(with([](Standing& s) { --s.n_inverted, ++s.n_flat; }), before));
  EXPECT_FALSE(is_no_worse(with([](Standing& s) { s.overlap *= 1.001; }), before));
  EXPECT_FALSE(is_no_worse(with([](Standing& s) { --s.n_inverted, s.worst = -0.3; }), before));
  EXPECT_TRUE(is_better(with([](Standing& s) { --s.n_inverted, s.overlap = 1; }), before));
  EXPECT_TRUE(is_better(with([](Standing& s) { s.overlap = 0.4, s.worst = -1; }), before));
  EXPECT_TRUE(is_better(with([](Standing& s) { s.worst = -0.1; }), before));
}

TEST(Checkpoint, WhatMetItsGoalStaysWhereSomethingBetterThanTheInputWasKept) {
  TetMesh mesh = small_cavity(4);
  const std::size_t n_at_first = standing(mesh).n_inverted;
  Checkpoint checkpoint(mesh, survey(mesh, {}), {});
  checkpoint.keep(mesh, false, {});
  ImproveOptions options = serial();
  options.min_dihedral = 1e-3;
  options.iterations = 1;
  options.ops = Ops::kEdge;
  improve(mesh, options);
  ASSERT_LT(standing(mesh).n_inverted, n_at_first);
  checkpoint.keep(mesh, false, {1000, 1});
  options = serial();
  options.min_dihedral = 1e-3;
  ASSERT_TRUE(improve(mesh, options).goal_reached);
  const std::uint64_t hash = io::mesh_hash(mesh);
  EXPECT_FALSE(checkpoint.settle(mesh, /*known_no_worse=*/true, [] {}));
  EXPECT_EQ(io::mesh_hash(mesh), hash);
}

TEST(Checkpoint, PutsBackWhatWasKeptWithTheHandlesOfPropertiesStillGood) {
  TetMesh mesh = jittered(2, 0.1, 1);
  auto mark = mesh.request_vertex_property<int>("mark");
  mark[V(13)] = 5;
  const std::uint64_t hash = io::mesh_hash(mesh);
  Checkpoint checkpoint(mesh, survey(mesh, {}), {});
  EXPECT_FALSE(checkpoint.settle(mesh, false, [] {})) << "nothing was announced";
  checkpoint.keep(mesh, true, {});
  mesh.set_point(V(13), mesh.point(V(13)) + Vec3{0.3, 0.2, 0});  // the only one inside
  mark[V(13)] = 6;
  bool has_mended = false;
  EXPECT_TRUE(checkpoint.settle(mesh, false, [&] { has_mended = true; }));
  EXPECT_TRUE(checkpoint.is_input());
  EXPECT_EQ(io::mesh_hash(mesh), hash);
  EXPECT_EQ(mark[V(13)], 5);
  mark[V(13)] = 7;
  EXPECT_EQ(mesh.request_vertex_property<int>("mark")[V(13)], 7);
  EXPECT_EQ(has_mended, standing(mesh).is_valid());
}

TEST(Checkpoint, KeepsTheBetterOfTwoStates) {
  TetMesh mesh = jittered(2, 0.1, 1);
  const Vec3 place = mesh.point(V(13));
  mesh.set_point(V(13), place + Vec3{0.2, 0.15, 0});
  Checkpoint checkpoint(mesh, survey(mesh, {}), {});
  checkpoint.keep(mesh, true, {});
  mesh.set_point(V(13), place);
  const double best = smallest_dihedral(mesh, {});
  checkpoint.keep(mesh, true, {40, 1});
  mesh.set_point(V(13), place + Vec3{0.1, 0.1, 0});
  checkpoint.keep(mesh, true, {80, 2});  // no worse than the input, but than what is kept
  mesh.set_point(V(13), place + Vec3{0.3, 0.3, 0});
  EXPECT_TRUE(checkpoint.settle(mesh, false, [] {}));
  EXPECT_EQ(smallest_dihedral(mesh, {}), best);
  EXPECT_FALSE(checkpoint.is_input());
}

TEST(Checkpoint, BrokenRuleIsAnInternalErrorAndLeavesWhatWasKept) {
  TetMesh mesh = jittered(2, 0.1, 1);
  const std::uint64_t hash = io::mesh_hash(mesh);
  Checkpoint checkpoint(mesh, survey(mesh, {}), {});
  checkpoint.keep(mesh, true, {});
  TetMesh::Writer(mesh).cell(C(5)).v[1] = mesh.cell(C(5)).v[0];
  EXPECT_THROW(checkpoint.settle(mesh, false, [] {}), InternalError);
  EXPECT_EQ(io::mesh_hash(mesh), hash);
}

/// What is trusted has been tested, and is not again until it is no longer trusted.
TEST(Checkpoint, ATrustedMeshIsTestedOnce) {
  const auto spoil = [](TetMesh& mesh) { TetMesh::Writer(mesh).cell(C(5)).v[1] = mesh.cell(C(5)).v[0]; };
  TetMesh mesh = jittered(2, 0.1, 1);
  Checkpoint checkpoint(mesh, survey(mesh, {}), {});
  const auto settle = [&] { checkpoint.settle(mesh, /*known_no_worse=*/true, [] {}); };
  checkpoint.trust(mesh, {1, 1});
  EXPECT_FALSE(checkpoint.is_trusted()) << "without being allowed to";
  checkpoint.may_trust(true);
  checkpoint.trust(mesh, {1, 1});
  EXPECT_FALSE(checkpoint.is_trusted()) << "without a copy";
  checkpoint.keep(mesh, true, {});
  checkpoint.trust(mesh, {});
  EXPECT_FALSE(checkpoint.is_trusted()) << "by a copy of itself";
  checkpoint.trust(mesh, {1, 1});
  EXPECT_TRUE(checkpoint.is_trusted());
  spoil(mesh);
  EXPECT_NO_THROW(settle());
  checkpoint.distrust();
  EXPECT_THROW(settle(), InternalError);

  TetMesh another = jittered(2, 0.1, 1);
  const std::uint64_t hash = io::mesh_hash(another);
  Checkpoint of_another(another, survey(another, {}), {});
  of_another.may_trust(true);
  of_another.keep(another, true, {});
  spoil(another);
  EXPECT_THROW(of_another.trust(another, {1, 1}), InternalError);
  EXPECT_EQ(io::mesh_hash(another), hash);
}

TEST(Checkpoint, CancelAtAnyQuestionLeavesNoWorseMesh) {
  std::size_t n_restored = 0;
  for (const auto& [name, make] : meshes()) {
    const Standing before = standing(make());
    int n_questions = 0;
    const auto improved = [&, &name = name, &make = make](int last) {
      TetMesh mesh = make();
      ImproveOptions options = serial();
      n_questions = 0;
      options.cancel = [&] { return ++n_questions == last; };
      const Result result = improve(mesh, options);
      expect_no_worse(mesh, before, name + ", question " + std::to_string(last));
      if (!result.changed) {
        EXPECT_EQ(io::mesh_hash(mesh), io::mesh_hash(make())) << name;
      }
      EXPECT_EQ(result.after.cells, mesh.n_cells());
      for (const StuckCell& stuck : result.stuck) EXPECT_LT(stuck.cell.idx(), mesh.n_cells());
      n_restored += std::any_of(result.passes.begin(), result.passes.end(),
                                [](const PassReport& pass) { return pass.stage == "undo"; })
                        ? 1
                        : 0;
    };
    improved(0);
    const int n_all = n_questions;
    ASSERT_GT(n_all, 10) << name;
    // Each of the first ones, which are in the bulk stage, and some of the many later ones.
    for (int last = 1; last <= n_all; last += last < 60 ? 1 : 1 + n_all / 20) improved(last);
  }
  EXPECT_GT(n_restored, 5U) << "the test asks nothing";
}

TEST(Checkpoint, AnyNumberOfIterationsLeavesNoWorseMesh) {
  for (const auto& [name, make] : meshes()) {
    const Standing before = standing(make());
    for (int iterations = 1; iterations <= 3; ++iterations) {
      for (const Smoother smoother : {Smoother::kNewton, Smoother::kLaplacian, Smoother::kTaubin}) {
        for (const double goal : {0.0, 30.0}) {
          TetMesh mesh = make();
          ImproveOptions options = serial();
          options.iterations = iterations;
          options.smoother = smoother;
          if (goal > 0) options.min_dihedral = goal;
          improve(mesh, options);
          expect_no_worse(mesh, before, name + ", " + std::to_string(iterations) + " iterations");
        }
      }
      TetMesh mesh = make();
      ImproveOptions options = serial();
      options.iterations = iterations;
      options.compat = Compat::kJpdc2013;
      improve(mesh, options);
      expect_no_worse(mesh, before, name + ", the paper's pipeline");
    }
  }
}

TEST(Checkpoint, EveryMetricOfTheBulkStageLeavesNoWorseMesh) {
  for (const auto& [name, make] : meshes()) {
    const Standing before = standing(make());
    for (const Metric metric : kMetrics) {
      TetMesh mesh = make();
      ImproveOptions options = serial();
      options.metric = metric;
      options.iterations = 2;
      improve(mesh, options);
      expect_no_worse(mesh, before, name + ", " + std::string(metric_name(metric)));
    }
  }
}

TEST(Checkpoint, TimeLimitsLeaveNoWorseMesh) {
  for (const auto& [name, make] : meshes()) {
    const Standing before = standing(make());
    for (double limit = 1e-5; limit < 0.2; limit *= 3) {
      TetMesh mesh = make();
      ImproveOptions options = serial();
      options.time_limit = limit;
      improve(mesh, options);
      expect_no_worse(mesh, before, name + ", " + std::to_string(limit) + " s");
    }
  }
}

TEST(Checkpoint, ExceptionOfACallbackLeavesNoWorseMeshAndNoGarbage) {
  for (const auto& [name, make] : meshes()) {
    const Standing before = standing(make());
    for (int last = 1; last <= 40; last += 3) {
      TetMesh mesh = make();
      auto mark = mesh.request_cell_property<int>("mark", 3);
      ImproveOptions options = serial();
      int n_calls = 0;
      bool threw = false;
      options.progress = [&](const Progress&) {
        if (++n_calls == last) throw std::runtime_error("no more");
      };
      try {
        improve(mesh, options);
      } catch (const std::runtime_error& error) {
        threw = true;
        EXPECT_STREQ(error.what(), "no more");
      }
      EXPECT_EQ(threw, n_calls >= last) << name;
      expect_no_worse(mesh, before, name + ", call " + std::to_string(last));
      expect_dense(mesh);
      EXPECT_EQ(mark.size(), mesh.n_cells());
    }
  }
}

TEST(Checkpoint, BoxWithInvertedCellsThatOverlapWhatIsLabelledIsNoWorseAfterwards) {
  // 8 of its cells are inverted. Two of them stayed, at -47.25 degrees where the worst was -43.01.
  const std::vector<Vec3> points = {{0, 0, 0},
                                    {0.8749625156598106, 0.031429492087769684, -0.3830029139943585},
                                    {1, 0, 0},
                                    {0, 0.3591438665750152, 0},
                                    {0.4125319401865679, 0.45320422376328356, 0},
                                    {1, 0.4113376857942835, 0},
                                    {0, 1, 0},
                                    {0.6106258810807691, 1, 0},
                                    {0.6763849182734132, 0.5917201390870602, 0.12442386626207247},
                                    {0, 0, 0.534333743092854},
                                    {0.8835596139347823, 0.34876654554953856, 0.5876657050862739},
                                    {1, 0, 0.47875707028640446},
                                    {0, 0.4189304267616451, 0.37064524693955425},
                                    {0.6472901680961413, 0.4300483377635448, 0.47127489966824226},
                                    {0.5468499724094776, 0.22838739904399197, 0.5197084385565764},
                                    {0, 1, 0.35893463441454454},
                                    {0.4751874609888553, 1, 0.40988908036502036},
                                    {1.1344240238049674, 1.3014824017672635, 0.5333064520483337},
                                    {-0.24977420892826818, -0.4525406549548182, 1.0646962986289417},
                                    {0.5514247210956215, 0, 1},
                                    {1, 0, 1},
                                    {0, 0.5109097971125495, 1},
                                    {0.4148127894907549, 0.6036480986877024, 1},
                                    {1, 0.6271513788042005, 1},
                                    {0, 1, 1},
                                    {0.4781586979291306, 1, 1},
                                    {1, 1, 1}};
  TetMesh mesh = build(points, generate::box({2, 2, 2}).cells);
  mesh.labels().faces.set({V(10), V(19), V(23)}, 1);
  mesh.labels().faces.set({V(13), V(16), V(25)}, 1);
  const Standing before = standing(mesh);
  ASSERT_EQ(before.n_inverted, 8U);
  improve(mesh, serial());
  expect_no_worse(mesh, before, "default");
}

TEST(Checkpoint, ShallowRunsOnSoundMeshesThatMayChangeTheirSurfaceAreNoWorseAfterwards) {
  struct Case {
    std::string what;
    Make make;
    std::function<void(ImproveOptions&)> set;
  };
  const Make prism = [] { return built(generate::cylinder(1, 2)); };
  const Make fixed_prism = [] {
    TetMesh mesh = built(generate::cylinder(1, 2));
    mesh.labels().edges.set({V(0), V(1)}, 2);
    const auto around = mesh.outgoing_halfedges(V(7));
    mesh.labels().edges.set({V(7), mesh.halfedge_vertices(*around.begin())[1]}, 1);
    return mesh;
  };
  const Make box = [] { return built(generate::box({2, 2, 2})); };
  const std::vector<Case> cases = {
      {"prism, free", prism, [](ImproveOptions& o) { o.surface.mode = SurfaceMode::kFree; }},
      {"prism, flat, 60 degrees", fixed_prism,
       [](ImproveOptions& o) { o.surface.mode = SurfaceMode::kFlat, o.min_dihedral = 60; }},
      {"prism, free, 60 degrees", fixed_prism,
       [](ImproveOptions& o) { o.surface.mode = SurfaceMode::kFree, o.min_dihedral = 60; }},
      {"box, flat, Laplacian", box, [](ImproveOptions& o) {
         o.surface.mode = SurfaceMode::kFlat, o.smoother = Smoother::kLaplacian, o.iterations = 1;
       }}};
  for (const Case& c : cases) {
    TetMesh mesh = c.make();
    const Standing before = standing(mesh);
    ImproveOptions options = serial();
    c.set(options);
    Result result;
    try {
      result = improve(mesh, options);
    } catch (const InvalidInput& error) {
      expect_build_without_surface();
      GTEST_SKIP() << error.what();
    }
    expect_no_worse(mesh, before, c.what);
    // What is said of the surface is said of the mesh that came back.
    EXPECT_EQ(result.surface.triangles_after, result.after.boundary_faces) << c.what;
    if (!result.changed) {
      EXPECT_LT(result.surface.hausdorff, 1e-12) << c.what;
    }
  }
}

TEST(Checkpoint, SmallRandomMeshesThatOnceBecameWorseAreNoWorseInAnyMode) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(HFR_TEST_MESHES).parent_path() / "repro";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "there is no " << folder.string() << "; it is not shipped";
  for (const auto& file : fs::directory_iterator(folder)) {
    if (file.path().extension() != ".vtu") continue;
    const TetMesh input = io::assemble(io::read_mesh(file.path()));
    const Standing before = standing(input);
    for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree}) {
      for (const double goal : {0.0, 15.0, 60.0}) {
        for (const int iterations : {0, 1}) {
          TetMesh mesh = input;
          ImproveOptions options = serial();
          options.surface.mode = mode;
          options.iterations = iterations;
          if (goal > 0) options.min_dihedral = goal;
          try {
            improve(mesh, options);
          } catch (const Error&) {  // no OpenMesh, or a rule that was broken: the mesh must be no worse
          }
          expect_no_worse(mesh, before,
                          file.path().filename().string() + ", mode " +
                              std::to_string(static_cast<int>(mode)) + ", goal " + std::to_string(goal) +
                              ", " + std::to_string(iterations));
        }
      }
    }
  }
}

}  // namespace
}  // namespace hfr::test
