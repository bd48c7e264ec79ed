// SPDX-License-Identifier: BSD-3-Clause
// What options name as fixed, and what ends a run early, over a mesh in parts.
#include "Distributed/PartFixes.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "Distributed/Labelled.hh"

namespace hfr::test {
namespace {

/// Vertices, edges and faces of cells that lie all over a mesh.
SurfaceOptions some_of(const TetMesh& mesh) {
  SurfaceOptions surface;
  const std::size_t step = mesh.n_cells() / 24;
  for (std::size_t c = 0; c < mesh.n_cells(); c += step) {
    const auto& v = mesh.cell(C(c)).v;
    switch (c / step % 3) {
      case 0:
        surface.fixed_vertices.push_back(v[c % 4]);
        break;
      case 1:
        surface.fixed_edges.push_back({v[3], v[c % 3]});
        break;
      default:
        surface.fixed_faces.push_back({v[2], v[0], v[1]});
    }
  }
  return surface;
}

class FixedInParts : public testing::Test {
 protected:
  void write(const TetMesh& mesh) {
    if (comm.rank() == 0) io::write(path, mesh);
    comm.sum(0);
  }

  mpi::Comm comm{MPI_COMM_WORLD};
  SharedFolder folder{comm};
  std::filesystem::path path = folder.path() / "in.vtu";
};

TEST_F(FixedInParts, RunsHaveTheBytesOfSharedMemory) {
  const TetMesh mesh = valid_box(7, 0.33, 5);
  write(mesh);
  ImproveOptions whole;
  whole.policy = {};
  for (ImproveOptions options : {polish_towards(25), whole}) {
    expect_same_run(comm, folder, path, options);
    const auto free = comm.rank() == 0 ? bytes_of(folder.path() / "whole.vtu") : std::string();
    options.surface = some_of(mesh);
    expect_same_run(comm, folder, path, options);
    if (comm.rank() == 0) {
      EXPECT_NE(bytes_of(folder.path() / "whole.vtu"), free) << "nothing that is fixed matters";
    }
  }
}

/// What was not fixed before is free again afterwards, on each rank that holds it; what was is not.
TEST_F(FixedInParts, IsAsFreeAfterwardsAsBefore) {
  TetMesh mesh = valid_box(6, 0.33, 5);
  SurfaceOptions named = some_of(mesh);
  mesh.set_fixed(named.fixed_vertices[1]);
  write(mesh);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  const std::vector<std::uint8_t> frozen = parts.work().frozen;
  const auto n_fixed = [&] {
    std::uint64_t n = 0;
    for (VertexHandle v : parts.part().vertices()) n += parts.is_own(v) && parts.part().is_fixed(v) ? 1 : 0;
    return comm.sum(n);
  };
  EXPECT_EQ(n_fixed(), 1U);
  {
    mpi::PartFixes fixes(parts, named);
    EXPECT_EQ(n_fixed(), named.fixed_vertices.size());
    const Locks& locks = parts.part().locks();
    EXPECT_EQ(comm.sum(locks.edges.empty() ? 0 : 1), static_cast<std::uint64_t>(comm.size()));
    for (const auto& face : named.fixed_faces) {
      std::array<VertexHandle, 3> here;
      std::ranges::transform(face, here.begin(), [&](VertexHandle v) { return parts.vertex_at(v.idx()); });
      if (std::ranges::all_of(here, [&](VertexHandle v) { return v.is_valid() && parts.is_own(v); })) {
        EXPECT_NE(locks.faces.find(here), nullptr);
        EXPECT_TRUE(
            std::ranges::all_of(here, [&](VertexHandle v) { return parts.work().frozen[v.idx()] != 0; }));
      }
    }
    fixes.release();
  }
  EXPECT_EQ(n_fixed(), 1U);
  EXPECT_TRUE(parts.part().locks().empty());
  for (std::size_t v = 0; v < frozen.size(); ++v)
    if (parts.within_two().has(v, comm.rank())) {
      EXPECT_EQ(parts.work().frozen[v], frozen[v]) << "vertex " << parts.number(V(v));
    }
}

TEST_F(FixedInParts, WhatTheMeshDoesNotHaveIsNamedOnAllRanks) {
  TetMesh mesh = valid_box(4, 0.1, 1);
  mesh.labels().faces.set({V(0), V(1), V(6)}, 7);
  write(mesh);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  const auto refusal = [&](auto&& fix) -> std::string {
    ImproveOptions options = polish_towards(15);
    fix(options.surface);
    try {
      mpi::improve(parts, options);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return {};
  };
  using S = SurfaceOptions;
  EXPECT_EQ(refusal([](S& s) {
              s.fixed_vertices = {V(3), V(125)};
            }),
            "fix vertex:125: there are 125 vertices, counted from 0");
  EXPECT_EQ(refusal([](S& s) {
              s.fixed_vertices = {V(125)};
              s.fixed_patches = {5};
            }),
            "fix vertex:125: there are 125 vertices, counted from 0");
  EXPECT_EQ(refusal([](S& s) {
              s.fixed_edges = {{V(0), V(1)}, {V(1), V(0)}, {V(0), V(1)}};
              s.fixed_faces = {{V(0), V(1), V(6)}, {V(6), V(0), V(1)}};
              s.fixed_vertices = {V(7), V(7)};
            }),
            "");
  EXPECT_EQ(refusal([](S& s) {
              s.fixed_edges = {{V(0), V(1)}, {V(200), V(99)}};
            }),
            "fix edge:200-99: there are 125 vertices, counted from 0");
  EXPECT_EQ(refusal([](S& s) { s.fixed_edges = {{V(0), V(124)}}; }), "fix edge:0-124: there is no such edge");
  EXPECT_EQ(refusal([](S& s) {
              s.fixed_faces = {{V(0), V(1), V(124)}};
            }),
            "fix face:0-1-124: there is no such face");
  EXPECT_EQ(refusal([](S& s) { s.fixed_patches = {7, 8}; }), "fix patch:8: no face has this label");
  EXPECT_EQ(refusal([](S& s) { s.fixed_patches = {7}; }), "");
  EXPECT_EQ(refusal([](S& s) { s.fixed_edges = {{V(1), V(0)}}; }), "");
}

/// Shared memory is asked in the same places, so that a run which is cancelled at the same question is the
/// same run. One rank cancels; the others have not been told how.
TEST_F(FixedInParts, ACancelOnOneRankEndsAllAtTheSameQuestion) {
  write(valid_box(6, 0.35, 8));
  std::atomic<int> n_asked{0};
  ImproveOptions options;
  options.policy = {};
  options.cancel = [&] { return ++n_asked < 0; };
  {
    mpi::DistributedMesh parts(comm);
    mpi::read_ranges(parts, path, 300);
    const mpi::PartsResult result = mpi::improve(parts, options);
    EXPECT_EQ(result.stop, Stop::kNoProgress);
  }
  const int n_all = n_asked;
  EXPECT_GT(n_all, 20);
  for (const int at : {1, 3, n_all / 4, n_all / 2, n_all - 2}) {
    SCOPED_TRACE(at);
    n_asked = 0;
    options.cancel = nullptr;
    if (comm.rank() == comm.size() - 1) options.cancel = [&] { return ++n_asked >= at; };
    mpi::DistributedMesh parts(comm);
    mpi::read_ranges(parts, path, 300);
    const mpi::PartsResult result = mpi::improve(parts, options);
    EXPECT_EQ(result.stop, Stop::kCancelled);
    EXPECT_TRUE(mpi::check(parts).is_good);
    EXPECT_GE(result.after.worst, result.before.worst);
    mpi::write_vtu(parts, folder.path() / "parts.vtu");
    if (comm.rank() == 0) {
      TetMesh mesh = io::read(path);
      n_asked = 0;
      options.cancel = [&] { return ++n_asked >= at; };
      hfr::improve(mesh, options);
      io::write(folder.path() / "whole.vtu", mesh);
      EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
    }
    comm.sum(0);
  }
}

/// Of one rank, met in the middle of the run: in a callback that all ranks hear, it waits for its clock.
TEST_F(FixedInParts, ATimeLimitOfOneRankEndsTheRunOfAll) {
  write(valid_box(7, 0.35, 8));
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  ImproveOptions options;
  options.policy = {};
  constexpr double kSeconds = 0.2;
  const auto start = std::chrono::steady_clock::now();
  if (comm.rank() == 0) {
    options.time_limit = kSeconds;
    options.progress = [&, n = 0](const Progress&) mutable {
      if (++n == 6) std::this_thread::sleep_until(start + std::chrono::duration<double>(2 * kSeconds));
    };
  }
  const mpi::PartsResult result = mpi::improve(parts, options);
  EXPECT_EQ(result.stop, Stop::kTimeLimit);
  EXPECT_TRUE(result.changed);
  EXPECT_GE(result.after.worst, result.before.worst);
  EXPECT_TRUE(mpi::check(parts).is_good);
}

TEST_F(FixedInParts, ProgressIsThatOfTheWhole) {
  write(valid_box(6, 0.35, 8));
  std::vector<Progress> heard, of_shared;
  ImproveOptions options;
  options.policy = {};
  if (comm.rank() == comm.size() - 1)
    options.progress = [&](const Progress& progress) { heard.push_back(progress); };
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  mpi::improve(parts, options);
  if (comm.rank() != comm.size() - 1) return;
  TetMesh mesh = io::read(path);
  options.progress = [&](const Progress& progress) { of_shared.push_back(progress); };
  hfr::improve(mesh, options);
  ASSERT_EQ(heard.size(), of_shared.size());
  EXPECT_GT(heard.size(), 5U);
  for (std::size_t i = 0; i < heard.size(); ++i) {
    EXPECT_EQ(heard[i].stage, of_shared[i].stage);
    EXPECT_EQ(heard[i].min_dihedral, of_shared[i].min_dihedral) << i;
    EXPECT_EQ(heard[i].n_inverted, of_shared[i].n_inverted);
  }
}

}  // namespace
}  // namespace hfr::test
