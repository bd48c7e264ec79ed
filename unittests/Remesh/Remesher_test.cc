// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Remesher.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <thread>
#include <utility>

#include "HalfFace/CountingNew.hh"
#include "HalfFace/Geometry.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

using ::testing::HasSubstr;

constexpr double kRadius = 0.3;

/// A box whose vertices within a ball in the middle are turned about the z axis; those outside stay, but for
/// a shell in between that follows in part.
std::vector<Vec3> turn(const TetMesh& mesh, double degrees) {
  std::vector<Vec3> d(mesh.n_vertices());
  const double angle = degrees * std::numbers::pi / 180;
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v) - Vec3{0.5, 0.5, 0.5};
    if (norm(p) > kRadius) continue;
    const double c = std::cos(angle), s = std::sin(angle);
    d[v.idx()] = Vec3{c * p.x - s * p.y, s * p.x + c * p.y, p.z} - p;
  }
  return d;
}

TetMesh box(Index n, double jitter = 0.1) { return built(generate::jittered_box({n, n, n}, jitter, 7)); }

RemesherOptions options_for(double goal = 15, double trigger = 10) {
  RemesherOptions options;
  options.improve = serial();
  options.improve.min_dihedral = goal;
  options.triggers.min_dihedral = trigger;
  return options;
}

std::vector<std::array<VertexHandle, 4>> cells_of(const TetMesh& mesh) {
  std::vector<std::array<VertexHandle, 4>> out;
  for (CellHandle c : mesh.cells()) out.push_back(mesh.cell_vertices(c));
  return out;
}

std::size_t inverted_cells(const TetMesh& mesh) {
  std::size_t n = 0;
  for (CellHandle c : mesh.cells()) n += volume(mesh, c) > 0 ? 0 : 1;
  return n;
}

TEST(Remesher, StepWithoutABadCellMovesAndLooksOnlyAtWhatMoved) {
  TetMesh mesh = box(8);
  Remesher remesher(mesh, options_for());
  const TetMesh before = mesh;
  std::vector<Vec3> d(mesh.n_vertices());
  d[300] = {0.001, 0, 0};
  const StepResult step = remesher.step(d);
  EXPECT_FALSE(step.changed);
  EXPECT_EQ(step.cause, RepairCause::kNone);
  EXPECT_TRUE(step.repairs.empty());
  std::size_t star = 0;
  for ([[maybe_unused]] CellHandle c : mesh.vertex_cells(V(300))) ++star;
  EXPECT_EQ(step.n_looked_at, star);
  EXPECT_EQ(mesh.point(V(300)), before.point(V(300)) + d[300]);
  EXPECT_EQ(cells_of(mesh), cells_of(before));
  const Result nothing = improve(
      mesh, remesher.n_inverted() ? serial() : [] {
        ImproveOptions o = serial();
        o.min_dihedral = 10;
        return o;
      }());
  EXPECT_FALSE(nothing.changed);
  EXPECT_DOUBLE_EQ(step.min_dihedral, nothing.after.min_dihedral.min);
}

TEST(Remesher, StepsThatRepairNothingAllocateNothing) {
  if (!HFR_COUNTS_ALLOCATIONS) GTEST_SKIP() << "allocations are the sanitizer's";
  TetMesh mesh = box(8);
  Remesher remesher(mesh, options_for());
  std::vector<Vec3> all(mesh.n_vertices(), Vec3{1e-4, 0, 0}), few(mesh.n_vertices());
  few[300] = {1e-4, 0, 0};
  remesher.step(all);  // makes room
  remesher.step(few);
  const std::size_t before = n_allocations();
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(remesher.step(all).changed);
    EXPECT_FALSE(remesher.step(few).changed);
  }
  EXPECT_EQ(n_allocations(), before);
}

TEST(Remesher, WhatItKnowsOfAllCellsIsWhatAFirstLookFinds) {
  for (const int threads : {1, 2, 7}) {
    TetMesh mesh = box(9);
    RemesherOptions options = options_for(15, 0);
    options.triggers.inverted = false;
    options.improve.policy = {.threads = threads, .serial_below = 0};
    Remesher remesher(mesh, options);
    Engine engine(3);
    std::vector<Vec3> d;
    std::size_t n_inverted = 0, n_raised = 0;
    double before = remesher.min_dihedral();
    for (int i = 0; i < 120; ++i) {
      // Few and many, far and near; every other step takes the one before it back.
      if (i % 2 == 1)
        for (Vec3& x : d) x = -x;
      else {
        d.assign(mesh.n_vertices(), {});
        const double far = i % 3 == 0 ? 0.12 : 0.03;
        for (Vec3& x : d)
          if (engine() % (i % 8 == 0 ? 2 : 40) == 0) x = random_point(engine, -far, far);
      }
      const StepResult step = remesher.step(d);
      ASSERT_FALSE(step.changed);
      TetMesh copy = mesh;
      const Remesher fresh(copy, options);
      ASSERT_EQ(step.min_dihedral, fresh.min_dihedral()) << "step " << i;
      ASSERT_EQ(step.n_inverted, inverted_cells(mesh)) << "step " << i;
      n_inverted += step.n_inverted > 0 ? 1 : 0;
      n_raised += step.min_dihedral > before ? 1 : 0;
      before = step.min_dihedral;
    }
    EXPECT_GT(n_inverted, 20U);
    EXPECT_GT(n_raised, 20U);
  }
}

