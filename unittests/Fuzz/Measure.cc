// SPDX-License-Identifier: BSD-3-Clause
#include "Fuzz/Measure.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "Quality/Metrics.hh"

namespace hfr::fuzz {
namespace {

using Wide = std::array<long double, 3>;

Wide difference(Vec3 a, Vec3 b) {
  return {static_cast<long double>(a.x) - b.x, static_cast<long double>(a.y) - b.y,
          static_cast<long double>(a.z) - b.z};
}
Wide cross_of(const Wide& a, const Wide& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
long double dot_of(const Wide& a, const Wide& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Place place(Vec3 p) { return {p.x, p.y, p.z}; }

/// Of the three ways to begin; corners may lie in the same place.
std::array<Place, 3> smallest_turn(std::array<Place, 3> corners) {
  std::array<Place, 3> smallest = corners;
  for (int i = 0; i < 2; ++i) {
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    smallest = std::min(smallest, corners);
  }
  return smallest;
}

/// Number of sets into which `n` things fall, given which are connected.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n), n_sets_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  void connect(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    parent_[a] = b;
    --n_sets_;
  }
  std::size_t count() const { return n_sets_; }

 private:
  std::size_t root(std::size_t a) const {
    while (parent_[a] != a) a = parent_[a];
    return a;
  }
  std::vector<std::size_t> parent_;
  std::size_t n_sets_;
};

class Measurer {
 public:
  explicit Measurer(const TetMesh& mesh) : mesh_(mesh) {}

  Measure run() {
    const CheckResult own = check(mesh_, {.last = Rule::kDuplicateEdge});
    out_.rule = own.rule;
    out_.rule_message = own.message;
    out_.labels_fit = labels_fit();
    measure_points();
    measure_cells();
    measure_constraints();
    count_pinches();
    return std::move(out_);
  }

 private:
  bool labels_fit() const {
    return std::ranges::all_of(used_entries(mesh_, mesh_.labels().faces),
                               [](auto used) { return used != 0; }) &&
           std::ranges::all_of(used_entries(mesh_, mesh_.labels().edges),
                               [](auto used) { return used != 0; });
  }

