// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Stars.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "HalfFace/Generate.hh"

namespace hfr::test {
namespace {

TEST(Stars, AreAllCellsRoundAVertexAscending) {
  const generate::Arrays box = generate::jittered_box({4, 4, 4}, 0.1, 3);
  const TetMesh mesh = build(box.points, box.cells);
  const std::vector<VertexHandle> asked = {VertexHandle(31), VertexHandle(), VertexHandle(7),
                                           VertexHandle(31)};
  for (const int threads : {1, 4}) {
    const Stars stars(mesh, asked, {threads, 0});
    for (VertexHandle v : mesh.vertices()) {
      std::vector<CellHandle> expected;
      if (std::ranges::find(asked, v) != asked.end())
        for (CellHandle c : mesh.cells())
          if (mesh.cell(c).has(v)) expected.push_back(c);
      EXPECT_TRUE(std::ranges::equal(stars.of(v), expected)) << v.idx();
    }
    EXPECT_TRUE(stars.of(VertexHandle()).empty());
  }
  EXPECT_TRUE(Stars().of(VertexHandle(0)).empty());
  EXPECT_TRUE(Stars(mesh, std::array{VertexHandle()}, {}).of(VertexHandle(7)).empty());
}

/// Two cells that share a vertex alone: a walk round it sees one of them.
TEST(Stars, CellsOfAPinchedVertexAreAllThere) {
  const std::vector<Vec3> points = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                                    {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const TetMesh mesh = build(points, std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {0, 4, 6, 5}});
  EXPECT_EQ(Stars(mesh, std::array{VertexHandle(0)}, {}).of(VertexHandle(0)).size(), 2U);
}

TEST(Stars, DeletedCellsAreInNone) {
  const generate::Arrays box = generate::box({2, 2, 2});
  TetMesh mesh = build(box.points, box.cells);
  const VertexHandle v = mesh.cell(CellHandle(5)).v[0];
  const std::size_t n = Stars(mesh, std::array{v}, {}).of(v).size();
  mesh.delete_cell(CellHandle(5));
  EXPECT_EQ(Stars(mesh, std::array{v}, {}).of(v).size(), n - 1);
}

}  // namespace
}  // namespace hfr::test
