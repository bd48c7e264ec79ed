// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/MultiFaceRemoval.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/FaceSwap.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<MultiFaceRemoval<VolumeLength>>);
static_assert(LocalOperator<MultiFaceRemoval<MinSine2>>);

/// Two apexes, 0 above and 1 below, over and under a polygon 2 … n+1 that a fan or a zigzag triangulates:
/// n - 2 faces between the same apexes.
TetMesh lens(std::size_t n, Engine& engine) {
  std::vector<Vec3> points = {
      {uniform(engine, -0.2, 0.2), uniform(engine, -0.2, 0.2), uniform(engine, 0.2, 1)},
      {uniform(engine, -0.2, 0.2), uniform(engine, -0.2, 0.2), uniform(engine, -1, -0.2)}};
  for (std::size_t i = 0; i < n; ++i) {
    const double angle =
        2 * std::numbers::pi * (static_cast<double>(i) + uniform(engine, -0.3, 0.3)) / static_cast<double>(n);
    const double radius = uniform(engine, 0.7, 1.3);
    points.push_back({radius * std::cos(angle), radius * std::sin(angle), uniform(engine, -0.1, 0.1)});
  }
  // Cut ears off at random: any triangulation of the polygon may come.
  std::vector<Index> polygon;
  for (Index i = 0; i < n; ++i) polygon.push_back(i + 2);
  std::vector<Corners> cells;
  while (polygon.size() > 2) {
    const std::size_t k = engine() % polygon.size();
    const Index a = polygon[(k + polygon.size() - 1) % polygon.size()];
    const Index b = polygon[k];
    const Index c = polygon[(k + 1) % polygon.size()];
    cells.push_back({a, b, c, 0});
    cells.push_back({b, a, c, 1});
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(k));
  }
  return build(points, cells);
}

/// The faces between 0 and 1, as half-faces of the cells of vertex 0.
std::vector<HalfFaceHandle> sandwiched(const TetMesh& mesh) {
  std::vector<HalfFaceHandle> faces;
  for (CellHandle c : mesh.cells())
    if (mesh.cell(c).has(V(0))) faces.push_back(mesh.vertex_opposite_halfface(c, V(0)));
  return faces;
}

/// Removes every set of faces that holds `first` in turn. Returns the largest worst value that the whole lens
/// comes to, the cells that stay included.
template <class Metric>
double brute_force(const TetMesh& mesh, const std::vector<HalfFaceHandle>& faces, std::size_t first,
                   const std::vector<double>& quality, const Metric& metric) {
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t set = 0; set < (std::size_t{1} << faces.size()); ++set) {
    if (!(set >> first & 1U)) continue;
    std::vector<CellHandle> removed;
    double worst = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const CellHandle up = cell_of(faces[i]);
      const CellHandle down = cell_of(mesh.opposite_halfface(faces[i]));
      if (set >> i & 1U) {
        removed.push_back(up);
        removed.push_back(down);
      } else {
        worst = std::min({worst, quality[up.idx()], quality[down.idx()]});
      }
    }
    // Each outer face at the upper apex is over an edge of the polygon, and each edge makes a new cell.
    std::size_t n_edges = 0;
    double new_volume = 0;
    for (const auto& f : outer_faces(mesh, removed)) {
      const auto at = std::find(f.begin(), f.end(), V(0));
      if (at == f.end()) continue;
      ++n_edges;
      const auto i = static_cast<std::size_t>(at - f.begin());
      Tet tet{f[(i + 1) % 3], f[(i + 2) % 3], V(1), V(0)};
      if (quality_of(mesh, tet, Volume{}) < 0) std::swap(tet[0], tet[1]);
      worst = std::min(worst, quality_of(mesh, tet, metric));
      new_volume += quality_of(mesh, tet, Volume{});
    }
    double old_volume = 0;
    for (CellHandle c : removed) old_volume += quality_of(mesh, mesh.cell(c).v, Volume{});
    // A set in several parts has too many edges; where the new edge leaves the lens, cells overlap.
    if (n_edges != removed.size() / 2 + 2 || std::abs(new_volume - old_volume) > 1e-9 * old_volume) continue;
    best = std::max(best, worst);
  }
  return best;
}