  void measure_points() {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
    for (VertexHandle v : mesh_.vertices()) {
      const Vec3 p = mesh_.point(v);
      for (int i = 0; i < 3; ++i) {
        out_.largest_coordinate = std::max(out_.largest_coordinate, std::abs(p[i]));
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
      if (mesh_.is_fixed(v)) out_.fixed_vertices.insert(place(p));
      if (mesh_.labels().vertex(v) != 0) out_.vertex_labels.insert(mesh_.labels().vertex(v));
    }
    if (mesh_.n_vertices() > 0) out_.diagonal = std::hypot(high.x - low.x, high.y - low.y, high.z - low.z);
  }

  /// Length of the longest edge as a power of two.
  int exponent_of_size() const {
    long double longest = 0;
    for (CellHandle c : mesh_.cells()) {
      const auto& v = mesh_.cell(c).v;
      for (std::size_t i = 1; i < 4; ++i) {
        const Wide d = difference(mesh_.point(v[i]), mesh_.point(v[0]));
        longest = std::max(longest, dot_of(d, d));
      }
    }
    int exponent = 0;
    std::frexp(std::sqrt(longest), &exponent);
    return longest > 0 ? exponent : 0;
  }

  void measure_cells() {
    const int exponent = exponent_of_size();
    const auto scaled = [&](VertexHandle v) {
      const Vec3 p = mesh_.point(v);
      return Vec3{std::ldexp(p.x, -exponent), std::ldexp(p.y, -exponent), std::ldexp(p.z, -exponent)};
    };
    std::vector<double> angles;
    for (CellHandle c : mesh_.cells()) {
      const auto& v = mesh_.cell(c).v;
      const std::array<Vec3, 4> p = {scaled(v[0]), scaled(v[1]), scaled(v[2]), scaled(v[3])};
      const int sign = orientation(p[0], p[1], p[2], p[3]);
      const Wide a = difference(mesh_.point(v[1]), mesh_.point(v[0]));
      const Wide b = difference(mesh_.point(v[2]), mesh_.point(v[0]));
      const long double volume = dot_of(a, cross_of(b, difference(mesh_.point(v[3]), mesh_.point(v[0])))) / 6;
      ++out_.cells;
      out_.inverted += sign < 0 ? 1 : 0;
      out_.flat += sign == 0 ? 1 : 0;
      if (sign < 0) out_.inverted_volume += std::abs(volume);
      out_.absolute_volume += std::abs(volume);
      out_.region_volume[mesh_.region(c)] += volume;
      angles.push_back(reported_quality(Metric::kMinDihedral, p[0], p[1], p[2], p[3]));
    }
    if (angles.empty()) return;
    std::sort(angles.begin(), angles.end());
    out_.worst = angles.front();
    out_.p1 = angles[angles.size() / 100];
    out_.angles = std::move(angles);
  }

  void measure_constraints() {
    for (HalfFaceHandle h : mesh_.halffaces()) {
      if (!mesh_.is_constrained(h)) continue;
      const auto v = mesh_.halfface_vertices(h);
      FrozenFace face;
      for (std::size_t i = 0; i < 3; ++i) face.corners[i] = place(mesh_.point(v[i]));
      face.corners = smallest_turn(face.corners);
      face.region = mesh_.region(cell_of(h));
      face.inside = mesh_.opposite_halfface(h).is_valid();
      const Wide up = cross_of(difference(mesh_.point(v[1]), mesh_.point(v[0])),
                               difference(mesh_.point(v[2]), mesh_.point(v[0])));
      const long double area = std::sqrt(dot_of(up, up)) / 2;
      out_.area += area;
      if (const int* label = mesh_.labels().faces.find(v)) {
        face.label = *label;
        if (*label != 0 || face.inside) {
          out_.patch_area[*label] += face.inside ? area / 2 : area;
          for (std::size_t i = 0; i < 3; ++i) {
            const Wide side = difference(mesh_.point(v[(i + 1) % 3]), mesh_.point(v[i]));
            out_.patch_edges[*label] += std::sqrt(dot_of(side, side));
          }
        }
      }
      out_.frozen_faces.insert(face);
    }
    for (const auto& entry : mesh_.labels().edges.entries()) {
      FrozenEdge edge{{place(mesh_.point(entry.vertices[0])), place(mesh_.point(entry.vertices[1]))},
                      entry.value};
      std::sort(edge.ends.begin(), edge.ends.end());
      out_.labelled_edges.insert(edge);
      const Wide along = difference(mesh_.point(entry.vertices[0]), mesh_.point(entry.vertices[1]));
      out_.edge_length[entry.value] += std::sqrt(dot_of(along, along));
    }
  }

  void count_pinches() {
    std::map<VertexHandle, std::vector<CellHandle>> at_vertex;
    std::map<std::array<VertexHandle, 2>, std::vector<CellHandle>> at_edge;
    for (CellHandle c : mesh_.cells()) {
      const auto& v = mesh_.cell(c).v;
      for (VertexHandle w : v) at_vertex[w].push_back(c);
      for (const auto& e : kEdgeCorners)
        at_edge[{std::min(v[e[0]], v[e[1]]), std::max(v[e[0]], v[e[1]])}].push_back(c);
    }
    for (const auto& [v, cells] : at_vertex) out_.extra_stars += connected_sets(cells, std::array{v}) - 1;
    for (const auto& [edge, cells] : at_edge) out_.extra_fans += connected_sets(cells, edge) - 1;
  }

  /// Sets of the cells that connect through faces with all of the vertices.
  template <std::size_t N>
  std::size_t connected_sets(const std::vector<CellHandle>& cells,
                             const std::array<VertexHandle, N>& vertices) const {
    Sets sets(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (int k = 0; k < 4; ++k) {
        const HalfFaceHandle h = halfface_of(cells[i], k);
        const HalfFaceHandle m = mesh_.opposite_halfface(h);
        const auto f = mesh_.halfface_vertices(h);
        const auto on_face = [&](VertexHandle v) { return std::find(f.begin(), f.end(), v) != f.end(); };
        if (!m.is_valid() || !std::all_of(vertices.begin(), vertices.end(), on_face)) continue;
        const auto at = std::lower_bound(cells.begin(), cells.end(), cell_of(m));
        if (at != cells.end() && *at == cell_of(m))
          sets.connect(i, static_cast<std::size_t>(at - cells.begin()));
      }
    }
    return sets.count();
  }

  const TetMesh& mesh_;
  Measure out_;
};

}  // namespace

Measure measure(const TetMesh& mesh) { return Measurer(mesh).run(); }

std::vector<CellHandle> invalid_cells_of(const TetMesh& mesh) {
  std::vector<CellHandle> invalid;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    if (orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) <= 0)
      invalid.push_back(c);
  }
  return invalid;
}

}  // namespace hfr::fuzz
