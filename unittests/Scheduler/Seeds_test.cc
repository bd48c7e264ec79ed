// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Seeds.hh"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "HalfFace/Writer.hh"
#include "Operators/Clusters.hh"
#include "Operators/FaceSwap.hh"

namespace hfr::test {
namespace {

/// A box with holes in its numbering: some cells have been replaced.
TetMesh sample() {
  TetMesh mesh = jittered(4, 0.35, 3);
  const auto quality = qualities(mesh, VolumeLength{});
  for (HalfFaceHandle h : all_faces(mesh)) {
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (mesh.is_deleted(cell_of(h)) || !m.is_valid()) continue;
    const auto q = qualities(mesh, VolumeLength{});
    apply(FaceSwap<VolumeLength>{{}, q}, mesh, h);
  }
  // Free two slots: a live cell is never listed twice, a deleted one never at all.
  TetMesh grown = mesh;
  TetMesh::Writer(grown).resize_cells(mesh.n_cells() + 2);
  TetMesh::Writer(grown).free_cells().push_back(C(mesh.n_cells()));
  TetMesh::Writer(grown).free_cells().push_back(C(mesh.n_cells() + 1));
  return grown;
}

struct Listed {
  TetMesh mesh = sample();
  std::vector<std::uint8_t> keep;
  explicit Listed(double share, std::uint64_t seed) {
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) keep.push_back(generate::random_unit(seed, i) < share);
  }
  Worklist list(par::Policy policy = {}) const {
    return Worklist(mesh, policy, [&](CellHandle c) { return keep[c.idx()] != 0; });
  }
  bool has(CellHandle c) const { return keep[c.idx()] && !mesh.is_deleted(c); }
};

class Seeds : public testing::TestWithParam<double> {};

TEST_P(Seeds, WorklistHoldsTheKeptLiveCellsInOrder) {
  const Listed listed(GetParam(), 1);
  std::vector<Index> expected;
  for (CellHandle c : listed.mesh.cells())
    if (listed.has(c)) expected.push_back(c.idx());
  for (const int threads : {1, 2, 3, 7}) {
    const Worklist list = listed.list({threads, 1});
    EXPECT_TRUE(std::equal(list.cells().begin(), list.cells().end(), expected.begin(), expected.end()));
    for (std::size_t i = 0; i < listed.mesh.n_cells(); ++i) EXPECT_EQ(list.has(C(i)), listed.has(C(i)));
  }
}

TEST_P(Seeds, EveryInnerEdgeOfAListedCellComesOnce) {
  const Listed listed(GetParam(), 2);
  std::map<std::array<VertexHandle, 2>, CellHandle> expected;  // → smallest listed cell
  for (EdgeHandle e : listed.mesh.edges()) {
    if (listed.mesh.is_boundary(e)) continue;
    for (CellHandle c : listed.mesh.edge_cells(e)) {
      if (!listed.has(c)) continue;
      auto ends = listed.mesh.edge_vertices(e);
      std::sort(ends.begin(), ends.end());
      const auto [at, is_new] = expected.try_emplace(ends, c);
      if (!is_new) at->second = std::min(at->second, c);
    }
  }
  const auto seeds = edge_seeds(listed.mesh, listed.list(), {});
  std::map<std::array<VertexHandle, 2>, CellHandle> found;
  for (EdgeHandle e : seeds) {
    const Cell& cell = listed.mesh.cell(C(e.idx() / 6));
    std::array<VertexHandle, 2> ends = {cell.v[kEdgeCorners[e.idx() % 6][0]],
                                        cell.v[kEdgeCorners[e.idx() % 6][1]]};
    std::sort(ends.begin(), ends.end());
    EXPECT_TRUE(found.try_emplace(ends, C(e.idx() / 6)).second) << "an edge came twice";
  }
  EXPECT_EQ(found, expected);
  for (const int threads : {2, 3, 7}) EXPECT_EQ(edge_seeds(listed.mesh, listed.list(), {threads, 1}), seeds);
}

TEST_P(Seeds, EdgesComeFromTheLongestOnUntilOneDoes) {
  const Listed listed(GetParam(), 2);
  const Worklist list = listed.list();
  const auto length = [&](EdgeHandle e) {
    const auto& v = listed.mesh.cell(C(e.idx() / 6)).v;
    const auto& ends = kEdgeCorners[e.idx() % 6];
    return norm2(listed.mesh.point(v[ends[0]]) - listed.mesh.point(v[ends[1]]));
  };
  std::set<EdgeHandle> all;
  for (Index c : list.cells()) {
    std::vector<EdgeHandle> one;
    const auto visit_until = [&](std::size_t n) {
      one.clear();
      visit_edge_seeds_until(listed.mesh, list, C(c), [&](EdgeHandle e) {
        one.push_back(e);
        return one.size() == n;
      });
    };
    visit_until(7);
    const auto whole = one;
    EXPECT_TRUE(std::is_sorted(one.begin(), one.end(),
                               [&](EdgeHandle a, EdgeHandle b) { return length(a) > length(b); }));
    all.insert(one.begin(), one.end());
    for (std::size_t n = 1; n <= whole.size(); ++n) {
      visit_until(n);
      EXPECT_TRUE(
          std::equal(one.begin(), one.end(), whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n)));
    }
  }
  const auto seeds = edge_seeds(listed.mesh, list, {});
  EXPECT_EQ(all, std::set<EdgeHandle>(seeds.begin(), seeds.end()));
}

