// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/StuckCells.hh"
#include "Remesh/SurfaceRun.hh"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "Quality/Statistics.hh"
#include "Quality/UnfillableFaces.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr::test {
namespace {

std::size_t n_of(const std::vector<StuckCell>& cells, StuckReason limit) {
  return count_reasons(cells)[static_cast<std::size_t>(limit)];
}

/// A roof: two cells on a wedge of the given degrees at the edge (0, 1).
TetMesh wedge(double degrees) {
  const double half = 0.5 * degrees * std::numbers::pi / 180;
  return build({{-1, 0, 0},
                {1, 0, 0},
                {0, std::sin(half), std::cos(half)},
                {0, -std::sin(half), std::cos(half)},
                {0, 0, 3}},
               std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 4, 3}, {1, 4, 2, 3}});
}

TEST(StuckCells, NoneAreBelowWhatAllMeet) {
  const TetMesh mesh = jittered(3, 0.1, 1);
  EXPECT_TRUE(stuck_cells(mesh, 5, {}).empty());
}

TEST(StuckCells, WhatIsProvenIsTheSameWithoutALookAtEdgesWhereNothingCanBe) {
  std::size_t n_proofs = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const TetMesh& mesh :
         {jittered(4, 0.2, seed), wedge(2.0 * static_cast<double>(seed)), kuhn_box(3)}) {
      const std::vector<std::uint8_t> frozen = constrained_vertices(mesh);
      std::vector<StuckCell> cells = without_proofs(mesh, cells_below(mesh, 60, {}));
      ASSERT_TRUE(are_positive(cells));
      for (double by : {0.01, 2.0, 30.0}) {
        std::vector<StuckCell> quick = cells, all = cells;
        prove_kept(mesh, frozen, quick, by, /*all_positive=*/true);
        prove_kept(mesh, frozen, all, by, /*all_positive=*/false);
        for (std::size_t i = 0; i < all.size(); ++i) {
          EXPECT_EQ(quick[i].reason, all[i].reason);
          EXPECT_EQ(quick[i].ceiling, all[i].ceiling);
          EXPECT_EQ(quick[i].a, all[i].a);
          EXPECT_EQ(quick[i].b, all[i].b);
          n_proofs += is_proof(all[i].reason) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(n_proofs, 100U);
}

TEST(StuckCells, EveryCellBelowTheAngleIsListedOnce) {
  const TetMesh mesh = jittered(4, 0.24, 3);
  const auto stuck = stuck_cells(mesh, 30, {});
  std::size_t n = 0;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const double q = quality_of(mesh, v, MinDihedral{});
    n += report_value(Metric::kMinDihedral, q) < 30 ? 1 : 0;
  }
  ASSERT_GT(n, 20U);
  EXPECT_EQ(stuck.size(), n);
  EXPECT_TRUE(std::is_sorted(stuck.begin(), stuck.end(),
                             [](const StuckCell& a, const StuckCell& b) { return a.cell < b.cell; }));
  std::size_t sum = 0;
  for (std::size_t count : count_reasons(stuck)) sum += count;
  EXPECT_EQ(sum, n);
}

TEST(StuckCells, NarrowWedgeOfTheSurfaceIsACeiling) {
  const auto narrow = stuck_cells(wedge(20), 25, {});
  ASSERT_GE(narrow.size(), 1U);
  EXPECT_EQ(narrow[0].cell, C(0));
  EXPECT_EQ(narrow[0].reason, StuckReason::kSurfaceCeiling);
  EXPECT_EQ(narrow[0].n_frozen_vertices, 4);
  EXPECT_NEAR(narrow[0].degrees, 20, 1e-9);
}

TEST(StuckCells, WedgeThatOneCellHasToFillIsACeilingWhereThisCellIsPoor) {
  // Surface faces (0, 1, 2) and (0, 1, 3) meet at 40 degrees, and the cell on both of them has an angle of 9
  // at its other end: two cells in the wedge would have one of at most 20.
  TetMesh mesh = wedge(40);
  const double half = 20 * std::numbers::pi / 180;
  mesh.set_point(V(2), {0.9, 0.3 * std::sin(half), 0.3 * std::cos(half)});
  const auto is_of_c0 = [](const StuckCell& cell) { return cell.cell == C(0); };
  const auto stuck = stuck_cells(mesh, 25, {});
  const auto found = std::find_if(stuck.begin(), stuck.end(), is_of_c0);
  ASSERT_NE(found, stuck.end());
  EXPECT_LT(found->degrees, 15);
  EXPECT_EQ(found->reason, StuckReason::kSurfaceCeiling);
  // Two of 20 degrees would do for 15.
  const auto below = stuck_cells(mesh, 15, {});
  ASSERT_TRUE(std::any_of(below.begin(), below.end(), is_of_c0));
  EXPECT_EQ(n_of(below, StuckReason::kSurfaceCeiling), 0U);
}

TEST(StuckCells, WedgeAtAnInterfaceIsAnInputFeature) {
  // Six cells round an edge of the octahedron's axis, one of them in a region of its own, squeezed.
  TetMesh mesh = octahedron();
  mesh.set_region(C(0), 1);
  const Cell cell = mesh.cell(C(0));
  // Bring two outer corners of cell 0 close to each other: its wedge at the edge to the third is narrow.
  mesh.set_point(cell.v[1], mesh.point(cell.v[2]) + 0.15 * (mesh.point(cell.v[1]) - mesh.point(cell.v[2])));
  const auto stuck = stuck_cells(mesh, 20, {});
  EXPECT_GE(n_of(stuck, StuckReason::kInputFeature), 1U);
  mesh.set_region(C(0), 0);
  EXPECT_EQ(n_of(stuck_cells(mesh, 20, {}), StuckReason::kInputFeature), 0U);
}

TEST(StuckCells, FoldsAreNamedBeforeAnythingElse) {
  const TetMesh mesh = jittered(5, 0.5, 2);
  std::vector<HalfFaceHandle> boundary;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) boundary.push_back(h);
  const auto folded = unfillable_faces(mesh, boundary);
  ASSERT_FALSE(folded.empty());
  EXPECT_GT(n_of(stuck_cells(mesh, 5, folded), StuckReason::kFoldedSurface), 0U);
  EXPECT_EQ(n_of(stuck_cells(mesh, 5, {}), StuckReason::kFoldedSurface), 0U);
}

