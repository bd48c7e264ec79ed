// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Conserve.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "Transfer/TwoMeshes.hh"

namespace hfr::test {
namespace {

std::vector<double> values(const TetMesh& mesh, std::span<const CellHandle> cells) {
  std::vector<double> out;
  for (CellHandle c : cells)
    out.push_back(std::sin(1.0 + 7.0 * mesh.point(mesh.cell_vertices(c)[0]).x) +
                  generate::random_unit(3, c.idx()));
  return out;
}

TEST(Cavities, HaveEachChangedCellOnceAndOldAndNewOnesFillTheSameRoom) {
  const TwoMeshes two(6, 0.15, 2);
  const Cavities cavities(two.old, two.now, two.edits(), {});
  ASSERT_GT(cavities.cavities().size(), 1U);
  std::size_t n_old = 0, n_new = 0;
  for (const auto& cavity : cavities.cavities()) {
    double old_volume = 0, new_volume = 0;
    for (Index i : cavity.old_cells) old_volume += cavities.old_volume(i);
    for (Index i : cavity.new_cells) new_volume += cavities.new_volume(i);
    EXPECT_NEAR(old_volume, new_volume, 1e-14);
    n_old += cavity.old_cells.size();
    n_new += cavity.new_cells.size();
  }
  EXPECT_EQ(n_old, cavities.old_cells().size());
  EXPECT_EQ(n_new, cavities.new_cells().size());
  for (std::size_t i = 0; i < n_new; ++i) EXPECT_FALSE(cavities.is_outside(i));
}

TEST(Conserve, SumOfEachCavityStaysAndNoValueLeavesItsRange) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TwoMeshes two(6, 0.15, seed);
    const Cavities cavities(two.old, two.now, two.edits(), {});
    const auto old = values(two.old, cavities.old_cells());
    const std::vector<double> nothing(cavities.new_cells().size(), 0);
    const Conserved conserved = conserve(cavities, old, {}, {}, nothing);
    EXPECT_NEAR(conserved.lost, 0, 1e-16);
    for (const auto& cavity : cavities.cavities()) {
      double before = 0, after = 0, low = 1e9, high = -1e9;
      for (Index i : cavity.old_cells) {
        before += cavities.old_volume(i) * old[i];
        low = std::min(low, old[i]);
        high = std::max(high, old[i]);
      }
      for (Index i : cavity.new_cells) {
        after += cavities.new_volume(i) * conserved.values[i];
        EXPECT_GE(conserved.values[i], low);
        EXPECT_LE(conserved.values[i], high);
      }
      EXPECT_NEAR(after, before, 1e-13 * std::abs(before));
    }
  }
}

TEST(Conserve, WhatIsNoNumberStaysWhereItWas) {
  const TwoMeshes two(6, 0.15, 1);
  const Cavities cavities(two.old, two.now, two.edits(), {});
  std::vector<double> old(cavities.old_cells().size(), 2), nothing(cavities.new_cells().size(), 0);
  old[old.size() / 2] = std::numeric_limits<double>::quiet_NaN();
  const Conserved conserved = conserve(cavities, old, {}, {}, nothing);
  std::size_t n_lost = 0;
  for (std::size_t i = 0; i < conserved.values.size(); ++i) {
    const auto& parts = cavities.overlaps().of(static_cast<Index>(i));
    const bool has_it = std::ranges::any_of(
        parts, [&](const Overlap& part) { return part.old_cell == cavities.old_cells()[old.size() / 2]; });
    EXPECT_EQ(std::isnan(conserved.values[i]), has_it);
    n_lost += has_it ? 1 : 0;
    if (!has_it) {
      EXPECT_EQ(conserved.values[i], 2);
    }
  }
  EXPECT_GT(n_lost, 0U);
  const std::vector<double> none(old.size(), std::numeric_limits<double>::quiet_NaN());
  for (const double v : conserve(cavities, none, {}, {}, nothing).values) EXPECT_TRUE(std::isnan(v));
}

TEST(Conserve, ConstantStaysOneToTheBit) {
  const TwoMeshes two(6, 0.15, 4);
  const Cavities cavities(two.old, two.now, two.edits(), {});
  const std::vector<double> old(cavities.old_cells().size(), 0.1);
  const std::vector<double> nothing(cavities.new_cells().size(), 0);
  for (const double v : conserve(cavities, old, {}, {}, nothing).values) EXPECT_EQ(v, 0.1);
}

TEST(Conserve, MomentumStaysWhereDensitiesWeigh) {
  const TwoMeshes two(6, 0.15, 5);
  const Cavities cavities(two.old, two.now, two.edits(), {});
  std::vector<double> rho = values(two.old, cavities.old_cells());
  for (double& r : rho) r = 1.5 + std::abs(r);
  const auto u = values(two.old, cavities.old_cells());
  const std::vector<double> nothing(cavities.new_cells().size(), 0);
  const auto new_rho = conserve(cavities, rho, {}, {}, nothing).values;
  const auto new_u = conserve(cavities, u, rho, new_rho, nothing).values;
  double before = 0, after = 0;
  for (std::size_t i = 0; i < u.size(); ++i) before += cavities.old_volume(i) * rho[i] * u[i];
  for (std::size_t i = 0; i < new_u.size(); ++i) after += cavities.new_volume(i) * new_rho[i] * new_u[i];
  EXPECT_NEAR(after, before, 1e-13 * std::abs(before));
}

