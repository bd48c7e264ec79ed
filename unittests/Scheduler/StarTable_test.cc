// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/StarTable.hh"
#include "Scheduler/VertexColours.hh"

#include <gtest/gtest.h>

#include "Operators/LimitMeshes.hh"
#include "Scheduler/Seeds.hh"
#include "Scheduler/Workspace.hh"

namespace hfr::test {
namespace {

std::vector<HalfFaceHandle> link_by_search(const TetMesh& mesh, VertexHandle v) {
  std::vector<HalfFaceHandle> link;
  for (CellHandle c : mesh.cells())
    if (mesh.cell(c).has(v)) link.push_back(halfface_of(c, mesh.cell(c).corner(v)));
  return link;
}

void expect_link(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link) {
  const auto expected = link_by_search(mesh, v);
  EXPECT_TRUE(std::equal(link.begin(), link.end(), expected.begin(), expected.end())) << "vertex " << v.idx();
}

TEST(StarTable, BothBuildersGiveTheCellsRoundTheVertexInOrder) {
  const TetMesh mesh = jittered(5, 0.3, 1);
  const auto all = all_vertices(mesh);
  const StarTable bulk(mesh, all, star_sizes(mesh));  // one sweep over all cells
  ASSERT_EQ(bulk.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) expect_link(mesh, all[i], bulk.link(i));
  for (std::size_t first = 0; first + 7 < all.size(); first += 7) {  // few: star by star
    const std::vector<VertexHandle> few(all.begin() + static_cast<std::ptrdiff_t>(first),
                                        all.begin() + static_cast<std::ptrdiff_t>(first) + 7);
    ASSERT_LT(few.size(), mesh.n_vertices() / 16);
    const StarTable table(mesh, few, star_sizes(mesh));
    for (std::size_t i = 0; i < few.size(); ++i) expect_link(mesh, few[i], table.link(i));
  }
}

TEST(StarTable, AnyNumberOfThreadsMakesTheSame) {
  const TetMesh mesh = jittered(6, 0.3, 4);
  const auto all = all_vertices(mesh);
  const auto few = std::span(all).first(mesh.n_vertices() / 20);
  const auto sizes = star_sizes(mesh);
  for (const std::span<const VertexHandle> vertices : {std::span<const VertexHandle>(all), few}) {
    const StarTable serial(mesh, vertices, sizes);
    for (const int threads : {2, 3, 7, 16}) {
      const StarTable table(mesh, vertices, sizes, {threads, /*serial_below=*/1});
      for (std::size_t i = 0; i < vertices.size(); ++i)
        EXPECT_TRUE(std::ranges::equal(table.link(i), serial.link(i))) << "vertex " << i << ", " << threads;
    }
  }
}

TEST(StarTable, StarsOfAnySizeAreThereFromBothBuilders) {
  const TetMesh mesh = built(hub(150));  // vertices 0 … 3 have 300 and 450 cells
  const auto sizes = star_sizes(mesh);
  ASSERT_EQ(sizes[0], 300U);
  const auto all = all_vertices(mesh);
  const std::vector<VertexHandle> few = {V(0), V(2), V(5), V(9)};
  ASSERT_LT(few.size(), mesh.n_vertices() / 16);
  for (const int threads : {1, 4, 7, 16}) {
    const StarTable bulk(mesh, all, sizes, {threads, /*serial_below=*/1});
    for (std::size_t i = 0; i < all.size(); ++i) expect_link(mesh, all[i], bulk.link(i));
    const StarTable table(mesh, few, sizes, {threads, /*serial_below=*/1});
    for (std::size_t i = 0; i < few.size(); ++i) expect_link(mesh, few[i], table.link(i));
  }
}

TEST(StarTable, PinchedVertexHasTheCellsOfAllItsPartsAndIsNotForRemoval) {
  generate::Arrays box = generate::box({4, 4, 4});
  const auto joint =
      static_cast<Index>(box.points.size());  // a second box touches the first in its last point
  generate::Arrays other = generate::box({4, 4, 4}, {1, 1, 1}, {2, 2, 2});
  for (auto& cell : other.cells) {
    for (Index& v : cell) v = v == 0 ? joint - 1 : v + joint - 1;
    box.cells.push_back(cell);
  }
  box.points.insert(box.points.end(), other.points.begin() + 1, other.points.end());
  const TetMesh mesh = build(box.points, box.cells);
  const auto sizes = star_sizes(mesh);
  std::vector<VertexHandle> vertices = {V(0), V(joint - 1), V(joint)};
  Star scratch;
  EXPECT_TRUE(is_pinched(mesh, V(joint - 1), sizes[joint - 1], scratch));
  const StarTable table(mesh, vertices, sizes);
  for (std::size_t i = 0; i < vertices.size(); ++i) expect_link(mesh, vertices[i], table.link(i));
  Workspace work;
  work.attach(mesh, {});
  drop_pinched(mesh, work, vertices);
  EXPECT_EQ(vertices, (std::vector<VertexHandle>{V(0), V(joint)}));
  for (const int threads : {2, 3, 7, 16}) EXPECT_EQ(star_sizes(mesh, {threads, /*serial_below=*/1}), sizes);
}

TEST(StarTable, VertexOfMoreCellsThanAStarHoldsIsNotForRemoval) {
  const TetMesh mesh = built(hub(150));
  Workspace work;
  work.attach(mesh, {});
  std::vector<VertexHandle> large, others;
  for (VertexHandle v : all_vertices(mesh))
    (work.star_size[v.idx()] > Star::kCapacity ? large : others).push_back(v);
  ASSERT_FALSE(large.empty());
  work.pinched.clear();  // a star may have outgrown that in a round
  std::vector<VertexHandle> left = all_vertices(mesh);
  drop_pinched(mesh, work, left);
  EXPECT_EQ(left, others);
}

TEST(StarTable, VertexThatIsPinchedNoLongerIsForRemoval) {
  const TetMesh mesh = jittered(3, 0.2, 1);
  Workspace work;
  work.attach(mesh, {});
  ASSERT_TRUE(work.pinched.empty());
  work.pinched.assign(mesh.n_vertices(), 1);
  std::vector<VertexHandle> left = all_vertices(mesh);
  drop_pinched(mesh, work, left);
  EXPECT_EQ(left, all_vertices(mesh));
}

TEST(Colouring, NoTwoVerticesOfACellShareAColour) {
  const TetMesh mesh = jittered(5, 0.3, 2);
  const auto all = all_vertices(mesh);
  for (const double share : {1.0, 0.5}) {
    std::vector<VertexHandle> vertices;
    for (VertexHandle v : all)
      if (generate::random_unit(5, v.idx()) < share) vertices.push_back(v);
    const StarTable stars(mesh, vertices, star_sizes(mesh));
    const auto groups = colour_vertices(mesh, vertices, stars);
    std::vector<int> colour(mesh.n_vertices(), -1);
    std::size_t n = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      EXPECT_FALSE(groups[g].empty());
      for (std::uint32_t i : groups[g]) {
        EXPECT_EQ(colour[vertices[i].idx()], -1) << "a vertex has two colours";
        colour[vertices[i].idx()] = static_cast<int>(g);
        ++n;
      }
    }
    EXPECT_EQ(n, vertices.size());
    EXPECT_LE(groups.size(), 12U) << "first-fit should need about eight";
    for (CellHandle c : mesh.cells()) {
      std::set<int> seen;
      for (VertexHandle v : mesh.cell(c).v)
        EXPECT_TRUE(colour[v.idx()] < 0 || seen.insert(colour[v.idx()]).second);
    }
  }
}

TEST(Colouring, AnyNumberOfThreadsGivesTheFirstFit) {
  const TetMesh mesh = jittered(9, 0.3, 6);
  const auto all = all_vertices(mesh);
  for (const double share : {1.0, 0.7, 0.2}) {
    std::vector<VertexHandle> vertices;
    for (VertexHandle v : all)
      if (generate::random_unit(8, v.idx()) < share) vertices.push_back(v);
    const StarTable stars(mesh, vertices, star_sizes(mesh));
    const auto first_fit = colour_vertices(mesh, vertices, stars);
    for (const int threads : {2, 3, 7, 16})
      for (int repetition = 0; repetition < 20; ++repetition)
        ASSERT_EQ(colour_vertices(mesh, vertices, stars, {threads, /*serial_below=*/1}), first_fit)
            << threads;
  }
}

TEST(Colouring, VerticesOfMoreThan256CellsTakePartForAnyNumberOfThreads) {
  const TetMesh mesh = built(hub(150));
  const auto sizes = star_sizes(mesh);
  for (const std::size_t first : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    const auto all = all_vertices(mesh);
    const auto vertices = std::span(all).subspan(first);
    const StarTable stars(mesh, vertices, sizes);
    const auto first_fit = colour_vertices(mesh, vertices, stars);
    std::vector<std::size_t> colour(mesh.n_vertices(), first_fit.size());
    for (std::size_t g = 0; g < first_fit.size(); ++g)
      for (std::uint32_t i : first_fit[g]) colour[vertices[i].idx()] = g;
    for (CellHandle c : mesh.cells())
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const std::size_t ours = colour[mesh.cell(c).v[i].idx()];
          EXPECT_TRUE(ours == first_fit.size() || ours != colour[mesh.cell(c).v[j].idx()]);
        }
    for (const int threads : {4, 7, 8, 16})
      for (int repetition = 0; repetition < 20; ++repetition)
        ASSERT_EQ(colour_vertices(mesh, vertices, stars, {threads, /*serial_below=*/1}), first_fit);
  }
}

