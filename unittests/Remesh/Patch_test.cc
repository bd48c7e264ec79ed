// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Patch.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "HalfFace/Writer.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/Metrics.hh"
#include "Operators/Replace.hh"
#include "Operators/VertexCollapse.hh"
#include "Operators/VertexInsertion.hh"
#include "Remesh/DamagedMeshes.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/PatchSearch.hh"
#include "Remesh/Refine.hh"
#include "Remesh/StageBench.hh"

namespace hfr::test {
namespace {

/// Places of the corners of every cell, which do not depend on handles.
std::multiset<std::set<Place>> cells_by_place(const TetMesh& mesh) {
  std::multiset<std::set<Place>> all;
  for (CellHandle c : mesh.cells()) {
    std::set<Place> corners;
    for (VertexHandle v : mesh.cell(c).v) corners.insert(place_of(mesh, v));
    all.insert(corners);
  }
  return all;
}

std::map<int, double> region_volumes(const TetMesh& mesh) {
  std::map<int, double> volumes;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const Vec3 o = mesh.point(v[0]);
    volumes[mesh.region(c)] +=
        dot(mesh.point(v[1]) - o, cross(mesh.point(v[2]) - o, mesh.point(v[3]) - o)) / 6;
  }
  return volumes;
}

TEST(Patch, HoldsTheCellsAroundAndTheirPoints) {
  const TetMesh mesh = jittered(6, 0.2, 1);
  const CellHandle centre = C(mesh.n_cells() / 2);
  const Patch none(mesh, centre, 0);
  ASSERT_EQ(none.cells(), std::vector<CellHandle>{centre});
  const Patch patch(mesh, centre, 1);
  std::set<VertexHandle> corners(mesh.cell(centre).v.begin(), mesh.cell(centre).v.end());
  std::size_t n = 0;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    n += std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return corners.contains(u); }) ? 1 : 0;
  }
  EXPECT_EQ(patch.cells().size(), n);
  EXPECT_EQ(check(patch.mesh()), Ok);
  ASSERT_EQ(patch.mesh().n_cells(), n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(patch.vertices()[patch.mesh().cell(C(i)).v[k].idx()], mesh.cell(patch.cells()[i]).v[k]);
}

/// Expects of the workspace what one that is attached anew has; what is frozen, where the boundary stays.
/// What has changed waits to be looked at, and nothing else.
template <class Metric>
void put_back_with_workspace(const Patch& patch, TetMesh& mesh, const TetMesh& changed,
                             const Metric& metric) {
  Workspace work, anew;
  work.clock = anew.clock = 7;
  work.attach(mesh, {});
  work.set_qualities(mesh, metric, {});
  work.clear_touched();
  std::fill(work.changed.begin(), work.changed.end(), 3U);
  std::fill(work.pending.begin(), work.pending.end(), std::uint8_t{0});
  const TetMesh before = mesh;
  patch.put_back(mesh, changed, work);
  anew.attach(mesh, {});
  anew.set_qualities(mesh, metric, {});
  EXPECT_TRUE(work.has_qualities_of<Metric>());
  EXPECT_EQ(work.quality, anew.quality);
  EXPECT_EQ(work.star_size, anew.star_size);
  EXPECT_EQ(work.pinched, anew.pinched);
  EXPECT_EQ(work.claim.size(), mesh.n_cells());
  EXPECT_TRUE(work.all_touched);
  if (boundary_of(changed) == boundary_of(patch.mesh())) {
    EXPECT_EQ(work.frozen, anew.frozen);
  }
  std::set<VertexHandle> of_patch(patch.vertices().begin(), patch.vertices().end());
  for (std::size_t i = before.n_vertices(); i < mesh.n_vertices(); ++i) of_patch.insert(V(i));
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i)
    EXPECT_EQ(work.changed[i], of_patch.contains(V(i)) ? 7U : 3U) << i;
  const std::set<CellHandle> were_there(patch.cells().begin(), patch.cells().end());
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    const bool is_new = i >= before.n_cells() || before.is_deleted(C(i));
    const bool waits = were_there.contains(C(i)) || (is_new && !mesh.is_deleted(C(i)));
    EXPECT_EQ(work.pending[i], waits ? 0xff : 0) << i;
  }
}

