// SPDX-License-Identifier: BSD-3-Clause
// All stages of a run over a mesh in parts, beside shared memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "Distributed/CellOrder.hh"
#include "Distributed/Labelled.hh"
#include "Distributed/PartPatchSearch.hh"
#include "HalfFace/Reorder.hh"
#include "Operators/VertexCollapse.hh"
#include "Remesh/Beside.hh"
#include "Remesh/Patch.hh"

namespace hfr::test {
namespace {

ImproveOptions passes_only() {
  ImproveOptions options;
  options.passes_only = true;
  options.policy = {};
  return options;
}

ImproveOptions all_stages() {
  ImproveOptions options;
  options.policy = {};
  return options;
}

/// Its points and cells, numbered in an order that has nothing to do with where they lie.
TetMesh shuffled(const TetMesh& mesh, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<Index> to(mesh.n_vertices());
  std::iota(to.begin(), to.end(), Index{0});
  std::shuffle(to.begin(), to.end(), engine);
  std::vector<Vec3> points(mesh.n_vertices());
  for (std::size_t i = 0; i < to.size(); ++i) points[to[i]] = mesh.point(V(i));
  std::vector<std::array<Index, 4>> cells;
  for (CellHandle c : mesh.cells()) {
    std::array<Index, 4> corners{};
    std::ranges::transform(mesh.cell(c).v, corners.begin(), [&](VertexHandle v) { return to[v.idx()]; });
    cells.push_back(corners);
  }
  std::shuffle(cells.begin(), cells.end(), engine);
  return build(points, cells);
}

TetMesh cavity(generate::Counts counts, double jitter, double amplitude) {
  generate::CavityOptions options;
  options.counts = counts;
  options.jitter = jitter;
  options.amplitude = amplitude;
  const generate::Arrays arrays = generate::cavity(options);
  return build(arrays.points, arrays.cells);
}

/// Each coordinate times a factor.
TetMesh stretched(TetMesh mesh, Vec3 by) {
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    mesh.set_point(v, {p.x * by.x, p.y * by.y, p.z * by.z});
  }
  return mesh;
}

/// A layer of cubes: no vertex lies inside.
TetMesh plate(Index n, std::uint64_t seed) {
  generate::Arrays arrays = generate::box({n, n, 1}, {0, 0, 0}, {1.0 * n, 1.0 * n, 0.6});
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> by(-0.2, 0.2);
  for (Vec3& p : arrays.points)
    if (p.x > 0 && p.y > 0 && p.x < n && p.y < n) p = {p.x + by(engine), p.y + by(engine), p.z};
  return build(arrays.points, arrays.cells);
}

/// What runs of a test have come to: their stages, and how many went back to what there was before.
struct Stages {
  std::set<std::string> names;
  std::size_t undone = 0, n_patched = 0, n_inserted = 0;

  void add(const Result& result) {
    for (const PassReport& pass : result.passes) {
      names.insert(pass.stage);
      undone += pass.stage == "undo" ? 1 : 0;
      n_patched += pass.stage == "patches" ? pass.winners : 0;
      n_inserted += pass.stage != "patches" && pass.op == "insert" ? pass.winners : 0;
    }
  }
};

class StagesInParts : public testing::Test {
 protected:
  Stages run(const TetMesh& mesh, const ImproveOptions& options) {
    if (comm.rank() == 0) io::write(path, mesh);
    comm.sum(0);
    Stages stages;
    stages.add(expect_same_run(comm, folder, path, options));
    return stages;
  }