TEST(StuckCells, CellWithoutAVertexThatMayMoveIsNotThereforeStuck) {
  // It was said to be kept by its vertices, but others may be connected to them.
  const TetMesh mesh = jittered(2, 0.3, 4);
  std::size_t n_frozen = 0;
  for (const StuckCell& stuck : stuck_cells(mesh, 40, {})) {
    if (stuck.n_frozen_vertices < 4 || is_proof(stuck.reason)) continue;
    ++n_frozen;
    EXPECT_EQ(stuck.reason, StuckReason::kNotFound);
  }
  EXPECT_GT(n_frozen, 0U);
}

TEST(StuckCells, InvertedCellInANarrowWedgeOfTheSurfaceIsHeldByIt) {
  // What the surface leaves does not hang on the cells: one inverted cell hid it.
  TetMesh mesh = wedge(20);
  mesh.set_point(V(4), {0, 0, 0.5});
  ASSERT_FALSE(invalid_cells(mesh, {}).empty());
  EXPECT_EQ(stuck_cells(mesh, 25, {})[0].reason, StuckReason::kSurfaceCeiling);
}

/// Cells round an upright edge, with outer vertices at these degrees about it; the first is a region.
TetMesh wheel(const std::vector<double>& degrees) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<Corners> cells;
  const auto n = static_cast<Index>(degrees.size());
  for (Index i = 0; i < n; ++i) {
    const double turn = degrees[i] * std::numbers::pi / 180;
    points.push_back({std::cos(turn), std::sin(turn), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
  }
  TetMesh mesh = build(points, cells);
  mesh.set_region(C(0), 1);
  return mesh;
}

TEST(StuckCells, InterfaceFoldedOverAnotherIsAnInputFeature) {
  TetMesh mesh = wheel({50, 49.937, 144, 216, 288});
  const auto stuck = stuck_cells(mesh, 15, {});
  ASSERT_FALSE(stuck.empty());
  EXPECT_EQ(stuck[0].cell, C(0));
  EXPECT_EQ(stuck[0].reason, StuckReason::kInputFeature);
  EXPECT_NEAR(stuck[0].ceiling, -0.063, 1e-9);
  EXPECT_EQ(stuck[0].a.idx() + stuck[0].b.idx(), 1U);
  const Result result = improve(mesh, serial());
  ASSERT_FALSE(result.invalid_cells.empty());
  for (const StuckCell& left : result.stuck)  // the boundary is folded there as well
    if (left.degrees <= 0) {
      EXPECT_TRUE(is_proof(left.reason));
    }
}

TEST(StuckCells, InterfaceFoldedOverAnotherIsAlsoOneWherePlanesAreKept) {
  const TetMesh mesh = wheel({50, 49.937, 144, 216, 288});
  const auto held_in = [&](SurfaceMode mode) {
    ImproveOptions options = serial();
    options.surface.mode = mode;
    auto stuck = stuck_cells(mesh, 15, {});
    blame_features(mesh, stuck, 15, options.surface, options.policy);
    return stuck.at(0);
  };
  const StuckCell flat = held_in(SurfaceMode::kFlat);
  EXPECT_EQ(flat.cell, C(0));
  EXPECT_EQ(flat.reason, StuckReason::kInputFeature);
  EXPECT_NEAR(flat.ceiling, -0.063, 1e-9);
}

/// The smallest dihedral of the cells at the edge between two places; nothing where there is none.
std::optional<double> worst_at(const TetMesh& mesh, const std::set<Place>& ends) {
  std::optional<double> worst;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const auto n =
        std::count_if(v.begin(), v.end(), [&](VertexHandle u) { return ends.count(place_of(mesh, u)); });
    if (n < 2) continue;
    const double degrees = report_value(Metric::kMinDihedral, quality_of(mesh, v, MinDihedral{}));
    worst = std::min(worst.value_or(degrees), degrees);
  }
  return worst;
}

