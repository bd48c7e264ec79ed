// SPDX-License-Identifier: BSD-3-Clause
// Who asks for more, or may do more, leaves no more cells invalid, on random meshes that no run makes valid.
#include <gtest/gtest.h>

#include <utility>

#include "Fuzz/Case.hh"
#include "Fuzz/RandomComplex.hh"
#include "HalfFace/Errors.hh"
#include "Remesh/Improve.hh"

namespace hfr::fuzz {
namespace {

/// Inverted cells, and flat ones, that a run leaves.
std::pair<std::size_t, std::size_t> left_invalid(TetMesh mesh, ImproveOptions options) {
  options.policy.threads = 1;
  const Result result = improve(mesh, options);
  return {result.after.inverted.size(), result.after.flat.size()};
}
std::pair<std::size_t, std::size_t> left_invalid(const TetMesh& mesh, SurfaceMode mode) {
  ImproveOptions options;
  options.surface.mode = mode;
  return left_invalid(mesh, options);
}

TEST(InvalidCells, FlatLeavesNoMoreCellsInvalidThanFrozenAndFreeNoMoreThanFlat) {
  std::size_t n_better = 0;
  for (const std::uint64_t number :
       {9100009, 9100011, 9100016, 9100017, 9100021, 9100026, 9100031, 9100034, 9100040, 9100042, 9100056,
        9100066, 9100072, 9100076, 9100089, 9100093, 9100106}) {
    const TetMesh mesh = mesh_of(make_case(number).complex);
    const auto frozen = left_invalid(mesh, SurfaceMode::kFrozen);
    EXPECT_GT(frozen.first + frozen.second, 0U) << number << " is another case now";
    try {
      const auto flat = left_invalid(mesh, SurfaceMode::kFlat);
      const auto free = left_invalid(mesh, SurfaceMode::kFree);
      EXPECT_LE(flat, frozen) << number;
      EXPECT_LE(free, flat) << number;
      n_better += free < frozen ? 1 : 0;
    } catch (const InvalidInput& error) {
#ifdef HFR_HAS_SURFACE
      FAIL() << number << ": " << error.what();
#else
      GTEST_SKIP() << error.what();  // a build without OpenMesh
#endif
    }
  }
  EXPECT_GT(n_better, 2U);
}

TEST(InvalidCells, DefaultRunsAndGoalsLeaveNoMoreThanAPlainGoal) {
  for (const std::uint64_t number : {9200032, 9200091, 9200311, 9200379}) {
    const TetMesh mesh = mesh_of(make_case(number).complex);
    ImproveOptions options;
    options.min_dihedral = 0.001;
    const auto plain = left_invalid(mesh, options);
    EXPECT_GT(plain.first + plain.second, 0U) << number << " is another case now";
    options.min_dihedral = 5;
    EXPECT_LE(left_invalid(mesh, options), plain) << number;
    EXPECT_LE(left_invalid(mesh, ImproveOptions()), plain) << number;
    options = {};
    options.raise_min_dihedral = true;
    EXPECT_LE(left_invalid(mesh, options), plain) << number;
  }
}

}  // namespace
}  // namespace hfr::fuzz
