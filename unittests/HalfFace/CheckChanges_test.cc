// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Check.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "HalfFace/Writer.hh"
#include "Meshes.hh"

namespace hfr {
namespace {

using test::kuhn_box;

CheckResult check_all(const TetMesh& mesh) { return check(mesh, {.last = Rule::kNonManifoldVertex}); }

/// Points without cells: compared with it, every cell of another mesh is new.
TetMesh without_cells(const TetMesh& mesh) {
  TetMesh empty;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) empty.add_vertex(mesh.point(VertexHandle(i)));
  return empty;
}

TEST(CheckChanges, WhereNothingHasChangedNothingIsWrong) {
  for (const auto& [name, mesh] : test::suite()) EXPECT_EQ(check_changes(mesh, mesh), Ok) << name;
}

TEST(CheckChanges, OfAllNewCellsItSaysWhatCheckSays) {
  int n_sound = 0, n_broken = 0;
  for (const auto& [name, mesh] : test::suite()) {
    const bool sound = static_cast<bool>(check_all(mesh));
    EXPECT_EQ(static_cast<bool>(check_changes(mesh, without_cells(mesh))), sound) << name;
  }
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    // A few cells missing, so that some of these meshes are manifolds and others are not.
    const TetMesh mesh = test::torn_box(2, 0.97 - 0.001 * static_cast<double>(seed), seed);
    const bool sound = static_cast<bool>(check_all(mesh));
    ++(sound ? n_sound : n_broken);
    EXPECT_EQ(static_cast<bool>(check_changes(mesh, without_cells(mesh))), sound) << seed;
  }
  EXPECT_GT(n_sound, 20);
  EXPECT_GT(n_broken, 20);
}

TEST(CheckChanges, WhatDeletingCellsBreaksIsFoundRoundThem) {
  std::mt19937_64 engine(1);
  int n_broken = 0;
  for (int run = 0; run < 40; ++run) {
    TetMesh mesh = kuhn_box(3);
    for (int step = 0; step < 12; ++step) {
      const TetMesh before = mesh;
      const CellHandle c(engine() % mesh.n_cells());
      if (mesh.is_deleted(c)) continue;
      mesh.delete_cell(c);
      const bool sound = static_cast<bool>(check_all(mesh));
      ASSERT_EQ(static_cast<bool>(check_changes(mesh, before)), sound) << run << ", " << step;
      if (sound) continue;
      ++n_broken;
      break;
    }
  }
  EXPECT_GT(n_broken, 10);
}

/// A vertex within two pyramids of n sides: 2 n cells, which have n + 2 other vertices.
TetMesh double_pyramid(Index n) {
  std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<test::Corners> cells;
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    const Index a = 3 + i, b = 3 + (i + 1) % n;
    cells.push_back({0, 1, b, a});
    cells.push_back({0, 2, a, b});
  }
  return build(points, cells);
}

TEST(CheckChanges, StarsOfAnySizeAreJudgedAlike) {
  for (const Index n : {3, 20, 61, 62, 63, 100, 128, 140}) {
    const TetMesh whole = double_pyramid(n);
    EXPECT_EQ(check_changes(whole, without_cells(whole)), Ok) << n;
    TetMesh mesh = whole;
    mesh.delete_cell(CellHandle(0));
    EXPECT_EQ(check_changes(mesh, whole), Ok) << n;
    if (n == 3) continue;
    mesh.delete_cell(CellHandle(4));  // a second hole, which touches the first at the edge to the top
    EXPECT_NE(check_changes(mesh, whole), Ok) << n;
    EXPECT_NE(check_changes(mesh, without_cells(mesh)), Ok) << n;
    mesh.delete_cell(CellHandle(2));  // both become one
    EXPECT_EQ(check_changes(mesh, whole), Ok) << n;
    // A ring of cells is gone, from the top to the bottom: two parts that touch in the inner vertex.
    mesh = whole;
    for (const Index at : {Index{0}, n / 2})
      for (const Index c : {2 * at, 2 * at + 1}) mesh.delete_cell(CellHandle(c));
    EXPECT_EQ(static_cast<bool>(check_changes(mesh, whole)), static_cast<bool>(check_all(mesh))) << n;
  }
}

TEST(CheckChanges, WhatWasNoManifoldMayStayButNotBecomeLessOfOne) {
  const TetMesh torn = test::torn_box(4, 0.5, 1);
  ASSERT_NE(check_all(torn), Ok);
  TetMesh mesh = torn;
  // A cell that is gone and comes again elsewhere in the arrays.
  const auto v = mesh.cell(CellHandle(7)).v;
  mesh.delete_cell(CellHandle(7));
  mesh.add_cell(v[0], v[1], v[2], v[3]);
  EXPECT_EQ(check_changes(mesh, torn), Ok);
  // Without most of its cells there are more pinches.
  for (std::size_t i = 0; i < mesh.n_cells(); i += 2)
    if (!mesh.is_deleted(CellHandle(i))) mesh.delete_cell(CellHandle(i));
  EXPECT_NE(check_changes(mesh, torn), Ok);
}

TEST(CheckChanges, EachRuleOfTheKernelIsTested) {
  const TetMesh before = kuhn_box(2);
  const CellHandle c(5);
  const auto broken_by = [&](auto&& change) {
    TetMesh mesh = before;
    change(mesh);
    return check_changes(mesh, before).rule;
  };
  // In each a cell has another order of its vertices as well, so that it counts as changed.
  const auto turn = [](Cell& cell) {
    std::swap(cell.v[0], cell.v[1]);
    std::swap(cell.v[2], cell.v[3]);
  };
  EXPECT_NE(broken_by([&](TetMesh& m) { turn(TetMesh::Writer(m).cell(c)); }),
            Ok);  // its mates were not turned
  EXPECT_EQ(broken_by([&](TetMesh& m) { TetMesh::Writer(m).cell(c).v[1] = VertexHandle(1000); }),
            Rule::kIndexRange);
  EXPECT_EQ(broken_by([&](TetMesh& m) { TetMesh::Writer(m).cell(c).v[1] = m.cell(c).v[0]; }),
            Rule::kRepeatedVertex);
  EXPECT_NE(broken_by([&](TetMesh& m) { TetMesh::Writer(m).mark_deleted(c); }), Ok);
  EXPECT_EQ(broken_by([&](TetMesh& m) {
              m.delete_cell(c);
              TetMesh::Writer(m).free_cells().clear();
            }),
            Rule::kFreeList);
  EXPECT_EQ(broken_by([&](TetMesh& m) {
              const auto v = m.cell(c).v;
              m.delete_cell(c);
              m.add_cell(v[0], v[1], v[2], v[3]);
              TetMesh::Writer(m).set_incident_cell(v[0], CellHandle(0));
              if (m.cell(CellHandle(0)).has(v[0])) TetMesh::Writer(m).set_incident_cell(v[0], CellHandle());
            }),
            Rule::kIncidentCell);
}

}  // namespace
}  // namespace hfr