TEST(Remesher, CellsThatAWalkRoundAVertexMissesAreLookedAt) {
  // Two boxes that share a corner: no walk comes from one to the other.
  TetMesh one = built(generate::box({4, 4, 4}));
  std::vector<Vec3> points(one.points().begin(), one.points().end());
  std::vector<std::array<Index, 4>> cells;
  const auto n = static_cast<Index>(points.size());
  for (CellHandle c : one.cells()) {
    const auto& v = one.cell_vertices(c);
    cells.push_back({v[0].idx(), v[1].idx(), v[2].idx(), v[3].idx()});
  }
  const std::size_t n_cells = cells.size();
  for (std::size_t i = 0; i < n_cells; ++i) {
    std::array<Index, 4> other = cells[i];
    for (Index& v : other) v = v == 0 ? n - 1 : n + v - 1;
    cells.push_back(other);
  }
  for (Index i = 1; i < n; ++i) points.push_back(one.point(V(i)) + Vec3{1, 1, 1});
  for (const double towards : {0.6, -0.6}) {
    TetMesh mesh = build(points, cells);
    ASSERT_EQ(mesh.point(V(n - 1)), (Vec3{1, 1, 1}));
    Remesher remesher(mesh, options_for());
    std::vector<Vec3> d(mesh.n_vertices());
    d[n - 1] = {towards, towards, towards};
    const MoveResult move = remesher.move(d);
    EXPECT_GT(inverted_cells(mesh), 0U);
    EXPECT_EQ(remesher.n_inverted(), inverted_cells(mesh));
    EXPECT_EQ(remesher.needs_repair(), RepairCause::kInverted);
    EXPECT_EQ(move.n_moved, 1U);
  }
}

TEST(Remesher, TurningBodyIsRepairedStepByStepAndEditsFollowTheMesh) {
  TetMesh mesh = box(8);
  RemesherOptions options = options_for();
  options.ids = true;
  Remesher remesher(mesh, options);
  auto cells = cells_of(mesh);
  std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
  std::map<std::uint64_t, Vec3> of_id;
  std::size_t n_repairs = 0, n_created = 0;
  for (int i = 0; i < 30; ++i) {
    const std::vector<Vec3> d = turn(mesh, 6);
    const StepResult step = remesher.step(d);
    ASSERT_EQ(step.n_inverted, 0U) << "step " << i;
    ASSERT_EQ(inverted_cells(mesh), 0U);
    EXPECT_GE(step.min_dihedral, 10);
    for (std::size_t v = 0; v < points.size(); ++v) points[v] = points[v] + d[v];
    for (const RepairResult& repair : step.repairs) {
      ++n_repairs;
      n_created += repair.edits.created_vertices.size();
      points = repair.edits.points(points);
      cells = repair.edits.cell_vertices(cells);
    }
    EXPECT_EQ(step.changed, !step.repairs.empty());
    ASSERT_EQ(cells, cells_of(mesh));
    ASSERT_TRUE(std::equal(points.begin(), points.end(), mesh.points().begin(), mesh.points().end()));
    ASSERT_EQ(check(mesh).message, "");
    std::set<std::uint64_t> ids(remesher.vertex_ids().begin(), remesher.vertex_ids().end());
    EXPECT_EQ(ids.size(), mesh.n_vertices());
    EXPECT_EQ(std::set<std::uint64_t>(remesher.cell_ids().begin(), remesher.cell_ids().end()).size(),
              mesh.n_cells());
  }
  EXPECT_GT(n_repairs, 3U);
  EXPECT_LT(n_repairs, 30U) << "the goal is above the trigger, so that not each step repairs";
}

Vec3 random_vector(int step, VertexHandle v) {
  const auto unit = [&](std::uint64_t k) {
    return 2 * generate::random_unit(static_cast<std::uint64_t>(step) * 3 + k, v.idx()) - 1;
  };
  return {unit(0), unit(1), unit(2)};
}

TEST(Remesher, FieldsAreCarriedOverAHundredRandomSteps) {
  for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree}) {
#ifndef HFR_HAS_SURFACE
    if (mode != SurfaceMode::kFrozen) continue;
#endif
    TetMesh mesh = box(7);
    auto linear = mesh.request_vertex_property<double>("linear");
    auto constant = mesh.request_vertex_property<double>("constant");
    auto mass = mesh.request_cell_property<double>("mass");
    auto one = mesh.request_cell_property<double>("one");
    auto part = mesh.request_cell_property<std::int64_t>("part");
    const auto f = [](Vec3 p) { return 1 + 2 * p.x - 3 * p.y + 0.5 * p.z; };
    for (VertexHandle v : mesh.vertices()) constant[v] = 0.1;
    for (CellHandle c : mesh.cells()) {
      mass[c] = generate::random_unit(5, c.idx());
      one[c] = 0.3;
      part[c] = c.idx() % 3;
    }
    RemesherOptions options = options_for();
    options.improve.surface.mode = mode;
    options.fields = {{.name = "linear"},
                      {.name = "constant"},
                      {.name = "mass", .how = Transfer::kConserve},
                      {.name = "one", .how = Transfer::kConserve},
                      {.name = "part", .how = Transfer::kInherit}};
    Remesher remesher(mesh, options);
    std::size_t n_repairs = 0;
    for (int i = 0; i < 100; ++i) {
      // Each step is large enough to call for a repair, mostly.
      std::vector<Vec3> d = turn(mesh, 20 * generate::random_unit(11, static_cast<std::uint64_t>(i)));
      for (VertexHandle v : mesh.vertices())
        if (!mesh.is_boundary(v)) d[v.idx()] = d[v.idx()] + 0.03 * random_vector(i, v);
      std::vector<Vec3> moved(mesh.points().begin(), mesh.points().end());
      double held = 0;
      for (std::size_t v = 0; v < d.size(); ++v) linear[V(v)] = f(moved[v] + d[v]);
      for (CellHandle c : mesh.cells()) {
        const auto& v = mesh.cell_vertices(c);
        const auto at = [&](std::size_t k) { return moved[v[k].idx()] + d[v[k].idx()]; };
        held += mass[c] * dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) / 6;
      }
      const StepResult step = remesher.step(d);
      n_repairs += step.repairs.size();
      double lost = 0;
      for (const RepairResult& repair : step.repairs)
        for (const FieldReport& report : repair.fields)
          if (report.name == "mass") lost += report.lost[0];
      for (VertexHandle v : mesh.vertices()) {
        ASSERT_NEAR(linear[v], f(mesh.point(v)), 1e-13);
        ASSERT_EQ(constant[v], 0.1);
      }
      double holds = 0;
      for (CellHandle c : mesh.cells()) {
        holds += mass[c] * volume(mesh, c);
        ASSERT_EQ(one[c], 0.3);
        ASSERT_GE(mass[c], 0);
        ASSERT_LE(mass[c], 1);
        ASSERT_GE(part[c], 0);
        ASSERT_LT(part[c], 3);
      }
      ASSERT_NEAR(holds + lost, held, 1e-13 * held);
      if (mode != SurfaceMode::kFree) {
        ASSERT_NEAR(lost, 0, 1e-13 * held);
      }
    }
    EXPECT_GE(n_repairs, 90U);
  }
}

