// SPDX-License-Identifier: BSD-3-Clause
// .mesh, .meshb and .msh of which each rank writes a range, beside what the writers for shared memory make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "Distributed/Labelled.hh"

namespace hfr::test {
namespace {

struct Kind {
  std::string name, variant = "";
  bool binary = false;

  io::WriteOptions options() const { return {binary, variant}; }
};
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {{"a.mesh"},       {"a.meshb"},
                                        {"a.msh"},        {"a.msh", "4.1", true},
                                        {"a.msh", "4.0"}, {"a.msh", "4.0", true},
                                        {"a.msh", "2.2"}, {"a.msh", "2.2", true},
                                        {"a.vtu"}};
  return all;
}

/// Writes what all ranks have read and maybe improved in all formats, and compares the bytes with what one
/// process makes of the same file. Returns how many bytes that were.
std::size_t expect_same_files(mpi::Comm& comm, const SharedFolder& folder, const std::filesystem::path& in,
                              double goal) {
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, in, 300);
  if (goal > 0) mpi::improve(parts, polish_towards(goal));
  TetMesh mesh;
  if (comm.rank() == 0) {
    mesh = io::read(in);
    if (goal > 0) hfr::improve(mesh, polish_towards(goal));
  }
  std::size_t n_bytes = 0;
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name + " " + kind.variant + (kind.binary ? " binary" : ""));
    const auto path = folder.path() / kind.name;
    const auto notes = mpi::write_ranges(parts, path, kind.options());
    if (comm.rank() != 0) continue;
    const std::string written = bytes_of(path);
    std::filesystem::remove(path);
    EXPECT_EQ(io::write(path, mesh, kind.options()), notes);
    EXPECT_TRUE(written == bytes_of(path)) << written.size() << " bytes";
    std::filesystem::remove(path);
    n_bytes += written.size();
  }
  comm.sum(0);
  return comm.from_first(n_bytes);
}

TEST(WriteRanges, AllFormatsHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  std::size_t n_bytes = 0;
  for (std::uint64_t seed = 1; seed <= 7; ++seed) {
    if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(6, 0.45, seed), seed, density_of(seed)));
    comm.sum(0);
    n_bytes += expect_same_files(comm, folder, path, seed % 2 == 0 ? 0 : 20);
    comm.sum(0);
  }
  EXPECT_GT(n_bytes, 1'000'000U);
}

/// Blocks of .msh 4 are stretches of elements with one label: one for all ranks, many in each, and some that
/// begin in one rank and end in the next, or in the one after that.
TEST(WriteRanges, BlocksOfOneLabelReachOverRanks) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  for (const std::size_t length : {1U, 7U, 100U, 160U, 550U, 648U}) {
    if (comm.rank() == 0) {
      io::MeshData data = io::disassemble(valid_box(6, 0.1, 2));
      for (std::size_t c = 0; c < data.cells.size(); ++c)
        data.regions.push_back(static_cast<int>(c / length % 3));
      io::write_mesh(path, data);
    }
    comm.sum(0);
    SCOPED_TRACE(length);
    expect_same_files(comm, folder, path, 0);
    comm.sum(0);
  }
}

TEST(WriteRanges, RanksMayHaveNothingToWrite) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.mesh";
  if (comm.rank() == 0) {
    io::MeshData data;
    data.points = {{0, 0, -0.0}, {1, 0, 0.0}, {0, 1, 0}, {0, 0, 1}};
    data.cells = {{0, 1, 2, 3}};
    data.triangles = {{0, 2, 1}};
    data.triangle_labels = {-4};
    data.edges = {{3, 1}};
    data.edge_labels = {0};
    data.vertex_labels = {0, 0, 5, 0};
    data.fixed_vertices = {3};
    io::write_mesh(path, data);
  }
  comm.sum(0);
  EXPECT_GT(expect_same_files(comm, folder, path, 0), 1000U);
}

TEST(WriteRanges, RealMeshesHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const std::filesystem::path meshes = HFR_TEST_MESHES;
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << meshes << " is not there";
  for (const char* const name :
       {"gaia_frog_reg/frog_reg.mesh", "polyfem_cubes_mm/cubes_v22.msh", "ipc_dolphin5k/dolphin5K.msh"}) {
    SCOPED_TRACE(name);
    expect_same_files(comm, folder, meshes / name, 12);
    comm.sum(0);
  }
}

/// Wherever a rank fails while a file is written: all end, and the file that was there stays as it is.
TEST(WriteRanges, ARankThatFailsLeavesTheFileThatWasThere) {
  mpi::Comm world(MPI_COMM_WORLD);
  if (world.size() == 1) GTEST_SKIP() << "one rank fails alone";
  const SharedFolder folder(world);
  const auto in = folder.path() / "in.vtu";
  if (world.rank() == 0) io::write_mesh(in, labelled(valid_box(4, 0.3, 1), 1, {}));
  for (const char* const name : {"out.msh", "out.meshb", "out.vtu"}) {
    const auto out = folder.path() / name;
    const auto run = [&](int bad, std::uint64_t call) -> std::uint64_t {
      world.sum(0);
      mpi::Comm comm(MPI_COMM_WORLD);
      std::uint64_t before = 0;
      try {
        mpi::DistributedMesh parts(comm);
        mpi::read_ranges(parts, in);
        before = comm.n_calls();
        if (comm.rank() == bad && call > 0) comm.fail_at_call(before + call);
        mpi::write_ranges(parts, out);
        EXPECT_EQ(call, 0U);
      } catch (const mpi::RankFailed& failed) {
        EXPECT_EQ(failed.rank(), bad);
      } catch (const ResourceLimit& error) {
        EXPECT_EQ(comm.rank(), bad);
        EXPECT_EQ(comm.fail(5, error.what()).rank(), bad);
      }
      return comm.n_calls() - before;
    };
    const std::uint64_t n_calls = run(0, 0);
    const std::string good = bytes_of(out);
    world.sum(0);
    if (world.rank() == 0) std::ofstream(out) << "what was there";
    for (std::uint64_t call = 1; call < n_calls; ++call) run(world.size() - 1, call);
    world.sum(0);
    EXPECT_EQ(bytes_of(out), "what was there");
    run(0, n_calls);  // the last call, when the file is there
    world.sum(0);
    EXPECT_TRUE(bytes_of(out) == good);
    world.sum(0);
    if (world.rank() == 0) std::filesystem::remove(out);
    world.sum(0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "temporary files";
    world.sum(0);
  }
}

TEST(WriteRanges, WhatCannotBeWrittenIsRefused) {
  mpi::Comm world(MPI_COMM_WORLD);
  const SharedFolder folder(world);
  const auto refusal = [&](const std::filesystem::path& path, const io::WriteOptions& options) {
    return refusal_of([&](mpi::DistributedMesh& parts) {
      mpi::generate_in_parts(parts, {});
      mpi::write_ranges(parts, path, options);
    });
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal(folder.path() / "a.ovm", {}), HasSubstr("known are .mesh, .meshb, .msh and .vtu"));
  EXPECT_THAT(refusal(folder.path() / "a.msh", {false, "3.0"}), HasSubstr("unknown variant '3.0'"));
  EXPECT_THAT(refusal(folder.path() / "a.vtu", {false, "zlib"}), HasSubstr("raw appended data"));
  EXPECT_THAT(refusal(folder.path() / "none/a.mesh", {}), HasSubstr("cannot be written"));
  EXPECT_THAT(refusal("/dev/null/a.mesh", {}), HasSubstr("cannot be written"));
  world.sum(0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace hfr::test
