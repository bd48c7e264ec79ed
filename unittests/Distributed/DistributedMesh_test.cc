// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/DistributedMesh.hh"

#include <gtest/gtest.h>

#include "Distributed/Parts.hh"

namespace hfr::test {
namespace {

constexpr mpi::Partition kWays[] = {mpi::Partition::kGraph, mpi::Partition::kCoordinates,
                                    mpi::Partition::kNumbers};

TEST(DistributedMesh, ComesBackAsItWasWhateverTheParts) {
  for (const mpi::Partition how : kWays) {
    mpi::Comm comm(MPI_COMM_WORLD);
    Whole whole(valid_box(6, 0.3, 3), VolumeLength{});
    for (CellHandle c : whole.mesh.cells()) whole.mesh.set_region(c, static_cast<int>(c.idx() % 3));
    const Whole before = whole;
    const bool first = comm.rank() == 0;
    const auto owner = mpi::partition(comm, first ? &whole.mesh : nullptr, how);
    mpi::DistributedMesh parts(comm);
    parts.scatter(&whole.mesh, &whole.work, owner);
    gather_from_nothing(parts, whole);
    if (first) expect_same(before, whole);
  }
}

TEST(DistributedMesh, PartsAreTheOwnCellsAndTwoLayersAndNoMore) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const Whole whole(valid_box(8, 0.2, 1), VolumeLength{});
  const auto owner = mpi::partition(comm, comm.rank() == 0 ? &whole.mesh : nullptr, mpi::Partition::kGraph);
  mpi::DistributedMesh parts(comm);
  parts.scatter(&whole.mesh, &whole.work, owner);
  const std::vector<int> distance = edges_to_own(parts, whole);
  std::size_t n_held = 0;
  for (CellHandle c : whole.mesh.cells()) {
    const auto& v = whole.mesh.cell(c).v;
    const bool is_held =
        std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return distance[u.idx()] <= 2; });
    const CellHandle here = parts.cell_at(c.idx());
    EXPECT_EQ(here.is_valid() && !parts.part().is_deleted(here), is_held);
    n_held += is_held ? 1 : 0;
  }
  EXPECT_EQ(parts.part().n_cells(), n_held);
  std::size_t n_own = 0;
  for (std::size_t c = 0; c < n_held; ++c) n_own += parts.is_own(C(c)) ? 1 : 0;
  EXPECT_EQ(comm.sum(n_own), whole.mesh.n_logical_cells()) << "each cell has one owner";
}

TEST(DistributedMesh, RefusesByNameWhatItCannotCut) {
  Whole whole(valid_box(3, 0, 1), VolumeLength{});
  EXPECT_EQ(mpi::DistributedMesh::reason_against(whole.mesh, whole.work), "");
  whole.mesh.labels().edges.set({V(0), V(1)}, 7);
  EXPECT_EQ(mpi::DistributedMesh::reason_against(whole.mesh, whole.work), "");
  whole.mesh.labels().edges.set({V(0), V(whole.mesh.n_vertices() - 2)}, 7);
  EXPECT_EQ(mpi::DistributedMesh::reason_against(whole.mesh, whole.work),
            "labelled or fixed edges or faces that no cell has");
}

TEST(Comm, ARankThatFailsEndsTheWaitOfAllOthers) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const int bad = comm.size() - 1;
  std::vector<mpi::Packer> none(comm.n_ranks());
  if (comm.rank() == bad) {
    const mpi::RankFailed failed = comm.fail(7, "no room");
    EXPECT_EQ(failed.rank(), bad);
    EXPECT_EQ(failed.code(), 7);
    return;
  }
  try {
    comm.exchange(none);
    FAIL() << "nobody noticed";
  } catch (const mpi::RankFailed& failed) {
    EXPECT_EQ(failed.rank(), bad);
    EXPECT_EQ(failed.code(), 7);
  }
}

}  // namespace
}  // namespace hfr::test
