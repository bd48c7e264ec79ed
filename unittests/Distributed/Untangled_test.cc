// SPDX-License-Identifier: BSD-3-Clause
// Meshes in parts with inverted and flat cells, beside what shared memory makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "Distributed/Labelled.hh"
#include "Distributed/PartPatches.hh"
#include "Distributed/PartUnfolding.hh"
#include "Parallel/DisjointSets.hh"
#include "Quality/Metrics.hh"

namespace hfr::test {
namespace {

using Motion = std::function<Vec3(Vec3 p, bool is_inside)>;

/// A box of unit cubes, each vertex where a motion brings it.
TetMesh moved_box(generate::Counts counts, const Motion& motion) {
  const Vec3 high = {1.0 * counts[0], 1.0 * counts[1], 1.0 * counts[2]};
  generate::Arrays arrays = generate::box(counts, {0, 0, 0}, high);
  for (Vec3& p : arrays.points)
    p = motion(p, p.x > 0 && p.x < high.x && p.y > 0 && p.y < high.y && p.z > 0 && p.z < high.z);
  return build(arrays.points, arrays.cells);
}

/// Away from there by up to so much, in every direction.
class Jitter {
 public:
  explicit Jitter(std::uint64_t seed) : engine_(seed) {}
  Vec3 operator()(double by) {
    std::uniform_real_distribution<double> at(-by, by);
    const double x = at(engine_), y = at(engine_), z = at(engine_);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

TetMesh tangled_inside(generate::Counts counts, double by, std::uint64_t seed) {
  Jitter jitter(seed);
  return moved_box(counts, [&](Vec3 p, bool is_inside) { return is_inside ? p + jitter(by) : p; });
}

/// Two corners of the box, far from each other, and nothing between them.
TetMesh two_tangles(std::uint64_t seed) {
  Jitter jitter(seed);
  return moved_box({9, 4, 4}, [&](Vec3 p, bool is_inside) {
    return is_inside ? p + jitter(p.x < 3 || p.x > 6 ? 0.9 : 0.1) : p;
  });
}

/// All cells round the middle are inverted, those of whole parts among them.
TetMesh inside_out(std::uint64_t seed) {
  Jitter jitter(seed);
  return moved_box({6, 5, 6}, [&](Vec3 p, bool is_inside) {
    if (!is_inside) return p;
    const Vec3 middle = {3, 2.5, 3};
    return middle - 0.7 * (p - middle) + jitter(0.1);
  });
}

/// Vertices that lie on their neighbours.
TetMesh with_flat_cells(std::uint64_t seed) {
  Jitter jitter(seed);
  return moved_box({5, 5, 5}, [&](Vec3 p, bool is_inside) {
    if (!is_inside) return p;
    return jitter(1).x < -0.7 ? p - Vec3{1, 0, 0} : p + jitter(0.2);
  });
}

/// The boundary has moved, and the inside stayed behind.
TetMesh left_behind(double by) {
  return moved_box({5, 5, 4}, [&](Vec3 p, bool is_inside) {
    return is_inside ? p : p + Vec3{by * std::sin(p.y * 0.6), 0.3 * by * std::sin(p.x * 0.6), 0};
  });
}

/// The boundary goes through itself, so that not all cells can be mended, and may end worse than it began.
TetMesh folded(generate::Counts counts, std::uint64_t seed) {
  Jitter jitter(seed);
  return moved_box(counts, [&](Vec3 p, bool) { return p + jitter(0.6); });
}

/// Positive cells that go through each other: octahedra that share their two nearest corners, u and v, each
/// with an edge between its farthest; each would make the edge from u to v in its place. From one to the next
/// go four cells at u and four at v, on opposite sides; or on one side, where both have an edge in common.
TetMesh overlapping(std::size_t n, std::uint64_t seed, bool has_pinched_edges) {
  Jitter jitter(seed);
  std::vector<Vec3> points = {{0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<Index, 4>> cells;
  const auto add_point = [&](double radius, double turn, double z) {
    points.push_back(Vec3{radius * std::cos(turn), radius * std::sin(turn), z} + jitter(0.1));
    return static_cast<Index>(points.size() - 1);
  };
  const auto add_cell = [&](Index a, Index b, Index c, Index d) {
    if (orientation(points[a], points[b], points[c], points[d]) < 0) std::swap(c, d);
    cells.push_back({a, b, c, d});
  };
  constexpr double kEighth = 0.25 * 3.14159265358979;
  std::array<Index, 4> last{};
  for (std::size_t i = 0; i < n; ++i) {
    const double turn = kEighth * static_cast<double>(i);
    std::array<Index, 4> rim{};
    for (std::size_t k = 0; k < 4; ++k)
      rim[k] = add_point(k % 2 == 0 ? 3 : 2, turn + 2 * kEighth * static_cast<double>(k), 0);
    for (const Index end : {0U, 1U}) {
      add_cell(rim[0], rim[2], end, rim[1]);
      add_cell(rim[0], rim[2], end, rim[3]);
      if (i == 0) continue;
      const std::size_t k = has_pinched_edges ? 0 : 2 * end;
      const double z = end == 0 ? 3 : -3, side = turn + 2 * kEighth * static_cast<double>(k);
      const Index p = add_point(3, side, z), q = add_point(3, side + 2 * kEighth, z);
      add_cell(end, last[k], last[k + 1], p);
      add_cell(end, last[k + 1], p, q);
      add_cell(end, last[k + 1], q, rim[k + 1]);
      add_cell(end, q, rim[k + 1], rim[(k + 2) % 4]);
    }
    last = rim;
  }
  return build(points, cells);
}

std::vector<std::pair<std::string, TetMesh>> tangled() {
  std::vector<std::pair<std::string, TetMesh>> all;
  for (const std::uint64_t seed : {1, 2})
    all.emplace_back("inside, " + std::to_string(seed), tangled_inside({4, 5, 4}, 0.6 + 0.2 * seed, seed));
  all.emplace_back("two tangles", two_tangles(3));
  all.emplace_back("inside out", inside_out(4));
  all.emplace_back("flat", with_flat_cells(5));
  all.emplace_back("left behind", left_behind(2.5));
  return all;
}

/// What the runs of a test have come to, over all meshes.
struct Seen {
  std::size_t unfolded = 0, reconnected = 0, smoothed = 0, inserted = 0, searched = 0, undone = 0, left = 0;
  std::size_t polished = 0;  ///< beside untangling

  void add(const Result& result) {
    for (const PassReport& pass : result.passes) {
      if (pass.stage == "undo") ++undone;
      if (pass.stage != "untangle") {
        polished += pass.winners;
        continue;
      }
      std::size_t& n = pass.op == "unfold"    ? unfolded
                       : pass.op == "smooth"  ? smoothed
                       : pass.op == "insert"  ? inserted
                       : pass.op == "cluster" ? searched
                                              : reconnected;
      n += pass.winners;
    }
    left += result.invalid_cells.size();
  }
};

void expect_same_run(mpi::Comm& comm, const SharedFolder& folder, const std::filesystem::path& in,
                     const ImproveOptions& options, Seen& seen) {
  seen.add(expect_same_run(comm, folder, in, options));
}

TEST(UntangledParts, TangledMeshesHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  Seen seen;
  for (const auto& [name, mesh] : tangled()) {
    SCOPED_TRACE(name);
    if (comm.rank() == 0) io::write(path, mesh);
    comm.sum(0);
    expect_same_run(comm, folder, path, polish_towards(12), seen);
  }
  if (comm.rank() != 0) return;
  EXPECT_GT(seen.unfolded, 200U);
}

/// What cannot be mended is left, held to links to the end, and where it ends worse than it began, begun
/// anew.
TEST(UntangledParts, FoldedBoundariesHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  Seen seen;
  for (const bool is_flat : {true, false}) {
    if (comm.rank() == 0) io::write(path, is_flat ? folded({2, 2, 1}, 23) : folded({2, 2, 2}, 10));
    comm.sum(0);
    ImproveOptions options = polish_towards(3);
    SCOPED_TRACE(is_flat);
    expect_same_run(comm, folder, path, options, seen);
  }
  if (comm.rank() != 0) return;
  EXPECT_GT(seen.left, 0U) << "all cells have been mended";
  EXPECT_GT(seen.reconnected, 0U);
  EXPECT_GT(seen.smoothed, 0U);
  EXPECT_GT(seen.undone, 0U) << "no run is put back";
}

/// Links have to be checked without any cell that is inverted, where the boundary goes through itself.
TEST(UntangledParts, OverlappingCellsHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  for (const bool has_pinched_edges : {false, true}) {
    SCOPED_TRACE(has_pinched_edges);
    if (comm.rank() == 0) io::write(path, overlapping(24, 5, has_pinched_edges));
    comm.sum(0);
    Seen seen;
    expect_same_run(comm, folder, path, polish_towards(30), seen);
    if (comm.rank() == 0) {
      EXPECT_GT(seen.polished, 0U) << "nothing was done";
    }
  }
}

TEST(UntangledParts, PinchedEdgesThatWereThereAreNoFault) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write(path, overlapping(6, 5, true));
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path, 300);
  EXPECT_THAT(mpi::check(parts).message, testing::HasSubstr("has more than one fan of cells"));
  mpi::Pinches known = mpi::pinches(parts);
  // Of an octahedron to the next one, seen from both ends.
  EXPECT_EQ(comm.sum(known.edges.size()), 10U);
  EXPECT_TRUE(mpi::check(parts, known).is_good);
  if (!known.edges.empty()) known.edges.begin()->second = 1;
  EXPECT_FALSE(mpi::check(parts, known).is_good);
}

/// Reconnecting alone, in turn and in one selection, with searched clusters, and with threads.
TEST(UntangledParts, OtherOperatorsHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write(path, tangled_inside({4, 4, 4}, 0.8, 7));
  comm.sum(0);
  Seen seen;
  for (const Ops ops : {without(Ops::kDefault, Ops::kSmooth) | Ops::kCluster, Ops::kInsert | Ops::kCluster,
                        Ops::kDefault | Ops::kCluster})
    for (const Rounds rounds : {Rounds::kAuto, Rounds::kMixed}) {
      if (ops == (Ops::kInsert | Ops::kCluster) && rounds == Rounds::kMixed) continue;
      ImproveOptions options = polish_towards(5);
      options.ops = ops;
      options.rounds = rounds;
      options.policy.threads = rounds == Rounds::kMixed ? 2 : 1;
      SCOPED_TRACE(static_cast<int>(ops));
      expect_same_run(comm, folder, path, options, seen);
    }
  if (comm.rank() != 0) return;
  EXPECT_GT(seen.reconnected, 50U);
  EXPECT_GT(seen.inserted, 0U);
  EXPECT_GT(seen.searched, 0U);
}

/// With regions, labels and fixed vertices.
TEST(UntangledParts, LabelledMeshesHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  Seen seen;
  for (const std::uint64_t seed : {2, 3}) {
    if (comm.rank() == 0)
      io::write_mesh(path, labelled(tangled_inside({4, 3, 4}, 0.7, seed), seed, density_of(seed)));
    comm.sum(0);
    expect_same_run(comm, folder, path, polish_towards(1), seen);
  }
  if (comm.rank() == 0) {
    EXPECT_GT(seen.unfolded, 10U);
    EXPECT_GT(seen.reconnected, 0U);
  }
}

/// What only the whole shows: a piece of the mesh that was written the other way round, and the whole. Parts
/// that have inverted cells alone are none.
/// A box of n³ cubes that hangs together with nothing else.
void put_box_beside(io::MeshData& data, Index n) {
  const io::MeshData box = io::disassemble(moved_box({n, n, n}, [](Vec3 p, bool) {
    return p + Vec3{10, 0, 0};
  }));
  const auto first = static_cast<Index>(data.points.size());
  for (auto cell : box.cells) {
    for (Index& v : cell) v += first;
    data.cells.push_back(cell);
  }
  data.points.insert(data.points.end(), box.points.begin(), box.points.end());
}

TEST(UntangledParts, PiecesOfNegativeCellsAreTurnedAsInSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  for (const bool turns_large : {false, true})
    for (const bool turns_small : {false, true}) {
      SCOPED_TRACE(turns_large);
      SCOPED_TRACE(turns_small);
      if (comm.rank() == 0) {
        io::MeshData data = io::disassemble(tangled_inside({3, 4, 3}, 0.5, 3));
        if (turns_large)
          for (auto& cell : data.cells) std::swap(cell[2], cell[3]);
        const std::size_t n_large = data.cells.size();
        put_box_beside(data, 2);
        for (std::size_t c = n_large; c < data.cells.size() && turns_small; ++c)
          std::swap(data.cells[c][2], data.cells[c][3]);
        io::write_mesh(path, data);
      }
      comm.sum(0);
      mpi::DistributedMesh parts(comm);
      EXPECT_EQ(mpi::read_ranges(parts, path).size(),
                (turns_large ? 1U : 0U) + (turns_large != turns_small ? 1U : 0U));
      EXPECT_TRUE(mpi::check(parts).is_good);
      mpi::write_vtu(parts, folder.path() / "parts.vtu");
      if (comm.rank() == 0) {
        io::write(folder.path() / "whole.vtu", io::read(path));
        EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
      }
      comm.sum(0);
      Seen seen;
      expect_same_run(comm, folder, path, polish_towards(12), seen);
    }
}

/// A third of the cells, half, and most of them; and two cells of which none is more.
TEST(UntangledParts, CellsThatAreOrderedAgainstOneAnotherAreTurnedAsInSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  const auto expect_same = [&](const io::MeshData& data) {
    if (comm.rank() == 0) io::write_mesh(path, data);
    comm.sum(0);
    mpi::DistributedMesh parts(comm);
    BuildReport report;
    io::assemble(io::read_mesh(path), {}, &report);
    const std::string notes = testing::PrintToString(mpi::read_ranges(parts, path, 300));
    EXPECT_THAT(notes, testing::HasSubstr(std::to_string(report.reoriented.size()) +
                                          " cells were written the other"));
    EXPECT_EQ(notes.find("flipped as a whole") != std::string::npos, report.flipped) << notes;
    EXPECT_TRUE(mpi::check(parts).is_good);
    mpi::write_vtu(parts, folder.path() / "parts.vtu");
    if (comm.rank() == 0) {
      io::write(folder.path() / "whole.vtu", io::read(path));
      EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
    }
    comm.sum(0);
  };
  for (const double share : {0.3, 0.5, 0.8}) {
    SCOPED_TRACE(share);
    io::MeshData data = io::disassemble(tangled_inside({5, 4, 6}, 0.5, 3));
    put_box_beside(data, 3);
    std::mt19937_64 engine(7);
    for (auto& cell : data.cells)
      if (std::uniform_real_distribution<double>()(engine) < share) std::swap(cell[1], cell[3]);
    expect_same(data);
    Seen seen;
    expect_same_run(comm, folder, path, polish_towards(12), seen);
  }
  io::MeshData two;
  two.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  two.cells = {{0, 1, 2, 3}, {1, 3, 2, 4}};
  expect_same(two);
  std::swap(two.cells[0], two.cells[1]);
  expect_same(two);
}

/// A strip of cells {i, i+1, i+2, i+3} whose last face is its first one, the other way round.
TEST(UntangledParts, WhatCannotBeOrientedIsRefusedOnAllRanks) {
  mpi::Comm world(MPI_COMM_WORLD);
  const SharedFolder folder(world);
  const auto path = folder.path() / "in.mesh";
  if (world.rank() == 0) {
    constexpr Index kLong = 61;
    constexpr std::array<Index, 3> kEnd = {1, 0, 2};
    const auto number = [&](Index i) { return i < kLong ? i : kEnd[i - kLong]; };
    io::MeshData data;
    for (Index i = 0; i < kLong; ++i)
      data.points.push_back({std::cos(0.1 * i), std::sin(0.1 * i), 0.3 * static_cast<double>(i % 3)});
    for (Index i = 0; i < kLong; ++i)
      data.cells.push_back({number(i), number(i + 1), number(i + 2), number(i + 3)});
    io::write_mesh(path, data);
    EXPECT_THROW(io::read(path), InvalidInput);
  }
  world.sum(0);
  const std::string refusal =
      refusal_of([&](mpi::DistributedMesh& parts) { mpi::read_ranges(parts, path, 10); });
  EXPECT_THAT(refusal, testing::HasSubstr("the mesh cannot be oriented"));
}

TEST(UntangledParts, SumsHaveTheOrderOfNumbersHoweverManyComeTogether) {
  mpi::Comm comm(MPI_COMM_WORLD);
  constexpr std::uint64_t kEnd = 5000;
  std::mt19937_64 engine(3);
  std::vector<mpi::Numbered> mine;
  double serial = 0, backwards = 0;
  std::vector<double> values;
  for (std::uint64_t i = 0; i < kEnd; ++i) {
    const double value = std::ldexp(static_cast<double>(engine() >> 11U), -static_cast<int>(engine() % 60));
    const auto who = static_cast<int>(engine() % comm.n_ranks());
    if (engine() % 3 == 0) continue;
    values.push_back(value);
    serial += value;
    if (who == comm.rank()) mine.insert(mine.begin(), {i, value});
  }
  for (std::size_t i = values.size(); i-- > 0;) backwards += values[i];
  EXPECT_NE(serial, backwards) << "the order does not matter for these";
  for (const std::uint64_t at_once : {7000U, 1000U, 37U})
    EXPECT_EQ(mpi::sum_in_order(comm, mine, kEnd, at_once), serial) << at_once;
  EXPECT_EQ(mpi::sum_in_order(comm, {}, kEnd), 0.0);
}

/// Long ones that wind through many parts, too.
TEST(UntangledParts, PatchesAreThoseOfTheWhole) {
  for (const mpi::Partition how : {mpi::Partition::kCoordinates, mpi::Partition::kNumbers})
    for (const unsigned one_in : {2U, 3U, 5U}) {
      mpi::Comm comm(MPI_COMM_WORLD);
      mpi::GridOptions grid;
      grid.cavity.counts = {9, 7, 8};
      grid.cavity.amplitude = 0;
      mpi::DistributedMesh parts(comm);
      mpi::generate_in_parts(parts, grid, how);
      const generate::Arrays arrays = generate::cavity(grid.cavity);
      const TetMesh whole = build(arrays.points, arrays.cells);
      std::mt19937_64 engine(one_in);
      std::vector<std::uint8_t> is_in(whole.n_vertices());
      for (auto& in : is_in) in = engine() % one_in == 0 ? 1 : 0;
      par::DisjointSets<Index> sets(whole.n_vertices());
      for (CellHandle c : whole.cells())
        for (VertexHandle u : whole.cell(c).v)
          for (VertexHandle v : whole.cell(c).v)
            if (is_in[u.idx()] && is_in[v.idx()]) sets.join(u.idx(), v.idx());
      std::vector<VertexHandle> known;
      const auto is_near = [&](VertexHandle v) {
        bool found = parts.is_own(v);
        mpi::for_ranks(parts.near(v), [&](int r) { found = found || r == comm.rank(); });
        return found;
      };
      for (std::size_t v = 0; v < parts.part().n_vertices(); ++v)
        if (is_in[parts.number(V(v))] && is_near(V(v))) known.push_back(V(v));
      const mpi::PartPatches patches(parts, known);
      std::size_t n_wrong = 0;
      for (VertexHandle v : known)
        n_wrong += patches.of(v) == sets.find(static_cast<Index>(parts.number(v))) ? 0 : 1;
      EXPECT_EQ(n_wrong, 0U) << one_in;
    }
}

/// One cell at a time, over all ranks, the damage of a patch is what it is in one go.
TEST(UntangledParts, ChangesOfPatchesAreJoinedInTheOrderOfTheirCells) {
  mpi::Comm comm(MPI_COMM_WORLD);
  constexpr std::uint64_t kCells = 600, kPatches = 7;
  Jitter jitter(11);
  std::mt19937_64 engine(12);
  std::vector<mpi::PatchChange> mine, whole(kPatches), backwards(kPatches);
  std::vector<mpi::PatchChange> cells;
  for (std::uint64_t i = 0; i < kCells; ++i) {
    mpi::PatchChange change{engine() % kPatches, i, {}, {}};
    change.was.add(jitter(1), jitter(1), jitter(1), jitter(1));
    change.is.add(jitter(1), jitter(1), jitter(1), jitter(1));
    cells.push_back(change);
    whole[change.patch].was.join(change.was);
    whole[change.patch].is.join(change.is);
    if (static_cast<int>(engine() % comm.n_ranks()) == comm.rank()) mine.insert(mine.begin(), change);
  }
  for (std::size_t i = cells.size(); i-- > 0;) backwards[cells[i].patch].is.join(cells[i].is);
  bool order_matters = false;
  const std::vector<mpi::PatchChange> joined = mpi::joined_on_first(comm, mine);
  ASSERT_EQ(joined.size(), comm.rank() == 0 ? kPatches : 0);
  for (std::size_t p = 0; p < joined.size(); ++p) {
    EXPECT_EQ(joined[p].patch, p);
    for (const auto& [found, expected] :
         {std::pair(joined[p].was, whole[p].was), std::pair(joined[p].is, whole[p].is)}) {
      EXPECT_EQ(found.n_inverted(), expected.n_inverted());
      EXPECT_EQ(found.n_invalid(), expected.n_invalid());
      EXPECT_EQ(found.overlap(), expected.overlap());
      EXPECT_EQ(found.worst(), expected.worst());
    }
    order_matters = order_matters || backwards[p].is.overlap() != whole[p].is.overlap();
  }
  if (comm.rank() == 0) {
    EXPECT_TRUE(order_matters) << "any order gives these sums";
  }
}

TEST(UntangledParts, APartThatIsPutBackIsWhatItWas) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, labelled(tangled_inside({5, 4, 5}, 0.5, 2), 2, density_of(1)));
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path);
  mpi::write_vtu(parts, folder.path() / "before.vtu");
  const auto copy = parts.copy();
  EXPECT_TRUE(mpi::improve(parts, polish_towards(15)).changed);
  const std::uint32_t clock = parts.work().clock;
  parts.put_back(*copy);
  EXPECT_EQ(parts.work().clock, clock);
  EXPECT_THAT(parts.work().changed, testing::Each(clock)) << "what failed before would not be tried again";
  parts.work().set_qualities(parts.part(), MinSine2{}, {});
  EXPECT_TRUE(mpi::check(parts).is_good);
  mpi::write_vtu(parts, folder.path() / "after.vtu");
  if (comm.rank() == 0) {
    EXPECT_TRUE(bytes_of(folder.path() / "before.vtu") == bytes_of(folder.path() / "after.vtu"));
  }
  comm.sum(0);
  mpi::improve(parts, polish_towards(15));
  mpi::write_vtu(parts, folder.path() / "after.vtu");
  if (comm.rank() == 0) {
    TetMesh mesh = io::read(path);
    hfr::improve(mesh, polish_towards(15));
    io::write(folder.path() / "whole.vtu", mesh);
    EXPECT_TRUE(bytes_of(folder.path() / "whole.vtu") == bytes_of(folder.path() / "after.vtu"));
  }
}

/// Whatever a rank is doing when it fails, all ranks end, and all know why.
TEST(UntangledParts, ARankThatFailsEndsAll) {
  mpi::Comm world(MPI_COMM_WORLD);
  if (world.size() == 1) GTEST_SKIP() << "one rank fails alone";
  const SharedFolder folder(world);
  const auto path = folder.path() / "in.vtu";
  if (world.rank() == 0) io::write(path, tangled_inside({4, 4, 4}, 0.8, 7));
  world.sum(0);
  const auto run = [&](std::uint64_t call) -> std::uint64_t {
    mpi::Comm comm(MPI_COMM_WORLD);
    if (comm.rank() == comm.size() - 1) comm.fail_at_call(call);
    try {
      mpi::DistributedMesh parts(comm);
      mpi::read_ranges(parts, path);
      mpi::improve(parts, polish_towards(1));
      EXPECT_EQ(call, 0U);
    } catch (const mpi::RankFailed& failed) {
      EXPECT_EQ(failed.rank(), comm.size() - 1);
    } catch (const ResourceLimit& error) {
      EXPECT_EQ(comm.fail(5, error.what()).rank(), comm.size() - 1);
    }
    return comm.n_calls();
  };
  const std::uint64_t n_calls = run(0);
  for (std::uint64_t k = 1; k <= 6; ++k) run(n_calls * k / 7);
}

}  // namespace
}  // namespace hfr::test