/// A box leaning over, so that two of its edges leave 45 degrees; with interfaces in every second one.
TetMesh leaning_box(std::uint64_t seed) {
  generate::Arrays arrays = generate::jittered_box({3, 3, 3}, 0.25, seed);
  for (Vec3& p : arrays.points) p.x += p.z;
  TetMesh mesh = built(arrays);
  if (seed % 2 == 0)
    for (CellHandle c : mesh.cells()) mesh.set_region(c, static_cast<int>(c.idx() / 9) % 3);
  return mesh;
}

TEST(StuckCellsProperty, NoOptionLiftsTheCellsOfAnEdgeBeyondItsCeiling) {
  std::size_t n_proofs = 0, n_lifted = 0;
  for (std::uint64_t s = 1; s <= 8; ++s) {
    const TetMesh start = leaning_box(s);
    ImproveOptions options = serial();
    options.min_dihedral = 30;
    TetMesh mesh = start;
    const Result result = improve(mesh, options);
    ImproveOptions more = serial();
    more.raise_min_dihedral = true;
    more.iterations = 2;
    more.max_cells = 4 * mesh.n_cells();
    ImproveOptions fewer = options;
    fewer.coarsen = true;
    std::vector<TetMesh> others = {mesh, mesh, start};
    improve(others[0], more);
    improve(others[1], fewer);
    improve(others[2], more);
    others.push_back(mesh);
    for (const StuckCell& stuck : result.stuck) {
      if (!is_proof(stuck.reason) || stuck.reason == StuckReason::kFoldedSurface) continue;
      ++n_proofs;
      ASSERT_TRUE(stuck.a.is_valid());
      EXPECT_LT(stuck.ceiling, 30);
      const std::set<Place> ends = {place_of(mesh, stuck.a), place_of(mesh, stuck.b)};
      for (const TetMesh& other : others) {
        const auto worst = worst_at(other, ends);
        ASSERT_TRUE(worst.has_value()) << "an edge of a face that may not change is gone";
        EXPECT_LE(*worst, std::max(stuck.ceiling, 0.0) + 1e-6);
        n_lifted += *worst > stuck.degrees + 0.5 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(n_proofs, 100U);
  EXPECT_GT(n_lifted, 0U) << "nothing has changed after the first run";
}

TEST(StuckCells, BoundOnCellsIsBlamedOnlyWhereANewVertexWouldHelp) {
  std::size_t n_blamed = 0;
  for (std::uint64_t s = 1; s <= 2; ++s) {
    TetMesh mesh = jittered(4, 0.3, s);
    ImproveOptions options = serial();
    options.min_dihedral = 30;
    options.max_cells = mesh.n_cells();
    const Result result = improve(mesh, options);
    const std::size_t n = n_of(result.stuck, StuckReason::kMaxCells);
    n_blamed += n;
    ImproveOptions roomy = options;
    roomy.max_cells = 10 * mesh.n_cells();
    TetMesh more = mesh;
    const Result next = improve(more, roomy);
    EXPECT_EQ(n_of(next.stuck, StuckReason::kMaxCells), 0U);
    EXPECT_EQ(next.cell_bound.bound, 0U);
    EXPECT_EQ(result.cell_bound.cells, n);
    EXPECT_EQ(result.cell_bound.bound, n > 0 ? options.max_cells : 0);
    if (n > 0) {
      EXPECT_GT(result.cell_bound.wanted, options.max_cells);
      EXPECT_LT(next.stuck.size(), result.stuck.size()) << s;
    }
  }
  EXPECT_GT(n_blamed, 0U);
}

/// No vertex raises a regular cell.
TEST(StuckCells, BoundOnCellsIsNamedWhereThereIsNoRoomForAVertexAndACellHasNoOtherReason) {
  const TetMesh mesh =
      build({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, std::vector<Corners>{{0, 1, 2, 3}});
  const auto met = [&](StuckReason reason, std::size_t max_cells) {
    StuckCell cell;
    cell.cell = C(0);
    cell.degrees = 70.5;
    cell.reason = reason;
    std::vector<StuckCell> stuck = {cell};
    const CellBoundMet found = blame_max_cells(mesh, stuck, 71, max_cells);
    EXPECT_EQ(stuck[0].reason, reason);
    EXPECT_EQ(found.cells, 0U);
    EXPECT_EQ(found.wanted, 0U);
    return found.bound;
  };
  EXPECT_EQ(met(StuckReason::kNotFound, 1), 1U);
  EXPECT_EQ(met(StuckReason::kNotFound, 4), 4U);
  EXPECT_EQ(met(StuckReason::kNotFound, 5), 0U) << "there is room for one";
  EXPECT_EQ(met(StuckReason::kTimeLimit, 1), 0U);
  EXPECT_EQ(met(StuckReason::kSurfaceCeiling, 1), 0U);
}

/// What a run claims may take it past its own bound; with a larger one it goes on beyond the claim.
TEST(StuckCells, BoundThatARunWentPastForItsClaimIsNamedBeyondIt) {
  generate::Arrays arrays = generate::jittered_box({4, 4, 4}, 0.2, 7);
  for (Vec3& p : arrays.points) p.z *= 0.15;
  TetMesh mesh = built(arrays), more = mesh;
  const std::size_t usual = 119 * mesh.n_cells() / 100;
  ImproveOptions options = serial();
  const Result result = improve(mesh, options);
  ASSERT_GE(result.after.min_dihedral.min, 15);
  ASSERT_GT(mesh.n_cells(), usual);
  EXPECT_EQ(result.cell_bound.bound, mesh.n_cells());
  options.max_cells = 4 * mesh.n_cells();
  EXPECT_GT(improve(more, options).after.min_dihedral.min, result.after.min_dihedral.min + 1);
}

TEST(StuckCells, IterationsAreBlamedOnlyWhereTheyRanOut) {
  TetMesh mesh = jittered(5, 0.3, 2);
  ImproveOptions options = serial();
  options.iterations = 1;
  options.min_dihedral = 40;
  TetMesh early = mesh;
  const Result one = improve(early, options);
  EXPECT_GT(n_of(one.stuck, StuckReason::kIterations), 0U);
  EXPECT_EQ(n_of(one.stuck, StuckReason::kNotFound), 0U);
  options.iterations = 100'000;
  const Result all = improve(mesh, options);
  EXPECT_EQ(n_of(all.stuck, StuckReason::kIterations), 0U);
}

TEST(StuckCells, RunThatWasEndedSaysByWhat) {
  TetMesh mesh = jittered(4, 0.35, 2);
  ImproveOptions options = serial();
  options.cancel = [] { return true; };
  TetMesh cancelled = mesh;
  const Result result = improve(cancelled, options);
  EXPECT_EQ(n_of(result.stuck, StuckReason::kNotFound), 0U);
  EXPECT_GT(n_of(result.stuck, StuckReason::kCancelled), 0U);
  options.cancel = nullptr;
  options.time_limit = 1e-9;
  EXPECT_GT(n_of(improve(mesh, options).stuck, StuckReason::kTimeLimit), 0U);
}

}  // namespace
}  // namespace hfr::test