TEST(Colouring, WhatHasNoStarHasNoPartInIt) {
  generate::Arrays arrays = generate::box({3, 3, 3});
  arrays.points.push_back({2, 2, 2});  // no cell uses it
  const TetMesh mesh = built(arrays);
  std::vector<VertexHandle> all;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) all.push_back(V(i));
  const StarTable stars(mesh, all, star_sizes(mesh));
  ASSERT_TRUE(stars.link(all.size() - 1).empty());
  for (const int threads : {1, 4, 16}) {
    std::size_t n = 0;
    for (const auto& group : colour_vertices(mesh, all, stars, {threads, /*serial_below=*/1})) {
      n += group.size();
      for (std::uint32_t i : group) EXPECT_FALSE(stars.link(i).empty());
    }
    EXPECT_EQ(n, all.size() - 1);
  }
}

TEST(Colouring, WhatNeedsMoreThan63ColoursMovesAlone) {
  const TetMesh mesh = built(neighbourly(70));
  const auto all = all_vertices(mesh);
  const StarTable stars(mesh, all, star_sizes(mesh));
  const auto groups = colour_vertices(mesh, all, stars);
  ASSERT_EQ(groups.size(), 70U);
  for (std::uint32_t i = 0; i < 70; ++i) EXPECT_EQ(groups[i], std::vector<std::uint32_t>{i});
  for (const int threads : {4, 7, 16})
    ASSERT_EQ(colour_vertices(mesh, all, stars, {threads, /*serial_below=*/1}), groups);
}

}  // namespace
}  // namespace hfr::test
