// SPDX-License-Identifier: BSD-3-Clause
// Meshes that come from the arrays of the ranks and go back to them, and the order over all ranks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include "Distributed/Labelled.hh"
#include "Distributed/Order.hh"
#include "Distributed/RankArrays.hh"
#include "HalfFace/Generate.hh"

namespace hfr::test {
namespace {

using mpi::LabelRecord;
using mpi::RankArrays;
using Kind = LabelRecord::Kind;

/// What a rank gives of a mesh that all have: the cells that rank_of(cell) says, with their points.
template <class RankOf>
RankArrays arrays_of(const io::MeshData& data, int rank, RankOf&& rank_of) {
  RankArrays arrays;
  std::set<Index> vertices;
  for (std::size_t c = 0; c < data.cells.size(); ++c) {
    if (rank_of(c) != rank) continue;
    auto& corners = arrays.cells.emplace_back();
    std::ranges::copy(data.cells[c], corners.begin());
    vertices.insert(data.cells[c].begin(), data.cells[c].end());
    arrays.cell_number.push_back(c);
    if (!data.regions.empty()) arrays.regions.push_back(data.regions[c]);
  }
  for (Index v : vertices) {
    arrays.vertex_number.push_back(v);
    arrays.points.push_back(data.points[v]);
  }
  return arrays;
}

void give_all_points(const io::MeshData& data, RankArrays& arrays) {
  arrays.vertex_number.clear();
  for (std::size_t v = 0; v < data.points.size(); ++v) arrays.vertex_number.push_back(v);
  arrays.points = data.points;
}

template <class Number, std::size_t N>
LabelRecord record(Kind kind, const std::array<Number, N>& v, int value) {
  LabelRecord r;
  r.kind = kind;
  std::ranges::copy(v, r.v.begin());
  r.value = value;
  return r;
}

std::vector<LabelRecord> labels_of(const io::MeshData& data) {
  std::vector<LabelRecord> labels;
  for (std::size_t i = 0; i < data.triangles.size(); ++i)
    labels.push_back(record(Kind::kFace, data.triangles[i], data.triangle_labels[i]));
  for (std::size_t i = 0; i < data.edges.size(); ++i)
    labels.push_back(record(Kind::kEdge, data.edges[i], data.edge_labels[i]));
  for (std::size_t v = 0; v < data.vertex_labels.size(); ++v)
    if (data.vertex_labels[v] != 0)
      labels.push_back(
          record(Kind::kVertex, std::array<Index, 1>{static_cast<Index>(v)}, data.vertex_labels[v]));
  for (Index v : data.fixed_vertices)
    labels.push_back(record(Kind::kFixedVertex, std::array<Index, 1>{v}, 0));
  return labels;
}

int scattered(std::size_t c, int n_ranks) {
  return static_cast<int>(mix64(c) % static_cast<std::uint64_t>(n_ranks));
}

TEST(RankArrays, MeshesOfArraysHaveTheBytesOfFiles) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const io::MeshData data = labelled(valid_box(6, 0.4, seed), seed, density_of(seed));
    RankArrays arrays =
        arrays_of(data, comm.rank(), [&](std::size_t c) { return scattered(c, comm.size()); });
    if (comm.rank() == comm.size() - 1) {  // one alone knows of labels, in the order of the file
      give_all_points(data, arrays);
      arrays.labels = labels_of(data);
    }
    mpi::DistributedMesh parts(comm);
    mpi::from_arrays(parts, arrays);
    parts.part().labels().names = data.names;
    ASSERT_TRUE(mpi::check(parts).is_good);
    mpi::improve(parts, polish_towards(20));
    mpi::write_vtu(parts, folder.path() / "parts.vtu");
    if (comm.rank() == 0) {
      io::write_mesh(path, data);
      TetMesh mesh = io::read(path);
      EXPECT_TRUE(hfr::improve(mesh, polish_towards(20)).changed);
      io::write(folder.path() / "whole.vtu", mesh);
      EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
    }
    comm.sum(0);
  }
}

