// SPDX-License-Identifier: BSD-3-Clause
// Meshes that touch themselves in vertices, and vertices of more cells than a Star holds, in parts and in
// shared memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "Distributed/Cutout.hh"
#include "Distributed/Labelled.hh"
#include "Distributed/WholeStars.hh"
#include "Operators/LimitMeshes.hh"
#include "Remesh/Survey.hh"

namespace hfr::test {
namespace {

ImproveOptions all_stages() {
  ImproveOptions options;
  options.policy = {};
  return options;
}

/// n boxes in a row, each of which has one vertex in common with the next.
generate::Arrays chain(Index n, Index cubes, double jitter) {
  generate::Arrays all;
  for (Index i = 0; i < n; ++i) {
    const double low = i;
    const generate::Arrays box = generate::jittered_box({cubes, cubes, cubes}, jitter, 5 + i, {low, low, low},
                                                        {low + 1, low + 1, low + 1});
    const auto first =
        static_cast<Index>(i == 0 ? 0 : all.points.size() - 1);  // of the box before the last one
    for (auto cell : box.cells) {
      for (Index& v : cell) v += first;
      all.cells.push_back(cell);
    }
    all.points.insert(all.points.end(), box.points.begin() + (i == 0 ? 0 : 1), box.points.end());
  }
  return all;
}

class PinchedParts : public testing::Test {
 protected:
  /// Returns stages and operators that have changed something, on rank 0.
  std::set<std::string> run(const TetMesh& mesh, const ImproveOptions& options) {
    if (comm.rank() == 0) io::write(path, mesh);
    comm.sum(0);
    const Result shared = expect_same_run(comm, folder, path, options);
    std::set<std::string> stages;
    for (const PassReport& pass : shared.passes)
      if (pass.winners > 0) stages.insert({pass.stage, pass.op});
    return stages;
  }

