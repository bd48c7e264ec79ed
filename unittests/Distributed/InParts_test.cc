// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/InParts.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>

#include "Distributed/Parts.hh"
#include "Distributed/SharedFolder.hh"
#include "HalfFace/Check.hh"
#include "IO/Assemble.hh"
#include "IO/MeshFile.hh"
#include "IO/ReadWrite.hh"
#include "Remesh/Survey.hh"
#include "ScratchFolder.hh"

namespace hfr::test {
namespace {

constexpr mpi::Partition kCuts[] = {mpi::Partition::kCoordinates, mpi::Partition::kNumbers};

mpi::GridOptions grid(generate::Counts counts, double jitter, double amplitude = 0) {
  mpi::GridOptions options;
  options.cavity.counts = counts;
  options.cavity.jitter = jitter;
  options.cavity.amplitude = amplitude;
  return options;
}

TetMesh whole_of(const mpi::GridOptions& options) {
  const generate::Arrays arrays = generate::cavity(options.cavity);
  return build(arrays.points, arrays.cells);
}

ImproveOptions polish_towards(double degrees) {
  ImproveOptions options;
  options.min_dihedral = degrees;
  options.polish_only = true;
  options.policy = {};
  return options;
}

TEST(InParts, AGridComesAsInSharedMemoryWhateverTheParts) {
  for (const mpi::Partition how : kCuts)
    for (const double amplitude : {0.0, 0.02}) {
      mpi::Comm comm(MPI_COMM_WORLD);
      const mpi::GridOptions options = grid({9, 7, 8}, 0.2, amplitude);
      mpi::DistributedMesh parts(comm);
      mpi::generate_in_parts(parts, options, how);
      Whole whole(whole_of(options), MinSine2{});
      EXPECT_EQ(parts.n_cells(), whole.mesh.n_cells());
      EXPECT_EQ(parts.n_vertices(), whole.mesh.n_vertices());
      parts.work().set_qualities(parts.part(), MinSine2{}, {});
      expect_part_of(parts, whole);
      const Whole before = whole;
      gather_from_nothing(parts, whole);
      if (comm.rank() == 0) expect_same(before, whole);
    }
}

TEST(InParts, WhatIsCountedIsWhatIsThere) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const mpi::GridOptions options = grid({6, 5, 7}, 0.3);
  mpi::DistributedMesh parts(comm);
  mpi::generate_in_parts(parts, options);
  const TetMesh whole = whole_of(options);
  const mpi::InParts found = mpi::survey(parts, 12);
  EXPECT_EQ(found.n_cells, whole.n_cells());
  EXPECT_EQ(found.n_vertices, whole.n_vertices());
  EXPECT_EQ(found.n_boundary_faces,
            static_cast<std::size_t>(std::ranges::distance(whole.boundary_halffaces())));
  EXPECT_EQ(found.n_invalid, hfr::invalid_cells(whole, {}).size());
  EXPECT_GT(found.n_invalid, 0U);
  EXPECT_EQ(found.n_below_goal, hfr::n_below(whole, 12, {}));
  EXPECT_EQ(found.n_below[1], hfr::n_below(whole, 10, {}));
  EXPECT_EQ(found.min_dihedral, hfr::smallest_dihedral(whole, {}));
}

/// Towards goals that the polish reaches, and beyond: then it goes on as far as it does in shared memory.
TEST(InParts, ThePolishHasTheBitsOfSharedMemory) {
  for (const mpi::Partition how : kCuts)
    for (const double goal : {12.0, 24.0, 40.0}) {
      mpi::Comm comm(MPI_COMM_WORLD);
      const mpi::GridOptions grid_options = grid({10, 9, 11}, 0.22);
      mpi::DistributedMesh parts(comm);
      mpi::generate_in_parts(parts, grid_options, how);
      const mpi::PartsResult result = mpi::improve(parts, polish_towards(goal));
      EXPECT_TRUE(result.changed);
      EXPECT_FALSE(result.has_fallen);
      const mpi::PartsCheck checked = mpi::check(parts);
      EXPECT_TRUE(checked.is_good) << checked.message;
      Whole whole(whole_of(grid_options), MinSine2{});
      parts.gather(&whole.mesh, &whole.work, mpi::DistributedMesh::Gather::kEverything);
      if (comm.rank() != 0) continue;
      whole.mesh.collect_garbage();
      TetMesh mesh = whole_of(grid_options);
      const Result shared = hfr::improve(mesh, polish_towards(goal));
      EXPECT_EQ(check(mesh), Ok);
      for (const PassReport& pass : shared.passes)
        EXPECT_TRUE(pass.stage == "polish" || pass.stage == "finish") << pass.stage << " is no polish";
      EXPECT_TRUE(identical(mesh, whole.mesh)) << goal;
      EXPECT_EQ(shared.goal_reached, result.goal_reached);
      EXPECT_EQ(shared.goal_reached, goal < 30);
      EXPECT_EQ(result.after.n_cells, mesh.n_cells());
      EXPECT_EQ(result.after.n_vertices, mesh.n_vertices());
      EXPECT_EQ(result.after.n_below_goal, hfr::n_below(mesh, goal, {}));
    }
}

TEST(InParts, CoordinatesThatNothingCanBeDecidedFromAreRefusedAsInSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const mpi::GridOptions grid_options = grid({3, 3, 24}, 0.1);
  const auto place_all = [](TetMesh& mesh, auto&& place) {
    for (VertexHandle v : mesh.vertices()) mesh.set_point(v, place(mesh.point(v)));
  };
  const auto refusal = [](auto&& improve) -> std::string {
    try {
      improve();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return {};
  };
  const auto expect_refused = [&](const char* words, auto&& place) {
    TetMesh mesh = whole_of(grid_options);
    place_all(mesh, place);
    const std::string expected = refusal([&] { hfr::improve(mesh, polish_towards(15)); });
    EXPECT_THAT(expected, testing::HasSubstr(words));
    mpi::DistributedMesh parts(comm);
    mpi::generate_in_parts(parts, grid_options);
    place_all(parts.part(), place);
    EXPECT_EQ(refusal([&] { mpi::improve(parts, polish_towards(15)); }), expected);
  };
  // One vertex at either end: no rank of several has both.
  for (const double end : {0.0, 1.0}) {
    const auto is_it = [&](Vec3 p) { return p.x == 1 && p.y == 1 && p.z == end; };
    expect_refused("beyond 1e30", [&](Vec3 p) { return is_it(p) ? 2e30 * p : p; });
    expect_refused("no numbers", [&](Vec3 p) { return is_it(p) ? Vec3{p.x, std::nan(""), p.z} : p; });
  }
  expect_refused("below 1e-25", [](Vec3 p) { return 1e-26 * p; });
  expect_refused("too coarse", [](Vec3 p) { return p + Vec3{1e14, 0, 0}; });
}

TEST(InParts, WhatIsNotThereIsNamed) {
  mpi::Comm comm(MPI_COMM_WORLD);
  mpi::DistributedMesh parts(comm);
  mpi::generate_in_parts(parts, grid({6, 6, 6}, 0.22));
  const auto refusal = [&](auto&& change) -> std::string {
    ImproveOptions options = polish_towards(15);
    change(options);
    try {
      mpi::improve(parts, options);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return {};
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal([](auto& o) {
                o = ImproveOptions();
                o.passes_only = true;
                o.metric = Metric::kMinSine;
              }),
              HasSubstr("another metric than volume-length"));
  EXPECT_THAT(refusal([](auto& o) {
                o.surface.mode = SurfaceMode::kFlat;
                o.surface.periodic.push_back({1, 2});
              }),
              HasSubstr("periodic patches"));
  EXPECT_THAT(refusal([](auto& o) { o.maps = true; }), HasSubstr("maps"));
}

/// Of a part in which something is spoilt on one rank, all ranks learn.
TEST(InParts, ACheckFindsWhatOneRankHasWrong) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const int bad = comm.size() - 1;
  const auto found_after = [&](auto&& spoil) {
    mpi::DistributedMesh parts(comm);
    mpi::generate_in_parts(parts, grid({7, 6, 8}, 0.1));
    EXPECT_TRUE(mpi::check(parts).is_good);
    if (comm.rank() == bad) spoil(parts);
    const mpi::PartsCheck found = mpi::check(parts);
    EXPECT_FALSE(found.is_good);
    EXPECT_FALSE(found.message.empty());
    EXPECT_LT(found.rank, comm.size());
    return found.message;
  };
  const auto own_cell = [](const mpi::DistributedMesh& parts) {
    for (std::size_t c = 0;; ++c) {
      const auto& v = parts.part().cell(C(c)).v;
      if (std::all_of(v.begin(), v.end(), [&](VertexHandle u) { return parts.is_own(u); })) return C(c);
    }
  };
  using testing::HasSubstr;
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                auto& cell = TetMesh::Writer(parts.part()).cell(own_cell(parts));
                std::swap(cell.v[0], cell.v[1]);
              }),
              HasSubstr("cell"));
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                parts.work().star_size[parts.part().cell(own_cell(parts)).v[0].idx()] += 1;
              }),
              HasSubstr("another number of cells"));
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                for (std::size_t v = 0;; ++v)
                  if (parts.is_own(V(v)) && !parts.is_among_own(V(v))) {
                    TetMesh::Writer(parts.part()).set_incident_cell(V(v), {});
                    return;
                  } else if (comm.size() == 1) {
                    TetMesh::Writer(parts.part()).set_incident_cell(V(0), {});
                    return;
                  }
              }),
              HasSubstr("incident cell"));
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                TetMesh::Writer writer(parts.part());
                for (HalfFaceHandle h : parts.part().cell_halffaces(own_cell(parts)))
                  if (const HalfFaceHandle m = parts.part().opposite_halfface(h); m.is_valid()) {
                    writer.set_mate(h, {});
                    writer.set_mate(m, {});
                    return;
                  }
              }),
              HasSubstr("not each other's neighbours"));
  if (comm.size() == 1) return;
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                for (std::size_t v = 0; v < parts.part().n_vertices(); ++v)
                  if (!parts.is_own(V(v)) && parts.part().incident_cell(V(v)).is_valid()) {
                    parts.part().set_point(V(v), {-1, -1, -1});
                    return;
                  }
              }),
              HasSubstr("as rank " + std::to_string(bad) + " holds it"));
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                for (std::size_t v = 0;; ++v)
                  if (!parts.is_own(V(v)) && parts.within_two().has(v, bad)) {
                    parts.work().pinched.assign(parts.part().n_vertices(), 0);
                    parts.work().pinched[v] = 1;
                    return;
                  }
              }),
              HasSubstr("as rank " + std::to_string(bad) + " holds it"));
  const auto near_of_others = [&](const mpi::DistributedMesh& parts) {
    for (std::size_t v = 0;; ++v)
      if (!parts.is_own(V(v)) && parts.within_two().has(v, bad)) return V(v);
  };
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                parts.work().star_size[near_of_others(parts).idx()] += 1;
              }),
              HasSubstr("as rank " + std::to_string(bad) + " holds it"));
  EXPECT_THAT(found_after([&](mpi::DistributedMesh& parts) {
                const VertexHandle v = near_of_others(parts);
                for (CellHandle c : parts.part().vertex_cells(v))
                  if (c != parts.part().incident_cell(v)) {
                    TetMesh::Writer(parts.part()).set_incident_cell(v, c);
                    return;
                  }
              }),
              HasSubstr("as rank " + std::to_string(bad) + " holds it"));
}

