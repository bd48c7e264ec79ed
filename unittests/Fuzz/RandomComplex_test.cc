// SPDX-License-Identifier: BSD-3-Clause
#include "Fuzz/RandomComplex.hh"

#include <gtest/gtest.h>

#include <optional>

#include "Fuzz/Measure.hh"
#include "HalfFace/Errors.hh"

namespace hfr::fuzz {
namespace {

TEST(RandomComplex, IsTheSameForTheSameNumber) {
  for (std::uint64_t number = 1; number < 200; ++number) {
    const Complex a = random_complex(number), b = random_complex(number);
    EXPECT_EQ(a.made_of, b.made_of);
    EXPECT_EQ(a.cells, b.cells);
    EXPECT_EQ(a.regions, b.regions);
    EXPECT_EQ(a.faces.size(), b.faces.size());
    EXPECT_EQ(a.points.size(), b.points.size());
  }
  EXPECT_NE(random_complex(1).cells, random_complex(2).cells);
}

struct Kinds {
  std::size_t refused = 0, valid = 0, inverted = 0, flat = 0, all_flat = 0, pinched_edges = 0,
              pinched_vertices = 0;
  std::size_t large_stars = 0, large_rings = 0, regions = 0, labels = 0, fixed = 0, huge = 0, tiny = 0,
              offset = 0;
  std::size_t one_cell = 0, without_inside = 0, equal_qualities = 0;
};

void count(const Complex& complex, Kinds& kinds) {
  std::optional<TetMesh> mesh;
  try {
    mesh = mesh_of(complex);
  } catch (const InvalidInput&) {
    ++kinds.refused;
    return;
  }
  const Measure m = measure(*mesh);
  kinds.valid += m.inverted + m.flat + m.extra_fans + m.extra_stars == 0;
  kinds.inverted += m.inverted > 0;
  kinds.flat += m.flat > 0;
  kinds.all_flat += m.flat == m.cells;
  kinds.pinched_edges += m.extra_fans > 0;
  kinds.pinched_vertices += m.extra_stars > 0;
  kinds.regions += m.region_volume.size() > 1;
  kinds.labels += !m.labelled_edges.empty() || !m.vertex_labels.empty() || !m.patch_area.empty();
  kinds.fixed += !m.fixed_vertices.empty();
  kinds.huge += m.largest_coordinate > 1e100;
  kinds.tiny += m.largest_coordinate < 1e-100 && m.largest_coordinate > 0;
  kinds.offset += m.largest_coordinate > 1e5 && m.largest_coordinate < 1e20;
  kinds.one_cell += m.cells == 1;
  kinds.equal_qualities += m.cells > 20 && m.worst == m.p1;
  std::map<Index, std::size_t> star;
  for (const Corners& c : complex.cells)
    for (Index v : c) ++star[v];
  kinds.large_stars += std::ranges::any_of(star, [](const auto& s) { return s.second > 256; });
  std::size_t longest_ring = 0, inside = 0;
  for (EdgeHandle e : mesh->edges())
    if (!mesh->is_boundary(e)) longest_ring = std::max(longest_ring, mesh->valence(e));
  for (VertexHandle v : mesh->vertices())
    inside += mesh->incident_cell(v).is_valid() && !mesh->is_boundary(v);
  kinds.large_rings += longest_ring > 32;
  kinds.without_inside += inside == 0;
}

TEST(RandomComplex, IsOfEveryKindThatARunMayMeet) {
  Kinds kinds;
  constexpr std::uint64_t kCases = 1500;
  for (std::uint64_t number = 1; number <= kCases; ++number) count(random_complex(number), kinds);
  EXPECT_LT(kinds.refused, kCases / 3);
  for (const std::size_t often :
       {kinds.refused, kinds.valid, kinds.inverted, kinds.flat, kinds.pinched_edges, kinds.pinched_vertices,
        kinds.regions, kinds.labels, kinds.fixed, kinds.offset, kinds.without_inside})
    EXPECT_GT(often, kCases / 30);
  for (const std::size_t rare : {kinds.all_flat, kinds.large_stars, kinds.large_rings, kinds.huge, kinds.tiny,
                                 kinds.one_cell, kinds.equal_qualities})
    EXPECT_GT(rare, kCases / 300);
}

}  // namespace
}  // namespace hfr::fuzz
