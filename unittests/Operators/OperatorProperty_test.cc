// SPDX-License-Identifier: BSD-3-Clause
// What every operator owes the mesh, over thousands of clusters of jittered and tangled boxes.
#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/StarFromVertex.hh"
#include "Operators/VertexCollapse.hh"

namespace hfr::test {
namespace {

struct Tally {
  int accepted = 0;
  int from_inverted = 0;  ///< accepted where the cluster had an inverted or flat cell
};

bool is_gone(const TetMesh& mesh, EdgeHandle e) { return mesh.is_deleted(C(e.idx() / 6)); }
bool is_gone(const TetMesh& mesh, HalfFaceHandle h) { return mesh.is_deleted(cell_of(h)); }
bool is_gone(const TetMesh& mesh, VertexHandle v) { return mesh.is_deleted(v); }
bool is_gone(const TetMesh& mesh, const MultiFaceRemoval<VolumeLength>::Seed& seed) {
  return mesh.is_deleted(cell_of(seed.halfface));
}
template <class Seed>
bool is_gone(const TetMesh& mesh, const Seed& seed) {
  return mesh.is_deleted(seed.cell);
}

/// Applies an operator to every seed of some integer boxes, one after the other, and checks after each commit
/// that the mesh is whole, its volume exact, its boundary the same bit for bit, and the cluster's worst
/// better. Seeds are those of the mesh at first; a slot that has been reused in between is a seed like any
/// other.
template <class MakeOp, class Seeds>
Tally apply_everywhere(double jitter, int n_boxes, MakeOp&& make_op, Seeds&& seeds_of) {
  Tally tally;
  for (int s = 1; s <= n_boxes; ++s) {
    TetMesh mesh = integer_box(4, jitter, static_cast<std::uint64_t>(100 + s));
    const Int128 volume = exact_volume6(mesh);
    const auto boundary = boundary_of(mesh);
    const auto frozen = frozen_vertices(mesh);
    auto quality = qualities(mesh, VolumeLength{});
    double worst = *std::min_element(quality.begin(), quality.end());
    for (const auto& seed : seeds_of(mesh)) {
      if (is_gone(mesh, seed)) continue;
      const auto op = make_op(quality, frozen);
      const auto plan = op.evaluate(mesh, seed);
      if (!apply(op, mesh, seed)) continue;
      ++tally.accepted;
      tally.from_inverted += plan->old_worst <= 0 ? 1 : 0;
      EXPECT_GT(plan->new_worst, plan->old_worst);
      const CheckResult result = check(mesh);
      EXPECT_EQ(result, Ok);
      if (!result) return tally;
      EXPECT_TRUE(exact_volume6(mesh) == volume);
      EXPECT_TRUE(boundary_of(mesh) == boundary);
      quality = qualities(mesh, VolumeLength{});
      const double now = *std::min_element(quality.begin(), quality.end());
      EXPECT_GE(now, worst) << "the mesh's worst cell got worse";
      worst = now;
    }
  }
  return tally;
}

template <class Seed>
std::vector<Seed> star_seeds(const std::vector<EdgeHandle>& edges) {
  std::vector<Seed> seeds;
  for (EdgeHandle e : edges) seeds.push_back({C(e.idx() / 6), static_cast<std::uint8_t>(e.idx() % 6)});
  return seeds;
}

class OperatorProperty : public testing::TestWithParam<double> {};  // of the jitter

TEST_P(OperatorProperty, EdgeRemovalKeepsTheMeshWhole) {
  const auto make = [](const auto& quality, const auto&) { return EdgeRemoval<VolumeLength>{{}, quality}; };
  const Tally tally = apply_everywhere(GetParam(), 8, make, all_edges);
  EXPECT_GT(tally.accepted, 200);
  EXPECT_GT(tally.from_inverted, GetParam() > 0.4 ? 30 : -1);
}

TEST_P(OperatorProperty, FaceSwapKeepsTheMeshWhole) {
  const auto make = [](const auto& quality, const auto&) { return FaceSwap<VolumeLength>{{}, quality}; };
  const Tally tally = apply_everywhere(GetParam(), 30, make, all_faces);
  EXPECT_GT(tally.accepted, GetParam() > 0.4 ? 200 : 10);
  EXPECT_GT(tally.from_inverted, GetParam() > 0.4 ? 30 : -1);
}

TEST_P(OperatorProperty, MultiFaceRemovalKeepsTheMeshWhole) {
  using Multi = MultiFaceRemoval<VolumeLength>;
  const auto make = [](const auto& quality, const auto&) { return Multi{{}, quality}; };
  const auto seeds = [](const TetMesh& mesh) {
    std::vector<Multi::Seed> all;
    for (HalfFaceHandle h : all_faces(mesh)) all.push_back(Multi::Seed(h));
    return all;
  };
  const Tally tally = apply_everywhere(GetParam(), 20, make, seeds);
  EXPECT_GT(tally.accepted, GetParam() > 0.4 ? 200 : 10);
  EXPECT_GT(tally.from_inverted, GetParam() > 0.4 ? 30 : -1);
}

TEST_P(OperatorProperty, VertexCollapseKeepsTheMeshWhole) {
  const auto make = [](const auto& quality, const auto& frozen) {
    return VertexCollapse<VolumeLength>{{}, quality, frozen};
  };
  const Tally tally = apply_everywhere(GetParam(), 30, make, all_vertices);
  EXPECT_GT(tally.accepted, 40);
}

TEST_P(OperatorProperty, StarFromVertexKeepsTheMeshWhole) {
  using Star = StarFromVertex<Cluster::kEdge, VolumeLength>;
  const auto make = [](const auto& quality, const auto& frozen) { return Star{{}, quality, frozen}; };
  const auto seeds = [](const TetMesh& mesh) { return star_seeds<Star::Seed>(all_edges(mesh)); };
  const Tally tally = apply_everywhere(GetParam(), 6, make, seeds);
  EXPECT_GT(tally.accepted, 150);
}

INSTANTIATE_TEST_SUITE_P(Jitter, OperatorProperty, testing::Values(0.3, 0.45, 0.7),
                         [](const auto& test) { return std::to_string(static_cast<int>(100 * test.param)); });

}  // namespace
}  // namespace hfr::test