TEST(InParts, OneFileHasTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const mpi::GridOptions grid_options = grid({8, 9, 7}, 0.22);
  for (const mpi::Partition how : kCuts) {
    mpi::DistributedMesh parts(comm);
    mpi::generate_in_parts(parts, grid_options, how);
    const mpi::PartsResult result = mpi::improve(parts, polish_towards(14));
    mpi::write_vtu(parts, folder.path() / "parts.vtu");
    if (comm.rank() != 0) continue;
    TetMesh mesh = whole_of(grid_options);
    const std::size_t n_before = mesh.n_vertices();
    hfr::improve(mesh, polish_towards(14));
    EXPECT_EQ(result.before.n_vertices, n_before);
    io::write(folder.path() / "whole.vtu", mesh);
    EXPECT_EQ(bytes_of(folder.path() / "parts.vtu"), bytes_of(folder.path() / "whole.vtu"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2) << "temporary files";
  }
}

/// A grid and a run over it.
struct Improving {
  mpi::GridOptions grid;
  ImproveOptions options;
};

/// A goal that takes new vertices; and one that insertion alone works for, so that some cells have to wait
/// for others, with room for all vertices, for some, and for none.
std::vector<Improving> inserting() {
  std::vector<Improving> all = {{grid({7, 8, 10}, 0.28), polish_towards(26)}};
  for (const std::size_t more : {0U, 100U, 40U, 1U}) {
    Improving one{grid({7, 8, 10}, 0.28), polish_towards(14)};
    one.options.ops = Ops::kInsert;
    if (more > 0) one.options.max_cells = whole_of(one.grid).n_cells() + more;
    all.push_back(one);
  }
  return all;
}

/// Of the vertices within two edges of own ones all cells are there, and no others are.
void expect_two_layers(const mpi::DistributedMesh& parts) {
  const TetMesh& part = parts.part();
  std::vector<int> edges(part.n_vertices(), 3);  // from an own vertex
  for (std::size_t v = 0; v < edges.size(); ++v)
    if (parts.is_own(V(v))) edges[v] = 0;
  std::vector<std::uint32_t> n_cells(part.n_vertices(), 0);
  for (const int step : {1, 2, 3})
    for (CellHandle c : part.cells()) {
      int least = 3;
      for (VertexHandle v : part.cell(c).v) least = std::min(least, edges[v.idx()]);
      if (step == 3) {
        EXPECT_LE(least, 2);
        for (VertexHandle v : part.cell(c).v) ++n_cells[v.idx()];
      } else if (least < step) {
        for (VertexHandle v : part.cell(c).v) edges[v.idx()] = std::min(edges[v.idx()], step);
      }
    }
  std::size_t n_wrong = 0;
  for (std::size_t v = 0; v < edges.size(); ++v)
    if (edges[v] <= 2 && !part.is_deleted(V(v))) n_wrong += n_cells[v] == parts.work().star_size[v] ? 0 : 1;
  EXPECT_EQ(n_wrong, 0U);
}

struct BothRuns {
  mpi::PartsResult in_parts;
  std::optional<Result> shared;  ///< on rank 0
};

/// The run in parts, and on rank 0 in shared memory: the same bytes, and no fault on any rank.
BothRuns improved_both_ways(mpi::Comm& comm, const Improving& one, mpi::Partition how) {
  const SharedFolder folder(comm);
  mpi::DistributedMesh parts(comm);
  mpi::generate_in_parts(parts, one.grid, how);
  BothRuns runs{mpi::improve(parts, one.options), {}};
  const mpi::PartsCheck checked = mpi::check(parts);
  EXPECT_TRUE(checked.is_good) << checked.message;
  expect_two_layers(parts);
  mpi::write_vtu(parts, folder.path() / "parts.vtu");
  if (comm.rank() != 0) return runs;
  TetMesh mesh = whole_of(one.grid);
  runs.shared = hfr::improve(mesh, one.options);
  EXPECT_EQ(runs.in_parts.after.n_cells, mesh.n_cells());
  EXPECT_EQ(runs.in_parts.after.n_vertices, mesh.n_vertices());
  EXPECT_EQ(runs.in_parts.goal_reached, runs.shared->goal_reached);
  io::write(folder.path() / "whole.vtu", mesh);
  EXPECT_EQ(bytes_of(folder.path() / "parts.vtu"), bytes_of(folder.path() / "whole.vtu"));
  return runs;
}

std::size_t n_of(const std::vector<PassReport>& passes, std::string_view op) {
  std::size_t n = 0;
  for (const PassReport& pass : passes) n += pass.op == op ? pass.winners : 0;
  return n;
}

TEST(InParts, InsertedVerticesHaveTheBitsOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  std::size_t n_inserted = 0;
  std::set<std::size_t> n_cells;
  for (const mpi::Partition how : kCuts)
    for (const Improving& one : inserting()) {
      const BothRuns runs = improved_both_ways(comm, one, how);
      if (!runs.shared) continue;
      n_inserted += n_of(runs.shared->passes, "insert");
      n_cells.insert(runs.in_parts.after.n_cells);
    }
  if (comm.rank() != 0) return;
  EXPECT_GT(n_inserted, 100U);
  EXPECT_GE(n_cells.size(), 4U) << "no bound on cells was met";
}

/// Runs that come to cluster search: where there is no room for new vertices, where few other operators may
/// do something before, in one selection or in turn, and where none may.
std::vector<Improving> searching() {
  std::vector<Improving> all = {{grid({12, 11, 13}, 0.26, 0.03), polish_towards(25)}};
  all[0].options.ops = Ops::kDefault | Ops::kCluster;
  all[0].options.max_cells = 1000;
  const auto add = [&](double goal, Ops ops, Rounds rounds) {
    all.push_back({grid({8, 7, 9}, 0.28), polish_towards(goal)});
    all.back().options.ops = ops | Ops::kCluster;
    all.back().options.rounds = rounds;
  };
  add(18, Ops::kEdge, Rounds::kAuto);
  add(20, Ops::kEdge | Ops::kFace, Rounds::kMixed);
  add(10, Ops::kCluster, Rounds::kAuto);
  return all;
}

TEST(InParts, SearchedClustersHaveTheBitsOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  for (const mpi::Partition how : kCuts)
    for (const Improving& one : searching()) {
      const BothRuns runs = improved_both_ways(comm, one, how);
      if (!runs.shared) continue;
      const std::size_t n_searched = n_of(runs.shared->passes, "cluster");
      EXPECT_GT(n_searched, 0U) << "nothing is left to cluster search";
      EXPECT_EQ(n_of(runs.in_parts.passes, "cluster"), n_searched);
    }
}

TEST(InParts, KindsInOneSelectionHaveTheBitsOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  for (const mpi::Partition how : kCuts)
    for (const Ops ops : {Ops::kDefault, without(Ops::kDefault, Ops::kNode)}) {
      Improving one{grid({10, 9, 11}, 0.24), polish_towards(24)};
      one.options.rounds = Rounds::kMixed;
      one.options.ops = ops;
      const BothRuns runs = improved_both_ways(comm, one, how);
      if (!runs.shared) continue;
      const auto n_mixed = std::ranges::count(runs.in_parts.passes, "mixed", &PassReport::op);
      EXPECT_GT(n_mixed, 0);
      EXPECT_EQ(std::ranges::count(runs.shared->passes, "mixed", &PassReport::op), n_mixed);
    }
}

/// Whatever ranks have written the pieces, they are the mesh; and a run goes on from there as from one file.
TEST(InParts, PiecesComeBackAsTheMesh) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "a & b.pvtu";
  const mpi::GridOptions grid_options = grid({8, 9, 7}, 0.22);
  {
    mpi::DistributedMesh parts(comm);
    mpi::generate_in_parts(parts, grid_options);
    mpi::improve(parts, polish_towards(10));
    mpi::write_pvtu(parts, path);
  }
  TetMesh mesh = whole_of(grid_options);
  hfr::improve(mesh, polish_towards(10));
  mpi::DistributedMesh parts(comm);
  EXPECT_THAT(mpi::read_pvtu(parts, path), testing::IsEmpty());
  parts.work().set_qualities(parts.part(), MinSine2{}, {});
  EXPECT_EQ(parts.n_cells(), mesh.n_cells());
  EXPECT_EQ(parts.n_vertices(), mesh.n_vertices());
  expect_part_of(parts, Whole(mesh, MinSine2{}));
  EXPECT_TRUE(mpi::check(parts).is_good);
  mpi::improve(parts, polish_towards(16));
  mpi::write_vtu(parts, folder.path() / "parts.vtu");
  if (comm.rank() == 0) {
    hfr::improve(mesh, polish_towards(16));
    io::write(folder.path() / "whole.vtu", mesh);
    EXPECT_EQ(bytes_of(folder.path() / "parts.vtu"), bytes_of(folder.path() / "whole.vtu"));
  }
  // By each rank alone, what all have written.
  mpi::Comm alone(MPI_COMM_SELF);
  mpi::DistributedMesh one(alone);
  mpi::read_pvtu(one, path);
  TetMesh again = whole_of(grid_options);
  hfr::improve(again, polish_towards(10));
  EXPECT_EQ(mpi::survey(one).worst, hfr::survey(again, {}).worst);
  EXPECT_EQ(one.n_cells(), again.n_cells());
}

