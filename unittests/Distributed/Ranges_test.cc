// SPDX-License-Identifier: BSD-3-Clause
// .mesh, .meshb and .msh of which each rank reads a range.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "Distributed/Labelled.hh"

namespace hfr::test {
namespace {

TEST(Ranges, FilesOfAllKindsHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  std::size_t n_winners = 0;
  std::uint64_t seed = 1;
  struct Kind {
    std::string name, variant = "";
    bool binary = false;
  };
  for (const auto& [name, variant, binary] :
       {Kind{"a.mesh"}, Kind{"a.meshb"}, Kind{"a.msh", "4.1"}, Kind{"a.msh", "4.1", true},
        Kind{"a.msh", "4.0"}, Kind{"a.msh", "4.0", true}, Kind{"a.msh", "2.2"}, Kind{"a.msh", "2.2", true}})
    for (const bool has_labels : {true, false}) {
      const auto path = folder.path() / name;
      if (comm.rank() == 0) {
        const Density density = has_labels ? Density{} : Density{0, 0, 0, 0, 0, 0, false};
        ++seed;
        io::write_mesh(path, labelled(valid_box(6, 0.45, seed), seed, density), {binary, variant});
      }
      comm.sum(0);
      SCOPED_TRACE(name + " " + variant + (binary ? " binary" : ""));
      n_winners += expect_bytes(comm, folder, path, polish_towards(has_labels ? 14 : 22), 170);
      comm.sum(0);
    }
  EXPECT_GT(n_winners, 1000U) << "the polish no longer finds anything to do";
}

TEST(Ranges, RealMeshesHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const std::filesystem::path meshes = HFR_TEST_MESHES;
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << meshes << " is not there";
  for (const auto& [name, goal] : {std::pair{"gaia_frog_reg/frog_reg.mesh", 12.0},
                                   {"polyfem_cubes_mm/cubes_v22.msh", 12.0},
                                   {"ipc_dolphin5k/dolphin5K.msh", 12.0}}) {
    SCOPED_TRACE(name);
    EXPECT_GT(expect_bytes(comm, folder, meshes / name, polish_towards(goal), 10'000), 0U);
    comm.sum(0);
  }
}

/// What stands in a file as a person may write it: comments, blank lines, counts behind keywords, spaces.
TEST(Ranges, LinesMayHaveMoreThanWritersPutThere) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "a.mesh";
  if (comm.rank() == 0)
    std::ofstream(path) << "# a mesh\nMeshVersionFormatted 2\n\nDimension\n3\n Vertices 5 # points\n"
                           "0 0 0 1\n1 0 0 0\r\n\n  0 1 0 0 # here\n0 0 1 2\n1 1 1.5D0 0\n#Edges\n"
                           "Tetrahedra\n2\n1 2 3 4 7\n2 3 4 5 8\nTriangles\n\n2\n1 2 3 5\n2 3 4 6\n"
                           "RequiredTriangles\n1\n2\nCorners\n1\n5\nEdges 1\n1 2 9\nEnd\n";
  comm.sum(0);
  expect_bytes(comm, folder, path, polish_towards(1));
}

/// The line with which a file of these bytes is refused, on all ranks.
class Refusals {
 public:
  explicit Refusals(const char* name) : folder_(world_), path_(folder_.path() / name) {}

  std::string of(const std::string& bytes) {
    world_.sum(0);
    if (world_.rank() == 0) std::ofstream(path_, std::ios::binary) << bytes;
    world_.sum(0);
    mpi::Comm comm(MPI_COMM_WORLD);
    mpi::DistributedMesh parts(comm);
    try {
      mpi::read_ranges(parts, path_);
    } catch (const mpi::RankFailed& failed) {
      return failed.what();
    } catch (const std::exception& error) {
      return comm.fail(2, error.what()).what();
    }
    return {};
  }

 private:
  mpi::Comm world_{MPI_COMM_WORLD};
  SharedFolder folder_;
  std::filesystem::path path_;
};

TEST(Ranges, MeditFilesThatCannotBeReadAreRefusedOnAllRanks) {
  using testing::HasSubstr;
  Refusals refusal("bad.mesh");
  const std::string head =
      "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";
  const std::string good = head + "Tetrahedra\n1\n1 2 3 4 0\nEnd\n";
  EXPECT_EQ(refusal.of(good), "");
  EXPECT_THAT(refusal.of("x\n"), HasSubstr("not a Medit file"));
  EXPECT_THAT(refusal.of(""), HasSubstr("empty"));
  EXPECT_THAT(refusal.of(head), HasSubstr("it has no cells"));
  EXPECT_THAT(refusal.of(head + "Tetrahedra\n2\n1 2 3 4 0\nEnd\n"),
              HasSubstr("announces 2 entries and has 1"));
  EXPECT_THAT(refusal.of(head + "Tetrahedra\n1\n1 2 3\n4 0\nEnd\n"), HasSubstr("more entries than it says"));
  EXPECT_THAT(refusal.of(head + "Tetrahedra\n1\n1 2 3 4\nEnd\n"),
              HasSubstr("each entry on a line of its own"));
  EXPECT_THAT(refusal.of(head + "Tetrahedra\n1\n1 2 3 4 0 0\nEnd\n"),
              HasSubstr("each entry on a line of its own"));
  EXPECT_THAT(refusal.of(head + "Tetrahedra\n1\n1 2 3 5 0\nEnd\n"), HasSubstr("vertex 5 is out of range"));
  EXPECT_THAT(refusal.of(head + "Tetrahedra\n1\n1 2 3 3 0\nEnd\n"), HasSubstr("vertices are the same"));
  EXPECT_THAT(refusal.of(head + "Hexahedra\n1\n1 2 3 4 1 2 3 4 0\nEnd\n"), HasSubstr("1 Hexahedra"));
  EXPECT_THAT(refusal.of(head + "Tetrahedra\n1\n" + std::string(70'000, ' ') + "1 2 3 4 0\nEnd\n"),
              HasSubstr("line of more than"));
}

TEST(Ranges, GmshFilesThatCannotBeReadAreRefusedOnAllRanks) {
  using testing::HasSubstr;
  Refusals refusal("bad.msh");
  const std::string head =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
  const auto elements = [&](const std::string& lines) {
    return head + "$Elements\n" + lines + "$EndElements\n";
  };
  EXPECT_EQ(refusal.of(elements("1\n1 4 2 0 1 1 2 3 4\n")), "");
  EXPECT_THAT(refusal.of("$MeshFormat\n2.2 1 8\n"), HasSubstr("the byte order of the file"));
  EXPECT_THAT(refusal.of("$MeshFormat\n4.2 0 8\n"), HasSubstr("this version of Gmsh's format"));
  EXPECT_THAT(refusal.of(head), HasSubstr("without an $Elements section"));
  EXPECT_THAT(refusal.of(head + "$Elements\n1\n"), HasSubstr("is not closed"));
  EXPECT_THAT(refusal.of(elements("1\n1 4 2 0 1 1 2 3 9\n")), HasSubstr("there is no node 9"));
  EXPECT_THAT(refusal.of(elements("1\n1 5 2 0 1 1 2 3 4 1 2 3 4\n")), HasSubstr("hexahedra"));
  EXPECT_THAT(refusal.of(elements("1\n1 11 2 0 1 1 2 3 4 1 2 3 4 1 2\n")), HasSubstr("of first order"));
  EXPECT_THAT(refusal.of(elements("2\n1 4 2 7 1 1 2 3 4\n2 4 2 8 1 1 2 3 4\n")),
              HasSubstr("in several physical groups"));
  std::string bytes = elements("1\n1 4 2 0 1 1 2 3 4\n");
  bytes.replace(bytes.find("\n4 0 0 1") + 1, 1, "3");
  EXPECT_THAT(refusal.of(bytes), HasSubstr("node 3 is given twice"));
}

/// One rank comes upon what is wrong, wherever that stands.
TEST(Ranges, BinaryGmshFilesThatEndTooEarlyAreRefusedOnAllRanks) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.msh";
  for (const char* const variant : {"2.2", "4.0", "4.1"}) {
    io::write_mesh(path, io::disassemble(valid_box(3, 0.2, 1)), {true, variant});
    const std::string good = bytes_of(path);
    Refusals refusal("bad.msh");
    EXPECT_EQ(refusal.of(good), "");
    int n_refused = 0;
    for (std::size_t n = 1; n + 1 < good.size(); n += 197, ++n_refused)
      EXPECT_THAT(refusal.of(good.substr(0, n)), testing::HasSubstr("bad.msh: ")) << n;
    EXPECT_GT(n_refused, 20);
  }
}

}  // namespace
}  // namespace hfr::test