TEST_P(Seeds, EveryInnerFaceOfAListedCellComesOnce) {
  const Listed listed(GetParam(), 3);
  std::set<HalfFaceHandle> expected;
  for (HalfFaceHandle h : all_faces(listed.mesh)) {
    const HalfFaceHandle m = listed.mesh.opposite_halfface(h);
    if (!m.is_valid()) continue;
    if (listed.has(cell_of(h)))
      expected.insert(h);  // the smaller one of the two
    else if (listed.has(cell_of(m)))
      expected.insert(m);
  }
  const auto seeds = face_seeds(listed.mesh, listed.list(), {});
  EXPECT_EQ(std::set<HalfFaceHandle>(seeds.begin(), seeds.end()), expected);
  EXPECT_EQ(seeds.size(), expected.size()) << "a face came twice";
  for (const int threads : {2, 3, 7}) EXPECT_EQ(face_seeds(listed.mesh, listed.list(), {threads, 1}), seeds);
}

TEST_P(Seeds, EveryFreeVertexOfAListedCellComesOnce) {
  const Listed listed(GetParam(), 4);
  const auto frozen = frozen_vertices(listed.mesh);
  std::set<VertexHandle> expected;
  for (CellHandle c : listed.mesh.cells()) {
    if (!listed.has(c)) continue;
    for (VertexHandle v : listed.mesh.cell(c).v)
      if (!frozen[v.idx()]) expected.insert(v);
  }
  const auto seeds = vertex_seeds(listed.mesh, listed.list(), frozen, {});
  EXPECT_TRUE(std::is_sorted(seeds.begin(), seeds.end()));
  EXPECT_EQ(seeds.size(), expected.size());
  EXPECT_EQ(std::set<VertexHandle>(seeds.begin(), seeds.end()), expected);
}

TEST(VertexSeeds, AFewListedCellsGiveTheirVerticesInOrder) {
  const TetMesh mesh = jittered(16, 0.3, 5);
  const auto frozen = frozen_vertices(mesh);
  const std::size_t every = mesh.n_cells() / 5;
  const Worklist list(mesh, {}, [&](CellHandle c) { return c.idx() % every == every / 2; });
  ASSERT_LT(list.cells().size() * 512, mesh.n_vertices()) << "so few that they are sorted";
  std::set<VertexHandle> expected;
  for (Index c : list.cells())
    for (VertexHandle v : mesh.cell(CellHandle(c)).v)
      if (!frozen[v.idx()]) expected.insert(v);
  ASSERT_GT(expected.size(), 8U);
  EXPECT_EQ(vertex_seeds(mesh, list, frozen, {}),
            std::vector<VertexHandle>(expected.begin(), expected.end()));
}

INSTANTIATE_TEST_SUITE_P(Share, Seeds, testing::Values(0.0, 0.1, 0.6, 1.0), [](const auto& test) {
  return std::to_string(static_cast<int>(100 * test.param)) + "Percent";
});

}  // namespace
}  // namespace hfr::test
