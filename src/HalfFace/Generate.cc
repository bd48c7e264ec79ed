// SPDX-License-Identifier: BSD-3-Clause
// Shapes as arrays. The ball subdivides the 20 cells that join an icosahedron's faces to its centre; the
// cylinder extrudes a disc of hexagonal rings: both give regular boundaries, where a cube mapped onto them
// would leave flat cells along the images of its edges.
#include "HalfFace/Generate.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <unordered_map>

#include "HalfFace/Errors.hh"
#include "HalfFace/TetMesh.hh"
#include "HalfFace/TupleMap.hh"

namespace hfr::generate {
namespace {

using Tet = std::array<Index, 4>;

/// Cells of a shape must leave room for 12 half-edge indices a cell.
void require_countable(double n_cells) {
  if (n_cells > static_cast<double>(TetMesh::kMostCells))
    throw ResourceLimit(
        "a mesh of " + (n_cells < 1e18 ? std::to_string(static_cast<long long>(n_cells)) : "10^18 and more") +
        " cells is too large for the indices of this build; ask for fewer");
}

void require_box(Counts n, Vec3 low, Vec3 high) {
  for (int d = 0; d < 3; ++d) {
    HFR_REQUIRE(n[static_cast<std::size_t>(d)] >= 1, "a box needs at least one cube in each direction");
    HFR_REQUIRE(std::isfinite(low[d]) && std::isfinite(high[d]) && low[d] < high[d],
                "a box needs a lower corner that lies below its upper one");
  }
  require_countable(6.0 * static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]));
}

/// Cells of the cubes (i, j, k) with has_cube(j, k), of which there are n_cubes.
template <class HasCube>
std::vector<Tet> kuhn_cells(Counts n, std::size_t n_cubes, HasCube&& has_cube) {
  const Index row = n[0] + 1;
  const Index layer = row * (n[1] + 1);
  std::vector<Tet> cells;
  cells.reserve(6 * n_cubes);
  for (Index k = 0; k < n[2]; ++k)
    for (Index j = 0; j < n[1]; ++j) {
      if (!has_cube(j, k)) continue;
      for (Index i = 0; i < n[0]; ++i)
        for (const auto& corners : kCubeCells) {
          Tet& cell = cells.emplace_back();
          for (std::size_t c = 0; c < 4; ++c) {
            const unsigned bits = corners[c];
            cell[c] = (k + (bits >> 2)) * layer + (j + (bits >> 1 & 1)) * row + i + (bits & 1);
          }
        }
    }
  return cells;
}

/// Adds cells between barycentric lattice points of one cell that is cut into n³. `at(b, c, d)` gives the
/// index of the lattice point with these weights of corners 1, 2, 3.
template <class At>
void subdivide(Index n, const std::vector<Vec3>& points, std::vector<Tet>& cells, At&& at) {
  for (Index b = 0; b < n; ++b)
    for (Index c = 0; b + c < n; ++c)
      for (Index d = 0; b + c + d < n; ++d) {
        cells.push_back({at(b, c, d), at(b + 1, c, d), at(b, c + 1, d), at(b, c, d + 1)});
        if (b + c + d + 2 > n) continue;
        // The octahedron between the corner cells is cut into four round its shortest diagonal; `belt` goes
        // round it.
        const Index x = at(b + 1, c, d), y = at(b, c + 1, d), z = at(b, c, d + 1);
        const Index xy = at(b + 1, c + 1, d), yz = at(b, c + 1, d + 1), zx = at(b + 1, c, d + 1);
        struct Cut {
          Index from, to;
          std::array<Index, 4> belt;
        };
        const std::array<Cut, 3> cuts = {
            {{x, yz, {y, xy, zx, z}}, {y, zx, {z, yz, xy, x}}, {z, xy, {x, zx, yz, y}}}};
        const Cut& cut = *std::min_element(cuts.begin(), cuts.end(), [&](const Cut& p, const Cut& q) {
          return norm2(points[p.to] - points[p.from]) < norm2(points[q.to] - points[q.from]);
        });
        for (std::size_t i = 0; i < 4; ++i)
          cells.push_back({cut.from, cut.to, cut.belt[i], cut.belt[(i + 1) % 4]});
        if (b + c + d + 3 <= n) cells.push_back({xy, zx, yz, at(b + 1, c + 1, d + 1)});
      }
}

