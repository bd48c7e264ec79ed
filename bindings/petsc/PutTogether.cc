// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "Plex.hh"
#include "Tuples.hh"
#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::petsc {
namespace {

using Place = Index;
using Point = Tuple<Place>;

/// What place a vertex of the DMPlex has among the vertices of the mesh.
struct Places {
  std::vector<Vec3> points;
  std::vector<Index> place;

  Point at(const std::array<std::int64_t, 4>& numbers, int n) const {
    Point v;
    v.fill(kNone<Place>);
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      HFR_REQUIRE(numbers[i] >= 0 && static_cast<std::size_t>(numbers[i]) < place.size(),
                  "the DMPlex names a vertex that no rank has");
      v[i] = place[static_cast<std::size_t>(numbers[i])];
    }
    return v;
  }
};

Places place_vertices(const std::vector<LocalPlex>& parts) {
  std::vector<std::pair<std::array<double, 3>, std::int64_t>> order;
  for (const LocalPlex& part : parts)
    for (std::size_t i = 0; i < part.n_own; ++i)
      order.push_back({{part.points[i].x, part.points[i].y, part.points[i].z}, part.numbers[i]});
  std::sort(order.begin(), order.end());
  Places places;
  places.place.assign(order.size(), kNone<Place>);
  for (const auto& [x, number] : order) {
    HFR_REQUIRE(number >= 0 && static_cast<std::size_t>(number) < order.size(),
                "the DMPlex numbers a vertex beyond their number");
    places.place[static_cast<std::size_t>(number)] = static_cast<Index>(places.points.size());
    places.points.push_back({x[0], x[1], x[2]});
  }
  return places;
}

/// Points with a value of one label.
using Marks = std::set<std::pair<Point, int>>;

bool has_any(const Marks& marks, const Point& point) {
  const auto at = marks.lower_bound({point, std::numeric_limits<int>::min()});
  return at != marks.end() && at->first == point;
}

bool is_closed(const Marks& marks) {
  bool has_inner = false;
  for (const auto& [point, value] : marks)
    for (const Point& face : faces_of(point)) {
      has_inner = true;
      if (!has_any(marks, face)) return false;
    }
  return has_inner;
}

/// Without what is part of the closure of another one with the same value.
Marks without_closures(const Marks& marks) {
  Marks implied, left;
  for (const auto& [point, value] : marks)
    for (const Point& face : faces_of(point)) implied.insert({face, value});
  std::set_difference(marks.begin(), marks.end(), implied.begin(), implied.end(),
                      std::inserter(left, left.end()));
  return left;
}

/// All values of each point, by label.
std::map<Point, std::vector<Labelling::Value>> values_of(const std::vector<LocalPlex>& parts,
                                                         const Places& places, Labelling& labelling) {
  std::map<std::string, Marks> by_name;
  for (const LocalPlex& part : parts) {
    for (const std::string& name : part.names) by_name[name];
    for (const Mark& m : part.marks)
      by_name[part.names.at(static_cast<std::size_t>(m.label))].insert(
          {point_of(places.at(m.v, m.n)), m.value});
  }
  std::map<Point, std::vector<Labelling::Value>> values;
  for (auto& [name, marks] : by_name) {
    const bool closed = is_closed(marks);
    const auto label = static_cast<int>(labelling.labels.size());
    labelling.labels.push_back({name, closed});
    for (const auto& [point, value] : closed ? without_closures(marks) : marks)
      values[point].push_back({label, value});
  }
  return values;
}

/// Gives the points their numbers: regions of cells, labels of faces, edges and vertices.
void attach(const std::map<Point, std::vector<Labelling::Value>>& values, const std::vector<Point>& cells,
            WholePlex& whole) {
  std::map<std::vector<Labelling::Value>, int> numbers;
  for (const auto& [point, set] : values) numbers[set] = 0;
  for (auto& [set, number] : numbers) {
    whole.labelling.values.push_back(set);
    number = static_cast<int>(whole.labelling.values.size());
  }
  TetMesh& mesh = whole.mesh;
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (const auto at = values.find(point_of(cells[c])); at != values.end())
      mesh.set_region(CellHandle(c), numbers.at(at->second));
  for (const auto& [point, set] : values) {
    const VertexHandle a(point[0]), b(point[1]), c(point[2]);
    switch (n_vertices(point)) {
      case 1:
        mesh.labels().vertices.resize(mesh.n_vertices(), 0);
        mesh.labels().vertices[a.idx()] = numbers.at(set);
        break;
      case 2:
        mesh.labels().edges.set({a, b}, numbers.at(set));
        break;
      case 3:
        mesh.labels().faces.set({a, b, c}, numbers.at(set));
        break;
      default:  // cells are done
        break;
    }
  }
}

}  // namespace

WholePlex put_together(const std::vector<LocalPlex>& parts) {
  const Places places = place_vertices(parts);
  std::vector<std::pair<Point, double>> ordered;
  for (const LocalPlex& part : parts)
    for (std::size_t c = 0; c < part.cells.size(); ++c)
      ordered.push_back({turned(places.at(part.cells[c], 4)), part.largest[c]});
  std::sort(ordered.begin(), ordered.end());
  WholePlex whole;
  std::vector<Point> cells;
  for (const auto& [v, largest] : ordered) {
    cells.push_back(v);
    whole.largest.push_back(largest);
  }
  whole.mesh = build(places.points, cells);
  attach(values_of(parts, places, whole.labelling), cells, whole);
  return whole;
}

}  // namespace hfr::petsc
