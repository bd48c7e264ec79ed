// SPDX-License-Identifier: BSD-3-Clause
#include "Bisect.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/Check.hh"
#include "hfremesh/HalfFace/Circulators.hh"
#include "hfremesh/HalfFace/Generate.hh"
#include "hfremesh/Quality/Statistics.hh"

namespace hfr::test {
namespace {

using petsc::Simplices;

/// The cells of a mesh for which `here` says so, with all points.
Simplices simplices_of(
    const generate::Arrays& arrays, const std::function<double(std::size_t)>& largest,
    const std::function<bool(std::size_t)>& here = [](std::size_t) { return true; }) {
  Simplices all;
  all.points = arrays.points;
  for (std::size_t v = 0; v < arrays.points.size(); ++v) all.ids.push_back({0, v});
  all.is_shared.assign(arrays.points.size(), 1);
  for (std::size_t c = 0; c < arrays.cells.size(); ++c) {
    if (!here(c)) continue;
    Simplices::Cell& cell = all.cells.emplace_back();
    std::ranges::copy(arrays.cells[c], cell.v.begin());
    cell.value = static_cast<std::int32_t>(c);
    cell.largest = largest(c);
  }
  return all;
}

void bisect_alone(Simplices& all) {
  mpi::Comm comm(MPI_COMM_SELF);
  petsc::bisect(comm, all);
}

TetMesh mesh_of(const Simplices& all) {
  std::vector<std::array<Index, 4>> cells;
  for (const Simplices::Cell& c : all.cells) cells.push_back(c.v);
  return build(all.points, cells);
}

double volume_of_all(const Simplices& all) {
  double sum = 0;
  for (const Simplices::Cell& c : all.cells) sum += petsc::volume_of(all, c);
  return sum;
}

/// The halves of these cells are of a few shapes, as long as the longest edge of all cells at it is halved:
/// with others the angles get smaller and smaller.
TEST(PetscBisect, HalvesOfLongestEdgesKeepTheirShape) {
  const generate::Arrays box = generate::box({4, 4, 4});
  const double cell = 1.0 / 384, worst = statistics(build(box.points, box.cells)).min_dihedral.min;
  Simplices all = simplices_of(box, [&](std::size_t c) { return c % 7 == 0 ? cell / 100 : 0; });
  bisect_alone(all);
  const TetMesh mesh = mesh_of(all);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(mesh.n_cells(), 4 * box.cells.size());
  EXPECT_NEAR(volume_of_all(all), 1, 1e-12);
  EXPECT_GT(statistics(mesh).min_dihedral.min, 0.6 * worst);
  std::size_t n_boundary = 0;
  for (CellHandle c : mesh.cells())
    for (HalfFaceHandle h : mesh.cell_halffaces(c))
      if (mesh.is_boundary(h))
        for (VertexHandle v : mesh.halfface_vertices(h)) {
          const Vec3 p = mesh.point(v);
          n_boundary += std::min({p.x, p.y, p.z, 1 - p.x, 1 - p.y, 1 - p.z}) > 0 ? 1 : 0;
        }
  EXPECT_EQ(n_boundary, 0U) << "cells that meet at an edge are not halved alike";
}

TEST(PetscBisect, MarkedCellsBecomeEightAtLeastAndNoneIsLarger) {
  const generate::Arrays box = generate::box({4, 4, 4});
  const double eighth = 1.0 / 384 / 8;
  Simplices all = simplices_of(box, [&](std::size_t) { return eighth; });
  bisect_alone(all);
  EXPECT_EQ(all.cells.size(), 8 * box.cells.size());
  for (const Simplices::Cell& c : all.cells) EXPECT_LE(petsc::volume_of(all, c), eighth * (1 + 1e-9));
}

TEST(PetscBisect, NothingIsHalvedThatIsSmallEnough) {
  const generate::Arrays box = generate::box({4, 4, 4});
  Simplices all = simplices_of(box, [](std::size_t c) { return c == 3 ? 0.0 : 1.0; });
  bisect_alone(all);
  EXPECT_EQ(all.cells.size(), box.cells.size());
  EXPECT_EQ(all.points.size(), box.points.size());
}

/// A cell by its corners and the one that it is a part of.
using Corners = std::array<std::array<double, 3>, 5>;
template <std::size_t N>
Corners corners_of(const Simplices& all, const Simplices::Labelled<N>& item) {
  Corners corners{};
  for (std::size_t i = 0; i < N; ++i) {
    const Vec3 p = all.points[item.v[i]];
    corners[i] = {p.x, p.y, p.z};
  }
  std::sort(corners.begin(), corners.begin() + N);
  corners[4] = {static_cast<double>(item.value), 0, 0};
  return corners;
}

/// Cells, and the labelled faces of the first one of the box and its edges.
std::vector<Corners> all_of(const Simplices& all) {
  std::vector<Corners> corners;
  for (const auto& c : all.cells) corners.push_back(corners_of(all, c));
  for (const auto& f : all.faces) corners.push_back(corners_of(all, f));
  for (const auto& e : all.edges) corners.push_back(corners_of(all, e));
  std::ranges::sort(corners);
  return corners;
}

/// The same with vertices in another order.
void reverse_vertices(Simplices& all) {
  const auto n = static_cast<Index>(all.points.size());
  std::ranges::reverse(all.points);
  std::ranges::reverse(all.ids);
  std::ranges::reverse(all.is_shared);
  const auto rename = [n](auto& items) {
    for (auto& item : items)
      for (Index& v : item.v) v = n - 1 - v;
  };
  rename(all.cells);
  rename(all.faces);
  rename(all.edges);
}

/// With cells all over the ranks, faces and edges on a rank that may have none of their cells.
TEST(PetscBisect, ItDoesNotMatterWhichRankHasWhichCell) {
  mpi::Comm comm(MPI_COMM_WORLD);
  generate::CavityOptions options;
  options.counts = {5, 5, 5};
  options.jitter = 0.3;
  // A cube in five, whose cells have three or six longest edges of one length.
  generate::Arrays five;
  for (int i = 0; i < 8; ++i) five.points.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  five.cells = {{0, 3, 5, 6}, {0, 1, 3, 5}, {0, 3, 2, 6}, {0, 4, 5, 6}, {3, 5, 6, 7}};
  const generate::Arrays deformed = generate::cavity(options);
  for (std::size_t every : {3, 29, 311, 1}) {
    const generate::Arrays& box = every == 1 ? five : deformed;
    const auto largest = [&](std::size_t c) { return c % every == 0 ? 1.0 / 750 / 30 : 0.0; };
    const auto add_labels = [&](Simplices& all, bool here) {
      for (std::size_t c = 0; here && c < box.cells.size(); c += 5) {
        const auto& v = box.cells[c];
        all.faces.push_back({{v[0], v[1], v[2]}, static_cast<std::int32_t>(c)});
        all.edges.push_back({{v[1], v[3]}, -static_cast<std::int32_t>(c)});
      }
    };
    Simplices whole = simplices_of(box, largest);
    add_labels(whole, true);
    bisect_alone(whole);
    const auto here = [&](std::size_t c) {
      return static_cast<int>(mix64(c) % comm.n_ranks()) == comm.rank();
    };
    Simplices mine = simplices_of(box, largest, here);
    add_labels(mine, comm.rank() == comm.size() - 1);
    if (comm.rank() % 2 == 0) reverse_vertices(mine);
    petsc::bisect(comm, mine);
    std::vector<Corners> together = comm.all_gather(std::span<const Corners>(all_of(mine)));
    std::ranges::sort(together);
    EXPECT_EQ(together, all_of(whole));
    EXPECT_GT(together.size(), box.cells.size() + 20);
  }
}

}  // namespace
}  // namespace hfr::test
