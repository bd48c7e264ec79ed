// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Improve.hh"

#include <gtest/gtest.h>

#include <vector>

#include "Distributed/Parts.hh"

namespace hfr::test {
namespace {

/// On rank 0 the mesh after a run of all ranks, and its report; elsewhere nothing.
struct Outcome {
  TetMesh mesh;
  Result result;
};

/// Whatever a pass is worth.
mpi::Sharing share_all(mpi::Partition how) {
  mpi::Sharing sharing;
  sharing.partition = how;
  sharing.least_cells = 0;
  sharing.least_one_in = 0;
  return sharing;
}

Outcome improve_on_all(const TetMesh& input, const ImproveOptions& options, mpi::Comm& comm,
                       const mpi::Sharing& sharing) {
  Outcome outcome;
  if (comm.rank() != 0) {
    EXPECT_EQ(mpi::serve(comm), 3);
    return outcome;
  }
  outcome.mesh = input;
  outcome.result = mpi::improve(outcome.mesh, options, comm, sharing);
  mpi::dismiss(comm, 3);
  return outcome;
}

std::size_t n_lines(const Result& result, std::string_view op) {
  return static_cast<std::size_t>(std::count_if(result.passes.begin(), result.passes.end(),
                                                [&](const PassReport& pass) { return pass.op == op; }));
}

/// A goal run without what takes long and is left to rank 0 anyway.
ImproveOptions short_run(double goal) {
  ImproveOptions options;
  options.min_dihedral = goal;
  options.ops = Ops::kEdge | Ops::kFace | Ops::kNode | Ops::kSmooth;
  options.min_cells = 1;
  return options;
}

void expect_that_of_shared_memory(const TetMesh& input, const ImproveOptions& options, bool is_shared,
                                  std::vector<mpi::Partition> ways = {mpi::Partition::kGraph}) {
  for (const mpi::Partition how : ways) {
    mpi::Comm comm(MPI_COMM_WORLD);
    const Outcome outcome = improve_on_all(input, options, comm, share_all(how));
    if (comm.rank() != 0) continue;
    TetMesh mesh = input;
    const Result result = improve(mesh, options);
    EXPECT_TRUE(result.changed);
    EXPECT_TRUE(identical(mesh, outcome.mesh));
    EXPECT_EQ(result.goal_reached, outcome.result.goal_reached);
    EXPECT_EQ(n_lines(outcome.result, "gather") > 0, is_shared && comm.size() > 1);
  }
}

TEST(MpiImprove, GoalRunsAreThoseOfSharedMemory) {
  expect_that_of_shared_memory(valid_box(5, 0.45, 1), short_run(6), true,
                               {mpi::Partition::kGraph, mpi::Partition::kNumbers});
}

/// By counts alone: too few cells in focus of a mesh of so many.
TEST(MpiImprove, PassesThatAreNotWorthAHandOverStayOnOneRank) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const TetMesh input = valid_box(5, 0.45, 1);
  for (const std::size_t one_in : {std::size_t{1}, input.n_cells()}) {
    mpi::Sharing sharing = share_all(mpi::Partition::kCoordinates);
    sharing.least_one_in = one_in;
    std::vector<mpi::RankFigures> told;
    sharing.tell_figures = [&](std::span<const mpi::RankFigures> ranks) {
      told.assign(ranks.begin(), ranks.end());
    };
    const Outcome outcome = improve_on_all(input, short_run(6), comm, sharing);
    if (comm.rank() != 0) continue;
    const bool is_shared = one_in > 1 && comm.size() > 1;
    EXPECT_EQ(n_lines(outcome.result, "gather") > 0, is_shared);
    ASSERT_EQ(told.size(), comm.n_ranks());
    std::uint64_t n_own = 0;
    for (const mpi::RankFigures& rank : told) {
      EXPECT_EQ(rank.n_rounds > 0, is_shared);
      EXPECT_GE(rank.n_held, rank.n_own);
      n_own += rank.n_own;
    }
    EXPECT_EQ(n_own > 0, is_shared);
  }
}

TEST(MpiImprove, InsertionIsLeftToOneRank) {
  ImproveOptions options;
  options.min_dihedral = 25;
  const TetMesh input = valid_box(4, 0.4, 1);
  expect_that_of_shared_memory(input, options, true);
  mpi::Comm comm(MPI_COMM_WORLD);
  const Outcome outcome = improve_on_all(input, options, comm, share_all(mpi::Partition::kGraph));
  if (comm.rank() != 0) return;
  std::size_t n_inserted = 0;
  for (const PassReport& pass : outcome.result.passes)
    if (pass.op == "insert") n_inserted += pass.winners;
  EXPECT_GT(n_inserted, 0U) << "nothing was inserted";
}

/// Their polish mixes kinds and smooths.
TEST(MpiImprove, DefaultRunsAreThoseOfSharedMemory) {
  ImproveOptions options = short_run(8);
  options.min_dihedral.reset();
  expect_that_of_shared_memory(valid_box(3, 0.4, 1), options, true);
}

TEST(MpiImprove, LabelledMeshesAreThoseOfSharedMemory) {
  TetMesh mesh = valid_box(5, 0.45, 2);
  for (HalfFaceHandle h : mesh.halffaces())
    if (mesh.is_boundary(h) || h.idx() % 97 == 0) mesh.labels().faces.set(mesh.halfface_vertices(h), 4);
  mesh.labels().edges.set({mesh.cell(C(300)).v[0], mesh.cell(C(300)).v[2]}, 5);
  mesh.set_fixed(mesh.cell(C(100)).v[1]);
  expect_that_of_shared_memory(mesh, short_run(8), true);
}

/// Whatever a rank is doing when it fails, all ranks end, and all know why. Calls are counted in a run that
/// goes well; then one of a rank fails in each run.
TEST(MpiImprove, ARankThatFailsAnywhereEndsAll) {
  const TetMesh input = valid_box(4, 0.45, 2);
  const ImproveOptions options = short_run(6);
  const auto run = [&](int bad, std::uint64_t call) -> std::uint64_t {
    mpi::Comm comm(MPI_COMM_WORLD);
    if (comm.rank() == bad) comm.fail_at_call(call);
    try {
      if (comm.rank() == 0) {
        TetMesh mesh = input;
        mpi::improve(mesh, options, comm, share_all(mpi::Partition::kCoordinates));
        mpi::dismiss(comm);
      } else {
        mpi::serve(comm);
      }
      EXPECT_EQ(call, 0U);
    } catch (const mpi::RankFailed& failed) {
      EXPECT_EQ(failed.rank(), bad);
      EXPECT_EQ(failed.code(), 5);
      EXPECT_NE(std::string(failed.what()).find("a fault that was asked for"), std::string::npos);
    } catch (const ResourceLimit& error) {
      EXPECT_EQ(comm.rank(), bad);
      EXPECT_EQ(comm.fail(5, error.what()).rank(), bad);
    }
    return comm.n_calls();
  };
  const std::uint64_t n_calls = run(0, 0);
  mpi::Comm comm(MPI_COMM_WORLD);
  if (comm.size() == 1) return;
  EXPECT_GT(n_calls, 30U);
  for (const int bad : {0, comm.size() - 1})
    for (std::uint64_t call = 1; call <= n_calls; ++call)
      if (call < 12 || call % (n_calls / 5) == 0 || call + 6 > n_calls) run(bad, call);
}

}  // namespace
}  // namespace hfr::test
