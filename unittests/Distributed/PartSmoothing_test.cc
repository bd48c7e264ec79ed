// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartSmoothing.hh"

#include <gtest/gtest.h>

#include "Distributed/Partition.hh"
#include "Distributed/Parts.hh"
#include "Operators/LimitMeshes.hh"
#include "Scheduler/VertexColours.hh"

namespace hfr::test {
namespace {

/// Groups of a pass over all vertices are those of colour_vertices(), with each vertex on its owner's rank.
void expect_colours_of_shared_memory(const TetMesh& mesh) {
  for (const mpi::Partition how : {mpi::Partition::kCoordinates, mpi::Partition::kNumbers}) {
    mpi::Comm comm(MPI_COMM_WORLD);
    const Whole whole(mesh, VolumeLength{});
    const auto owner = mpi::partition(comm, comm.rank() == 0 ? &whole.mesh : nullptr, how);
    mpi::DistributedMesh parts(comm);
    parts.scatter(&whole.mesh, &whole.work, owner);
    std::vector<VertexHandle> all, here;
    for (std::size_t i = 0; i < whole.mesh.n_vertices(); ++i) all.push_back(V(i));
    for (std::size_t i = 0; i < parts.part().n_vertices(); ++i) here.push_back(V(i));
    const StarTable stars(whole.mesh, all, whole.work.star_size, {});
    const auto expected = colour_vertices(whole.mesh, all, stars, {});
    const auto groups = mpi::PartSmoothing(parts, here, {}).colour_groups();
    ASSERT_EQ(groups.size(), expected.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
      std::vector<std::uint64_t> mine, wanted;
      for (VertexHandle v : groups[g]) mine.push_back(parts.number(v));
      for (std::uint32_t i : expected[g]) {
        const VertexHandle v = parts.vertex_at(i);
        if (v.is_valid() && parts.is_own(v)) wanted.push_back(i);
      }
      EXPECT_EQ(mine, wanted) << "group " << g;
    }
  }
}

TEST(PartSmoothing, ColoursAreThoseOfSharedMemory) { expect_colours_of_shared_memory(jittered(7, 0.3, 5)); }

/// More than a rank colours in a round.
TEST(PartSmoothing, ManyThatWaitAreColouredAFewInEachRound) {
  expect_colours_of_shared_memory(jittered(20, 0.3, 6));
}

TEST(PartSmoothing, WhatNeedsMoreThanSixtyThreeColoursHasAGroupEach) {
  expect_colours_of_shared_memory(built(neighbourly(70)));
}

}  // namespace
}  // namespace hfr::test