  mpi::Comm comm{MPI_COMM_WORLD};
  SharedFolder folder{comm};
  std::filesystem::path path = folder.path() / "in.vtu";
};

TEST_F(StagesInParts, ARunOverAllCellsHasTheBytesOfSharedMemory) {
  const Stages stages = run(cavity({6, 6, 6}, 0.3, 0), passes_only());
  if (comm.rank() == 0) {
    EXPECT_THAT(stages.names, testing::IsSupersetOf({"bulk", "polish", "finish", "refine"}));
  }
  run(valid_box(8, 0.3, 1), passes_only());
}

/// Where a slab is mended, no cell is left for more vertices; in the other box some are.
TEST_F(StagesInParts, TangledMeshesHaveTheBytesOfSharedMemory) {
  Stages stages = run(cavity({2, 9, 9}, 0.45, 0.05), passes_only());
  const Stages thicker = run(cavity({3, 7, 7}, 0.4, 0.05), passes_only());
  stages.names.insert(thicker.names.begin(), thicker.names.end());
  if (comm.rank() == 0) {
    EXPECT_THAT(stages.names, testing::IsSupersetOf({"untangle", "bulk", "refine"}));
    EXPECT_GT(stages.undone, 0U) << "no try is put back";
  }
}

TEST_F(StagesInParts, WhereAGoalIsMissedTheOtherStagesFollow) {
  for (const double goal : {14.0, 33.0}) {
    SCOPED_TRACE(goal);
    ImproveOptions options = passes_only();
    options.min_dihedral = goal;
    const Stages stages = run(valid_box(7, 0.34, 3), options);
    if (comm.rank() == 0) {
      EXPECT_EQ(stages.names.count("bulk"), goal > 20 ? 1U : 0U);
    }
  }
}

/// Poor throughout, with vertices that may move and without.
TEST_F(StagesInParts, PoorMeshesHaveTheBytesOfSharedMemory) {
  for (const TetMesh& mesh : {stretched(valid_box(6, 0.3, 4), {1, 1, 0.12}), plate(8, 5)}) {
    const Stages stages = run(mesh, passes_only());
    if (comm.rank() == 0) {
      EXPECT_EQ(stages.names.count("bulk"), 1U);
    }
  }
}

/// The searches for the last cells as well.
TEST_F(StagesInParts, WholeRunsHaveTheBytesOfSharedMemory) {
  std::vector<TetMesh> meshes = {cavity({6, 6, 6}, 0.3, 0), cavity({2, 9, 9}, 0.3, 0.05),
                                 valid_box(7, 0.34, 3), plate(8, 5),
                                 stretched(valid_box(4, 0.1, 7), {1, 1, 0.05})};
  Stages all;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    SCOPED_TRACE(i);
    const Stages stages = run(meshes[i], all_stages());
    all.names.insert(stages.names.begin(), stages.names.end());
    all.n_patched += stages.n_patched;
  }
  ImproveOptions options = all_stages();
  options.min_dihedral = 24;
  run(meshes[2], options);
  if (comm.rank() == 0) {
    EXPECT_THAT(all.names, testing::IsSupersetOf({"neighbourhoods", "patches"}));
    EXPECT_GT(all.n_patched, 5U);
  }
}

/// Cells that are held, or worked for in vain, and others whose turn comes all the same.
TEST_F(StagesInParts, CellsThatNothingRaisesHaveTheBytesOfSharedMemory) {
  ImproveOptions goal = all_stages();
  goal.min_dihedral = 12;
  for (const ImproveOptions& options : {all_stages(), goal}) {
    for (const TetMesh& mesh : {beside_slivers(ring(64, 0), 90), beside_plates(ring(64, 0), 12)}) {
      const Stages stages = run(mesh, options);
      if (comm.rank() == 0) {
        EXPECT_GT(stages.n_inserted, 3U) << "the others do not get their turn";
      }
    }
  }
}

TEST_F(StagesInParts, WholeRunsOverTangledMeshesHaveTheBytesOfSharedMemory) {
  run(cavity({2, 9, 9}, 0.45, 0.05), all_stages());
  ImproveOptions options = all_stages();
  options.max_cells = 700;
  run(cavity({4, 5, 5}, 0.3, 0.2), options);
}

TEST_F(StagesInParts, WholeRunsOverLabelledMeshesHaveTheBytesOfSharedMemory) {
  for (const std::uint64_t seed : {1, 4}) {
    SCOPED_TRACE(seed);
    if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(5, 0.33, seed), seed, density_of(seed)));
    comm.sum(0);
    expect_same_run(comm, folder, path, all_stages());
  }
}

TEST_F(StagesInParts, AnyCostHasTheBytesOfSharedMemory) {
  ImproveOptions options = all_stages();
  options.raise_min_dihedral = true;
  run(cavity({2, 2, 3}, 0.25, 0.05), options);
}

TEST_F(StagesInParts, OptionsHaveTheBytesOfSharedMemory) {
  const std::vector<std::function<void(ImproveOptions&)>> changes = {
      [](auto& o) { o.iterations = 2, o.passes_only = false, o.policy.threads = 2; },
      [](auto& o) { o.rounds = Rounds::kMixed; },
      [](auto& o) { o.rounds = Rounds::kByKind, o.bulk_nodes = true; },
      [](auto& o) { o.ops = without(Ops::kDefault, Ops::kInsert) | Ops::kCluster; },
      [](auto& o) { o.max_cells = 1100, o.seed = 7; },
      [](auto& o) { o.coarsen = true; },
      [](auto& o) { o.ops = Ops::kSmooth; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    SCOPED_TRACE(i);
    ImproveOptions options = passes_only();
    changes[i](options);
    run(valid_box(5, 0.33, 6), options);
  }
}

/// With regions, labels and fixed vertices.
TEST_F(StagesInParts, LabelledMeshesHaveTheBytesOfSharedMemory) {
  for (const std::uint64_t seed : {1, 2, 5}) {
    SCOPED_TRACE(seed);
    if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(5, 0.3, seed), seed, density_of(seed)));
    comm.sum(0);
    expect_same_run(comm, folder, path, passes_only());
  }
}

