// SPDX-License-Identifier: BSD-3-Clause
// Damage in one place, whose cells other ranks work on.
#include "Distributed/WorkBalance.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "Distributed/Labelled.hh"
#include "Distributed/OwnItems.hh"
#include "Remesh/Survey.hh"

namespace hfr::test {
namespace {

using testing::ElementsAre;

TEST(WorkBalance, NobodyIsLeftWithMoreThanTheAverage) {
  const std::vector<std::uint64_t> counts = {100, 0, 20, 40};
  EXPECT_THAT(mpi::gifts(counts, 0), ElementsAre(0, 40, 20, 0));
  for (int rank : {1, 2, 3}) EXPECT_THAT(mpi::gifts(counts, rank), ElementsAre(0, 0, 0, 0));
  for (const std::vector<std::uint64_t>& some :
       {std::vector<std::uint64_t>{7}, {0, 0, 0}, {3, 3}, {1, 0, 0, 0}, {5, 900, 17, 2, 900, 0}}) {
    std::vector<std::uint64_t> left = some;
    for (std::size_t giver = 0; giver < some.size(); ++giver) {
      const std::vector<std::uint64_t> given = mpi::gifts(some, static_cast<int>(giver));
      for (std::size_t r = 0; r < given.size(); ++r) left[giver] -= given[r], left[r] += given[r];
    }
    const std::uint64_t all = std::accumulate(some.begin(), some.end(), std::uint64_t{0});
    for (std::uint64_t n : left) EXPECT_LE(n, (all + some.size() - 1) / some.size());
  }
}

/// A box whose cells are regular but for a corner of it.
TetMesh box_with_a_poor_corner(Index n, double jitter) {
  const TetMesh poor = valid_box(n, jitter, 5);
  TetMesh mesh = jittered(n, 0, 5);
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    if (p.x < 0.5 && p.y < 0.5 && p.z < 0.5) mesh.set_point(v, poor.point(v));
  }
  return mesh;
}

std::vector<std::uint64_t> owned(const mpi::DistributedMesh& parts) {
  std::vector<std::uint64_t> numbers;
  for (std::size_t v = 0; v < parts.part().n_vertices(); ++v)
    if (parts.is_own(V(v))) numbers.push_back(parts.number(V(v)));
  return numbers;
}

TEST(WorkBalance, PoorCellsAreSharedOutAndGivenBack) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Whole whole(box_with_a_poor_corner(14, 0.45), MinSine2{});
  const bool first = comm.rank() == 0;
  const auto owner = mpi::partition(comm, first ? &whole.mesh : nullptr, mpi::Partition::kNumbers);
  mpi::DistributedMesh parts(comm);
  parts.scatter(&whole.mesh, &whole.work, owner);
  const std::vector<std::uint64_t> before = owned(parts);
  const auto most_poor = [&] {
    std::uint64_t n = 0;
    for (CellHandle c : cells_below(parts.part(), 30, {})) n += parts.is_own(c) ? 1 : 0;
    return -comm.min(-static_cast<double>(n));
  };
  const double all = static_cast<double>(n_below(whole.mesh, 30, {})), most_before = most_poor();
  mpi::WorkBalance balance(parts, 30, {});
  expect_part_of(parts, whole);
  if (comm.size() > 1) {
    EXPECT_GT(most_before, 1.5 * all / comm.size());
    EXPECT_LT(most_poor(), 1.1 * all / comm.size()) << "a vertex has some cells";
    EXPECT_GT(comm.sum(balance.n_borrowed()), 0U);
  }
  balance.give_back();
  EXPECT_EQ(owned(parts), before);
  expect_part_of(parts, whole);
}

TEST(WorkBalance, WhereItSavesLessThanItTakesNothingIsHandedOver) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Whole whole(valid_box(8, 0.3, 2), MinSine2{});  // poor everywhere
  const auto owner = mpi::partition(comm, comm.rank() == 0 ? &whole.mesh : nullptr, mpi::Partition::kNumbers);
  mpi::DistributedMesh parts(comm);
  parts.scatter(&whole.mesh, &whole.work, owner);
  const std::vector<std::uint64_t> before = owned(parts);
  EXPECT_EQ(mpi::WorkBalance(parts, 30, {}).n_borrowed(), 0U);
  EXPECT_EQ(owned(parts), before);
}

