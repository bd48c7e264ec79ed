// SPDX-License-Identifier: BSD-3-Clause
// Vertices that come to belong to other ranks: parts are then what they would be had the mesh been cut so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "Distributed/CellOrder.hh"
#include "Distributed/Labelled.hh"
#include "HalfFace/TupleMap.hh"

namespace hfr::test {
namespace {

/// Each vertex to some rank, or blocks of so many by number to each.
void change_owners(mpi::DistributedMesh& parts, std::uint64_t seed, std::uint64_t block) {
  std::vector<int> to(parts.part().n_vertices());
  const auto n = static_cast<std::uint64_t>(parts.comm().size());
  for (std::size_t v = 0; v < to.size(); ++v)
    to[v] = static_cast<int>(mix64(seed ^ mix64(parts.number(V(v)) / block)) % n);
  parts.change_owners(to);
}

TEST(ChangeOwners, PartsAreAsIfTheMeshHadBeenCutSo) {
  mpi::Comm comm(MPI_COMM_WORLD);
  for (const std::uint64_t block : {1U, 7U, 120U}) {
    Whole whole(valid_box(8, 0.3, block), VolumeLength{});
    for (CellHandle c : whole.mesh.cells()) whole.mesh.set_region(c, static_cast<int>(c.idx() % 3));
    const bool first = comm.rank() == 0;
    const auto owner = mpi::partition(comm, first ? &whole.mesh : nullptr, mpi::Partition::kCoordinates);
    mpi::DistributedMesh parts(comm);
    parts.scatter(&whole.mesh, &whole.work, owner);
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      change_owners(parts, seed, block);
      std::uint64_t n_own = 0;
      for (std::size_t v = 0; v < parts.part().n_vertices(); ++v) n_own += parts.is_own(V(v)) ? 1 : 0;
      EXPECT_EQ(comm.sum(n_own), whole.mesh.n_vertices()) << "each vertex has one owner";
      expect_part_of(parts, whole);
      Whole together = whole;
      gather_from_nothing(parts, together);
      if (first) expect_same(whole, together);
    }
  }
}

/// Labels of edges whose cells have no other labelled thing, far from the boundary, among them.
TEST(ChangeOwners, WhatIsLabelledStaysSo) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(10, 0.2, 1), 1, {0, 0, 400, 0, 0, 0, false}));
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    change_owners(parts, seed, 25);
    const mpi::PartsCheck checked = mpi::check(parts);
    EXPECT_TRUE(checked.is_good) << checked.message;
    mpi::write_vtu(parts, folder.path() / "parts.vtu");
    if (comm.rank() == 0) {
      io::write(folder.path() / "whole.vtu", io::read(path));
      EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
    }
    comm.sum(0);
  }
}

/// Which cells have changed is found by their numbers where the part has been cut anew.
TEST(ChangeOwners, AChangedCellIsFoundWhereverItStands) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const int bad = comm.size() - 1;
  for (const bool moves : {false, true}) {
    mpi::DistributedMesh parts(comm);
    mpi::GridOptions grid;
    grid.cavity.counts = {14, 12, 16};
    grid.cavity.amplitude = 0;
    mpi::generate_in_parts(parts, grid);
    const auto before = parts.copy();
    if (moves) {  // slices instead of blocks
      std::vector<int> to(parts.part().n_vertices());
      for (std::size_t v = 0; v < to.size(); ++v)
        to[v] = static_cast<int>(parts.number(V(v)) * static_cast<std::uint64_t>(comm.size()) /
                                 parts.n_vertices());
      parts.change_owners(to);
    }
    EXPECT_TRUE(mpi::check_changes(parts, *before).is_good);
    // One that no other rank holds, so that none can say that it is another there, and that no vertex names.
    const auto own_cell = [&] {
      const auto is_right = [&](CellHandle c) {
        return std::ranges::all_of(parts.part().cell(c).v, [&](VertexHandle v) {
          return parts.is_own(v) && parts.is_inside(v) && parts.part().incident_cell(v) != c;
        });
      };
      std::size_t c = 0;
      while (!is_right(C(c))) ++c;
      return C(c);
    };
    const CellHandle cell = comm.rank() == bad ? own_cell() : CellHandle();
    const auto change_star_size = [&](std::uint32_t by) {
      if (cell.is_valid()) parts.work().star_size[parts.part().cell(cell).v[0].idx()] += by;
    };
    using testing::HasSubstr;
    change_star_size(1);
    EXPECT_THAT(mpi::check_changes(parts, *before).message, HasSubstr("another number of cells"));
    change_star_size(0xffffffffU);
    EXPECT_TRUE(mpi::check_changes(parts, *before).is_good);

    const auto whole = parts.copy();
    if (cell.is_valid()) parts.part().delete_cell(cell);
    EXPECT_THAT(mpi::check_changes(parts, *whole).message, HasSubstr("another number of cells"));
    const auto without = parts.copy();
    parts.put_back(*whole);
    if (cell.is_valid()) {
      auto& v = TetMesh::Writer(parts.part()).cell(cell).v;
      std::swap(v[0], v[1]);
    }
    for (const auto* copy : {&before, &whole, &without}) {
      const mpi::PartsCheck found = mpi::check_changes(parts, **copy);
      EXPECT_FALSE(found.is_good) << moves;
      EXPECT_EQ(found.rank, bad) << moves;
      EXPECT_THAT(found.message, HasSubstr("see their face in the same order"));
    }
  }
}