TEST(Patch, PutBackUnchangedIsTheSameMesh) {
  TetMesh mesh = jittered(5, 0.2, 3);
  const auto before = cells_by_place(mesh);
  for (std::size_t i = 0; i < mesh.n_cells(); i += 101) {
    const Patch patch(mesh, C(i), 2);
    patch.put_back(mesh, patch.mesh());
    ASSERT_EQ(check(mesh), Ok);
  }
  EXPECT_TRUE(cells_by_place(mesh) == before);
}

/// A vertex in the middle of eight cells, and one cell more that has only this vertex in common with them.
TetMesh inner_vertex_with_a_cell_apart() {
  return build({{0, 0, 0},
                {1, 0, 0},
                {-1, 0, 0},
                {0, 1, 0},
                {0, -1, 0},
                {0, 0, 1},
                {0, 0, -1},
                {3, 0, 0},
                {3, 1, 0},
                {3, 0, 1}},
               std::vector<Corners>{{0, 1, 3, 5},
                                    {0, 3, 2, 5},
                                    {0, 2, 4, 5},
                                    {0, 4, 1, 5},
                                    {0, 3, 1, 6},
                                    {0, 2, 3, 6},
                                    {0, 4, 2, 6},
                                    {0, 1, 4, 6},
                                    {0, 7, 8, 9}});
}

/// A vertex is pinched after a patch was put back where it was so before and the patch leaves that alone; not
/// where the cell apart goes; and one is where the patch leaves two cells that have but this vertex in
/// common.
TEST(Patch, WorkspaceSaysWhichVerticesArePinched) {
  TetMesh mesh = inner_vertex_with_a_cell_apart();
  const Patch same(mesh, C(0), 2, pinched_vertices(mesh, star_sizes(mesh)));
  put_back_with_workspace(same, mesh, same.mesh(), MinSine2{});
  const auto without = [](const TetMesh& whole, std::span<const CellHandle> gone) {
    TetMesh left = whole;
    for (CellHandle c : gone) left.delete_cell(c);
    return left;
  };
  const Patch apart(mesh, C(8), 0);
  ASSERT_EQ(apart.cells().size(), 1U);
  put_back_with_workspace(apart, mesh, without(apart.mesh(), std::array{C(0)}), MinSine2{});
  ASSERT_TRUE(pinched_vertices(mesh, star_sizes(mesh)).empty());
  const Patch round(mesh, C(0), 2);
  ASSERT_EQ(round.cells().size(), 8U);
  // Of the eight cells, that of three positive axes and that of three negative ones.
  std::vector<CellHandle> gone;
  for (std::size_t i = 0; i < 8; ++i) {
    Vec3 middle;
    for (VertexHandle v : round.mesh().cell(C(i)).v) middle = middle + round.mesh().point(v);
    const int n_positive = (middle.x > 0 ? 1 : 0) + (middle.y > 0 ? 1 : 0) + (middle.z > 0 ? 1 : 0);
    if (n_positive != 0 && n_positive != 3) gone.push_back(C(i));
  }
  ASSERT_EQ(gone.size(), 6U);
  put_back_with_workspace(round, mesh, without(round.mesh(), gone), MinSine2{});
  EXPECT_FALSE(pinched_vertices(mesh, star_sizes(mesh)).empty());
}

/// Rounds leave a vertex pinched that is no longer, and one whose star has outgrown Star not pinched.
TEST(Workspace, LooksAgainForPinchedVertices) {
  constexpr Index kRing = Star::kCapacity + 20;
  std::vector<Vec3> points;
  std::vector<Corners> cells;
  for (Index i = 0; i < kRing; ++i) {
    const double turn = 2 * std::numbers::pi * i / kRing;
    points.push_back({std::cos(turn), std::sin(turn), 0});
    cells.push_back({kRing, kRing + 1, i, (i + 1) % kRing});
  }
  points.insert(points.end(), {{0, 0, -1}, {0, 0, 1}});
  const TetMesh mesh = build(std::move(points), cells);
  Workspace work;
  work.attach(mesh, {});
  const std::vector<std::uint8_t> expected = work.pinched;
  ASSERT_FALSE(expected.empty());
  work.pinched.clear();
  for (const int threads : {1, 3}) {
    work.look_again_for_pinched(mesh, {.threads = threads, .serial_below = 1});
    EXPECT_EQ(work.pinched, expected);
    work.pinched[4] = 1;
  }
  const TetMesh box = jittered(3, 0.2, 3);
  work.attach(box, {});
  ASSERT_TRUE(work.pinched.empty());
  work.pinched.assign(box.n_vertices(), 0);
  work.pinched[4] = 1;
  work.look_again_for_pinched(box, {});
  EXPECT_TRUE(work.pinched.empty());
}

