// SPDX-License-Identifier: BSD-3-Clause
// The fuzzer finds what it is made to find.
#include "Fuzz/Promises.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "HalfFace/Generate.hh"

namespace hfr::fuzz {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

/// 16 cubes; region 1 and 2, a labelled face, edge and vertex, and a fixed vertex.
TetMesh box() {
  generate::Arrays arrays = generate::two_region_box({4, 2, 2});
  TetMesh mesh = build(arrays.points, arrays.cells);
  for (std::size_t c = 0; c < arrays.regions.size(); ++c) mesh.set_region(CellHandle(c), arrays.regions[c]);
  mesh.labels().faces.set(mesh.halfface_vertices(*mesh.boundary_halffaces().begin()), 5);
  mesh.labels().edges.set(mesh.edge_vertices(*mesh.boundary_edges().begin()), 6);
  mesh.labels().vertices.assign(mesh.n_vertices(), 0);
  mesh.labels().vertices[3] = 7;
  mesh.set_fixed(VertexHandle(44));
  return mesh;
}
constexpr Index kInside = 21;  // of region 1

std::vector<std::string> broken(const TetMesh& before, const TetMesh& after,
                                SurfaceMode mode = SurfaceMode::kFrozen) {
  RandomOptions options;
  options.improve.surface.mode = mode;
  std::vector<Finding> findings;
  compare_meshes(measure(before), measure(after), options, {}, findings);
  std::vector<std::string> names;
  for (const Finding& finding : findings) names.push_back(finding.promise);
  return names;
}

TEST(Promises, AreKeptByAMeshThatStaysOrOneThatIsMended) {
  const TetMesh good = box();
  EXPECT_THAT(broken(good, good), IsEmpty());
  TetMesh bad = box();
  bad.set_point(VertexHandle(kInside), {0.95, 0.95, 0.1});
  EXPECT_GT(measure(bad).inverted, 0U);
  EXPECT_THAT(broken(bad, good), IsEmpty());
}

TEST(Promises, AreBrokenByACellThatInverts) {
  const TetMesh good = box();
  TetMesh bad = box();
  bad.set_point(VertexHandle(kInside), {0.95, 0.95, 0.1});
  const auto names = broken(good, bad);
  for (const char* promise : {"inverted", "invalid", "overlap", "worst angle"})
    EXPECT_THAT(names, Contains(promise));
}

TEST(Promises, AreBrokenByAnAngleThatFallsALittle) {
  const TetMesh good = box();
  TetMesh worse = box();
  worse.set_point(VertexHandle(kInside), {0.25, 0.51, 0.5});
  EXPECT_THAT(broken(good, worse), Contains("worst angle"));
  EXPECT_THAT(broken(worse, good), IsEmpty());
}

TEST(Promises, AreBrokenByCellsForNothingButNotByThoseThatLeaveFewerBelowTheGoal) {
  Measure before = measure(box());
  before.worst = before.p1 = 5;
  before.angles = {5, 10, 20};
  Measure after = before;
  after.cells = 3 * before.cells + 30;
  RandomOptions options;
  options.improve.min_dihedral = 15;
  const auto n_findings = [&] {
    std::vector<Finding> findings;
    compare_meshes(before, after, options, {}, findings);
    return std::count_if(findings.begin(), findings.end(),
                         [](const Finding& f) { return f.promise == "cells for nothing"; });
  };
  EXPECT_EQ(n_findings(), 1);
  after.angles = {5, 15, 20};
  EXPECT_EQ(n_findings(), 0);
  options.improve.min_dihedral.reset();
  EXPECT_EQ(n_findings(), 0) << "without a goal, below what is claimed";
  after.angles = {5, 14, 20};
  EXPECT_EQ(n_findings(), 1) << "there is no goal";
  before.inverted = after.inverted = 1;
  EXPECT_EQ(n_findings(), 0) << "the worst beside the inverted one has risen";
  after.angles = before.angles;
  EXPECT_EQ(n_findings(), 1);
}

TEST(Promises, AreBrokenByABoundaryThatMoves) {
  const TetMesh good = box();
  TetMesh moved = box();
  moved.set_point(VertexHandle(44), {1, 1, std::nextafter(1, 2)});
  const auto names = broken(good, moved);
  for (const char* promise : {"fixed vertices", "frozen faces"}) EXPECT_THAT(names, Contains(promise));
  moved.set_point(VertexHandle(44), {1, 1, 1 + 1e-9});
  for (const char* promise : {"volume", "region volume"})
    EXPECT_THAT(broken(good, moved, SurfaceMode::kFlat), Contains(promise));
}

TEST(Promises, AreKeptByAThinBodyThatMovesByWhatCountsAsPlanar) {
  const auto sheet = [](double lift) {
    TetMesh mesh = box();
    for (VertexHandle v : mesh.vertices()) {
      const Vec3 p = mesh.point(v);
      mesh.set_point(v, {p.x, p.y, 1e-12 * p.z});
    }
    mesh.set_point(VertexHandle(44), mesh.point(VertexHandle(44)) + Vec3{0, 0, lift});
    return mesh;
  };
  EXPECT_THAT(broken(sheet(0), sheet(1e-12), SurfaceMode::kFlat), Not(Contains("volume")));
  EXPECT_THAT(broken(sheet(0), sheet(1e-10), SurfaceMode::kFlat), Contains("volume"));
}

TEST(Promises, OfAPatchAreKeptToTheRoundingOfItsOutlineAndNoFurther) {
  // A corner of the labelled face, in units of the distance of doubles at 1e12, along one of its sides.
  const auto moved = [](double offset, double n_steps) {
    TetMesh mesh = box();
    const auto face = mesh.halfface_vertices(*mesh.boundary_halffaces().begin());
    const Vec3 side = mesh.point(face[1]) - mesh.point(face[0]);
    mesh.set_point(face[0], mesh.point(face[0]) + (-n_steps * 0x1p-13 / norm(side)) * side);
    for (VertexHandle v : mesh.vertices()) mesh.set_point(v, mesh.point(v) + Vec3{offset, offset, offset});
    return mesh;
  };
  for (double n_steps : {2.0, 64.0})
    EXPECT_THAT(broken(moved(0, 0), moved(0, n_steps), SurfaceMode::kFlat), Contains("patch area"));
  EXPECT_THAT(broken(moved(1e12, 0), moved(1e12, 2), SurfaceMode::kFlat), Not(Contains("patch area")));
  EXPECT_THAT(broken(moved(1e12, 0), moved(1e12, 64), SurfaceMode::kFlat), Contains("patch area"));
}

TEST(Promises, AreBrokenByLabelsThatGo) {
  const TetMesh good = box();
  TetMesh bare = box();
  bare.labels() = {};
  const auto names = broken(good, bare);
  for (const char* promise : {"frozen faces", "labelled edges", "vertex labels"})
    EXPECT_THAT(names, Contains(promise));
  const auto flat = broken(good, bare, SurfaceMode::kFlat);
  for (const char* promise : {"patch area", "edge length"}) EXPECT_THAT(flat, Contains(promise));
}

TEST(Promises, AreBrokenByCellsThatComeToShareNoMoreThanAnEdgeOrAVertex) {
  Measure before = measure(box());
  Measure after = before;
  ++after.extra_fans;
  ++after.extra_stars;
  after.labels_fit = false;
  SurfaceReport surface;
  surface.bound = 1e-3;
  surface.hausdorff = 2e-3;
  std::vector<Finding> findings;
  compare_meshes(before, after, {}, surface, findings);
  std::vector<std::string> names;
  for (const Finding& finding : findings) names.push_back(finding.promise);
  EXPECT_THAT(names, UnorderedElementsAre("pinched edges", "pinched vertices", "labels", "hausdorff"));
}

/// A run that has been made, and what is found when its mesh or what it says of it is changed.
class WhatARunSays : public testing::Test {
 protected:
  void SetUp() override {
    mesh_.set_point(VertexHandle(kInside), {0.95, 0.95, 0.1});
    options_.improve.min_dihedral = 70;  // missed
    result_ = improve(mesh_, options_.improve);
  }
  std::vector<std::string> broken() const {
    std::vector<Finding> findings;
    compare_result(mesh_, result_, same_bits_, options_, findings);
    std::vector<std::string> names;
    for (const Finding& finding : findings) names.push_back(finding.promise);
    return names;
  }