/// Small moves to and fro, of vertices of the boundary as well where that is asked for.
std::vector<Vec3> shake(const TetMesh& mesh, double by, int step, bool boundary_too) {
  std::vector<Vec3> d(mesh.n_vertices());
  for (VertexHandle v : mesh.vertices()) {
    if (!boundary_too && mesh.is_boundary(v)) continue;
    const double phase = 12.9898 * static_cast<double>(v.idx()) + step;
    d[v.idx()] = {by * std::sin(phase), by * std::sin(3 * phase), by * std::sin(7 * phase)};
  }
  return d;
}

TEST(Remesher, RepairsThatRememberTheOnesBeforeDoWhatAFirstOneWould) {
  std::size_t n_repairs = 0;
  for (const bool boundary_too : {false, true}) {
    TetMesh mesh = box(5);
    RemesherOptions options = options_for(20, 12);
    options.improve.min_cells = mesh.n_cells() / 2;
    options.improve.max_cells = 2 * mesh.n_cells();
    Remesher remesher(mesh, options);
    for (int i = 0; i < 12; ++i) {
      const std::vector<Vec3> d = shake(mesh, 0.04, i, boundary_too);
      TetMesh other = mesh;
      for (VertexHandle v : other.vertices()) other.set_point(v, other.point(v) + d[v.idx()]);
      if (i == 6) {  // by hand
        for (VertexHandle v : mesh.vertices()) mesh.set_point(v, mesh.point(v) + d[v.idx()]);
        remesher.reset();
      }
      if (!remesher.step(i == 6 ? std::vector<Vec3>(mesh.n_vertices()) : d).changed) continue;
      ++n_repairs;
      improve(other, options.improve);
      ASSERT_EQ(cells_of(mesh), cells_of(other)) << "step " << i;
      ASSERT_TRUE(std::ranges::equal(mesh.points(), other.points())) << "step " << i;
    }
  }
  EXPECT_GT(n_repairs, 10U) << "the motion no longer makes cells bad";
}

TEST(Remesher, MotionThatInvertsIsRefusedWithTheCellsNamed) {
  TetMesh mesh = box(5);
  RemesherOptions options = options_for();
  options.on_inversion = OnInversion::kRefuse;
  Remesher remesher(mesh, options);
  const TetMesh before = mesh;
  std::vector<Vec3> d(mesh.n_vertices());
  VertexHandle inner;
  for (VertexHandle v : mesh.vertices())
    if (!mesh.is_boundary(v)) inner = v;
  d[inner.idx()] = {0.5, 0, 0};
  const StepResult step = remesher.step(d);
  EXPECT_EQ(step.fraction, 0);
  EXPECT_FALSE(step.changed);
  ASSERT_FALSE(step.refused.empty());
  for (CellHandle c : step.refused) EXPECT_TRUE(mesh.cell(c).has(inner));
  EXPECT_TRUE(std::equal(mesh.points().begin(), mesh.points().end(), before.points().begin()));
  EXPECT_EQ(step.n_inverted, 0U);
  d[inner.idx()] = {0.01, 0, 0};
  EXPECT_EQ(remesher.step(d).fraction, 1);
}

TEST(Remesher, LargeMotionIsTakenInSafePartsWithRepairsBetween) {
  TetMesh whole = box(8), parts = whole;
  RemesherOptions options = options_for();
  Remesher at_once(whole, options);
  options.on_inversion = OnInversion::kSubsteps;
  Remesher in_parts(parts, options);
  auto total = parts.request_vertex_property<Vec3>("where to");
  const std::vector<Vec3> d = turn(parts, 60);
  for (VertexHandle v : parts.vertices()) total[v] = parts.point(v) + d[v.idx()];
  at_once.step(d);
  const StepResult step = in_parts.step(d);
  EXPECT_EQ(step.n_inverted, 0U);
  EXPECT_DOUBLE_EQ(step.fraction, 1);
  EXPECT_GT(step.repairs.size(), 1U);
  EXPECT_EQ(check(parts).message, "");
  EXPECT_TRUE(parts.properties().vertices.names() == std::vector<std::string>{"where to"});
  for (VertexHandle v : parts.boundary_vertices()) EXPECT_EQ(parts.point(v), total[v]);
}

