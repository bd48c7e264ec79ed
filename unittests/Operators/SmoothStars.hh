// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_OPERATORS_SMOOTH_STARS_HH
#define HFR_UNITTESTS_OPERATORS_SMOOTH_STARS_HH

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/Smooth.hh"

namespace hfr::test {

/// What smoothing every inner vertex of some boxes once, one after the other, came to.
struct SmoothTally {
  int tried = 0;
  int moved = 0;
  int untangled = 0;    ///< stars with an inverted or flat cell that had none afterwards
  int tangled = 0;      ///< stars with an inverted or flat cell
  double sum_gain = 0;  ///< of the report value q of the star's worst cell, over stars without inverted cells
};

/// Smooths each inner vertex of jittered boxes by itself, from the same mesh each time, and checks that the
/// move is what the plan says and never makes the star worse.
template <class Search, class Metric>
SmoothTally smooth_stars(const Search& search, const Metric& metric, double jitter, int n_boxes) {
  SmoothTally tally;
  for (int s = 1; s <= n_boxes; ++s) {
    TetMesh mesh = jittered(4, jitter, static_cast<std::uint64_t>(s));
    const auto quality = qualities(mesh, metric);
    const auto frozen = frozen_vertices(mesh);
    const Smooth<Search, Metric> op{metric, quality, frozen, search};
    for (VertexHandle v : mesh.vertices()) {
      if (frozen[v.idx()]) {
        EXPECT_FALSE(op.evaluate(mesh, v));
        continue;
      }
      ++tally.tried;
      double before = std::numeric_limits<double>::infinity();
      for (CellHandle c : mesh.vertex_cells(v)) before = std::min(before, quality[c.idx()]);
      tally.tangled += before <= 0 ? 1 : 0;
      const auto plan = op.evaluate(mesh, v);
      if (!plan) continue;
      ++tally.moved;
      EXPECT_EQ(plan->old_worst, before);
      EXPECT_GT(plan->new_worst, before);
      const Vec3 home = mesh.point(v);
      Cavity cavity;
      op.cavity(mesh, *plan, cavity);
      replace(mesh, cavity);  // apply() may find that other cells of the star suffer
      double after = std::numeric_limits<double>::infinity();
      for (CellHandle c : mesh.vertex_cells(v))
        after = std::min(after, quality_of(mesh, mesh.cell(c).v, metric));
      EXPECT_EQ(after, plan->new_worst) << "the plan is not what it claims";
      mesh.set_point(v, home);
      if (before <= 0)
        tally.untangled += after > 0 ? 1 : 0;
      else
        tally.sum_gain += std::sqrt(after) - std::sqrt(before);
    }
    EXPECT_EQ(check(mesh), Ok);
  }
  return tally;
}

}  // namespace hfr::test

#endif