  mpi::Comm comm{MPI_COMM_WORLD};
  SharedFolder folder{comm};
  std::filesystem::path path = folder.path() / "in.vtu";
};

TEST_F(PinchedParts, BoxesThatTouchInVerticesHaveTheBytesOfSharedMemory) {
  const auto stages = run(build(chain(4, 4, 0.3).points, chain(4, 4, 0.3).cells), all_stages());
  if (comm.rank() == 0) {
    EXPECT_THAT(stages, testing::IsSupersetOf({"bulk", "polish"}));
  }
}

TEST_F(PinchedParts, TornBoxesHaveTheBytesOfSharedMemory) {
  bool is_any_inverted = false;
  for (const double keep : {0.95, 0.6})
    for (const double jitter : {0.3, 0.45}) {
      SCOPED_TRACE(keep);
      SCOPED_TRACE(jitter);
      run(torn(5, jitter, keep, 3), all_stages());
      run(torn(5, jitter, keep, 4), polish_towards(20));
      is_any_inverted |= !invalid_cells(torn(5, jitter, keep, 3), {}).empty();
    }
  EXPECT_TRUE(is_any_inverted) << "links are never checked";
}

TEST_F(PinchedParts, WhatIsFixedStays) {
  const TetMesh mesh = torn(5, 0.4, 0.6, 3);
  ImproveOptions options = all_stages();
  for (std::size_t c = 0; c + 40 < mesh.n_cells(); c += 40) {
    const auto& v = mesh.cell(C(c)).v;
    options.surface.fixed_edges.push_back({v[1], v[3]});
    options.surface.fixed_faces.push_back({v[0], v[3], v[2]});
  }
  run(mesh, options);
}

TEST_F(PinchedParts, OtherOperatorsHaveTheBytesOfSharedMemory) {
  std::set<std::string> done;
  for (const Rounds rounds : {Rounds::kAuto, Rounds::kMixed})
    for (ImproveOptions options : {polish_towards(20), all_stages()}) {
      options.ops = Ops::kDefault | Ops::kCluster;
      if (options.polish_only) options.ops = without(options.ops, Ops::kInsert);
      options.rounds = rounds;
      done.merge(run(torn(7, 0.4, 0.99, 9), options));
    }
  if (comm.rank() == 0) {
    EXPECT_THAT(done, testing::IsSupersetOf({"polish", "mixed", "insert", "cluster"}));
  }
}

TEST_F(PinchedParts, LargeStarsHaveTheBytesOfSharedMemory) {
  const generate::Arrays wheel = hub(140);  // vertices of 280 and 420 cells
  TetMesh mesh = build(wheel.points, wheel.cells);
  for (Index v = 4; v < 144; ++v) {
    const Vec3 p = mesh.point(V(v));
    mesh.set_point(V(v), p + Vec3{0, 0, 0.02 * (generate::random_unit(1, v) - 0.5)});
  }
  const auto done = run(mesh, all_stages());
  if (comm.rank() == 0) {
    EXPECT_THAT(done, testing::Not(testing::IsEmpty()));
  }
  const generate::Arrays everyone = neighbourly(20);
  run(build(everyone.points, everyone.cells), all_stages());
}

/// What hangs together goes through faces: a box that was written the other way round is turned, although it
/// shares a vertex with one that was not.
TEST_F(PinchedParts, ABoxThatWasTurnedOverIsTurnedBackByItself) {
  const generate::Arrays boxes = pinched(4, 0.2, 3);
  const TetMesh mesh = build(boxes.points, boxes.cells);
  io::MeshData data = io::disassemble(mesh);
  const std::size_t half = data.cells.size() / 2;
  for (std::size_t c = half; c < data.cells.size(); ++c) std::swap(data.cells[c][0], data.cells[c][1]);
  if (comm.rank() == 0) io::write_mesh(path, data);
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  EXPECT_THAT(mpi::read_ranges(parts, path, 300),
              testing::Contains(testing::HasSubstr("were written the other way round")));
  expect_same_run(comm, folder, path, all_stages());
}

/// Each rank that holds all cells of a vertex knows whether it is pinched, before and after a run.
TEST_F(PinchedParts, WhoHoldsAllCellsKnows) {
  if (comm.rank() == 0) io::write(path, torn(6, 0.3, 0.9, 9));
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  const auto expect_known = [&] {
    const TetMesh& part = parts.part();
    const std::vector<std::uint32_t> size = star_sizes(part);
    std::size_t n_pinched = 0;
    Star star;
    for (std::size_t i = 0; i < part.n_vertices(); ++i) {
      if (!parts.within_two().has(i, comm.rank()) || size[i] == 0) continue;
      const bool is = is_pinched(part, V(i), size[i], star);
      EXPECT_TRUE(!is || parts.work().pinched[i] != 0) << "vertex " << parts.number(V(i));
      n_pinched += is && parts.is_own(V(i)) ? 1 : 0;
      std::size_t n_seen = 0;
      mpi::WholeStars(part, parts.work()).for_cells(V(i), [&](CellHandle c) {
        EXPECT_TRUE(part.cell(c).has(V(i)));
        ++n_seen;
      });
      EXPECT_EQ(n_seen, size[i]);
    }
    return comm.sum(n_pinched);
  };
  const std::uint64_t n_before = expect_known();
  EXPECT_GT(n_before, 20U);
  const auto copy = parts.copy();
  mpi::improve(parts, all_stages());
  EXPECT_LE(expect_known(), n_before);
  parts.work().pinched.assign(parts.part().n_vertices() + 1, 0);  // whatever it was
  parts.put_back(*copy);
  EXPECT_EQ(parts.work().pinched.size(), parts.part().n_vertices());
  EXPECT_EQ(expect_known(), n_before);
}

/// Pairs of cells on triangles round one axis, all with the same two tips: any pair may become three cells
/// round the edge of the tips, which may be made once.
TEST_F(PinchedParts, AnEdgeBetweenPinchedVerticesIsMadeOnce) {
  constexpr Index kPairs = 12;
  std::vector<Vec3> points = {{0, 0, 0.2}, {0, 0, -0.2}};
  std::vector<Corners> cells;
  for (Index i = 0; i < kPairs; ++i) {
    const auto first = static_cast<Index>(points.size());
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * std::numbers::pi * (k / 3.0 + 0.37 * i), radius = 1 + 0.03 * i;
      points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    }
    cells.push_back({first, first + 1, first + 2, 0});
    cells.push_back({first, first + 2, first + 1, 1});
  }
  const auto done = run(build(points, cells), polish_towards(25));
  if (comm.rank() == 0) {
    EXPECT_THAT(done, testing::Contains("face"));
  }
}

/// Whatever group of cells leads there.
TEST_F(PinchedParts, CutoutsHaveAllThatLiesSoNear) {
  const TetMesh mesh = torn(4, 0.3, 0.4, 9);
  if (comm.rank() == 0) io::write(path, mesh);
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  const auto near = [&](std::set<std::size_t>& cells) {  // and those that share a vertex with one of them
    std::set<VertexHandle> vertices;
    for (std::size_t c : cells) vertices.insert(mesh.cell(C(c)).v.begin(), mesh.cell(C(c)).v.end());
    for (CellHandle c : mesh.cells())
      if (std::ranges::any_of(mesh.cell(c).v, [&](VertexHandle v) { return vertices.contains(v); }))
        cells.insert(c.idx());
  };
  std::size_t n_beyond = 0;  // cutouts that walks alone would not have made
  for (std::uint64_t first = 0; first < mesh.n_cells(); first += 5)
    for (const std::uint8_t depth : {std::uint8_t{0}, std::uint8_t{2}}) {
      mpi::Cutout cutout(parts, {&first, 1}, {&depth, 1}, mpi::Cutout::Where::kOnAll);
      std::set<std::size_t> found, wanted = {first};
      for (CellHandle c : cutout.mesh().cells()) found.insert(cutout.number(c));
      for (int i = 0; i <= depth; ++i) near(wanted);
      EXPECT_EQ(found, wanted) << "round cell " << first << ", " << int{depth};
      std::set<std::size_t> walked;
      for (VertexHandle v : mesh.cell(C(first)).v)
        for (CellHandle c : mesh.vertex_cells(v)) walked.insert(c.idx());
      n_beyond += depth == 0 && walked.size() < wanted.size() ? 1 : 0;
    }
  EXPECT_GT(n_beyond, 10U);
}

TEST_F(PinchedParts, MorePinchesThanThereWereAreAFault) {
  if (comm.rank() == 0) io::write(path, build(chain(3, 3, 0.1).points, chain(3, 3, 0.1).cells));
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  EXPECT_THAT(mpi::check(parts).message, testing::HasSubstr("do not connect through faces"));
  mpi::Pinches known = mpi::pinches(parts);
  EXPECT_EQ(comm.sum(known.vertices.size()), 2U);
  EXPECT_EQ(comm.sum(known.edges.size()), 0U);
  EXPECT_TRUE(mpi::check(parts, known).is_good);
  if (!known.vertices.empty()) known.vertices.begin()->second = 1;
  EXPECT_FALSE(mpi::check(parts, known).is_good);
  // Not where they were there before, in cells that have changed.
  const auto before = parts.copy();
  TetMesh& part = parts.part();
  for (std::size_t c = 0; c < part.n_cells(); ++c) {  // a turn of its corners, so that it is another
    Cell& cell = TetMesh::Writer(part).cell(C(c));
    std::rotate(cell.v.begin(), cell.v.begin() + 1, cell.v.begin() + 3);
    std::rotate(cell.mate.begin(), cell.mate.begin() + 1, cell.mate.begin() + 3);
  }
  for (std::size_t c = 0; c < part.n_cells(); ++c)
    for (HalfFaceHandle& m : TetMesh::Writer(part).cell(C(c)).mate)
      if (m.is_valid() && corner_of(m) < 3) m = halfface_of(cell_of(m), (corner_of(m) + 2) % 3);
  EXPECT_FALSE(mpi::check(parts).is_good);
  EXPECT_TRUE(mpi::check_changes(parts, *before).is_good) << mpi::check(parts, mpi::pinches(*before)).message;
}

}  // namespace
}  // namespace hfr::test