TEST(Remesher, WhatARepairHadToLeaveCallsForNoOtherUntilItIsWorse) {
  // One cell whose four vertices lie on the boundary: nothing mends it.
  TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.05}},
                       std::vector<std::array<Index, 4>>{{0, 1, 2, 3}});
  Remesher remesher(mesh, options_for());
  EXPECT_EQ(remesher.needs_repair(), RepairCause::kAngle);
  std::vector<Vec3> d(4);
  d[3].z = 1e-5;
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kAngle);
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kNone);
  d[3].z = -0.01;
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kAngle);
  EXPECT_EQ(remesher.step(std::vector<Vec3>(4)).cause, RepairCause::kNone);
}

TetMesh flat_cell() {
  return build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.05}},
               std::vector<std::array<Index, 4>>{{0, 1, 2, 3}});
}

/// Whether the others move or not: a value below 0 is no worse for being looked at again.
TEST(Remesher, AnInvertedCellThatIsLeftCallsForNoOtherWhereInversionIsNoTrigger) {
  TetMesh mesh = built(generate::box({1, 1, 1}));
  mesh.set_point(V(0), {1.2, 1.2, 1.2});  // all six cells have it, and none can be mended
  ASSERT_GT(inverted_cells(mesh), 0U);
  RemesherOptions options = options_for();
  options.triggers.inverted = false;
  Remesher remesher(mesh, options);
  const std::vector<Vec3> all(mesh.n_vertices(), {0.5, 0.25, 0.125});  // no angle changes by it
  EXPECT_EQ(remesher.step(all).cause, RepairCause::kAngle);
  ASSERT_GT(remesher.n_inverted(), 0U);
  EXPECT_EQ(remesher.step(std::vector<Vec3>(mesh.n_vertices(), {0.5, 0.25, 0.125})).cause,
            RepairCause::kNone);
}

TEST(Remesher, WhatAMetricHadToLeaveCallsAgainWhenItIsWorse) {
  for (const bool of_volume : {false, true}) {
    TetMesh mesh = flat_cell();
    RemesherOptions options = options_for(15, 0);
    if (of_volume)
      options.triggers.jacobian_ratio = 0.9;
    else
      options.triggers.metrics = {{Metric::kVolumeLength, 0.5}};
    Remesher remesher(mesh, options);
    std::vector<Vec3> d(4);
    d[3].z = -0.01;
    const RepairCause cause = of_volume ? RepairCause::kJacobian : RepairCause::kMetric;
    EXPECT_EQ(remesher.step(d).cause, cause);
    EXPECT_EQ(remesher.step(std::vector<Vec3>(4)).cause, RepairCause::kNone);
    EXPECT_EQ(remesher.step(d).cause, cause);
    EXPECT_EQ(remesher.step(std::vector<Vec3>(4)).cause, RepairCause::kNone);
  }
}

TEST(Remesher, ARefusedMoveLeavesWhatRepairsHadToLeave) {
  TetMesh mesh = flat_cell();
  RemesherOptions options = options_for();
  options.on_inversion = OnInversion::kRefuse;
  Remesher remesher(mesh, options);
  std::vector<Vec3> d(4);
  EXPECT_EQ(remesher.step(std::vector<Vec3>(4)).cause, RepairCause::kAngle);
  ASSERT_EQ(remesher.needs_repair(), RepairCause::kNone);
  d[3].z = -0.2;
  EXPECT_FALSE(remesher.step(d).refused.empty());
  EXPECT_EQ(remesher.needs_repair(), RepairCause::kNone);
}

TEST(Remesher, AMoveThatRightsACellAndInvertsAnotherIsRefused) {
  TetMesh mesh =
      build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}},
            std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {4, 5, 6, 7}});
  mesh.set_point(VertexHandle(3), {0, 0, -1});
  RemesherOptions options = options_for();
  options.on_inversion = OnInversion::kRefuse;
  Remesher remesher(mesh, options);
  ASSERT_EQ(remesher.n_inverted(), 1U);
  std::vector<Vec3> d(8);
  d[3].z = 2;
  EXPECT_TRUE(remesher.move(d).refused.empty()) << "what rights one alone is taken";
  d[3].z = -2;
  remesher.move(d);
  mesh.set_point(VertexHandle(3), {0, 0, -1});
  remesher.reset();
  d[3].z = 2;
  d[7].z = -2;
  EXPECT_EQ(remesher.move(d).refused, std::vector<CellHandle>{CellHandle(1)});
  EXPECT_EQ(mesh.point(VertexHandle(3)).z, -1);
}

/// Moves one inner vertex of a good box so far that cells would be inverted, in sub-steps.
RepairCause cause_of_sub_steps(const RemesherOptions& triggers) {
  TetMesh mesh = box(5, 0);
  RemesherOptions options = triggers;
  options.on_inversion = OnInversion::kSubsteps;
  Remesher remesher(mesh, options);
  VertexHandle inner;
  for (VertexHandle v : mesh.vertices())
    if (!mesh.is_boundary(v)) inner = v;
  std::vector<Vec3> d(mesh.n_vertices());
  d[inner.idx()] = {0.25, 0, 0};
  const StepResult step = remesher.step(d);
  EXPECT_FALSE(step.repairs.empty());
  return step.cause;
}

TEST(Remesher, AStepOfPartsSaysWhyItHasRepaired) {
  EXPECT_EQ(cause_of_sub_steps(options_for(15, 0)), RepairCause::kInverted);
}

