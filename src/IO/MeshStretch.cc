// SPDX-License-Identifier: BSD-3-Clause
#include "IO/MeshStretch.hh"

#include <algorithm>
#include <limits>

#include "HalfFace/Errors.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

template <class Items>
ElementStretch whole(const Items& items, const std::vector<int>& labels) {
  return {items.size(), NumberRows(items), labels};
}

template <std::size_t N>
void add_boxes(LabelBoxes& boxes, const std::vector<Vec3>& points,
               const std::vector<std::array<Index, N>>& items, const std::vector<int>& labels) {
  std::array<Vec3, N> corners;
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t k = 0; k < N; ++k) corners[k] = points[items[i][k]];
    boxes.add(static_cast<int>(N) - 1, labels.empty() ? 0 : labels[i], corners);
  }
}

}  // namespace

/// Adding 0 makes 0 of -0: of two zeros the first one would count, and elements come in any order.
void LabelBoxes::add(int dimension, int label, std::span<const Vec3> corners) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  LabelBox& box = boxes_.try_emplace({dimension, label}, LabelBox{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}})
                      .first->second;
  for (const Vec3& p : corners)
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], p[k] + 0.0);
      box.high[k] = std::max(box.high[k], p[k] + 0.0);
    }
}

MeshStretch stretch_of(const MeshData& mesh) {
  MeshStretch stretch;
  stretch.processes.all_gather = [](std::span<const std::byte> mine) {
    return std::vector<std::byte>(mine.begin(), mine.end());
  };
  stretch.n_points = mesh.points.size();
  stretch.points = mesh.points;
  stretch.vertex_labels = mesh.vertex_labels;
  stretch.fixed = whole(mesh.fixed_vertices, {});
  stretch.edges = whole(mesh.edges, mesh.edge_labels);
  stretch.triangles = whole(mesh.triangles, mesh.triangle_labels);
  stretch.cells = whole(mesh.cells, mesh.regions);
  stretch.with_vertex_labels = !mesh.vertex_labels.empty();
  const auto has_any = [](const std::vector<int>& labels) {
    return std::ranges::any_of(labels, [](int label) { return label != 0; });
  };
  stretch.with_labels = !mesh.regions.empty() || has_any(mesh.triangle_labels) || has_any(mesh.edge_labels);
  stretch.names = &mesh.names;
  stretch.point_fields = mesh.point_fields;
  stretch.cell_fields = mesh.cell_fields;
  return stretch;
}

LabelBoxes boxes_of(const MeshData& mesh) {
  LabelBoxes boxes;
  for (std::size_t i = 0; i < mesh.vertex_labels.size(); ++i)
    if (mesh.vertex_labels[i] != 0) boxes.add(0, mesh.vertex_labels[i], {&mesh.points[i], 1});
  add_boxes(boxes, mesh.points, mesh.edges, mesh.edge_labels);
  add_boxes(boxes, mesh.points, mesh.triangles, mesh.triangle_labels);
  add_boxes(boxes, mesh.points, mesh.cells, mesh.regions);
  return boxes;
}

void require_stretches(const std::filesystem::path& path, const WriteOptions& options) {
  require_writable_format(path, options);
  const std::string extension = lower(path.extension().string());
  HFR_REQUIRE((extension == ".mesh" || extension == ".meshb" || extension == ".msh" || extension == ".vtu"),
              path.string() + ": not written by several processes; known are .mesh, .meshb, .msh and .vtu");
  HFR_REQUIRE((extension != ".vtu" || options.variant.empty() || options.variant == "appended"),
              path.string() + ": several processes write .vtu as raw appended data alone");
}

StretchedFile stretched_file(const std::filesystem::path& path, const MeshStretch& mesh,
                             const WriteOptions& options) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".vtu") return vtu_stretches(mesh);
  return extension == ".msh" ? gmsh_stretches(path, mesh, options)
                             : medit_stretches(path, mesh, extension == ".meshb");
}

bool wants_boxes(const std::filesystem::path& path, const WriteOptions& options) {
  return lower(path.extension().string()) == ".msh" && options.variant != "2.2";
}

std::vector<std::uint64_t> StretchLengths::finish() {
  flush();
  return std::move(lengths_);
}

void StretchLengths::next_stretch() {
  flush();
  lengths_.push_back(0);
}

}  // namespace hfr::io
