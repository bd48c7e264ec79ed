// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MovedVertices.hh"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>

#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Vec3> displacement_of(Engine& engine, std::size_t n, unsigned one_in) {
  std::vector<Vec3> d(n);
  for (Vec3& x : d)
    if (engine() % one_in == 0) x = random_point(engine, -0.01, 0.01);
  return d;
}

bool same_bits(const std::vector<Vec3>& a, std::span<const Vec3> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

TEST(MovedVertices, OnesThatMoveAreFoundAndPutBackToTheBit) {
  Engine engine(2);
  std::size_t n_many = 0, n_few = 0;
  for (int round = 0; round < 60; ++round) {
    const auto side = static_cast<Index>(1 + round % 9);
    TetMesh mesh = built(generate::jittered_box({side, side, side}, 0.1, 1));
    mesh.set_point(V(0), {-0.0, -0.0, -0.0});  // to which 0 must not be added
    const std::vector<Vec3> was(mesh.points().begin(), mesh.points().end());
    std::vector<Vec3> d = displacement_of(engine, was.size(), round % 3 == 0 ? 30 : round % 3 == 1 ? 2 : 1);
    if (round % 2 == 0) d[0] = {0.0, -0.0, 0.0};
    if (round % 5 == 0) d.back() = {0, 0, std::numeric_limits<double>::denorm_min()};
    std::vector<Vec3> all = was, half = was;
    std::vector<VertexHandle> list;
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (d[i] == Vec3{}) continue;
      list.push_back(VertexHandle(i));
      all[i] = was[i] + d[i];
      half[i] = was[i] + 0.5 * d[i];
    }
    for (const int threads : {1, 2, 7}) {
      const par::Policy policy = {.threads = threads, .serial_below = 0};
      MovedVertices moved;
      ASSERT_EQ(moved.find(d, policy), d.size());
      EXPECT_EQ(moved.size(), list.size());
      std::vector<VertexHandle> visited;
      EXPECT_FALSE(moved.find_if([&](VertexHandle v) {
        visited.push_back(v);
        return false;
      }));
      EXPECT_EQ(visited, list);
      for (VertexHandle v : mesh.vertices()) EXPECT_EQ(moved.has(v), !(d[v.idx()] == Vec3{}));
      moved.move(mesh, d, policy);
      EXPECT_TRUE(same_bits(all, mesh.points()));
      if (!moved.are_many()) {
        EXPECT_TRUE(std::equal(list.begin(), list.end(), moved.list().begin(), moved.list().end()));
      }
      ++(moved.are_many() ? n_many : n_few);
      moved.put(mesh, d, 0.5, policy);
      EXPECT_TRUE(same_bits(half, mesh.points()));
      moved.put_back(mesh, policy);
      EXPECT_TRUE(same_bits(was, mesh.points()));
    }
  }
  EXPECT_GT(n_many, 50U);
  EXPECT_GT(n_few, 30U);
}

TEST(MovedVertices, FirstThatIsNotFiniteIsNamed) {
  Engine engine(5);
  const double nan = std::numeric_limits<double>::quiet_NaN(), largest = std::numeric_limits<double>::max();
  for (const std::size_t n : {1U, 63U, 64U, 65U, 1000U})
    for (const int threads : {1, 2, 7}) {
      const par::Policy policy = {.threads = threads, .serial_below = 0};
      std::vector<Vec3> d = displacement_of(engine, n, 3);
      d[engine() % n] = {largest, -largest, 0};
      MovedVertices moved;
      EXPECT_EQ(moved.find(d, policy), n);
      for (const double bad :
           {kInfinity, -kInfinity, nan, -nan, std::bit_cast<double>(0x7FF0000000000001U)}) {
        std::vector<Vec3> wrong = d;
        const std::size_t first = engine() % n, second = first + engine() % (n - first);
        wrong[second][static_cast<int>(engine() % 3)] = bad;
        wrong[first][static_cast<int>(engine() % 3)] = bad;
        EXPECT_EQ(moved.find(wrong, policy), first);
      }
    }
}

TEST(MovedVertices, NothingMovesWhereNothingIsToldTo) {
  MovedVertices moved;
  EXPECT_EQ(moved.find({}, {}), 0U);
  EXPECT_EQ(moved.size(), 0U);
  TetMesh mesh = built(generate::box({2, 2, 2}));
  EXPECT_EQ(moved.find(std::vector<Vec3>(mesh.n_vertices()), {}), mesh.n_vertices());
  EXPECT_EQ(moved.size(), 0U);
  EXPECT_FALSE(moved.are_many());
}

}  // namespace
}  // namespace hfr::test