void make_positive(const std::vector<Vec3>& p, std::vector<Tet>& cells) {
  for (Tet& c : cells)
    if (dot(p[c[1]] - p[c[0]], cross(p[c[2]] - p[c[0]], p[c[3]] - p[c[0]])) < 0) std::swap(c[2], c[3]);
}

constexpr std::array<std::array<Index, 3>, 20> kIcosahedronFaces = {
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

std::array<Vec3, 12> icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::array<Vec3, 12> corners = {{{-1, g, 0},
                                   {1, g, 0},
                                   {-1, -g, 0},
                                   {1, -g, 0},
                                   {0, -1, g},
                                   {0, 1, g},
                                   {0, -1, -g},
                                   {0, 1, -g},
                                   {g, 0, -1},
                                   {g, 0, 1},
                                   {-g, 0, -1},
                                   {-g, 0, 1}}};
  for (Vec3& c : corners) c = (1 / norm(c)) * c;
  return corners;
}

/// Vertices of a disc: the axis, then ring m = 1 … n of 6m vertices.
Index disc_vertex(Index ring, Index step) {
  return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + step % (6 * ring);
}

std::vector<std::array<Index, 3>> disc_triangles(Index n) {
  std::vector<std::array<Index, 3>> triangles;
  for (Index m = 1; m <= n; ++m)
    for (Index sector = 0; sector < 6; ++sector)
      for (Index s = 0; s < m; ++s) {
        const Index outer = sector * m + s;
        const Index inner = sector * (m - 1) + s;
        triangles.push_back({disc_vertex(m - 1, inner), disc_vertex(m, outer), disc_vertex(m, outer + 1)});
        if (s + 1 < m)
          triangles.push_back(
              {disc_vertex(m - 1, inner), disc_vertex(m, outer + 1), disc_vertex(m - 1, inner + 1)});
      }
  return triangles;
}

Vec3 gaussian_push(Vec3 p, const CavityOptions& options) {
  const double w = 64 * p.x * (1 - p.x) * p.y * (1 - p.y) * p.z * (1 - p.z);
  Vec3 sum;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        const Vec3 d = p - Vec3{0.25 + i / 2.0, 0.25 + j / 2.0, 0.25 + k / 2.0};
        const double push = std::exp(-norm2(d) / (2 * options.sigma * options.sigma));
        sum[(i + 2 * j + 3 * k) % 3] += (i + j + k) % 2 == 0 ? push : -push;
      }
  return options.amplitude * w * sum;
}

Vec3 bulk_shear(Vec3 p, const CavityOptions& options) {
  constexpr double kPi = std::numbers::pi;
  Vec3 once, twice;  // sin²(π·) and sin(2π·)
  for (int d = 0; d < 3; ++d) {
    if (p[d] == 0 || p[d] == 1) return {};  // the sines there are zero, but not in floating point
    once[d] = std::sin(kPi * p[d]) * std::sin(kPi * p[d]);
    twice[d] = std::sin(2 * kPi * p[d]);
  }
  return options.amplitude *
         Vec3{2 * once.x * twice.y * twice.z, -twice.x * once.y * twice.z, -twice.x * twice.y * once.z};
}

}  // namespace

double random_unit(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(mix64(seed + (index + 1) * 0x9e3779b97f4a7c15ULL) >> 11) * 0x1p-53;
}

Arrays box(Counts counts, Vec3 low, Vec3 high) { return jittered_box(counts, 0, 0, low, high); }