/// One file by ranges: whatever its numbers are, and whoever has written it, the parts are those of the mesh.
TEST(InParts, RangesOfOneFileAreTheMesh) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "one.vtu";
  TetMesh mesh = whole_of(grid({8, 9, 7}, 0.22));
  // Numbers that say nothing of where things are.
  std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
  const std::size_t n = points.size(), step = 287;
  ASSERT_EQ(std::gcd(n, step), 1U);
  std::vector<std::array<Index, 4>> cells;
  std::vector<Vec3> shuffled(n);
  for (std::size_t i = 0; i < n; ++i) shuffled[i * step % n] = points[i];
  shuffled.push_back({2, 2, 2});  // of no cell
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    auto& v = cells.emplace_back();
    const std::size_t from = c * 11 % mesh.n_cells();
    for (std::size_t k = 0; k < 4; ++k) v[k] = static_cast<Index>(mesh.cell(C(from)).v[k].idx() * step % n);
  }
  ASSERT_EQ(std::gcd(mesh.n_cells(), std::size_t{11}), 1U);
  mesh = build(shuffled, cells);
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) mesh.set_region(C(c), c % 3 == 0 ? 4 : -1);
  if (comm.rank() == 0) io::write(path, mesh);
  comm.sum(0);
  for (const std::uint64_t at_once : {100, 5000}) {
    mpi::DistributedMesh parts(comm);
    EXPECT_THAT(mpi::read_ranges(parts, path, at_once), testing::IsEmpty());
    parts.work().set_qualities(parts.part(), MinSine2{}, {});
    EXPECT_EQ(parts.n_cells(), mesh.n_cells());
    EXPECT_EQ(parts.n_vertices(), mesh.n_vertices());
    expect_part_of(parts, Whole(mesh, MinSine2{}));
    EXPECT_TRUE(mpi::check(parts).is_good);
    const std::uint64_t most_held = mpi::survey(parts).most_held;
    EXPECT_TRUE(comm.size() == 1 || most_held < mesh.n_cells()) << most_held;
    mpi::write_vtu(parts, folder.path() / "again.vtu");
    if (comm.rank() == 0) {
      EXPECT_EQ(bytes_of(folder.path() / "again.vtu"), bytes_of(path));
    }
    comm.sum(0);
  }
}