  TetMesh mesh_ = box();
  RandomOptions options_;
  Result result_;
  bool same_bits_ = false;
};

TEST_F(WhatARunSays, IsKeptAsItIs) { EXPECT_THAT(broken(), IsEmpty()); }

TEST_F(WhatARunSays, IsBrokenByAMeshThatInvertsAfterwards) {
  mesh_.set_point(*mesh_.vertices().begin(), {0.95, 0.95, 0.6});
  const auto names = broken();
  EXPECT_THAT(names, Contains("invalid_cells"));
  EXPECT_THAT(names, Contains("statistics"));
}

TEST_F(WhatARunSays, IsBrokenByAGoalThatWasNotReached) {
  result_.goal_reached = true;
  EXPECT_THAT(broken(), Contains("goal_reached"));
}

TEST_F(WhatARunSays, IsBrokenByAGoalThatWasReachedAndIsNotSaid) {
  options_.improve.min_dihedral = 0;
  EXPECT_THAT(broken(), Contains("goal_reached"));
}

TEST_F(WhatARunSays, IsBrokenByAChangeThatIsNotSaid) {
  result_.changed = false;
  EXPECT_THAT(broken(), ElementsAre("changed"));
  same_bits_ = true;
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(WhatARunSays, IsBrokenByAnEndThatNobodyAskedFor) {
  for (const Stop stop : {Stop::kGoal, Stop::kCancelled, Stop::kTimeLimit, Stop::kIterations}) {
    result_.stop = stop;
    EXPECT_THAT(broken(), ElementsAre("stop")) << static_cast<int>(stop);
  }
  options_.cancel_at = 1;
  result_.stop = Stop::kCancelled;
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(WhatARunSays, IsBrokenByCellsThatAreDeletedAndLeft) {
  mesh_.delete_cell(CellHandle(0));
  EXPECT_THAT(broken(), Contains("dense"));
}

TEST_F(WhatARunSays, IsBrokenByStatisticsThatAreNotOfTheMesh) {
  ASSERT_FALSE(result_.stuck.empty());
  Result said = result_;
  result_.after.min_dihedral.min += 1e-3;
  EXPECT_THAT(broken(), ElementsAre("statistics"));
  result_ = said;
  result_.after.flat.emplace_back(0);
  EXPECT_THAT(broken(), ElementsAre("statistics"));
  result_ = said;
  result_.stuck.clear();
  EXPECT_THAT(broken(), ElementsAre("statistics"));
  result_ = said;
  result_.stuck.front().degrees = result_.stuck_below + 1;
  EXPECT_THAT(broken(), ElementsAre("statistics"));
}

TEST(Measure, CountsFansRoundAnEdgeAndSetsAtAVertex) {
  const std::vector<Vec3> points = {{0, 0, 0},  {0, 0, 1},   {1, 0, 0},  {1, 1, 0},
                                    {-1, 0, 0}, {-1, -1, 0}, {0, -1, -1}};
  using Cells = std::vector<std::array<Index, 4>>;
  const Measure at_edge = measure(build(points, Cells{{0, 1, 2, 3}, {0, 1, 4, 5}}));
  EXPECT_EQ(at_edge.extra_fans, 1U);
  EXPECT_EQ(at_edge.extra_stars, 2U);
  const Measure at_vertex = measure(build(points, Cells{{0, 1, 2, 3}, {0, 4, 5, 6}}));
  EXPECT_EQ(at_vertex.extra_fans, 0U);
  EXPECT_EQ(at_vertex.extra_stars, 1U);
  const Measure at_face = measure(build(points, Cells{{0, 1, 2, 3}, {0, 1, 2, 6}}));
  EXPECT_EQ(at_face.extra_fans, 0U);
  EXPECT_EQ(at_face.extra_stars, 0U);
}

}  // namespace
}  // namespace hfr::fuzz
