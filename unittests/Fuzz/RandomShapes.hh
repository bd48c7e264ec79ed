// SPDX-License-Identifier: BSD-3-Clause
// The parts that RandomComplex.hh puts together. Sizes are about 1; cells are positive and well shaped unless
// a comment says otherwise.
#ifndef HFR_UNITTESTS_FUZZ_RANDOM_SHAPES_HH
#define HFR_UNITTESTS_FUZZ_RANDOM_SHAPES_HH

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "Fuzz/Random.hh"
#include "HalfFace/Generate.hh"

namespace hfr::fuzz {

using generate::Arrays;
using Corners = std::array<Index, 4>;
using Triangle = std::array<Index, 3>;

inline Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}
inline Corners sorted(Corners c) {
  std::sort(c.begin(), c.end());
  return c;
}
/// The face opposite corner k as the cell sees it.
inline Triangle face_of(const Corners& c, std::size_t k) {
  return {c[kFaceCorners[k][0]], c[kFaceCorners[k][1]], c[kFaceCorners[k][2]]};
}

/// Faces of one cell alone, as that cell sees them, in the order of cells.
inline std::vector<Triangle> open_faces(const Arrays& mesh) {
  std::map<Triangle, int> count;
  for (const Corners& c : mesh.cells)
    for (std::size_t k = 0; k < 4; ++k) ++count[sorted(face_of(c, k))];
  std::vector<Triangle> open;
  for (const Corners& c : mesh.cells)
    for (std::size_t k = 0; k < 4; ++k)
      if (count[sorted(face_of(c, k))] == 1) open.push_back(face_of(c, k));
  return open;
}

/// Drops points that no cell has.
inline void drop_unused(Arrays& mesh) {
  std::vector<Index> to(mesh.points.size(), 0);
  for (const Corners& c : mesh.cells)
    for (Index v : c) to[v] = 1;
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < to.size(); ++v) {
    if (to[v] == 0) continue;
    to[v] = static_cast<Index>(points.size());
    points.push_back(mesh.points[v]);
  }
  for (Corners& c : mesh.cells)
    for (Index& v : c) v = to[v];
  mesh.points = std::move(points);
}

inline Arrays one_cell() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}}; }

/// A cell after a cell, each on a face that is open: with a new vertex above it, or with one that is there
/// already, which closes rings and pinches vertices and edges. Some cells are inverted, flat or nearly so
/// with `wild`.
inline Arrays glued(Random& random, std::size_t n_cells, bool wild) {
  Arrays mesh = one_cell();
  mesh.points[3] = {0.3, 0.3, random.between(0.5, 1)};
  std::map<Triangle, int> used;
  std::set<Corners> known = {sorted(mesh.cells[0])};
  for (std::size_t k = 0; k < 4; ++k) ++used[sorted(face_of(mesh.cells[0], k))];
  for (std::size_t tries = 0; mesh.cells.size() < n_cells && tries < 20 * n_cells; ++tries) {
    const Corners& on = mesh.cells[random.below(mesh.cells.size())];
    const Triangle f = face_of(on, random.below(4));
    if (used[sorted(f)] != 1) continue;
    const bool takes_known = mesh.cells.size() > 2 && random.chance(0.45);
    auto apex = static_cast<Index>(mesh.points.size());
    if (takes_known) apex = random.pick(mesh.cells)[random.below(4)];
    if (std::find(f.begin(), f.end(), apex) != f.end()) continue;
    const Corners created = {f[0], f[2], f[1], apex};
    bool legal = known.count(sorted(created)) == 0;
    for (std::size_t k = 0; k < 3; ++k) {  // the fourth face is f
      const auto at = used.find(sorted(face_of(created, k)));
      legal = legal && (at == used.end() || at->second < 2);
    }
    if (!legal) continue;
    if (!takes_known) {
      const Vec3 a = mesh.points[f[0]], b = mesh.points[f[1]], c = mesh.points[f[2]];
      const Vec3 up = cross(b - a, c - a);
      const double size = std::sqrt(norm(up)) + 1e-12;
      double height = random.between(0.5, 1.3);
      if (wild && random.chance(0.2)) height *= random.pick({-1.0, -0.1, 0.0, 1e-3, 1e-9});
      const double out = norm(up) > 0 ? -height * size / norm(up) : 0;
      mesh.points.push_back((1.0 / 3) * (a + b + c) + out * up + random.step(0.15 * size));
    }
    mesh.cells.push_back(created);
    known.insert(sorted(created));
    for (std::size_t k = 0; k < 4; ++k) ++used[sorted(face_of(created, k))];
  }
  return mesh;
}

/// Cells round an edge of the z axis, all the way round or not; `layers` more rings of vertices outside.
inline Arrays fan(Random& random, int n, bool closed) {
  Arrays mesh;
  mesh.points = {{0, 0, -0.6}, {0, 0, 0.6}};
  const int n_rim = closed ? n : n + 1;
  const double turn = 2 * 3.14159265358979 / n * (closed ? 1 : 0.9);
  for (int i = 0; i < n_rim; ++i) {
    const double r = random.between(0.9, 1.1);
    mesh.points.push_back({r * std::cos(turn * i), r * std::sin(turn * i), random.between(-0.1, 0.1)});
  }
  for (int i = 0; i < n; ++i)
    mesh.cells.push_back({0, 1, static_cast<Index>(2 + i), static_cast<Index>(2 + (i + 1) % n_rim)});
  return mesh;
}