TEST(InParts, FilesThatCannotBeReadInRangesAreRefusedOnAllRanks) {
  mpi::Comm world(MPI_COMM_WORLD);
  const SharedFolder folder(world);
  const auto path = folder.path() / "bad.vtu";
  const TetMesh mesh = valid_box(2, 0, 1);
  if (world.rank() == 0) io::write(path, mesh);
  world.sum(0);
  const std::string good = bytes_of(path);
  const auto refusal = [&](const std::string& bytes) {
    world.sum(0);  // all have done with the file before
    if (world.rank() == 0) std::ofstream(path, std::ios::binary) << bytes;
    world.sum(0);
    return refusal_of([&](mpi::DistributedMesh& parts) { mpi::read_ranges(parts, path); });
  };
  const auto with = [&](const std::string& was, const std::string& is) {
    std::string bytes = good;
    bytes.replace(bytes.find(was), was.size(), is);
    return bytes;
  };
  using testing::HasSubstr;
  EXPECT_EQ(refusal(good), "");
  EXPECT_THAT(refusal(""), HasSubstr("hfremesh convert writes it"));
  EXPECT_THAT(refusal(with("encoding=\"raw\"", "encoding=\"base64\"")),
              HasSubstr("hfremesh convert writes it"));
  EXPECT_THAT(refusal(with("byte_order", "compressor=\"vtkZLibDataCompressor\" byte_order")),
              HasSubstr("hfremesh convert writes it"));
  EXPECT_THAT(refusal(good.substr(0, good.size() / 2)), HasSubstr("ends too early"));
  EXPECT_THAT(refusal(with("NumberOfPoints=\"27\"", "NumberOfPoints=\"26\"")), HasSubstr("array 'Points'"));
  EXPECT_THAT(refusal(with("NumberOfPoints=\"27\"", "NumberOfPoints=\"x\"")), HasSubstr("must be a number"));
  EXPECT_THAT(refusal(with("Name=\"types\"", "Name=\"kinds\"")), HasSubstr("no array 'types'"));
  // What only the rank sees that reads it: the last cell's kind, and its last corner.
  const auto number_of = [&](const std::string& name) {
    const std::size_t at = good.find("offset=\"", good.find("Name=\"" + name + "\"")) + 8;
    return good.find("\n_") + 2 + std::stoul(good.substr(at)) + 8;
  };
  std::string bytes = good;
  bytes[number_of("types") + mesh.n_cells() - 1] = 12;
  EXPECT_THAT(refusal(bytes), HasSubstr("cell 47: meshes in parts have tetrahedra, triangles and lines"));
  bytes = good;
  bytes[number_of("connectivity") + 16 * mesh.n_cells() - 4] = 27;
  EXPECT_THAT(refusal(bytes), HasSubstr("cell 47: vertex 27 is out of range"));
  bytes = good;
  bytes[number_of("connectivity") + 3] = '\x80';
  EXPECT_THAT(refusal(bytes), HasSubstr("cell 0: vertex -"));
  std::error_code error;
  if (world.rank() == 0) std::filesystem::remove(path, error);
  world.sum(0);
  mpi::DistributedMesh parts(world);
  EXPECT_THROW(mpi::read_ranges(parts, path), IoError);
}