Vec3 jittered_point(Counts counts, Counts at, double jitter, std::uint64_t seed, Vec3 low, Vec3 high) {
  const std::uint64_t v =
      (std::uint64_t{at[2]} * (std::uint64_t{counts[1]} + 1) + at[1]) * (std::uint64_t{counts[0]} + 1) +
      at[0];
  Vec3 p;
  for (std::size_t d = 0; d < 3; ++d) {
    const int axis = static_cast<int>(d);
    const auto n = static_cast<double>(counts[d]);
    if (at[d] == 0 || at[d] == counts[d]) {
      p[axis] = at[d] == 0 ? low[axis] : high[axis];
      continue;
    }
    double x = static_cast<double>(at[d]) / n;
    if (jitter != 0) x += jitter / n * (2 * random_unit(seed, 3 * v + d) - 1);
    p[axis] = low[axis] + (high[axis] - low[axis]) * x;
  }
  return p;
}

Arrays jittered_box(Counts counts, double jitter, std::uint64_t seed, Vec3 low, Vec3 high) {
  require_box(counts, low, high);
  HFR_REQUIRE(std::isfinite(jitter), "the jitter must be a finite number");
  Arrays mesh;
  mesh.points.reserve((std::size_t{counts[0]} + 1) * (std::size_t{counts[1]} + 1) *
                      (std::size_t{counts[2]} + 1));
  for (Index k = 0; k <= counts[2]; ++k)
    for (Index j = 0; j <= counts[1]; ++j)
      for (Index i = 0; i <= counts[0]; ++i)
        mesh.points.push_back(jittered_point(counts, {i, j, k}, jitter, seed, low, high));
  mesh.cells =
      kuhn_cells(counts, std::size_t{counts[0]} * counts[1] * counts[2], [](Index, Index) { return true; });
  return mesh;
}