/// Cells that were inverted while it was looked for what may be taken are so no more when the repair begins.
TEST(Remesher, CauseIsThatOfCellsAsTheRepairFindsThem) {
  EXPECT_EQ(cause_of_sub_steps(options_for(15, 10)), RepairCause::kAngle);
}

TEST(Remesher, FixedPartsThatAreNotThereAreRefusedAtOnce) {
  for (const Motion motion : {Motion::kGiven, Motion::kLaplace}) {
    TetMesh mesh = box(2, 0);
    RemesherOptions options = options_for();
    options.motion = motion;
    options.improve.surface.fixed_vertices = {VertexHandle(1000000)};
    EXPECT_THROW(Remesher(mesh, options), InvalidInput);
  }
}

TEST(Remesher, EachTriggerCallsForARepair) {
  const auto cause = [](const std::function<void(RemesherOptions&)>& set, double by) {
    TetMesh mesh = box(5, 0);
    RemesherOptions options = options_for(15, 0);
    set(options);
    Remesher remesher(mesh, options);
    VertexHandle inner;
    for (VertexHandle v : mesh.vertices())
      if (!mesh.is_boundary(v)) inner = v;
    std::vector<Vec3> d(mesh.n_vertices());
    d[inner.idx()] = {by, 0, 0};
    return remesher.step(d).cause;
  };
  using O = RemesherOptions;
  EXPECT_EQ(cause([](O&) {}, 0.15), RepairCause::kNone);
  EXPECT_EQ(cause([](O&) {}, 0.25), RepairCause::kInverted);
  EXPECT_EQ(cause([](O& o) { o.triggers.inverted = false; }, 0.25), RepairCause::kNone);
  EXPECT_EQ(cause([](O& o) { o.triggers.min_dihedral = 14; }, 0.18), RepairCause::kAngle);
  EXPECT_EQ(cause(
                [](O& o) {
                  o.triggers.metrics = {{Metric::kVolumeLength, 0.5}};
                },
                0.15),
            RepairCause::kMetric);
  EXPECT_EQ(cause(
                [](O& o) {
                  o.triggers.metrics = {{Metric::kMaxDihedral, 120}};
                },
                0.15),
            RepairCause::kMetric);
  EXPECT_EQ(cause([](O& o) { o.triggers.jacobian_ratio = 0.5; }, 0.15), RepairCause::kJacobian);
  EXPECT_EQ(cause([](O& o) { o.triggers.motion = 0.5; }, 0.15), RepairCause::kMotion);
  EXPECT_EQ(cause([](O& o) { o.triggers.motion = 2; }, 0.15), RepairCause::kNone);
  EXPECT_EQ(cause([](O& o) { o.triggers.every = 1; }, 0.01), RepairCause::kSteps);
  EXPECT_EQ(
      cause([](O& o) { o.triggers.indicator = [](const TetMesh&, CellHandle c) { return c.idx() > 0; }; },
            0.01),
      RepairCause::kIndicator);
}

TEST(Remesher, FieldOfCellsCallsForARepairWhereItIsNotZero) {
  TetMesh mesh = box(5, 0);
  auto marked = mesh.request_cell_property<std::int64_t>("marked");
  RemesherOptions options = options_for(15, 0);
  options.triggers.indicator_field = "marked";
  Remesher remesher(mesh, options);
  VertexHandle inner;
  for (VertexHandle v : mesh.vertices())
    if (!mesh.is_boundary(v)) inner = v;
  std::vector<Vec3> d(mesh.n_vertices());
  d[inner.idx()] = {0.01, 0, 0};
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kNone);
  const CellHandle cell = mesh.incident_cell(inner);
  marked[cell] = 1;
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kIndicator);
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kNone) << "the repair had to leave it";
  marked[cell] = 0;
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kNone);
  marked[cell] = 1;
  EXPECT_EQ(remesher.step(d).cause, RepairCause::kIndicator);
  options.triggers.indicator_field = "no such field";
  EXPECT_THROW(Remesher(mesh, options), InvalidInput);
}

TEST(Remesher, InnerVerticesFollowTheBoundary) {
  for (const Motion motion : {Motion::kLaplace, Motion::kElastic}) {
    TetMesh mesh = box(6, 0);  // cells of one size: none is stiffer than another
    RemesherOptions options = options_for();
    options.motion = motion;
    Remesher remesher(mesh, options);
    const TetMesh before = mesh;
    // A linear motion of the boundary: Laplace's equation and elasticity both carry it on inside.
    std::vector<Vec3> d(mesh.n_vertices(), Vec3{9, 9, 9});
    const auto f = [](Vec3 p) { return Vec3{0.2 * p.x + 0.1 * p.y, 0.05 * p.z, -0.1 * p.x}; };
    for (VertexHandle v : mesh.boundary_vertices()) d[v.idx()] = f(mesh.point(v));
    const StepResult step = remesher.step(d);
    EXPECT_FALSE(step.changed);
    for (VertexHandle v : mesh.vertices())
      EXPECT_NEAR(norm(mesh.point(v) - before.point(v) - f(before.point(v))), 0, 1e-6);
  }
}