TEST(InParts, RegionsStayWithTheirCells) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  mpi::DistributedMesh parts(comm);
  mpi::generate_in_parts(parts, grid({6, 5, 7}, 0.2));
  const auto region = [&](const mpi::DistributedMesh& mesh, CellHandle c) {
    return mesh.number(c) < mesh.n_cells() / 3 ? 1 : 2;
  };
  for (std::size_t c = 0; c < parts.part().n_cells(); ++c) parts.part().set_region(C(c), region(parts, C(c)));
  mpi::write_pvtu(parts, folder.path() / "two.pvtu");
  mpi::DistributedMesh read(comm);
  mpi::read_pvtu(read, folder.path() / "two.pvtu");
  std::size_t n_wrong = 0;
  for (std::size_t c = 0; c < read.part().n_cells(); ++c)
    n_wrong += read.part().region(C(c)) == region(read, C(c)) ? 0 : 1;
  EXPECT_EQ(n_wrong, 0U);
}

TEST(InParts, PiecesWithoutCellsNeedNoArrays) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const TetMesh mesh = valid_box(2, 0, 1);
  if (comm.rank() == 0) {
    io::MeshData data = io::disassemble(mesh);
    io::Field points{"number", 1, false, {}}, cells{"number", 1, false, {}}, heat{"heat", 1, false, {}};
    for (std::size_t i = 0; i < data.points.size(); ++i) points.values.push_back(static_cast<double>(i));
    for (std::size_t c = 0; c < data.cells.size(); ++c) cells.values.push_back(static_cast<double>(c));
    heat.values.assign(data.points.size(), 0.5);
    data.point_fields = {points, heat};
    data.cell_fields = {cells};
    io::write_mesh(folder.path() / "heat.vtu", data);
    std::ofstream(folder.path() / "heat.pvtu")
        << "<PUnstructuredGrid><Piece Source=\"heat.vtu\"/></PUnstructuredGrid>";
  }
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  EXPECT_EQ(mpi::read_pvtu(parts, folder.path() / "heat.pvtu"), std::vector<std::string>{});
  EXPECT_EQ(mpi::attached_to_points(parts).names, std::vector<std::string>{"heat"});
  EXPECT_EQ(parts.n_cells(), mesh.n_cells());
  // All ranks but the first own nothing, and their pieces name no arrays.
  mpi::write_pvtu(parts, folder.path() / "again.pvtu");
  mpi::DistributedMesh again(comm);
  EXPECT_EQ(mpi::read_pvtu(again, folder.path() / "again.pvtu"), std::vector<std::string>{});
  EXPECT_EQ(again.n_cells(), mesh.n_cells());
  EXPECT_EQ(mpi::attached_to_points(again).names, std::vector<std::string>{"heat"});
}

