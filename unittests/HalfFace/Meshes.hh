// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_HALFFACE_MESHES_HH
#define HFR_UNITTESTS_HALFFACE_MESHES_HH

#include <array>
#include <ostream>
#include <string>
#include <vector>

#include "HalfFace/Generate.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr::test {

using Corners = std::array<Index, 4>;

inline TetMesh built(const generate::Arrays& arrays) {
  TetMesh mesh = build(arrays.points, arrays.cells);
  for (std::size_t i = 0; i < arrays.regions.size(); ++i)
    mesh.set_region(CellHandle(static_cast<Index>(i)), arrays.regions[i]);
  return mesh;
}

inline TetMesh single_cell() {
  return build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, std::vector<Corners>{{0, 1, 2, 3}});
}

inline TetMesh kuhn_box(Index n) { return built(generate::box({n, n, n})); }

/// The box without some of its cells, chosen at random: fans, pinched vertices and pinched edges.
inline TetMesh torn_box(Index n, double keep, std::uint64_t seed) {
  generate::Arrays arrays = generate::box({n, n, n});
  std::vector<Corners> kept;
  for (std::size_t i = 0; i < arrays.cells.size(); ++i)
    if (generate::random_unit(seed, i) < keep) kept.push_back(arrays.cells[i]);
  return build(arrays.points, kept);
}

/// The cells of a box whose centres are in a ball: one solid with a rough surface.
inline TetMesh carved_ball(Index n) {
  generate::Arrays arrays = generate::box({n, n, n}, {-1, -1, -1}, {1, 1, 1});
  std::vector<Corners> kept;
  for (const Corners& c : arrays.cells) {
    Vec3 sum;
    for (Index v : c) sum = sum + arrays.points[v];
    if (norm(0.25 * sum) < 0.8) kept.push_back(c);
  }
  return build(arrays.points, kept);
}

struct NamedMesh {
  std::string name;
  TetMesh mesh;
  friend std::ostream& operator<<(std::ostream& out, const NamedMesh& m) { return out << m.name; }
};

/// Every kind of neighbourhood that the kernel has to cope with.
inline std::vector<NamedMesh> suite() {
  return {{"SingleCell", single_cell()},   {"Box", kuhn_box(3)},
          {"CarvedBall", carved_ball(6)},  {"TornBox", torn_box(4, 0.5, 1)},
          {"Crumbs", torn_box(4, 0.2, 2)}, {"Ball", built(generate::ball(3))}};
}

}  // namespace hfr::test

#endif