/// With the slots, numbers and vertices that shared memory gives them: the first patch leaves slots, which
/// the second takes, and more; vertices come and go.
TEST(PartPatchSearch, PatchesThatShrinkAndGrowComeHome) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Whole whole(valid_box(7, 0.3, 5), MinSine2{});
  Whole cut = whole;
  const auto owner =
      mpi::partition(comm, comm.rank() == 0 ? &cut.mesh : nullptr, mpi::Partition::kCoordinates);
  mpi::DistributedMesh parts(comm);
  parts.scatter(&cut.mesh, &cut.work, owner);
  const std::vector<std::uint64_t> centres = {whole.mesh.n_cells() - 150, 150};
  const auto shrunk = [](TetMesh mesh) {
    const std::vector<std::uint8_t> frozen = constrained_vertices(mesh, {});
    const std::vector<double> nothing_to_lose(mesh.n_cells(), 0);
    for (std::size_t v = 0, n = 0; v < mesh.n_vertices() && n < 1; ++v)
      if (frozen[v] == 0 && apply(VertexCollapse<MinSine2>{MinSine2{}, nothing_to_lose, frozen}, mesh, V(v)))
        ++n;
    return mesh;
  };
  const auto grown = [](TetMesh mesh) {
    for (std::size_t i = 0; i < 9; ++i) mesh.split_cell(C(i));
    return mesh;
  };
  const auto change = [&](const TetMesh& mesh, std::span<const CellHandle> worst, const auto& put) {
    const Patch first(mesh, worst[0], 1), second(mesh, worst[1], 1);
    const TetMesh small = shrunk(first.mesh()), large = grown(second.mesh());
    EXPECT_LT(small.n_logical_cells(), first.cells().size());
    EXPECT_GT(large.n_logical_cells() - second.cells().size(),
              first.cells().size() - small.n_logical_cells() + 2);
    put(first, small);
    put(second, large);
  };
  const auto done = mpi::search_patches_in_parts(parts, centres, 1, nullptr, [&](PatchPlace& place) {
    change(place.mesh(), place.worst(),
           [&](const Patch& patch, const TetMesh& changed) { place.put_back(patch, changed); });
    return PatchesDone{2, 2, 2, true, false, false};
  });
  EXPECT_EQ(done.n_changed, 2U);
  const std::vector<CellHandle> worst = {C(centres[0]), C(centres[1])};
  change(whole.mesh, worst,
         [&](const Patch& patch, const TetMesh& changed) { patch.put_back(whole.mesh, changed); });
  whole.work.attach(whole.mesh, {});
  whole.work.set_qualities(whole.mesh, MinSine2{}, {});
  parts.work().set_qualities(parts.part(), MinSine2{}, {});
  EXPECT_EQ(check(whole.mesh), Ok);
  EXPECT_EQ(parts.n_cells(), whole.mesh.n_logical_cells());
  expect_part_of(parts, whole);
  gather_from_nothing(parts, cut);
  if (comm.rank() == 0) {
    EXPECT_TRUE(identical(whole.mesh, cut.mesh));
  }
}

TEST(PartPatchSearch, EachRankTriesOnSomeOfThePatchesAndAllLearnWhatCounts) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Whole whole(valid_box(6, 0.3, 5), MinSine2{});
  const auto owner =
      mpi::partition(comm, comm.rank() == 0 ? &whole.mesh : nullptr, mpi::Partition::kCoordinates);
  mpi::DistributedMesh parts(comm);
  parts.scatter(&whole.mesh, &whole.work, owner);
  const std::vector<std::uint64_t> centres = {whole.mesh.n_cells() - 100, 100};
  bool was_here = false;
  mpi::search_patches_in_parts(parts, centres, 1, nullptr, [&](PatchPlace& place) {
    was_here = true;
    const auto n_cells = static_cast<double>(place.mesh().n_cells());
    EXPECT_EQ(comm.min(n_cells), -comm.min(-n_cells)) << "ranks have other surroundings";
    std::vector<PatchVerdict> verdicts(7);
    std::uint64_t n_mine = 0;
    for (std::uint32_t i = 0; i < verdicts.size(); ++i) {
      if (!place.tries_on(i)) continue;
      ++n_mine;
      if (i != 4) verdicts[i] = {i + 10, i == 2};
    }
    EXPECT_EQ(comm.sum(n_mine), verdicts.size()) << "each patch is one rank's";
    EXPECT_EQ(place.share(verdicts), comm.rank() == 0);
    for (std::uint32_t i = 0; i < verdicts.size(); ++i) {
      EXPECT_EQ(verdicts[i].best, i == 4 ? PatchVerdict::kNone : i + 10);
      EXPECT_EQ(verdicts[i].held_back, i == 2);
    }
    return PatchesDone();
  });
  EXPECT_TRUE(was_here);
}