TEST(Remesher, ExceptionOfACallbackLeavesMeshAndFieldsAsBeforeTheStep) {
  for (const int where : {0, 1, 2}) {
    TetMesh mesh = box(8);
    auto t = mesh.request_vertex_property<double>("T");
    for (VertexHandle v : mesh.vertices()) t[v] = mesh.point(v).x;
    bool armed = false;
    RemesherOptions options = options_for();
    options.on_inversion = where == 1 ? OnInversion::kSubsteps : OnInversion::kRepair;
    options.ids = true;
    options.fields = {{.name = "T"}};
    if (where < 2)
      options.improve.progress = [&](const Progress&) {
        if (armed) throw std::runtime_error("enough");
      };
    else
      options.triggers.indicator = [&](const TetMesh&, CellHandle c) {
        if (armed && c.idx() % 100 == 99) throw std::runtime_error("enough");
        return false;
      };
    Remesher remesher(mesh, options);
    const auto cells = cells_of(mesh);
    const std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
    const std::vector<double> values(t.values().begin(), t.values().end());
    const std::vector<std::uint64_t> ids(remesher.cell_ids().begin(), remesher.cell_ids().end());
    armed = true;
    EXPECT_THROW(remesher.step(turn(mesh, 40)), std::runtime_error);
    armed = false;
    EXPECT_EQ(cells_of(mesh), cells);
    EXPECT_TRUE(std::equal(points.begin(), points.end(), mesh.points().begin(), mesh.points().end()));
    EXPECT_TRUE(std::equal(values.begin(), values.end(), t.values().begin(), t.values().end()));
    EXPECT_TRUE(std::equal(ids.begin(), ids.end(), remesher.cell_ids().begin(), remesher.cell_ids().end()));
    EXPECT_EQ(remesher.n_inverted(), 0U);
    const StepResult step = remesher.step(turn(mesh, 6));
    EXPECT_EQ(step.n_inverted, 0U);
    for (VertexHandle v : mesh.vertices()) ASSERT_TRUE(std::isfinite(t[v]));
  }
}

// An indicator is asked when a repair has been made, too.
TEST(Remesher, ExceptionAfterARepairLeavesMeshAndFieldsAsBefore) {
  for (const bool in_a_step : {true, false}) {
    TetMesh mesh = box(8);
    auto t = mesh.request_vertex_property<double>("T");
    for (VertexHandle v : mesh.vertices()) t[v] = mesh.point(v).x;
    bool armed = false;
    std::vector<std::array<VertexHandle, 4>> cells = cells_of(mesh);
    RemesherOptions options = options_for(20);
    options.on_inversion = OnInversion::kSubsteps;
    options.ids = true;
    options.fields = {{.name = "T"}};
    options.triggers.indicator = [&](const TetMesh& m, CellHandle) {
      if (armed && cells_of(m) != cells) throw std::runtime_error("enough");
      return false;
    };
    Remesher remesher(mesh, options);
    if (!in_a_step) remesher.move(turn(mesh, 40));  // as far as nothing is inverted
    const std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
    const std::vector<double> values(t.values().begin(), t.values().end());
    const std::vector<std::string> names = mesh.properties().vertices.names();
    const std::vector<std::uint64_t> ids(remesher.vertex_ids().begin(), remesher.vertex_ids().end());
    armed = true;
    if (in_a_step) {
      EXPECT_THROW(remesher.step(turn(mesh, 40)), std::runtime_error);
    } else {
      EXPECT_THROW(remesher.repair(), std::runtime_error);
    }
    armed = false;
    EXPECT_EQ(cells_of(mesh), cells);
    EXPECT_TRUE(std::equal(points.begin(), points.end(), mesh.points().begin(), mesh.points().end()));
    EXPECT_TRUE(std::equal(values.begin(), values.end(), t.values().begin(), t.values().end()));
    EXPECT_TRUE(
        std::equal(ids.begin(), ids.end(), remesher.vertex_ids().begin(), remesher.vertex_ids().end()));
    EXPECT_EQ(mesh.properties().vertices.names(), names);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_EQ(remesher.step(turn(mesh, 6)).n_inverted, 0U);
  }
}

TEST(Remesher, TransferThatHasFailedIsDoneAgain) {
  TetMesh mesh = box(8);
  auto mark = mesh.request_cell_property<double>("mark", 1.0);
  bool armed = true;
  RemesherOptions options = options_for(20);
  options.on_inversion = OnInversion::kSubsteps;
  options.fields = {{.name = "mark",
                     .how = Transfer::kCallback,
                     .callback = [&](const TetMesh&, TetMesh& now, const Edits&) {
                       if (armed) throw std::runtime_error("enough");
                       now.get_cell_property<double>("mark")->fill(2.0);
                     }}};
  Remesher remesher(mesh, options);
  remesher.move(turn(mesh, 40));
  ASSERT_FALSE(remesher.repair().edits.empty());
  EXPECT_THROW(remesher.transfer(), std::runtime_error);
  armed = false;
  EXPECT_EQ(remesher.transfer().size(), 1U);
  EXPECT_EQ(mark[C(0)], 2.0);
  EXPECT_TRUE(remesher.transfer().empty());
}

TEST(Remesher, StepThatThrowsCountsForNoTrigger) {
  for (const bool in_the_look : {false, true}) {
    TetMesh mesh = box(8);
    bool armed = false;
    RemesherOptions options = options_for();
    options.triggers.every = 3;
    options.triggers.motion = 1;
    if (in_the_look)  // throws again while the step is taken back
      options.triggers.indicator = [&](const TetMesh&, CellHandle c) {
        if (armed && c.idx() % 100 == 99) throw std::runtime_error("enough");
        return false;
      };
    else
      options.improve.progress = [&](const Progress&) {
        if (armed) throw std::runtime_error("enough");
      };
    Remesher remesher(mesh, options);
    const double before = remesher.min_dihedral();
    EXPECT_EQ(remesher.step(turn(mesh, 0.1)).cause, RepairCause::kNone);
    armed = true;
    EXPECT_THROW(remesher.step(turn(mesh, 40)), std::runtime_error);
    EXPECT_EQ(remesher.n_inverted(), 0U);
    armed = false;
    const StepResult second = remesher.step(turn(mesh, 0.1));
    EXPECT_EQ(second.cause, RepairCause::kNone);
    EXPECT_NEAR(second.min_dihedral, before, 1);
    EXPECT_EQ(remesher.step(turn(mesh, 0.1)).cause, RepairCause::kSteps);
  }
}

