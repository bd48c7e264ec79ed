// SPDX-License-Identifier: BSD-3-Clause
// Vertices that come to belong to other ranks: parts are then what they would be had the mesh been cut so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "Distributed/Labelled.hh"
#include "Distributed/PartRound.hh"
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

/// With labels of all kinds, pinched vertices and inverted cells, before a run and after it.
TEST(ChangeOwners, RunsHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  int n_changed = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const bool is_valid = seed % 3 != 0;
    if (comm.rank() == 0)
      io::write_mesh(path, labelled(is_valid ? valid_box(5, 0.4, seed) : jittered(4, 0.3, seed), seed,
                                    density_of(seed)));
    comm.sum(0);
    ImproveOptions options = polish_towards(seed % 2 == 0 ? 14 : 22);
    options.polish_only = is_valid && seed < 5;
    const Result shared = expect_same_run(comm, folder, path, options, [&](mpi::DistributedMesh& parts) {
      change_owners(parts, seed, seed % 2 == 0 ? 1 : 40);
    });
    n_changed += shared.changed ? 1 : 0;
  }
  EXPECT_GE(comm.from_first(n_changed), 4);
}

}  // namespace
}  // namespace hfr::test