/// Cutouts, patches, percentiles and tries that are put back included.
TEST_F(StagesInParts, ARankThatFailsAnywhereEndsAll) {
  if (comm.rank() == 0) io::write(path, cavity({2, 6, 6}, 0.4, 0.05));
  comm.sum(0);
  const auto run = [&](int bad, std::uint64_t call) -> std::uint64_t {
    mpi::Comm own(MPI_COMM_WORLD);
    if (own.rank() == bad) own.fail_at_call(call);
    try {
      mpi::DistributedMesh parts(own);
      mpi::read_ranges(parts, path);
      mpi::improve(parts, all_stages());
      EXPECT_EQ(call, 0U);
    } catch (const mpi::RankFailed& failed) {
      EXPECT_EQ(failed.rank(), bad);
    } catch (const ResourceLimit& error) {
      EXPECT_EQ(own.rank(), bad);
      EXPECT_EQ(own.fail(5, error.what()).rank(), bad);
    }
    return own.n_calls();
  };
  const std::uint64_t n_calls = run(0, 0);
  if (comm.size() == 1) return;
  constexpr std::uint64_t kTimes = 6;
  for (std::uint64_t k = 0; k < kTimes; ++k)
    run(k % 2 == 0 ? 0 : comm.size() - 1, n_calls * (2 * k + 1) / (2 * kTimes));
}

/// Cells of which most have neighbours far away in memory are put in order first, here as there.
TEST_F(StagesInParts, ScatteredCellsComeInOrder) {
  const TetMesh mesh = shuffled(valid_box(17, 0.2, 7), 8);
  // The same as small as one place of the curve, beside a large cell: numbers decide alone.
  TetMesh speck = stretched(mesh, {1e-9, 1e-9, 1e-9});
  std::array<VertexHandle, 4> corners;
  for (std::size_t k = 0; k < 4; ++k)
    corners[k] = speck.add_vertex({k == 1 ? 2.0 : 1.0, k == 2 ? 2.0 : 1.0, k == 3 ? 2.0 : 1.0});
  speck.add_cell(corners[0], corners[1], corners[2], corners[3]);
  for (const TetMesh* whole : std::initializer_list<const TetMesh*>{&mesh, &speck}) {
    ASSERT_TRUE(is_scattered(*whole));
    if (comm.rank() == 0) io::write(path, *whole);
    comm.sum(0);
    mpi::DistributedMesh parts(comm);
    mpi::read_ranges(parts, path, 300);
    ASSERT_TRUE(mpi::is_dense(parts));
    EXPECT_TRUE(mpi::is_scattered(parts));
    const std::vector<std::uint64_t> old = parts.renumber(mpi::numbers_along_curve(parts));
    EXPECT_TRUE(mpi::check(parts).is_good);
    TetMesh ordered = *whole;
    const GarbageMap map = reorder(ordered, {.curve = SpaceCurve::kMorton, .vertices = false});
    EXPECT_EQ(mpi::is_scattered(parts), is_scattered(ordered));
    std::size_t n_others = 0;  // all ranks go on together, whatever one has found
    for (std::size_t i = 0; i < parts.part().n_cells(); ++i) {
      const CellHandle there = map.cells[old[i]];
      bool is_other = parts.number(C(i)) != there.idx() || parts.cell_at(there.idx()) != C(i);
      for (std::size_t k = 0; k < 4; ++k)
        is_other |= parts.number(parts.part().cell(C(i)).v[k]) != ordered.cell(there).v[k].idx();
      n_others += is_other ? 1 : 0;
    }
    EXPECT_EQ(n_others, 0U);
    parts.renumber(old);  // as it was
    EXPECT_TRUE(mpi::check(parts).is_good);
    mpi::write_vtu(parts, folder.path() / "again.vtu");
    if (comm.rank() == 0) {
      EXPECT_TRUE(bytes_of(folder.path() / "again.vtu") == bytes_of(path));
    }
    comm.sum(0);
  }
  ImproveOptions options = passes_only();
  options.iterations = 1;
  run(mesh, options);
  // Where nothing is changed, they have their old order in the end.
  options.ops = Ops::kInsert;
  options.max_cells = 1;
  EXPECT_FALSE(expect_same_run(comm, folder, path, options).changed);
}

}  // namespace
}  // namespace hfr::test
