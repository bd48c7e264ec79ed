// SPDX-License-Identifier: BSD-3-Clause
#include "IO/Linearise.hh"

#include <algorithm>
#include <cstddef>

namespace hfr::io {
namespace {

template <class T>
void keep_marked(std::vector<T>& values, std::size_t per_point, const std::vector<char>& keep) {
  if (values.size() != keep.size() * per_point) return;  // empty, or for validate() to name
  std::size_t last = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (keep[i / per_point]) values[last++] = values[i];
  }
  values.resize(last);
}

}  // namespace

void drop_midside_points(MeshData& mesh, const std::vector<Index>& midside) {
  if (midside.empty()) return;
  const std::size_t n_points = mesh.points.size();
  std::vector<char> keep(n_points, 1);
  for (const Index i : midside) {
    if (i < n_points) keep[i] = 0;
  }
  const auto keep_corners = [&](const auto& elements) {
    for (const auto& element : elements) {
      for (const Index i : element) {
        if (i < n_points) keep[i] = 1;
      }
    }
  };
  keep_corners(mesh.cells);
  keep_corners(mesh.triangles);
  keep_corners(mesh.edges);

  std::vector<Index> new_number(n_points, 0);
  Index n_kept = 0;
  for (std::size_t i = 0; i < n_points; ++i) {
    new_number[i] = n_kept;
    if (keep[i]) ++n_kept;
  }
  // A corner out of range stays so: validate() names it.
  const auto renumber = [&](auto& elements) {
    for (auto& element : elements) {
      for (Index& i : element) {
        if (i < n_points) i = new_number[i];
      }
    }
  };
  renumber(mesh.cells);
  renumber(mesh.triangles);
  renumber(mesh.edges);
  std::erase_if(mesh.fixed_vertices, [&](Index i) { return i < n_points && !keep[i]; });
  for (Index& i : mesh.fixed_vertices) {
    if (i < n_points) i = new_number[i];
  }

  keep_marked(mesh.vertex_labels, 1, keep);
  if (std::ranges::all_of(mesh.vertex_labels, [](int label) { return label == 0; }))
    mesh.vertex_labels.clear();
  for (Field& field : mesh.point_fields) {
    keep_marked(field.values, static_cast<std::size_t>(std::max(field.components, 1)), keep);
  }
  keep_marked(mesh.points, 1, keep);
}

}  // namespace hfr::io