TEST(InParts, NumbersThatComeTwiceAreRefused) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const TetMesh mesh = valid_box(2, 0, 1);
  for (const bool of_cells : {true, false}) {
    if (comm.rank() == 0) {
      io::MeshData data = io::disassemble(mesh);
      io::Field points{"number", 1, false, {}}, cells{"number", 1, false, {}};
      for (std::size_t i = 0; i < data.points.size(); ++i) points.values.push_back(static_cast<double>(i));
      for (std::size_t c = 0; c < data.cells.size(); ++c) cells.values.push_back(static_cast<double>(c));
      if (of_cells) cells.values[3] = 4;  // as many as the largest says, but not each once
      data.point_fields = {points};
      data.cell_fields = {cells};
      if (!of_cells) {
        const auto f = mesh.halfface_vertices(*mesh.boundary_halffaces().begin());
        data.triangles = {{f[0].idx(), f[1].idx(), f[2].idx()}};
        data.triangle_labels = {3};
        data.triangle_numbers = {100};
      }
      io::write_mesh(folder.path() / "bad.vtu", data);
      std::ofstream(folder.path() / "bad.pvtu")
          << "<PUnstructuredGrid><Piece Source=\"bad.vtu\"/></PUnstructuredGrid>";
    }
    comm.sum(0);
    mpi::DistributedMesh parts(comm);
    EXPECT_ANY_THROW(mpi::read_pvtu(parts, folder.path() / "bad.pvtu")) << of_cells;
  }
}

