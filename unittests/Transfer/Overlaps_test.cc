// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Overlaps.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "HalfFace/Geometry.hh"
#include "Transfer/SharedVolume.hh"
#include "Transfer/TwoMeshes.hh"

namespace hfr::test {
namespace {

/// Every new cell with every old one.
std::vector<std::vector<Overlap>> all_pairs(const TwoMeshes& two, std::span<const CellHandle> new_cells,
                                            std::span<const CellHandle> old_cells) {
  std::vector<std::vector<Overlap>> out(new_cells.size());
  for (std::size_t i = 0; i < new_cells.size(); ++i)
    for (CellHandle c : old_cells) {
      const TetPoints is = points_of(two.now, new_cells[i]), was = points_of(two.old, c);
      const double shared = shared_volume(is, was);
      if (shared > 1e-12 * std::min(std::abs(volume6(is)), std::abs(volume6(was))) / 6)
        out[i].push_back({c, volume6(was) < 0 ? -shared : shared});
    }
  return out;
}

TEST(Overlaps, AreThoseOfAllPairs) {
  std::size_t n_parts = 0, n_with_many = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const TwoMeshes two(6, 0.12, seed);
    for (CellHandle c : two.old.cells()) ASSERT_GT(volume(two.old, c), 0);
    const Edits edits = two.edits();
    const std::vector<CellHandle> is = changed_new_cells(edits), was = changed_old_cells(edits);
    const auto expected = all_pairs(two, is, was);
    for (const int threads : {1, 2, 7}) {
      const Overlaps found = find_overlaps(two.old, shapes_of(two.now, edits, is), was, {threads, 0});
      ASSERT_EQ(found.first.size(), is.size() + 1);
      for (std::size_t i = 0; i < is.size(); ++i) {
        const auto parts = found.of(i);
        ASSERT_EQ(parts.size(), expected[i].size()) << "cell " << is[i].idx();
        for (std::size_t k = 0; k < parts.size(); ++k) {
          EXPECT_EQ(parts[k].old_cell, expected[i][k].old_cell);
          EXPECT_EQ(parts[k].volume, expected[i][k].volume);
        }
        n_parts += parts.size();
        n_with_many += parts.size() > 5 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(n_parts, 10'000U);
  EXPECT_GT(n_with_many, 500U);
}

TEST(Overlaps, NearInvertedOldCellsThoseWithVolumeOnBothSidesAreFound) {
  std::size_t n_inverted = 0, n_negative = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    TwoMeshes two(6, 0.12, seed);
    // Vertices far within the old mesh cross to the other side of their stars; both meshes keep their
    // surface.
    for (VertexHandle v : two.old.vertices())
      if (!two.old.is_boundary(v) && v.idx() % 5 == 0 && two.maps.vertices[v.idx()].is_valid())
        two.old.set_point(v, two.old.point(v) + Vec3{0.15, -0.1, 0.12});
    for (CellHandle c : two.old.cells()) n_inverted += volume(two.old, c) < 0 ? 1 : 0;
    const Edits edits = two.edits();
    const std::vector<CellHandle> is = changed_new_cells(edits), was = changed_old_cells(edits);
    const Overlaps one = find_overlaps(two.old, shapes_of(two.now, edits, is), was, {1, 0});
    const Overlaps two_threads = find_overlaps(two.old, shapes_of(two.now, edits, is), was, {2, 0});
    EXPECT_EQ(one.first, two_threads.first);
    for (std::size_t i = 0; i < is.size(); ++i) {
      double covered = 0;
      for (const Overlap& part : one.of(i)) {
        covered += part.volume;
        n_negative += part.volume < 0 ? 1 : 0;
      }
      EXPECT_NEAR(covered, volume(two.now, is[i]), 1e-6 * volume(two.now, is[i]));
    }
  }
  EXPECT_GT(n_inverted, 20U);
  EXPECT_GT(n_negative, 20U);
}

}  // namespace
}  // namespace hfr::test
