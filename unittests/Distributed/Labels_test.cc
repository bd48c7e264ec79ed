// SPDX-License-Identifier: BSD-3-Clause
// Labelled vertices, edges and faces, and fixed vertices, of meshes in parts: read, respected, written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "Distributed/Labelled.hh"

namespace hfr::test {
namespace {

TEST(PartLabels, LabelledMeshesHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  std::size_t n_winners = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(7, 0.45, seed), seed, density_of(seed)));
    comm.sum(0);
    n_winners += expect_bytes(comm, folder, path, polish_towards(seed % 2 == 0 ? 14 : 25));
    comm.sum(0);
  }
  EXPECT_GT(n_winners, 1000U) << "the polish no longer finds anything to do";
}

/// Interfaces between regions, labels and what is fixed, where cluster search is at work.
TEST(PartLabels, LabelledMeshesHaveTheBytesOfSharedMemoryWithClusterSearch) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  std::size_t n_searched = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Density density = seed % 2 == 0 ? Density{} : Density{1, 90, 0, 20, 0, 25, true};
    if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(7, 0.33, seed), seed, density));
    for (const double goal : {7.0, 12.0}) {
      comm.sum(0);
      ImproveOptions options = polish_towards(goal);
      options.ops = Ops::kEdge | Ops::kFace | Ops::kCluster;
      n_searched += expect_bytes(comm, folder, path, options, 300, "cluster");
      comm.sum(0);
    }
  }
  EXPECT_GT(n_searched, 0U) << "nothing is left to cluster search";
}

/// What is labelled keeps passes from what they do without: else the test above would show nothing.
TEST(PartLabels, LabelsAreConstraints) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu", plain = folder.path() / "plain.vtu";
  if (comm.rank() == 0) {
    io::MeshData data = labelled(valid_box(7, 0.45, 1), 1, {0, 5, 5, 5, 5, 0, false});
    io::write_mesh(path, data);
    data.triangles.clear(), data.triangle_labels.clear(), data.edges.clear(), data.edge_labels.clear();
    data.vertex_labels.clear(), data.fixed_vertices.clear();
    io::write_mesh(plain, data);
  }
  comm.sum(0);
  mpi::DistributedMesh parts(comm), free(comm);
  mpi::read_ranges(parts, path);
  mpi::read_ranges(free, plain);
  const auto held = mpi::improve(parts, polish_towards(20)).after.n_below_goal;
  EXPECT_GT(held, 2 * mpi::improve(free, polish_towards(20)).after.n_below_goal + 100);
}

/// So many cells round an edge, with labels on it, on its ends and on faces at it.
io::MeshData wheel(Index n) {
  constexpr double kTurn = 6.283185307179586;
  io::MeshData data;
  data.points = {{0, 0, -1}, {0, 0, 1}};
  for (Index i = 0; i < n; ++i) {
    const double angle = kTurn * static_cast<double>(i) / static_cast<double>(n);
    data.points.push_back({std::cos(angle), std::sin(angle), 0});
    data.cells.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
    data.triangles.push_back({0, 2 + i, 2 + (i + 1) % n});
    data.triangle_labels.push_back(static_cast<int>(i));
  }
  data.edges = {{1, 0}};
  data.edge_labels = {7};
  data.vertex_labels.assign(data.points.size(), 0);
  data.vertex_labels[1] = 9;
  return data;
}

/// As many cells as a star holds, and far more than a ring does; and one more.
TEST(PartLabels, AsManyCellsRoundAVertexAsAStarHolds) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu", larger = folder.path() / "larger.vtu";
  static_assert(Star::kCapacity > Ring::kCapacity + 1);
  if (comm.rank() == 0) {
    io::write_mesh(path, wheel(Star::kCapacity));
    io::write_mesh(larger, wheel(Star::kCapacity + 1));
  }
  comm.sum(0);
  expect_bytes(comm, folder, path, polish_towards(1));
  mpi::DistributedMesh whole(comm);
  mpi::read_ranges(whole, path);
  EXPECT_TRUE(mpi::check(whole).is_good);
  whole.work().star_size[0] += 1;
  EXPECT_FALSE(mpi::check(whole).is_good);
  expect_bytes(comm, folder, larger, polish_towards(1));
}

TEST(PartLabels, PiecesKeepThemInTheirOrder) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu", index = folder.path() / "pieces.pvtu";
  if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(6, 0.45, 8), 8, {}));
  comm.sum(0);
  {
    mpi::DistributedMesh parts(comm);
    EXPECT_THAT(mpi::read_ranges(parts, path),
                testing::IsSupersetOf({testing::HasSubstr("triangles given more than once")}));
    mpi::improve(parts, polish_towards(10));
    mpi::write_pvtu(parts, index);
  }
  mpi::DistributedMesh parts(comm);
  EXPECT_THAT(mpi::read_pvtu(parts, index), testing::IsEmpty());
  mpi::improve(parts, polish_towards(18));
  EXPECT_TRUE(mpi::check(parts).is_good);
  mpi::write_vtu(parts, folder.path() / "parts.vtu");
  if (comm.rank() != 0) return;
  TetMesh mesh = io::read(path);
  hfr::improve(mesh, polish_towards(10));
  hfr::improve(mesh, polish_towards(18));
  io::write(folder.path() / "whole.vtu", mesh);
  EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
}

TEST(PartLabels, ACheckFindsALabelThatAnotherRankHasOtherwise) {
  mpi::Comm comm(MPI_COMM_WORLD);
  if (comm.size() == 1) GTEST_SKIP() << "one rank holds nothing for others";
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(6, 0.2, 5), 5, {}));
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path);
  EXPECT_TRUE(mpi::check(parts).is_good);
  const TetMesh& part = parts.part();
  bool is_spoilt = comm.rank() != comm.size() - 1;
  for (std::size_t c = 0; c < part.n_cells() && !is_spoilt; ++c) {
    if (parts.is_own(C(c))) continue;
    for (HalfFaceHandle h : part.cell_halffaces(C(c)))
      if (int* const label = parts.part().labels().faces.find(part.halfface_vertices(h)); label) {
        ++*label;
        is_spoilt = true;
      }
  }
  EXPECT_TRUE(is_spoilt);
  const mpi::PartsCheck found = mpi::check(parts);
  EXPECT_FALSE(found.is_good);
  EXPECT_THAT(found.message, testing::HasSubstr("what is labelled of cell"));
}

TEST(PartLabels, TrianglesOfNoCellAreRefusedOnAllRanks) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) {
    io::MeshData data = io::disassemble(valid_box(3, 0, 1));
    data.triangles = {{0, 1, static_cast<Index>(data.points.size() - 1)}};
    data.triangle_labels = {4};
    io::write_mesh(path, data);
  }
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  try {
    mpi::read_ranges(parts, path);
    FAIL() << "it was read";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("1 triangles and 0 edges are of no tetrahedron"));
  }
}

}  // namespace
}  // namespace hfr::test