TEST(InParts, BrokenPiecesAreRefusedOnAllRanks) {
  mpi::Comm world(MPI_COMM_WORLD);
  const SharedFolder folder(world);
  const auto refusal = [&](const std::string& index) {
    if (world.rank() == 0) std::ofstream(folder.path() / "bad.pvtu") << index;
    return refusal_of(
        [&](mpi::DistributedMesh& parts) { mpi::read_pvtu(parts, folder.path() / "bad.pvtu"); });
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal("<VTKFile/>"), HasSubstr("no index of pieces"));
  EXPECT_THAT(refusal("<PUnstructuredGrid></PUnstructuredGrid>"), HasSubstr("it names no pieces"));
  EXPECT_THAT(refusal("<PUnstructuredGrid><Piece Source=\"none.vtu\"/></PUnstructuredGrid>"),
              HasSubstr("none.vtu"));
  if (world.rank() == 0) io::write(folder.path() / "plain.vtu", valid_box(2, 0, 1));
  EXPECT_THAT(refusal("<PUnstructuredGrid><Piece Source=\"plain.vtu\"/></PUnstructuredGrid>"),
              HasSubstr("\"number\""));
}

/// Whatever a rank is doing when it fails, all ranks end, all know why, and nothing half-written stays.
TEST(InParts, ARankThatFailsAnywhereEndsAll) {
  mpi::Comm world(MPI_COMM_WORLD);
  const SharedFolder folder(world);
  const auto run = [&](int bad, std::uint64_t call) -> std::uint64_t {
    mpi::Comm comm(MPI_COMM_WORLD);
    if (comm.rank() == bad) comm.fail_at_call(call);
    try {
      mpi::DistributedMesh parts(comm);
      mpi::generate_in_parts(parts, grid({8, 9, 7}, 0.22));
      mpi::improve(parts, polish_towards(18));
      mpi::check(parts);
      mpi::write_vtu(parts, folder.path() / "out.vtu");
      EXPECT_EQ(call, 0U);
    } catch (const mpi::RankFailed& failed) {
      EXPECT_EQ(failed.rank(), bad);
      EXPECT_NE(std::string(failed.what()).find("a fault that was asked for"), std::string::npos);
    } catch (const ResourceLimit& error) {
      EXPECT_EQ(comm.rank(), bad);
      EXPECT_EQ(comm.fail(5, error.what()).rank(), bad);
    }
    return comm.n_calls();
  };
  const std::uint64_t n_calls = run(0, 0);
  EXPECT_GT(n_calls, 20U);
  if (world.size() == 1) return;
  for (int k = 0; k < 8; ++k)
    run(k % 2 == 0 ? 0 : world.size() - 1, 1 + n_calls * static_cast<std::uint64_t>(k) / 8);
  run(world.size() - 1, n_calls);  // the last call, when the file is there
  world.sum(0);
  if (world.rank() == 0) {
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "temporary files";
  }
}

}  // namespace
}  // namespace hfr::test