Arrays two_region_box(Counts counts, Vec3 low, Vec3 high) {
  HFR_REQUIRE(counts[0] >= 2, "a box of two regions needs at least two cubes along x");
  Arrays mesh = box(counts, low, high);
  mesh.regions.resize(mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    mesh.regions[c] = c / 6 % counts[0] < counts[0] / 2 ? 1 : 2;
  return mesh;
}

Vec3 deform(Vec3 p, const CavityOptions& options) {
  const Vec3 push =
      options.field == CavityField::kBulkShear ? bulk_shear(p, options) : gaussian_push(p, options);
  return p + push;
}

Arrays cavity(const CavityOptions& options) {
  HFR_REQUIRE(std::isfinite(options.amplitude), "the amplitude must be a finite number");
  HFR_REQUIRE(std::isfinite(options.sigma) && options.sigma > 0, "sigma must be above 0");
  Arrays mesh = jittered_box(options.counts, options.jitter, options.seed);
  if (options.amplitude == 0) return mesh;
  for (Vec3& p : mesh.points) p = deform(p, options);
  return mesh;
}

Arrays ball(Index n, double radius) {
  HFR_REQUIRE(n >= 1, "a ball needs at least one shell");
  HFR_REQUIRE(std::isfinite(radius) && radius > 0, "the radius must be above 0");
  const auto n_shells = static_cast<double>(n);
  require_countable(20 * n_shells * n_shells * n_shells);
  const std::array<Vec3, 12> corners = icosahedron();
  Arrays mesh;
  mesh.points.reserve(static_cast<std::size_t>(n_shells * (n_shells + 1) * (20 * n_shells + 10) / 6) + 2 * n +
                      1);
  mesh.cells.reserve(std::size_t{20} * n * n * n);
  std::unordered_map<std::uint64_t, Index> index_of;  // by the weights of the icosahedron's corners
  for (const auto& face : kIcosahedronFaces) {
    const auto at = [&](Index b, Index c, Index d) {
      const std::array<Index, 3> weight = {b, c, d};
      std::array<std::uint64_t, 3> parts{};
      Vec3 sum;
      for (std::size_t i = 0; i < 3; ++i) {
        if (weight[i] != 0) parts[i] = std::uint64_t{weight[i]} << 4 | face[i];
        sum = sum + static_cast<double>(weight[i]) * corners[face[i]];
      }
      std::sort(parts.begin(), parts.end());  // 20 bits each: at most 1,024 shells fit 32-bit indices
      const auto [found, is_new] = index_of.try_emplace(parts[0] << 40 | parts[1] << 20 | parts[2],
                                                        static_cast<Index>(mesh.points.size()));
      if (is_new) {
        const double length = norm(sum);
        const double shell = radius * (static_cast<double>(b + c + d) / n_shells);
        mesh.points.push_back(length == 0 ? Vec3{} : (shell / length) * sum);
      }
      return found->second;
    };
    subdivide(n, mesh.points, mesh.cells, at);
  }
  make_positive(mesh.points, mesh.cells);
  return mesh;
}

Arrays cylinder(Index n_radial, Index n_axial, double radius, double height, double twist, double wring) {
  HFR_REQUIRE(n_radial >= 1 && n_axial >= 1, "a cylinder needs at least one ring and one layer");
  HFR_REQUIRE(std::isfinite(radius) && radius > 0 && std::isfinite(height) && height > 0,
              "radius and height must be above 0");
  HFR_REQUIRE(std::isfinite(twist), "the twist must be a finite number");
  HFR_REQUIRE(std::isfinite(wring), "the wring must be a finite number");
  require_countable(18.0 * static_cast<double>(n_radial) * static_cast<double>(n_radial) *
                    static_cast<double>(n_axial));
  const Index layer = disc_vertex(n_radial + 1, 0);  // vertices of one disc
  Arrays mesh;
  mesh.points.reserve(std::size_t{layer} * (std::size_t{n_axial} + 1));
  for (Index k = 0; k <= n_axial; ++k) {
    const double part = static_cast<double>(k) / static_cast<double>(n_axial);
    const double turn = twist / 180 * std::numbers::pi * part;
    const bool at_end = k == 0 || k == n_axial;  // where the sine is zero, but not in floating point
    const double pull = at_end ? 0.0 : wring / 180 * std::numbers::pi * std::sin(std::numbers::pi * part);
    mesh.points.push_back({0, 0, height * part});
    for (Index m = 1; m <= n_radial; ++m) {
      const double share = static_cast<double>(m) / static_cast<double>(n_radial);
      const double r = radius * share;
      for (Index s = 0; s < 6 * m; ++s) {
        double angle = std::numbers::pi * static_cast<double>(s) / (3.0 * static_cast<double>(m));
        if (pull != 0) angle += pull * share * share * std::sin(angle);
        angle += turn;
        mesh.points.push_back({r * std::cos(angle), r * std::sin(angle), height * part});
      }
    }
  }
  // Each prism is cut along the order of its vertices, so that neighbours agree on the diagonals between
  // them.
  mesh.cells.reserve(std::size_t{18} * n_radial * n_radial * n_axial);
  const auto triangles = disc_triangles(n_radial);
  for (Index k = 0; k < n_axial; ++k)
    for (const auto& triangle : triangles) {
      auto [a, b, c] = triangle;
      bool even = true;  // sorting keeps the orientation
      const auto order = [&](Index& p, Index& q) {
        if (p <= q) return;
        std::swap(p, q);
        even = !even;
      };
      order(a, b), order(b, c), order(a, b);
      const Index low = k * layer, high = low + layer;
      for (Tet cell : {Tet{low + a, low + b, low + c, high + c}, Tet{low + a, low + b, high + c, high + b},
                       Tet{low + a, high + b, high + c, high + a}}) {
        if (!even) std::swap(cell[2], cell[3]);
        mesh.cells.push_back(cell);
      }
    }
  return mesh;
}

Arrays fandisk(Counts counts, double jitter, std::uint64_t seed) {
  constexpr double kLevel = 0.5;
  require_countable(18.0 * static_cast<double>(counts[0]) * static_cast<double>(counts[1]) *
                    static_cast<double>(counts[2]));
  const Counts grid = {counts[0], 2 * counts[1], 2 * counts[2]};
  require_box(grid, {0, 0, 0}, {1, 1, 1});
  HFR_REQUIRE(std::isfinite(jitter), "the jitter must be a finite number");
  const auto place = [&](Counts at, std::uint64_t v) -> Vec3 {
    Vec3 along;  // radius, halves of the arc, levels
    for (std::size_t d = 0; d < 3; ++d) {
      const Index half = d == 0 ? grid[d] : counts[d];
      double x = static_cast<double>(at[d]);
      if (at[d] % half != 0 && jitter != 0) x += jitter * (2 * random_unit(seed, 3 * v + d) - 1);
      along[static_cast<int>(d)] = x / static_cast<double>(half);
    }
    const double r = 1 + along.x;
    const double angle = std::numbers::pi / 4 * along.y;
    double c = std::cos(angle);
    double s = std::sin(angle);
    // The ends and the step are planes to the last bit.
    if (at[1] == 0) s = 0;
    if (at[1] == counts[1]) s = c;
    if (at[1] == grid[1]) c = 0;
    const double x = r * c;
    const double top = 1.3 - 0.15 * x;
    const double z = at[2] == grid[2]     ? top
                     : at[2] <= counts[2] ? kLevel * along.z
                                          : kLevel + (top - kLevel) * (along.z - 1);
    return {x, r * s, z};
  };
  // Without the cubes above the low half, and their vertices.
  Arrays mesh;
  mesh.cells = kuhn_cells(grid, std::size_t{3} * counts[0] * counts[1] * counts[2],
                          [&](Index j, Index k) { return j < counts[1] || k < counts[2]; });
  std::vector<Index> number(
      (std::size_t{grid[0]} + 1) * (std::size_t{grid[1]} + 1) * (std::size_t{grid[2]} + 1),
      VertexHandle::kInvalid);
  for (const Tet& cell : mesh.cells)
    for (Index v : cell) number[v] = 0;
  std::size_t v = 0;
  for (Index k = 0; k <= grid[2]; ++k)
    for (Index j = 0; j <= grid[1]; ++j)
      for (Index i = 0; i <= grid[0]; ++i, ++v) {
        if (number[v] != 0) continue;
        number[v] = static_cast<Index>(mesh.points.size());
        mesh.points.push_back(place({i, j, k}, v));
      }
  for (Tet& cell : mesh.cells)
    for (Index& corner : cell) corner = number[corner];
  return mesh;
}

void jitter_inner(Arrays& mesh, double jitter, std::uint64_t seed) {
  HFR_REQUIRE(std::isfinite(jitter), "the jitter must be a finite number");
  const TetMesh built = build(mesh.points, mesh.cells);
  std::vector<double> shortest2(mesh.points.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> stays(mesh.points.size(), false);
  for (CellHandle c : built.cells()) {
    const auto& v = built.cell(c).v;
    for (const auto& [i, j] : kEdgeCorners) {
      const Vec3 edge = built.point(v[j]) - built.point(v[i]);
      const double length2 = dot(edge, edge);
      shortest2[v[i].idx()] = std::min(shortest2[v[i].idx()], length2);
      shortest2[v[j].idx()] = std::min(shortest2[v[j].idx()], length2);
    }
    for (int k = 0; k < 4; ++k) {
      if (!built.is_boundary(halfface_of(c, k))) continue;
      for (VertexHandle w : built.halfface_vertices(halfface_of(c, k))) stays[w.idx()] = true;
    }
  }
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (stays[v] || !(shortest2[v] < std::numeric_limits<double>::infinity())) continue;
    const double reach = jitter * std::sqrt(shortest2[v]);
    for (int d = 0; d < 3; ++d)
      mesh.points[v][d] += reach * (2 * random_unit(seed, 3 * v + static_cast<std::size_t>(d)) - 1);
  }
}

}  // namespace hfr::generate