TEST(Remesher, FixedInnerVerticesGoWhereTheyAreTold) {
  TetMesh mesh = box(6, 0);
  RemesherOptions options = options_for();
  options.motion = Motion::kLaplace;
  VertexHandle inner;
  for (VertexHandle v : mesh.vertices())
    if (!mesh.is_boundary(v)) inner = v;
  options.improve.surface.fixed_vertices = {inner};
  mesh.delete_vertex(V(0));  // its handle is another one from here on
  const Vec3 from = mesh.point(inner);
  Remesher remesher(mesh, options);
  const VertexHandle now(inner.idx() - 1);
  ASSERT_EQ(mesh.point(now), from);
  std::vector<Vec3> d(mesh.n_vertices());
  d[now.idx()] = {0.02, 0.01, 0};
  remesher.step(d);
  EXPECT_EQ(mesh.point(now), from + d[now.idx()]);
}

TEST(Remesher, RefusedMoveIsNoStep) {
  TetMesh mesh = box(4, 0);
  RemesherOptions options = options_for();
  options.on_inversion = OnInversion::kRefuse;
  options.triggers.every = 1;
  Remesher remesher(mesh, options);
  std::vector<Vec3> d(mesh.n_vertices());
  VertexHandle inner;
  for (VertexHandle v : mesh.vertices())
    if (!mesh.is_boundary(v)) inner = v;
  d[inner.idx()] = {0.5, 0, 0};
  ASSERT_FALSE(remesher.move(d).refused.empty());
  EXPECT_EQ(remesher.needs_repair(), RepairCause::kNone);
  d[inner.idx()] = {0.001, 0, 0};
  ASSERT_TRUE(remesher.move(d).refused.empty());
  EXPECT_EQ(remesher.needs_repair(), RepairCause::kSteps);
}

#ifdef HFR_HAS_SURFACE
TEST(Remesher, FixedVerticesStayFixedUnderTheirNewHandles) {
  TetMesh mesh = box(8);
  RemesherOptions options = options_for(30, 29);
  options.improve.surface.mode = SurfaceMode::kFlat;
  options.ids = true;
  std::vector<std::uint64_t> fixed;
  for (VertexHandle v : mesh.vertices())
    if (v.idx() % 9 == 7 && mesh.is_boundary(v)) {
      options.improve.surface.fixed_vertices.push_back(v);
      fixed.push_back(v.idx());
    }
  ASSERT_GT(fixed.size(), 5U);
  Remesher remesher(mesh, options);
  std::map<std::uint64_t, Vec3> where;
  bool renumbered = false;
  for (const std::uint64_t id : fixed) where[id] = mesh.point(VertexHandle(id));
  for (int i = 0; i < 12; ++i) {
    const std::vector<Vec3> d = turn(mesh, 6);
    for (VertexHandle v : mesh.vertices())
      if (where.contains(remesher.vertex_ids()[v.idx()]))
        where[remesher.vertex_ids()[v.idx()]] = mesh.point(v) + d[v.idx()];
    remesher.step(d);
    std::size_t n_found = 0;
    for (VertexHandle v : mesh.vertices()) {
      const auto at = where.find(remesher.vertex_ids()[v.idx()]);
      if (at == where.end()) continue;
      ++n_found;
      renumbered = renumbered || v.idx() != at->first;
      ASSERT_EQ(mesh.point(v), at->second) << "step " << i;
    }
    ASSERT_EQ(n_found, fixed.size());
  }
  EXPECT_TRUE(renumbered) << "no handle changed, so that nothing was shown";
}
#endif

TEST(Remesher, CancelledStepThatWouldLeaveInvertedCellsIsUndone) {
  TetMesh mesh = box(8);
  bool cancel = false;
  RemesherOptions options = options_for();
  options.improve.cancel = [&] { return cancel; };
  Remesher remesher(mesh, options);
  const auto cells = cells_of(mesh);
  const std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
  cancel = true;
  const StepResult step = remesher.step(turn(mesh, 40));
  EXPECT_EQ(step.stop, Stop::kCancelled);
  EXPECT_TRUE(step.undone);
  EXPECT_FALSE(step.changed);
  EXPECT_EQ(step.n_inverted, 0U);
  EXPECT_EQ(cells_of(mesh), cells);
  EXPECT_TRUE(std::equal(points.begin(), points.end(), mesh.points().begin(), mesh.points().end()));
  cancel = false;
  EXPECT_FALSE(remesher.step(turn(mesh, 6)).undone);
}

TEST(Remesher, PartsOfAStepCalledAloneDoTheSame) {
  TetMesh one = box(8), other = one;
  RemesherOptions options = options_for();
  auto t = one.request_vertex_property<double>("T");
  auto u = other.request_vertex_property<double>("T");
  for (VertexHandle v : one.vertices()) u[v] = t[v] = std::sin(9 * one.point(v).x);
  options.fields = {{.name = "T"}};
  Remesher steps(one, options), alone(other, options);
  for (int i = 0; i < 8; ++i) {
    const std::vector<Vec3> d = turn(one, 8);
    steps.step(d);
    alone.move(d);
    if (alone.needs_repair() == RepairCause::kNone) continue;
    alone.repair();
    if (i % 2 == 0) alone.transfer();  // the next move does it otherwise
  }
  alone.transfer();
  EXPECT_EQ(cells_of(one), cells_of(other));
  EXPECT_TRUE(std::equal(t.values().begin(), t.values().end(), u.values().begin(), u.values().end()));
}