TEST(Patch, VertexWithCellsThatThePatchDoesNotSeeStays) {
  const TetMesh mesh = inner_vertex_with_a_cell_apart();
  ASSERT_EQ(mesh.n_cells(), 9U);
  const auto pinched = pinched_vertices(mesh, star_sizes(mesh));
  ASSERT_FALSE(pinched.empty());
  ASSERT_TRUE(pinched[0] != 0);
  const Patch blind(mesh, C(0), 2);
  const Patch patch(mesh, C(0), 2, pinched);
  ASSERT_EQ(patch.cells().size(), 8U) << "the cell apart is in it";
  for (std::size_t i = 0; i < patch.vertices().size(); ++i)
    EXPECT_EQ(patch.mesh().is_fixed(VertexHandle(i)), patch.vertices()[i] == V(0));
  const VertexHandle middle(static_cast<std::size_t>(
      std::find(patch.vertices().begin(), patch.vertices().end(), V(0)) - patch.vertices().begin()));
  EXPECT_FALSE(blind.mesh().is_boundary(middle)) << "it no longer looks like an inner one";
}

/// Two flat cells on a common triangle; another region has the edge between their apexes already, if wanted.
TetMesh flat_pair(bool with_edge_elsewhere) {
  std::vector<Vec3> points = {{1, 0, 0}, {-0.5, 0.9, 0}, {-0.5, -0.9, 0}, {0, 0, 0.2}, {0, 0, -0.2}};
  std::vector<Corners> cells = {{0, 1, 2, 3}, {0, 2, 1, 4}};
  if (with_edge_elsewhere) {
    points.insert(points.end(), {{5, 0, 0}, {5, 5, 0}});
    cells.push_back({3, 4, 6, 5});
  }
  TetMesh mesh = build(std::move(points), cells);
  if (with_edge_elsewhere) mesh.set_region(C(2), 1);
  return mesh;
}

TEST(Patch, FitsUnlessItHasAnEdgeThatIsElsewhereAlready) {
  for (const bool elsewhere : {false, true}) {
    const TetMesh mesh = flat_pair(elsewhere);
    const Patch patch(mesh, C(0), 2);
    ASSERT_EQ(patch.cells().size(), 2U);
    TetMesh changed = patch.mesh();
    const auto quality = qualities(changed, MinSine2{});
    const FaceSwap<MinSine2> swap{MinSine2{}, quality};
    int swaps = 0;
    for (int k = 0; k < 4 && swaps == 0; ++k)
      if (changed.opposite_halfface(halfface_of(C(0), k)).is_valid())
        swaps += apply(swap, changed, halfface_of(C(0), k)) ? 1 : 0;
    ASSERT_EQ(swaps, 1);
    EXPECT_TRUE(patch.fits(mesh, patch.mesh()));
    EXPECT_EQ(patch.fits(mesh, changed), !elsewhere);
  }
}

