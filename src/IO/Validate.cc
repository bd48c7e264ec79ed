// SPDX-License-Identifier: BSD-3-Clause
#include "IO/Validate.hh"

#include <cmath>
#include <limits>
#include <string_view>

#include "HalfFace/Errors.hh"

namespace hfr::io {
namespace {

/// The message is built only when something is wrong: this runs over every cell of every mesh.
template <class Items>
void check_corners(const Items& items, std::size_t n_points, std::string_view kind, const std::string& name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (const Index corner : items[i]) {
      if (corner < n_points) continue;
      throw InvalidInput(name + ": " + std::string(kind) + " " + std::to_string(i) + ": vertex " +
                         std::to_string(corner) + " is out of range (the file has " +
                         std::to_string(n_points) + " points)");
    }
  }
}

void check_length(std::size_t length, std::size_t expected, const std::string& what,
                  const std::string& name) {
  if (length == expected) return;
  throw InvalidInput(name + ": " + what + ": " + std::to_string(length) + " entries where " +
                     std::to_string(expected) + " are needed");
}

void check_labels(const std::vector<int>& labels, std::size_t expected, const std::string& what,
                  const std::string& name) {
  if (!labels.empty()) check_length(labels.size(), expected, what, name);
}

void check_fields(const std::vector<Field>& fields, std::size_t n_items, const std::string& kind,
                  const std::string& name) {
  for (const Field& field : fields) {
    const std::string what = kind + " field '" + field.name + "'";
    if (field.components < 1) throw InvalidInput(name + ": " + what + ": has no components");
    check_length(field.values.size(), n_items * static_cast<std::size_t>(field.components), what, name);
  }
}

}  // namespace

bool is_label(double number) {
  return number >= std::numeric_limits<int>::min() && number <= std::numeric_limits<int>::max() &&
         number == std::trunc(number);
}

void validate(const MeshData& mesh, const std::string& name) {
  const std::size_t n_points = mesh.points.size();
  if (n_points >= VertexHandle::kInvalid) {
    throw ResourceLimit(name + ": " + std::to_string(n_points) +
                        " points are more than this build can index; build with HFR_INDEX64");
  }
  for (std::size_t i = 0; i < n_points; ++i) {
    const Vec3& p = mesh.points[i];
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
    throw InvalidInput(name + ": point " + std::to_string(i) + ": a coordinate is not finite");
  }
  check_corners(mesh.cells, n_points, "cell", name);
  check_corners(mesh.triangles, n_points, "triangle", name);
  check_corners(mesh.edges, n_points, "edge", name);
  for (const Index vertex : mesh.fixed_vertices) {
    if (vertex < n_points) continue;
    throw InvalidInput(name + ": fixed vertex " + std::to_string(vertex) + " is out of range (the file has " +
                       std::to_string(n_points) + " points)");
  }
  check_labels(mesh.regions, mesh.cells.size(), "regions", name);
  check_labels(mesh.triangle_labels, mesh.triangles.size(), "triangle labels", name);
  check_labels(mesh.edge_labels, mesh.edges.size(), "edge labels", name);
  check_labels(mesh.vertex_labels, n_points, "vertex labels", name);
  if (!mesh.triangle_numbers.empty())
    check_length(mesh.triangle_numbers.size(), mesh.triangles.size(), "numbers of triangles", name);
  if (!mesh.edge_numbers.empty())
    check_length(mesh.edge_numbers.size(), mesh.edges.size(), "numbers of edges", name);
  check_fields(mesh.point_fields, n_points, "point", name);
  check_fields(mesh.cell_fields, mesh.cells.size(), "cell", name);
}

}  // namespace hfr::io
