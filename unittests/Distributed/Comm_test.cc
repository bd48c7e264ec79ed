// SPDX-License-Identifier: BSD-3-Clause
// A rank that fails within a call leaves none waiting.
#include "Distributed/Comm.hh"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <vector>

#include "HalfFace/Errors.hh"

namespace hfr::test {
namespace {

/// `call` throws on rank `bad`, and the next call of the others says so.
void expect_end_of_all(int bad, const std::function<void(mpi::Comm&)>& call) {
  mpi::Comm comm(MPI_COMM_WORLD);
  try {
    call(comm);
    comm.sum(1);
    ADD_FAILURE() << "no rank has failed";
  } catch (const mpi::RankFailed& failed) {
    EXPECT_NE(comm.rank(), bad);
    EXPECT_EQ(failed.rank(), bad);
  } catch (const std::exception& error) {
    EXPECT_EQ(comm.rank(), bad);
    EXPECT_EQ(comm.fail(5, error.what()).rank(), bad);
  }
}

int last_rank() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size - 1;
}

TEST(Comm, MessageThatIsTooLongIsRefusedBeforeAnyoneWaits) {
  if (last_rank() == 0) GTEST_SKIP() << "of two ranks and more";
  expect_end_of_all(last_rank(), [](mpi::Comm& comm) {
    if (comm.rank() == last_rank()) comm.refuse_beyond(100);
    std::vector<mpi::Packer> to(comm.n_ranks());
    for (mpi::Packer& one : to) one.put_all(std::vector<int>(comm.rank() == last_rank() ? 200 : 10));
    comm.exchange(to);
  });
}

TEST(Comm, WhatIsTooLongToGatherIsRefusedBeforeAnyoneWaits) {
  expect_end_of_all(last_rank(), [](mpi::Comm& comm) {
    if (comm.rank() == last_rank()) comm.refuse_beyond(100);
    const std::vector<int> mine(comm.rank() == last_rank() ? 200 : 10);
    comm.all_gather(std::span<const int>(mine));
  });
}

TEST(Comm, RankThatCannotMakeItsOwnBlockHasSentTheOthersTheirs) {
  expect_end_of_all(0, [](mpi::Comm& comm) {
    const mpi::Block block = comm.hand_out([](int rank) {
      if (rank == 0) throw std::runtime_error("no block for rank 0");
      return mpi::Block(std::size_t{3} << 20);
    });
    EXPECT_EQ(block.size(), std::size_t{3} << 20);
  });
}

}  // namespace
}  // namespace hfr::test