TEST(Patch, WhatCameWentAndMovedArrives) {
  int came = 0;
  int went = 0;
  for (std::uint64_t s = 1; s <= 6; ++s) {
    TetMesh mesh = labelled_box(6, 0.2, s);
    const double all = volume(mesh);
    const auto boundary = boundary_of(mesh);
    const auto faces = places_of(mesh, mesh.labels().faces);
    const auto edges = places_of(mesh, mesh.labels().edges);
    const auto volumes = region_volumes(mesh);
    Engine engine(s);
    for (int turn = 0; turn < 6; ++turn) {
      CellHandle centre;
      do centre = C(engine() % mesh.n_cells());
      while (mesh.is_deleted(centre));
      const Patch patch(mesh, centre, 2);
      TetMesh changed = patch.mesh();
      for (std::size_t i = 0; i < 40; ++i) {
        const auto quality = qualities(changed, MinSine2{});
        const auto frozen = frozen_vertices(changed);
        const VertexHandle v = V(engine() % changed.n_vertices());
        const CellHandle c = C(engine() % changed.n_cells());
        if (!changed.is_deleted(v) && !frozen[v.idx()])
          went += apply(VertexCollapse<MinSine2>{{}, quality, frozen}, changed, v) ? 1 : 0;
        else if (!changed.is_deleted(c))
          came += apply(VertexInsertion<MinSine2>{{}, quality}, changed, VertexInsertion<MinSine2>::Seed(c));
      }
      const std::size_t n_vertices = mesh.n_logical_vertices();
      const std::size_t n_cells = mesh.n_logical_cells();
      if (turn % 2 == 0)
        put_back_with_workspace(patch, mesh, changed, MinSine2{});
      else
        put_back_with_workspace(patch, mesh, changed, MinDihedral{});
      EXPECT_EQ(mesh.n_logical_vertices() - n_vertices,
                changed.n_logical_vertices() - patch.mesh().n_logical_vertices());
      EXPECT_EQ(mesh.n_logical_cells() - n_cells, changed.n_logical_cells() - patch.cells().size());
      ASSERT_EQ(check(mesh), Ok);
    }
    EXPECT_NEAR(volume(mesh), all, 1e-12);
    for (const auto& [region, size] : region_volumes(mesh)) EXPECT_NEAR(size, volumes.at(region), 1e-12);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
    mesh.collect_garbage();
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_EQ(places_of(mesh, mesh.labels().faces), faces);
    EXPECT_EQ(places_of(mesh, mesh.labels().edges), edges);
  }
  EXPECT_GT(came, 20);
  EXPECT_GT(went, 20);
}

/// A box that went as far as the cheap operators take it.
TetMesh poor_box(std::uint64_t seed) {
  TetMesh mesh = jittered(5, 0.28, seed);
  ImproveOptions options = serial();
  options.ops = Ops::kEdge | Ops::kFace | Ops::kSmooth;
  improve(mesh, options);
  return mesh;
}

TEST(SearchPatches, RaisesTheWorstAndIsTheSameForAllThreads) {
  int raised = 0;
  for (std::uint64_t s = 1; s <= 4; ++s) {
    const TetMesh first = poor_box(s);
    const double before = smallest_dihedral(first, {});
    ASSERT_GT(before, 0);
    std::optional<TetMesh> alone;
    for (const int threads : {1, 2, 3, 7}) {
      TetMesh mesh = first;
      ImproveOptions options;
      options.policy = {threads, 1};
      StageBench bench(mesh, options);
      const bool changed = search_patches(bench.run, 40, kLittleEffort);
      EXPECT_EQ(check(mesh), Ok);
      EXPECT_NEAR(volume(mesh), volume(first), 1e-12);
      EXPECT_TRUE(boundary_of(mesh) == boundary_of(first));
      ASSERT_EQ(bench.control().passes().size(), 1U);
      EXPECT_EQ(bench.control().passes()[0].winners > 0, changed);
      EXPECT_EQ(identical(mesh, first), !changed);
      EXPECT_GE(smallest_dihedral(mesh, {}), before);
      if (threads == 1) raised += smallest_dihedral(mesh, {}) > before ? 1 : 0;
      if (!alone) alone = mesh;
      EXPECT_TRUE(identical(mesh, *alone)) << threads << " threads";
    }
  }
  EXPECT_GT(raised, 1);
}

TEST(SearchPatches, KeepsToTheBoundOnCellsAndSaysSo) {
  int held = 0;
  for (std::uint64_t s = 1; s <= 4; ++s) {
    TetMesh mesh = poor_box(s);
    ImproveOptions options = serial();
    options.max_cells = mesh.n_logical_cells();
    StageBench bench(mesh, options);
    search_patches(bench.run, 40, kLittleEffort);
    EXPECT_LE(mesh.n_logical_cells(), options.max_cells);
    held += bench.findings().met_cell_bound ? 1 : 0;
  }
  EXPECT_GT(held, 0);
}