/// Steps of a solver: it gets its arrays, moves the points, and gives them back.
TEST(RankArrays, ArraysGoThereAndBackBetweenStepsOfASolver) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const io::MeshData data = labelled(valid_box(6, 0.3, 3), 3, {});
  const auto moved = [](Vec3 p) { return Vec3{p.x + 0.2 * p.y * p.z, p.y, p.z - 0.1 * p.x * p.x}; };
  ImproveOptions options;
  options.policy = {};
  RankArrays arrays = arrays_of(data, comm.rank(), [&](std::size_t c) { return scattered(c, comm.size()); });
  std::set<std::array<std::uint64_t, 3>> faces;  // labels come from all ranks that have a cell of theirs
  const auto here = [&](const LabelRecord& r) {
    return std::ranges::all_of(r.v, [&](std::uint64_t v) {
      return v == mpi::kNoNumber || std::ranges::binary_search(arrays.vertex_number, v);
    });
  };
  for (const LabelRecord& r : labels_of(data))
    if (here(r)) arrays.labels.push_back(r);
  for (int step = 0; step < 3; ++step) {
    mpi::DistributedMesh parts(comm);
    mpi::from_arrays(parts, arrays);
    mpi::improve(parts, options);
    arrays = mpi::own_arrays(parts);
    EXPECT_TRUE(std::ranges::is_sorted(arrays.vertex_number));
    EXPECT_TRUE(std::ranges::is_sorted(arrays.cell_number));
    if (step < 2) std::ranges::transform(arrays.points, arrays.points.begin(), moved);
  }
  // The same in shared memory, from a file.
  TetMesh whole;
  if (comm.rank() == 0) {
    io::write_mesh(folder.path() / "in.vtu", data);
    whole = io::read(folder.path() / "in.vtu");
    for (int step = 0; step < 3; ++step) {
      hfr::improve(whole, options);
      for (VertexHandle v : whole.vertices())
        if (step < 2) whole.set_point(v, moved(whole.point(v)));
    }
  }
  std::uint64_t n_own = 0, n_faces = 0, n_edges = 0;
  for (std::size_t i = 0; i < arrays.points.size(); ++i) n_own += arrays.owner[i] == comm.rank() ? 1 : 0;
  for (const LabelRecord& r : arrays.labels) n_faces += r.kind == Kind::kFace ? 1 : 0;
  EXPECT_EQ(comm.sum(n_own), comm.from_first<std::uint64_t>(whole.n_vertices()));
  const auto numbers = comm.all_gather(std::span<const std::uint64_t>(arrays.vertex_number));
  const auto points = comm.all_gather(std::span<const Vec3>(arrays.points));
  const auto cell_numbers = comm.all_gather(std::span<const std::uint64_t>(arrays.cell_number));
  const auto cells = comm.all_gather(std::span<const std::array<std::uint64_t, 4>>(arrays.cells));
  const auto regions = comm.all_gather(std::span<const std::int32_t>(arrays.regions));
  const auto labels = comm.all_gather(std::span<const LabelRecord>(arrays.labels));
  if (comm.rank() != 0) return;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    ASSERT_EQ(points[i], whole.point(V(numbers[i]))) << "vertex " << numbers[i];
  ASSERT_EQ(cell_numbers.size(), whole.n_cells());
  ASSERT_EQ(regions.size(), whole.n_cells());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellHandle c(cell_numbers[i]);
    for (std::size_t k = 0; k < 4; ++k) ASSERT_EQ(V(cells[i][k]), whole.cell(c).v[k]) << "cell " << c.idx();
    ASSERT_EQ(regions[i], whole.region(c));
  }
  for (const LabelRecord& r : labels) {
    const VertexHandle a(r.v[0]), b(r.v[1]), c(r.v[2]);
    if (r.kind == Kind::kFace) {
      const int* const found = whole.labels().faces.find({a, b, c});
      ASSERT_TRUE(found != nullptr && *found == r.value);
      faces.insert(r.key());
    } else if (r.kind == Kind::kEdge) {
      const int* const found = whole.labels().edges.find({a, b});
      ASSERT_TRUE(found != nullptr && *found == r.value);
      ++n_edges;
    } else if (r.kind == Kind::kVertex) {
      ASSERT_EQ(whole.labels().vertex(a), r.value);
    } else {
      ASSERT_TRUE(r.kind == Kind::kFixedVertex && whole.is_fixed(a));
    }
  }
  EXPECT_GT(n_faces, 0U);
  EXPECT_EQ(faces.size(), whole.labels().faces.size());
  EXPECT_GE(n_edges, whole.labels().edges.size());
}

TEST(RankArrays, CellsWithoutNumbersAreNumberedByRanks) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const io::MeshData data = io::disassemble(valid_box(4, 0.2, 1));
  const std::size_t n = data.cells.size(), n_ranks = comm.n_ranks();
  const auto slab = [&](std::size_t c) { return static_cast<int>(c * n_ranks / n); };
  RankArrays with = arrays_of(data, comm.rank(), slab), without = with;
  without.cell_number.clear();
  mpi::DistributedMesh a(comm), b(comm);
  mpi::from_arrays(a, with);
  mpi::from_arrays(b, without);
  EXPECT_EQ(mpi::own_arrays(a).cell_number, mpi::own_arrays(b).cell_number);
  EXPECT_EQ(mpi::own_arrays(a).cells, mpi::own_arrays(b).cells);
}