/// A cell, and the same with another one on its largest face, beyond the old mesh as a whole; the corner
/// across from that one moves by `step`.
TwoMeshes grown(double step) {
  TwoMeshes two;
  std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  two.old = build(points, std::vector<std::array<Index, 4>>{{0, 1, 2, 3}});
  points[0] = {step, step, step};
  points.push_back({1, 1, 1});
  two.now = build(points, std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {4, 1, 3, 2}});
  const auto vertices = two.old.vertices();
  two.maps = {};
  two.maps.vertices = two.maps.old_vertices = two.maps.sources = {vertices.begin(), vertices.end()};
  two.maps.old_vertices.push_back({});
  two.maps.sources.push_back(VertexHandle(1));
  two.maps.cells = {CellHandle(0)};
  two.maps.old_cells = {CellHandle(0), CellHandle()};
  return two;
}

TEST(Conserve, CellBeyondTheOldMeshSharesWithTheChangedOneBesideIt) {
  const TwoMeshes two = grown(0.1);
  const Cavities cavities(two.old, two.now, two.edits(), {});
  ASSERT_EQ(cavities.new_cells().size(), 2U);
  EXPECT_EQ(cavities.cavities().size(), 1U);
  const std::vector<double> old = {2}, elsewhere = {7, 7};
  const Conserved conserved = conserve(cavities, old, {}, {}, elsewhere);
  double holds = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(conserved.values[i], 2) << "the only value that the cavity had";
    holds += cavities.new_volume(i) * conserved.values[i];
  }
  EXPECT_LT(conserved.lost, 0);
  EXPECT_NEAR(holds + conserved.lost, conserved.integral, 1e-15);
}

TEST(Conserve, WhatACellBeyondTheOldMeshHasWithNobodyBesideItIsSaid) {
  const TwoMeshes two = grown(0);
  const Cavities cavities(two.old, two.now, two.edits(), {});
  ASSERT_EQ(cavities.new_cells().size(), 1U);
  const Conserved conserved = conserve(cavities, {}, {}, {}, std::vector<double>{7});
  EXPECT_EQ(conserved.values[0], 7);
  EXPECT_EQ(conserved.integral, 0);
  EXPECT_NEAR(conserved.lost, -7 * cavities.new_volume(0), 1e-15);
}

TEST(Conserve, SumsDoNotDependOnTheOrder) {
  std::vector<double> values;
  for (std::uint64_t i = 0; i < 999; ++i)
    values.push_back(generate::random_unit(1, i) * std::pow(10, 12 * generate::random_unit(2, i)));
  const double sum = order_free_sum(values);
  double plain = 0;
  for (double x : values) plain += x;
  EXPECT_NEAR(sum, plain, 1e-9 * std::abs(plain));
  for (std::size_t i = 1; i < values.size(); ++i) std::swap(values[i], values[i * 7919 % (i + 1)]);
  EXPECT_EQ(order_free_sum(values), sum);
  EXPECT_EQ(order_free_sum({}), 0);
  EXPECT_EQ(order_free_sum(std::vector<double>{5e-324, 5e-324}), 0) << "below what the units resolve";
  EXPECT_EQ(order_free_sum(std::vector<double>{1e-200, 2e-200}), 3e-200);
  EXPECT_EQ(order_free_sum(std::vector<double>{-1e300, 3e300, 1e300}), 3e300);
  values[5] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(order_free_sum(values)));
}

TEST(Conserve, InvertedOldCellsCountNegatively) {
  // The cavity's inverted cells overlap others: what they hold is taken off again.
  generate::Arrays bent =
      generate::cavity({.counts = {6, 6, 6}, .jitter = 0.2, .sigma = 0.15, .amplitude = 0.6});
  TwoMeshes two(bent);
  const generate::Arrays straight = generate::box({6, 6, 6});
  two.now = build(straight.points, straight.cells);
  two.maps = {};
  for (VertexHandle v : two.old.vertices()) two.maps.vertices.push_back(v);
  for (CellHandle c : two.old.cells()) two.maps.cells.push_back(c);
  two.maps.old_vertices = two.maps.sources = two.maps.vertices;
  two.maps.old_cells = two.maps.cells;
  const Cavities cavities(two.old, two.now, two.edits(), {});
  std::size_t n_inverted = 0;
  for (std::size_t i = 0; i < cavities.old_cells().size(); ++i)
    n_inverted += cavities.old_volume(i) < 0 ? 1 : 0;
  ASSERT_GT(n_inverted, 0U);
  for (std::size_t i = 0; i < cavities.new_cells().size(); ++i) {
    double covered = 0;
    for (const Overlap& part : cavities.overlaps().of(i)) covered += part.volume;
    EXPECT_NEAR(covered, cavities.new_volume(i), 1e-12);
  }
  const auto old = values(two.old, cavities.old_cells());
  const std::vector<double> nothing(cavities.new_cells().size(), 0);
  const Conserved conserved = conserve(cavities, old, {}, {}, nothing);
  double after = 0;
  for (std::size_t i = 0; i < conserved.values.size(); ++i)
    after += cavities.new_volume(i) * conserved.values[i];
  EXPECT_NEAR(after, conserved.integral, 1e-13 * std::abs(after));
}

}  // namespace
}  // namespace hfr::test