/// With labels of all kinds, pinched vertices and inverted cells, before a run and after it.
TEST(ChangeOwners, RunsHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  std::uint64_t n_changed = 0, n_pinched = 0, n_invalid = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const bool is_valid = seed % 3 != 0;
    if (comm.rank() == 0)
      io::write_mesh(path, labelled(is_valid ? valid_box(5, 0.4, seed) : torn(4, 0.45, 0.8, seed), seed,
                                    density_of(seed)));
    comm.sum(0);
    ImproveOptions options = polish_towards(seed % 2 == 0 ? 14 : 22);
    options.polish_only = is_valid && seed < 5;
    const Result shared = expect_same_run(comm, folder, path, options, [&](mpi::DistributedMesh& parts) {
      n_pinched += mpi::pinches(parts).vertices.size();
      n_invalid += mpi::survey(parts).n_invalid;
      change_owners(parts, seed, seed % 2 == 0 ? 1 : 40);
    });
    n_changed += shared.changed ? 1 : 0;
  }
  EXPECT_GE(comm.from_first(n_changed), 4U);
  EXPECT_GT(comm.sum(n_pinched), 0U);
  EXPECT_GT(n_invalid, 0U);
}

/// Parts that have given cells away have no gaps from it: a run without a goal gives the same cells the same
/// new numbers, whatever was there before.
TEST(ChangeOwners, ARunWithoutAGoalReordersAsIfNothingHadBeen) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write(path, scattered_box(17));
  comm.sum(0);
  const ImproveOptions options = one_iteration();
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path);
  EXPECT_TRUE(mpi::is_scattered(parts)) << "the test shows nothing";
  expect_same_run(comm, folder, path, options,
                  [](mpi::DistributedMesh& some) { change_owners(some, 1, 200); });
}

/// A run leaves slots in a part whose cells it does not hold any more, and none free in the whole: what comes
/// after it, without a goal, does not depend on them. Beside it, the same with all of the mesh on this rank.
TEST(ChangeOwners, ASecondRunHasTheBytesThatItHasOnOneRank) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  const auto run_twice = [&](mpi::Comm& ranks, const char* out) {
    mpi::DistributedMesh parts(ranks);
    mpi::read_ranges(parts, path);
    ImproveOptions options = polish_towards(22);
    options.ops = Ops::kFace;
    EXPECT_TRUE(mpi::improve(parts, options).changed);
    std::uint64_t n_dead = 0;
    for (std::size_t c = 0; c < parts.part().n_cells(); ++c) n_dead += parts.part().is_deleted(C(c)) ? 1 : 0;
    n_dead = mpi::is_dense(parts) && mpi::is_scattered(parts) ? ranks.sum(n_dead) : 0;
    ImproveOptions rest;
    rest.policy = {};
    rest.iterations = 1;
    rest.passes_only = true;
    mpi::improve(parts, rest);
    mpi::write_vtu(parts, folder.path() / out);
    return n_dead;
  };
  std::uint64_t n_dead = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    if (comm.rank() == 0) {
      generate::Arrays box = generate::jittered_box({17, 17, 17}, 0.22, seed);
      std::mt19937_64 engine(seed);
      std::shuffle(box.cells.begin(), box.cells.end(), engine);
      io::write(path, build(box.points, box.cells));
    }
    comm.sum(0);
    n_dead += run_twice(comm, "parts.vtu");
    if (comm.rank() == 0) {
      mpi::Comm alone(MPI_COMM_SELF);
      run_twice(alone, "one.vtu");
      EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "one.vtu"));
    }
    comm.sum(0);
  }
  EXPECT_EQ(n_dead > 0, comm.size() > 1) << "where cells are put in order, some part has such slots";
}

}  // namespace
}  // namespace hfr::test