/// A rank that has nothing, and cells that lie on one rank: they stay there.
TEST(RankArrays, CellsStayWhereTheyAreInside) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const generate::Arrays column = generate::box({4, 4, 36});
  const io::MeshData data = io::disassemble(build(column.points, column.cells));
  const int n_with = std::max(comm.size() - 1, 1);
  const auto slab = [&](std::size_t c) {
    return static_cast<int>(c * static_cast<std::size_t>(n_with) / data.cells.size());
  };
  const RankArrays given = arrays_of(data, comm.rank(), slab);
  mpi::DistributedMesh parts(comm);
  mpi::from_arrays(parts, given);
  const RankArrays back = mpi::own_arrays(parts);
  std::size_t n_kept = 0;
  for (std::uint64_t c : back.cell_number) n_kept += std::ranges::binary_search(given.cell_number, c) ? 1 : 0;
  EXPECT_GE(static_cast<double>(n_kept), 0.8 * static_cast<double>(given.cells.size()));
  if (comm.rank() >= n_with) {
    EXPECT_TRUE(back.cells.empty());
  }
}

TEST(RankArrays, APointBelongsToTheRankThatGivesMostOfItsCells) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const io::MeshData data = io::disassemble(valid_box(5, 0.2, 1));
  const auto rank_of = [&](std::size_t c) { return scattered(c / 7, comm.size()); };
  std::vector<std::vector<int>> n_cells(data.points.size(), std::vector<int>(comm.n_ranks(), 0));
  for (std::size_t c = 0; c < data.cells.size(); ++c)
    for (Index v : data.cells[c]) ++n_cells[v][static_cast<std::size_t>(rank_of(c))];
  mpi::DistributedMesh parts(comm);
  mpi::from_arrays(parts, arrays_of(data, comm.rank(), rank_of));
  const RankArrays mine = mpi::own_arrays(parts);
  for (std::size_t i = 0; i < mine.points.size(); ++i) {
    const std::vector<int>& of = n_cells[mine.vertex_number[i]];
    EXPECT_EQ(mine.owner[i], std::ranges::max_element(of) - of.begin()) << "vertex " << mine.vertex_number[i];
  }
}

/// Six cells, of which a rank may hold some and own none: they are turned all the same.
TEST(RankArrays, CellsAreTurnedOnRanksThatOwnNone) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const generate::Arrays cube = generate::box({1, 1, 1});
  io::MeshData data = io::disassemble(build(cube.points, cube.cells));
  for (auto& cell : data.cells) std::swap(cell[0], cell[1]);
  const auto from = [&](auto&& rank_of) {
    mpi::DistributedMesh parts(comm);
    const RankArrays mine = arrays_of(data, comm.rank(), rank_of);
    EXPECT_THAT(mpi::from_arrays(parts, mine, mpi::Keep::kIfEven),
                testing::ElementsAre(testing::HasSubstr("flipped as a whole")));
    const mpi::PartsCheck checked = mpi::check(parts);
    EXPECT_TRUE(checked.is_good) << checked.message;
    EXPECT_EQ(mpi::survey(parts).n_invalid, 0U);
  };
  from([](std::size_t) { return 0; });
  from([&](std::size_t c) { return scattered(c, comm.size()); });
}

/// Where one rank gives everything, as when pieces are fewer than ranks, each gets its share; the bytes stay.
TEST(RankArrays, UnevenPartsAreCutAnew) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const io::MeshData data = io::disassemble(valid_box(8, 0.2, 1));
  const RankArrays given = arrays_of(data, comm.rank(), [](std::size_t) { return 0; });
  const auto n_own = [](mpi::DistributedMesh& mesh) { return mpi::own_arrays(mesh).cells.size(); };
  mpi::DistributedMesh kept(comm), even(comm), read(comm);
  mpi::from_arrays(kept, given);
  EXPECT_EQ(n_own(kept), given.cells.size());
  mpi::from_arrays(even, given, mpi::Keep::kIfEven);
  EXPECT_GE(2 * comm.n_ranks() * n_own(even), data.cells.size());
  mpi::write_pvtu(kept, folder.path() / "one.pvtu");
  mpi::read_pvtu(read, folder.path() / "one.pvtu");
  EXPECT_GE(2 * comm.n_ranks() * n_own(read), data.cells.size());
  EXPECT_TRUE(mpi::check(read).is_good);
  for (mpi::DistributedMesh* mesh : {&kept, &even, &read}) {
    mpi::write_vtu(*mesh, folder.path() / (mesh == &kept ? "kept.vtu" : "cut.vtu"));
    EXPECT_TRUE(mesh == &kept || bytes_of(folder.path() / "kept.vtu") == bytes_of(folder.path() / "cut.vtu"));
    comm.sum(0);
  }
}