/// Of these meshes, those that `with` raises, on so many threads.
std::vector<TetMesh> raised_by(const PatchEffort& with, const std::vector<TetMesh>& meshes, int threads) {
  std::vector<TetMesh> raised;
  for (const TetMesh& first : meshes) {
    TetMesh mesh = first;
    ImproveOptions options;
    options.policy = {threads, 1};
    StageBench bench(mesh, options);
    const bool has_changed = search_patches(bench.run, 60, with);
    EXPECT_GE(smallest_dihedral(mesh, {}), smallest_dihedral(first, {}));
    EXPECT_TRUE(boundary_of(mesh) == boundary_of(first));
    EXPECT_EQ(check(mesh), Ok);
    if (has_changed) raised.push_back(std::move(mesh));
  }
  return raised;
}

/// Six meshes that nothing of `without` raises any more.
std::vector<TetMesh> exhausted(const PatchEffort& without) {
  std::vector<TetMesh> meshes;
  const ImproveOptions options = serial();
  for (std::uint64_t s = 1; s <= 6; ++s) {
    TetMesh& mesh = meshes.emplace_back(poor_box(s));
    StageBench bench(mesh, options);
    while (search_patches(bench.run, 60, without)) {
    }
  }
  return meshes;
}

TEST(SearchPatches, TakesVerticesOutWhereNothingElseHelps) {
  PatchEffort without = kLittleEffort;
  without.vertices = 0;
  without.removals = 0;
  PatchEffort with = without;
  with.removals = kLittleEffort.removals;
  EXPECT_GT(raised_by(with, exhausted(without), 1).size(), 1U);
}

TEST(SearchPatches, PutsAVertexElsewhereWhereTakingOneOutIsNotEnough) {
  PatchEffort without = kLittleEffort;
  without.rows = without.vertices = 0;
  without.few = 200;
  PatchEffort with = without;
  with.replaces = true;
  const std::vector<TetMesh> meshes = exhausted(without);
  const std::vector<TetMesh> raised = raised_by(with, meshes, 1), other = raised_by(with, meshes, 3);
  EXPECT_GT(raised.size(), 1U);
  ASSERT_EQ(raised.size(), other.size());
  for (std::size_t i = 0; i < raised.size(); ++i) EXPECT_TRUE(identical(raised[i], other[i])) << i;
}

TEST(SearchPatches, LeavesDearerTriesToTheNextTurnWhereOneHasHelped) {
  PatchEffort all = kLittleEffort;
  all.few = 1000;
  all.patches = 1;
  all.turns = 1;
  all.degrees = 5;  // more than tries come to at once
  PatchEffort first = all;
  first.rows = first.vertices = first.removals = 0;
  int helped = 0;
  for (std::uint64_t s = 1; s <= 6; ++s) {
    TetMesh mesh = poor_box(s);
    TetMesh other = mesh;
    const ImproveOptions options = serial();
    StageBench bench(mesh, options), other_bench(other, options);
    if (!search_patches(bench.run, 60, first)) continue;
    ++helped;
    EXPECT_TRUE(search_patches(other_bench.run, 60, all));
    EXPECT_TRUE(identical(mesh, other)) << s;
  }
  EXPECT_GT(helped, 2);
}

TEST(SearchPatches, PutsAnApexOverEachNeedleOfABandAtOnce) {
  PatchEffort effort = kLittleEffort;
  effort.vertices = 0;
  effort.removals = 0;
  int raised = 0;
  for (const double height : {7.0, 7.5, 8.0, 8.5, 9.0, 9.5, 10.0, 10.5, 11.0, 11.5, 12.0}) {
    // Round the side lie needles, their short sides up and down by turns.
    TetMesh first = built(generate::cylinder(4, 2, 1, height));
    ImproveOptions options = serial();
    options.max_cells = 3400;
    options.iterations = 30;  // without patches
    improve(first, options);
    options = serial();
    const auto with_rows = [&](std::size_t rows) {
      effort.rows = rows;
      TetMesh mesh = first;
      StageBench bench(mesh, options);
      search_patches(bench.run, 20, effort);
      EXPECT_EQ(check(mesh), Ok);
      EXPECT_TRUE(boundary_of(mesh) == boundary_of(first));
      return smallest_dihedral(mesh, {});
    };
    const double without = with_rows(0);
    const double with = with_rows(kNeedleRows);
    raised += with > 1.05 * without ? 1 : 0;
  }
  EXPECT_GT(raised, 1);
}