TEST(Remesher, SameBitsForAnyNumberOfThreads) {
  std::map<int, std::vector<double>> results;
  for (const int threads : {1, 2, 7}) {
    TetMesh mesh = box(7);
    auto t = mesh.request_vertex_property<double>("T");
    auto mass = mesh.request_cell_property<double>("mass");
    for (VertexHandle v : mesh.vertices()) t[v] = std::sin(9 * mesh.point(v).x);
    for (CellHandle c : mesh.cells()) mass[c] = generate::random_unit(5, c.idx());
    RemesherOptions options = options_for();
    options.improve.policy = {.threads = threads, .serial_below = 0};
    options.on_inversion = OnInversion::kSubsteps;
    options.fields = {{.name = "T"}, {.name = "mass", .how = Transfer::kConserve}};
    Remesher remesher(mesh, options);
    auto& out = results[threads];
    for (int i = 0; i < 6; ++i) {
      const StepResult step = remesher.step(turn(mesh, 12));
      out.push_back(static_cast<double>(step.repairs.size()));
      for (const RepairResult& repair : step.repairs)
        for (const ParentCell& parent : repair.edits.parents().all) out.push_back(parent.share);
    }
    for (Vec3 p : mesh.points()) out.insert(out.end(), {p.x, p.y, p.z});
    for (const auto& c : cells_of(mesh))
      for (VertexHandle v : c) out.push_back(static_cast<double>(v.idx()));
    out.insert(out.end(), t.values().begin(), t.values().end());
    out.insert(out.end(), mass.values().begin(), mass.values().end());
  }
  EXPECT_EQ(results[1], results[2]);
  EXPECT_EQ(results[1], results[7]);
}

std::vector<std::pair<CellHandle, double>> list_of(const Parents& parents) {
  std::vector<std::pair<CellHandle, double>> out;
  for (const ParentCell& parent : parents.all) out.emplace_back(parent.old_cell, parent.share);
  return out;
}

TEST(Remesher, ParentsAreTheSameWheneverTheyAreAskedFor) {
  const auto edits_of_turn = [](auto&& take) {
    TetMesh mesh = box(7);
    Remesher remesher(mesh, options_for());
    for (int i = 0; i < 15; ++i)
      for (const RepairResult& repair : remesher.step(turn(mesh, 12)).repairs) take(repair.edits);
  };
  std::vector<std::vector<std::pair<CellHandle, double>>> at_once;
  std::vector<Edits> kept;
  edits_of_turn([&](const Edits& edits) { at_once.push_back(list_of(edits.parents())); });
  edits_of_turn([&](const Edits& edits) { kept.push_back(edits); });
  ASSERT_GT(kept.size(), 3U);  // more copies of the mesh than a remesher keeps for itself
  ASSERT_EQ(kept.size(), at_once.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_FALSE(at_once[i].empty());
    const Edits copy = kept[i];
    std::vector<const Parents*> asked(4);
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < asked.size(); ++k)
      threads.emplace_back([&, k] { asked[k] = &(k % 2 == 0 ? copy : kept[i]).parents(); });
    for (std::thread& thread : threads) thread.join();
    for (const Parents* parents : asked) EXPECT_EQ(parents, asked[0]);
    EXPECT_EQ(list_of(*asked[0]), at_once[i]) << "repair " << i;
  }
}

TEST(Remesher, ParentsThatAreLeftOutAreSaidToBe) {
  TetMesh mesh = box(7);
  RemesherOptions options = options_for();
  options.parents = false;
  Remesher remesher(mesh, options);
  const StepResult step = remesher.step(turn(mesh, 30));
  ASSERT_FALSE(step.repairs.empty());
  EXPECT_FALSE(step.repairs[0].edits.has_parents());
  try {
    step.repairs[0].edits.parents();
    ADD_FAILURE() << "parents without the mesh as it was";
  } catch (const InvalidInput& e) {
    EXPECT_THAT(e.what(), HasSubstr("left out"));
  }
}

TEST(Remesher, BadInputIsNamedBeforeAnythingMoves) {
  TetMesh mesh = box(3);
  const auto says = [&](const std::function<void()>& f) -> std::string {
    try {
      f();
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(says([&] { Remesher(mesh, options_for(15, 20)); }), HasSubstr("must not be above the goal"));
  EXPECT_THAT(says([&] {
                RemesherOptions o = options_for();
                o.fields = {{.name = "T"}};
                Remesher(mesh, o);
              }),
              HasSubstr("no field 'T'"));
  EXPECT_THAT(says([&] {
                RemesherOptions o = options_for();
                o.max_substeps = 0;
                Remesher(mesh, o);
              }),
              HasSubstr("max_substeps"));
  Remesher remesher(mesh, options_for());
  const std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
  std::vector<Vec3> d(mesh.n_vertices(), Vec3{1, 1, 1});
  d[17].y = std::nan("");
  EXPECT_THAT(says([&] { remesher.step(d); }), HasSubstr("vertex 17 is not finite"));
  d.pop_back();
  EXPECT_THAT(says([&] { remesher.step(d); }), HasSubstr("has 63 entries for 64 vertices"));
  EXPECT_TRUE(std::equal(points.begin(), points.end(), mesh.points().begin(), mesh.points().end()));
}

}  // namespace
}  // namespace hfr::test