/// All cells at one vertex inside a geodesic sphere of 20 n² triangles; with `shell`, three times as many
/// cells round these, so that the vertices of the sphere lie inside, too.
inline Arrays star(Random& random, Index n, bool shell) {
  Arrays ball = generate::ball(n);
  Arrays mesh;
  mesh.points = ball.points;
  const std::vector<Triangle> rim = open_faces(ball);
  const auto centre = static_cast<Index>(mesh.points.size());
  mesh.points.push_back(random.step(0.15));
  for (const Triangle& t : rim) mesh.cells.push_back({t[0], t[1], t[2], centre});
  if (shell) {
    const auto n_points = static_cast<Index>(mesh.points.size());
    for (Index v = 0; v < n_points; ++v) mesh.points.push_back(1.35 * mesh.points[v]);
    for (Triangle t : rim) {  // a prism, cut by ascending vertices
      while (t[0] != std::min({t[0], t[1], t[2]})) t = {t[1], t[2], t[0]};
      const bool second = t[1] < t[2];
      const Index a = t[0], b = t[1], c = t[2], d = a + n_points, e = b + n_points, g = c + n_points;
      mesh.cells.push_back(second ? Corners{a, b, c, g} : Corners{a, b, c, e});
      mesh.cells.push_back(second ? Corners{a, b, g, e} : Corners{a, c, g, e});
      mesh.cells.push_back({a, e, g, d});
    }
  }
  drop_unused(mesh);
  return mesh;
}

/// Cells of the body-centred lattice round the faces between n³ cubes: dihedrals of 60 and 90 degrees.
inline Arrays lattice(Index n) {
  Arrays mesh;
  const Index m = n + 1;
  const auto corner = [&](Index i, Index j, Index k) { return (k * m + j) * m + i; };
  for (Index k = 0; k < m; ++k)
    for (Index j = 0; j < m; ++j)
      for (Index i = 0; i < m; ++i) mesh.points.push_back({double(i), double(j), double(k)});
  const Index first = m * m * m;
  const auto centre = [&](Index i, Index j, Index k) { return first + (k * n + j) * n + i; };
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) mesh.points.push_back({i + 0.5, j + 0.5, k + 0.5});
  const auto round_face = [&](Index p, Index q, std::array<Index, 4> rim) {
    for (std::size_t e = 0; e < 4; ++e) mesh.cells.push_back({p, q, rim[e], rim[(e + 1) % 4]});
  };
  for (Index a = 1; a < n; ++a)
    for (Index b = 0; b < n; ++b)
      for (Index c = 0; c < n; ++c) {
        round_face(centre(a - 1, b, c), centre(a, b, c),
                   {corner(a, b, c), corner(a, b + 1, c), corner(a, b + 1, c + 1), corner(a, b, c + 1)});
        round_face(centre(c, a - 1, b), centre(c, a, b),
                   {corner(c, a, b), corner(c, a, b + 1), corner(c + 1, a, b + 1), corner(c + 1, a, b)});
        round_face(centre(b, c, a - 1), centre(b, c, a),
                   {corner(b, c, a), corner(b + 1, c, a), corner(b + 1, c + 1, a), corner(b, c + 1, a)});
      }
  drop_unused(mesh);
  return mesh;
}

/// The mesh without some of its cells: pinched vertices and edges, cavities, crumbs.
inline void tear(Random& random, Arrays& mesh, double keep) {
  std::vector<Corners> kept;
  std::vector<int> regions;
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    if (!random.chance(keep) && (i > 0 || !kept.empty())) continue;
    kept.push_back(mesh.cells[i]);
    if (!mesh.regions.empty()) regions.push_back(mesh.regions[i]);
  }
  mesh.cells = std::move(kept);
  mesh.regions = std::move(regions);
  drop_unused(mesh);
}

/// Cuts cells into four at a point inside: valid, and of ever worse angles.
inline void split_cells(Random& random, Arrays& mesh, int n) {
  for (int i = 0; i < n; ++i) {
    const std::size_t at = random.below(mesh.cells.size());
    const Corners c = mesh.cells[at];
    std::array<double, 4> w;
    for (double& x : w) x = random.between(0.05, 1);
    const double sum = w[0] + w[1] + w[2] + w[3];
    Vec3 p;
    for (std::size_t k = 0; k < 4; ++k) p = p + (w[k] / sum) * mesh.points[c[k]];
    const auto v = static_cast<Index>(mesh.points.size());
    mesh.points.push_back(p);
    for (std::size_t k = 0; k < 4; ++k) {
      Corners created = c;
      created[k] = v;
      if (k == 0) {
        mesh.cells[at] = created;
      } else {
        mesh.cells.push_back(created);
        if (!mesh.regions.empty()) mesh.regions.push_back(mesh.regions[at]);
      }
    }
  }
}

/// A box whose cells beyond x = 1/2 have vertices of their own in part of that plane: two sheets of the
/// boundary lie on one another.
inline Arrays slit(Random& random, Index n) {
  Arrays mesh = generate::box({2 * n, n + 1, n + 1});
  std::vector<Index> twin(mesh.points.size(), 0);
  const double y = random.between(0.3, 1), z = random.between(0.3, 1);
  const std::size_t n_points = mesh.points.size();
  for (std::size_t v = 0; v < n_points; ++v) {
    const Vec3 p = mesh.points[v];
    if (p.x != 0.5 || p.y > y || p.z > z || p.y == 0 || p.z == 0) continue;
    twin[v] = static_cast<Index>(mesh.points.size());
    mesh.points.push_back(p);
  }
  for (Corners& c : mesh.cells) {
    double x = 0;
    for (Index v : c) x += mesh.points[v].x;
    if (x > 2)
      for (Index& v : c)
        if (v < n_points && twin[v] != 0) v = twin[v];
  }
  return mesh;
}

}  // namespace hfr::fuzz

#endif