TEST(SearchPatches, LeavesAMeshThatIsPoorThroughoutAlone) {
  TetMesh mesh = jittered(6, 0.1, 1);
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    mesh.set_point(v, {p.x, p.y, 1e-3 * p.z});
  }
  const TetMesh first = mesh;
  const ImproveOptions options = serial();
  StageBench bench(mesh, options);
  EXPECT_FALSE(search_patches(bench.run, 40, kLittleEffort));
  EXPECT_TRUE(identical(mesh, first));
}

TEST(Refine, StopsWhereTheBoundOnCellsLeavesNoRoom) {
  const TetMesh first = jittered(6, 0.2, 2);
  for (const std::size_t room : {0U, 40U, 100'000U}) {
    TetMesh mesh = first;
    ImproveOptions options = serial();
    options.ops = Ops::kInsert;
    options.max_cells = first.n_logical_cells() + room;
    StageBench bench(mesh, options);
    insert_where_poor(bench.run, {.below = 30, .gain = 1.1});
    EXPECT_LE(mesh.n_logical_cells(), options.max_cells);
    EXPECT_EQ(mesh.n_logical_cells() > first.n_logical_cells(), room > 0);
    EXPECT_EQ(bench.findings().met_cell_bound, room < 100'000);
    if (room == 0) {
      EXPECT_TRUE(bench.control().passes().empty()) << "seeds were evaluated in vain";
    }
    std::size_t n_seeds = 0;
    for (const PassReport& pass : bench.control().passes()) n_seeds += pass.seeds;
    if (room == 40) {
      EXPECT_LT(n_seeds, n_below(first, 30, {}));
    }
  }
}

TEST(Refine, LetsPoorCellsMultiplyOnlyWhereNothingIsSpared) {
  const TetMesh first = jittered(4, 0.3, 2);
  std::array<std::size_t, 2> more_poor{};
  for (const bool spare : {true, false}) {
    TetMesh mesh = first;
    ImproveOptions options = serial();
    options.ops = Ops::kInsert;
    StageBench bench(mesh, options);
    bench.run.may_add_poor_cells = !spare;
    insert_where_poor(bench.run, {.below = 45, .gain = 1.05});
    const std::size_t n_new = mesh.n_logical_vertices() - first.n_logical_vertices();
    ASSERT_GT(n_new, 20U);
    const std::size_t n_poor = n_below(mesh, 45, {});
    if (spare) {
      EXPECT_LE(n_poor, n_below(first, 45, {}) + VertexInsertion<MinSine2>::kMorePoor * n_new);
    }
    more_poor[spare ? 0 : 1] = n_poor;
  }
  EXPECT_GT(more_poor[1], more_poor[0]);
}

TEST(SearchPatches, EdgeThatAnotherRegionHasIsNotMadeAgain) {
  for (const bool elsewhere : {false, true}) {
    TetMesh mesh = flat_pair(elsewhere);
    ASSERT_GT(smallest_dihedral(mesh, {}), 0);
    const ImproveOptions options = serial();
    StageBench bench(mesh, options);
    EXPECT_EQ(bench.run.work.pinched.empty(), !elsewhere);
    EXPECT_EQ(search_patches(bench.run, 40, kLittleEffort), !elsewhere);
    EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
  }
}

TEST(SearchPatches, MeshWhoseCellsLieOverOneAnotherGetsNoFaceOfThreeCells) {
  TetMesh mesh = glued_over_itself();
  ImproveOptions options = serial();
  options.ops = Ops::kEdge | Ops::kInsert;
  options.min_dihedral = 10;
  ASSERT_NO_THROW(improve(mesh, options));
  EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
}

TEST(SearchPatches, LeavesAMeshWithInvalidCellsAlone) {
  TetMesh mesh = small_cavity();
  const TetMesh first = mesh;
  ImproveOptions options = serial();
  StageBench bench(mesh, options);
  EXPECT_FALSE(search_patches(bench.run, 40, kLittleEffort));
  EXPECT_TRUE(identical(mesh, first));
}

}  // namespace
}  // namespace hfr::test