TEST(MultiFaceRemoval, ProgrammeFindsTheBestOfAllTrees) {
  // The programme weighs a subtree's new cells against its old ones and against stopping; what it returns
  // leaves no worse a cluster than any tree does, whenever the seed's own cells are the worst.
  Engine engine(3);
  int accepted = 0;
  int several = 0;
  int refused = 0;
  for (int trial = 0; trial < 900; ++trial) {
    const std::size_t n = 3 + static_cast<std::size_t>(trial) % 5;
    const TetMesh mesh = lens(n, engine);
    const MinSine2 metric;
    const auto quality = qualities(mesh, metric);
    const double old_all = *std::min_element(quality.begin(), quality.end());
    if (!(old_all > 0)) continue;
    const auto faces = sandwiched(mesh);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const double own = std::min(quality[cell_of(faces[i]).idx()],
                                  quality[cell_of(mesh.opposite_halfface(faces[i])).idx()]);
      if (own > old_all) continue;
      const double best = brute_force(mesh, faces, i, quality, metric);
      const MultiFaceRemoval<MinSine2> op{{}, quality};
      const auto plan = op.evaluate(mesh, MultiFaceRemoval<MinSine2>::Seed(faces[i]));
      if (!plan) {
        ++refused;
        EXPECT_LE(best, old_all + 1e-12) << n;
        continue;
      }
      ++accepted;
      several += plan->n_removed > 2 ? 1 : 0;
      const Cavity cavity = cavity_of(op, mesh, *plan);
      double all = plan->new_worst;
      for (CellHandle c : mesh.cells())
        if (std::find(cavity.removed.begin(), cavity.removed.end(), c) == cavity.removed.end())
          all = std::min(all, quality[c.idx()]);
      EXPECT_NEAR(all, best, 1e-12) << n;
    }
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(several, 50) << "only single faces were removed";
  EXPECT_GT(refused, 20);
}

TEST(MultiFaceRemoval, LensOfFourFacesBecomesSixCellsRoundTheNewEdge) {
  Engine engine(5);
  int done = 0;
  for (int trial = 0; trial < 200; ++trial) {
    TetMesh mesh = lens(6, engine);
    const std::vector<double> quality(mesh.n_cells(), 1e-6);
    const double before = volume(mesh);
    const auto boundary = boundary_of(mesh);
    const MultiFaceRemoval<VolumeLength> op{{}, quality};
    if (!apply(op, mesh, MultiFaceRemoval<VolumeLength>::Seed(sandwiched(mesh)[0]))) continue;
    if (ring_size(mesh, V(0), V(1)) != 6) continue;
    ++done;
    EXPECT_EQ(mesh.n_logical_cells(), 6U);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_NEAR(volume(mesh), before, 1e-12);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
  }
  EXPECT_GT(done, 20);
}

TEST(MultiFaceRemoval, FindsEveryFaceSwap) {
  int swaps = 0;
  for (std::uint64_t s = 1; s <= 20; ++s) {
    const TetMesh mesh = jittered(4, 0.35, s);
    const auto quality = qualities(mesh, VolumeLength{});
    const FaceSwap<VolumeLength> swap{{}, quality};
    const MultiFaceRemoval<VolumeLength> multi{{}, quality};
    for (HalfFaceHandle h : all_faces(mesh)) {
      const auto one = swap.evaluate(mesh, h);
      if (!one) continue;
      ++swaps;
      EXPECT_TRUE(multi.evaluate(mesh, MultiFaceRemoval<VolumeLength>::Seed(h)));
    }
  }
  EXPECT_GT(swaps, 40);
}

TEST(MultiFaceRemoval, ConstrainedFacesStay) {
  TetMesh mesh = bipyramid(0.3);
  const std::vector<double> quality(mesh.n_cells(), 1e-6);
  const MultiFaceRemoval<VolumeLength> op{{}, quality};
  using Seed = MultiFaceRemoval<VolumeLength>::Seed;
  HalfFaceHandle inner;
  for (HalfFaceHandle h : mesh.halffaces())
    if (!mesh.is_boundary(h)) inner = h;
  for (HalfFaceHandle h : mesh.halffaces())
    if (mesh.is_boundary(h)) {
      EXPECT_FALSE(op.evaluate(mesh, Seed(h)));
    }
  EXPECT_TRUE(op.evaluate(mesh, Seed(inner)));
  mesh.set_region(C(1), 7);
  EXPECT_FALSE(op.evaluate(mesh, Seed(inner)));
}

}  // namespace
}  // namespace hfr::test