/// As many poor cells with many good ones between them are not worth it.
TEST(WorkBalance, WherePoorCellsLieFarApartNothingIsHandedOver) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const TetMesh poor = jittered(22, 0.35, 5);
  TetMesh mesh = jittered(22, 0, 5);
  for (VertexHandle v : mesh.vertices())
    if (mesh.point(v).z < 0.5 && mix64(v.idx()) % 8 == 0) mesh.set_point(v, poor.point(v));
  Whole whole(std::move(mesh), MinSine2{});
  const auto owner = mpi::partition(comm, comm.rank() == 0 ? &whole.mesh : nullptr, mpi::Partition::kNumbers);
  mpi::DistributedMesh parts(comm);
  parts.scatter(&whole.mesh, &whole.work, owner);
  double mine = 0;
  for (CellHandle c : cells_below(parts.part(), 30, {})) mine += parts.is_own(c) ? 1 : 0;
  const double all = static_cast<double>(n_below(whole.mesh, 30, {})),
               saved = -comm.min(-mine) - all / comm.size();
  if (comm.size() > 1) {
    const double most_held = -comm.min(-static_cast<double>(parts.part().n_cells()));
    EXPECT_GT(saved, 100 + most_held / 200) << "the first look refuses already, and the test shows nothing";
  }
  EXPECT_EQ(comm.sum(mpi::WorkBalance(parts, 30, {}).n_borrowed()), 0U);
}

/// Runs in which vertices come and go, with labels: the bytes are the same, and afterwards each rank
/// has what it had.
TEST(WorkBalance, RunsHaveTheBytesOfSharedMemoryAndEachRankWhatItHad) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  std::uint64_t n_new = 0;
  for (std::uint64_t seed : {4, 6}) {
    if (comm.rank() == 0)
      io::write_mesh(path, labelled(box_with_a_poor_corner(12, 0.5), seed, {1, 200, 300, 9, 0, 0, true}));
    comm.sum(0);
    const ImproveOptions options = polish_towards(seed == 4 ? 30 : 35);
    const Result shared = expect_same_run(comm, folder, path, options);
    if (comm.rank() == 0) {
      EXPECT_TRUE(shared.changed);
    }
    mpi::DistributedMesh parts(comm);
    mpi::read_ranges(parts, path);
    std::vector<std::uint64_t> before = owned(parts);
    const std::uint64_t n_before = parts.n_vertices();
    const mpi::PartsResult result = mpi::improve(parts, options);
    const std::uint64_t n_borrowed = comm.sum(result.mine.n_borrowed);
    EXPECT_EQ(n_borrowed > 0, comm.size() > 1);
    std::vector<std::uint64_t> after = owned(parts);
    std::erase_if(after, [&](std::uint64_t number) { return number >= n_before; });
    // What has been deleted stays with whoever deleted it.
    const auto is_gone = [&](std::uint64_t number) {
      const VertexHandle v = parts.vertex_at(number);
      if (!v.is_valid() || parts.part().is_deleted(v)) return true;
      const CellHandle c = parts.part().incident_cell(v);
      return !c.is_valid() || parts.part().is_deleted(c) || !parts.part().cell(c).has(v);
    };
    std::erase_if(before, is_gone);
    std::erase_if(after, is_gone);
    EXPECT_EQ(after, before);
    // What has come is where its neighbours are.
    for (VertexHandle v : mpi::own_vertices(parts)) {
      const auto is_old_and_own = [&](VertexHandle u) {
        return parts.is_own(u) && parts.number(u) < n_before;
      };
      if (parts.number(v) < n_before) continue;
      ++n_new;
      std::size_t n_near = 0;
      for (CellHandle c : parts.part().vertex_cells(v))
        for (VertexHandle u : parts.part().cell(c).v) n_near += is_old_and_own(u) ? 1 : 0;
      EXPECT_GT(n_near, 0U);
    }
  }
  EXPECT_GT(comm.sum(n_new), 0U);
}

/// Inverted cells, pinched vertices, what is fixed, copies that are put back, and a surface that may change.
TEST(WorkBalance, RunsOfAllStagesHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  std::vector<SurfaceMode> modes = {SurfaceMode::kFrozen};
#ifdef HFR_HAS_SURFACE
  modes.push_back(SurfaceMode::kFree);
#endif
  for (const SurfaceMode mode : modes) {
    if (comm.rank() == 0) {
      const TetMesh poor = torn(7, 0.42, 0.97, 3);
      TetMesh mesh = torn(7, 0, 0.97, 3);
      for (VertexHandle v : mesh.vertices())
        if (mesh.point(v).x < 0.5) mesh.set_point(v, poor.point(v));
      io::write(path, mesh);
    }
    comm.sum(0);
    ImproveOptions options;
    options.policy = {};
    options.min_dihedral = 30;
    options.iterations = 1;
    options.passes_only = true;
    options.surface.mode = mode;
    options.surface.fixed_vertices = {V(40), V(41)};
    bool is_before = true;
    expect_same_run(comm, folder, path, options, [&](mpi::DistributedMesh& parts) {
      if (!std::exchange(is_before, false)) return;
      EXPECT_GT(mpi::survey(parts).n_invalid, 0U);
      mpi::WorkBalance balance(parts, 30, {});  // as the run will have it
      EXPECT_EQ(comm.sum(balance.n_borrowed()) > 0, comm.size() > 1);
      balance.give_back();
    });
  }
}

}  // namespace
}  // namespace hfr::test