TEST(RankArrays, WhatDoesNotFitIsRefusedInALine) {
  const io::MeshData data = io::disassemble(valid_box(3, 0.2, 1));
  const auto refusal = [&](auto&& spoil) {
    return refusal_of([&](mpi::DistributedMesh& parts) {
      mpi::Comm& comm = parts.comm();
      RankArrays arrays =
          arrays_of(data, comm.rank(), [&](std::size_t c) { return scattered(c, comm.size()); });
      if (comm.rank() == comm.size() - 1) spoil(arrays);
      mpi::from_arrays(parts, arrays);
      mpi::improve(parts, polish_towards(1));
    });
  };
  EXPECT_EQ(refusal([](RankArrays&) {}), "");
  EXPECT_THAT(refusal([](RankArrays& a) { a.points.pop_back(); }), testing::HasSubstr(" points and "));
  EXPECT_THAT(refusal([](RankArrays& a) { a.regions.push_back(1); }), testing::HasSubstr(" regions"));
  EXPECT_THAT(refusal([](RankArrays& a) { a.cells[3][2] = 12345; }),
              testing::HasSubstr("cell 3 of this rank has vertex 12345, whose point it does not give"));
  EXPECT_THAT(
      refusal([](RankArrays& a) {
        a.labels.push_back(record(Kind::kEdge, std::array<std::uint64_t, 2>{a.vertex_number[0], 12345}, 1));
      }),
      testing::HasSubstr("label 0 of this rank has vertex 12345"));
  EXPECT_THAT(refusal([](RankArrays& a) { a.cell_number[0] = a.cell_number[1]; }),
              testing::HasSubstr("numbers of cells have gaps, or come twice"));
  EXPECT_THAT(refusal([](RankArrays& a) {
                a.vertex_number.push_back(12345);
                a.points.push_back({});
              }),
              testing::HasSubstr("numbers of points have gaps"));
  EXPECT_THAT(refusal([](RankArrays& a) { a.points[0].x = std::nan(""); }), testing::HasSubstr("finite"));
  EXPECT_THAT(refusal([](RankArrays& a) {
                a.vertex_number.push_back(a.vertex_number[4]);
                a.points.push_back({9, 9, 9});
              }),
              testing::HasSubstr(" comes with different coordinates"));
  if (mpi::Comm(MPI_COMM_WORLD).size() > 1) {
    EXPECT_THAT(refusal([](RankArrays& a) {
                  for (Vec3& p : a.points) p.x += 1;
                }),
                testing::HasSubstr(" comes with different coordinates"));
    EXPECT_THAT(refusal([](RankArrays& a) { a.cell_number.clear(); }),
                testing::HasSubstr("some ranks give numbers of cells, and others do not"));
  }
}

TEST(Order, PlacesAreThoseOfAllKeysSorted) {
  mpi::Comm comm(MPI_COMM_WORLD);
  std::mt19937_64 engine(static_cast<std::uint64_t>(comm.rank()) + 1);
  for (const std::uint64_t range : {std::uint64_t{1}, std::uint64_t{7}, std::uint64_t{1} << 62}) {
    std::vector<mpi::OrderKey> keys(comm.rank() == 1 ? 0 : 500);
    for (mpi::OrderKey& key : keys) key = {engine() % 2, engine() % range, 5, engine() % 3};
    std::vector<mpi::OrderKey> all = comm.all_gather(std::span<const mpi::OrderKey>(keys));
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    const std::vector<std::uint64_t> places = mpi::places_in_order(comm, keys);
    ASSERT_EQ(places.size(), keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      ASSERT_LT(places[i], all.size());
      EXPECT_EQ(all[places[i]], keys[i]);
    }
  }
}

TEST(Order, BitsOfNumbersHaveTheirOrder) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const std::vector<double> values = {-kInf, -1e300, -2, -1, -1e-310, 0, 1e-310, 1, 1 + 1e-15, 3e9, kInf};
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(mpi::value_of_ordered(mpi::ordered_bits(values[i])), values[i]);
    if (i + 1 == values.size()) break;
    EXPECT_LT(mpi::ordered_bits(values[i]), mpi::ordered_bits(values[i + 1]));
  }
  EXPECT_EQ(mpi::ordered_bits(-0.0), mpi::ordered_bits(0.0));
}

}  // namespace
}  // namespace hfr::test
