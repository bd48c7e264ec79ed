// SPDX-License-Identifier: BSD-3-Clause
#include "IO/Hash.hh"

#include <gtest/gtest.h>

#include <cmath>

#include "HalfFace/Generate.hh"
#include "IO/Assemble.hh"

namespace hfr::io {
namespace {

MeshData small_mesh() {
  generate::Arrays box = generate::two_region_box({2, 1, 1});
  MeshData data;
  data.points = std::move(box.points);
  data.cells = std::move(box.cells);
  data.regions = std::move(box.regions);
  data.triangles = {{0, 1, 4}, {1, 5, 4}};
  data.triangle_labels = {3, 0};
  data.edges = {{0, 1}, {2, 5}, {7, 6}};
  data.edge_labels = {1, 0, -3};
  data.vertex_labels = std::vector<int>(12, 5);
  data.fixed_vertices = {2, 11};
  return data;
}

TEST(Hash, SeesEveryPartOfAMesh) {
  const MeshData data = small_mesh();
  const std::uint64_t hash = mesh_hash(data);
  EXPECT_EQ(hash, mesh_hash(assemble(data)));
  const auto changed = [&](auto&& change) {
    MeshData other = data;
    change(other);
    return mesh_hash(other) != hash;
  };
  EXPECT_TRUE(changed([](MeshData& m) { m.points[7].y = std::nextafter(m.points[7].y, 2.0); }));
  EXPECT_TRUE(changed([](MeshData& m) { m.points[0].x = -0.0; }));
  EXPECT_TRUE(changed([](MeshData& m) { std::swap(m.cells[0], m.cells[1]); }));
  EXPECT_TRUE(changed([](MeshData& m) { m.cells.pop_back(); }));
  EXPECT_TRUE(changed([](MeshData& m) { ++m.regions[2]; }));
  EXPECT_TRUE(changed([](MeshData& m) { std::swap(m.triangles[0][0], m.triangles[0][1]); }));
  EXPECT_TRUE(changed([](MeshData& m) { ++m.triangle_labels[1]; }));
  EXPECT_TRUE(changed([](MeshData& m) { m.edges[0][0] = 6; }));
  EXPECT_TRUE(changed([](MeshData& m) { --m.edge_labels[2]; }));
  EXPECT_TRUE(changed([](MeshData& m) { m.vertex_labels[0] = 1; }));
  EXPECT_TRUE(changed([](MeshData& m) { m.fixed_vertices.pop_back(); }));
}

TEST(Hash, AbsentRegionsAndZeroRegionsAreTheSame) {
  MeshData data = small_mesh();
  data.regions.clear();
  data.vertex_labels.clear();
  MeshData zeros = data;
  zeros.regions.assign(data.cells.size(), 0);
  zeros.vertex_labels.assign(data.points.size(), 0);
  EXPECT_EQ(mesh_hash(data), mesh_hash(zeros));
}

TEST(Hash, IsTheSameOnEveryMachine) {
  MeshData data;
  data.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  data.cells = {{0, 1, 2, 3}};
  EXPECT_EQ(hash_text(mesh_hash(data)), "804407e3f5d02b4f");
  EXPECT_EQ(hash_text(0x123abcULL), "0000000000123abc");
}

}  // namespace
}  // namespace hfr::io
