// SPDX-License-Identifier: BSD-3-Clause
#include "Labels.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "ExitCode.hh"
#include "Report.hh"

namespace hfr::app {
namespace {

/// On the boundary or between two regions.
bool is_surface(const TetMesh& mesh, HalfFaceHandle h) {
  return mesh.is_boundary(h) || mesh.region(cell_of(h)) != mesh.region(cell_of(mesh.opposite_halfface(h)));
}

/// Calls use(half-face) once for each face.
template <class Use>
void for_each_face(const TetMesh& mesh, Use&& use) {
  for (CellHandle c : mesh.cells())
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      if (mesh.is_boundary(h) || h < mesh.opposite_halfface(h)) use(h);
    }
}

/// Which labelled faces, edges and vertices lie on a face of the surface.
struct OnSurface {
  std::vector<std::uint8_t> faces, edges, vertices;

  explicit OnSurface(const TetMesh& mesh)
      : faces(mesh.labels().faces.size() + 1),
        edges(mesh.labels().edges.size() + 1),
        vertices(mesh.n_vertices()) {
    for_each_face(mesh, [&](HalfFaceHandle h) {
      if (!is_surface(mesh, h)) return;
      const auto v = mesh.halfface_vertices(h);
      faces[mesh.labels().faces.position(v)] = 1;  // the place beyond the last is for those without a label
      for (std::size_t i = 0; i < 3; ++i) {
        edges[mesh.labels().edges.position({v[i], v[(i + 1) % 3]})] = 1;
        vertices[v[i].idx()] = 1;
      }
    });
  }
};

/// Drops the entries that are not kept; returns their number.
template <std::size_t N>
std::size_t keep_only(TupleMap<N, int>& map, const std::vector<std::uint8_t>& kept) {
  const std::size_t before = map.size();
  std::size_t at = 0;
  map.rename_vertices([](VertexHandle v) { return v; }, [&](const auto&) { return kept[at++] != 0; });
  return before - map.size();
}

std::size_t n_labelled(const std::vector<int>& labels) {
  return labels.size() - static_cast<std::size_t>(std::count(labels.begin(), labels.end(), 0));
}

std::vector<std::string> dropped(std::size_t triangles, std::size_t edges, std::size_t vertices) {
  if (triangles + edges + vertices == 0) return {};
  return {fmt::format("labels left out (--ignore-labels): of {} triangles, {} edges and {} vertices",
                      grouped(triangles), grouped(edges), grouped(vertices))};
}

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw Failure(ExitCode::kUsage, "--fix " + what + ": " + why);
}

void require_vertex(const std::string& what, VertexHandle v, std::size_t n_vertices) {
  if (v.idx() >= n_vertices)
    refuse(what, fmt::format("there are {} vertices, counted from 0", grouped(n_vertices)));
}

template <std::size_t N>
std::string name_of(const char* kind, const std::array<VertexHandle, N>& vertices) {
  std::string text = kind;
  for (std::size_t i = 0; i < N; ++i) text += (i == 0 ? ":" : "-") + std::to_string(vertices[i].idx());
  return text;
}

/// has_edge and has_face are asked only about vertices that are there; `labels` are those of triangles.
template <class HasEdge, class HasFace>
void require_fixed(const SurfaceOptions& options, std::size_t n_vertices, const std::set<int>& labels,
                   HasEdge&& has_edge, HasFace&& has_face) {
  for (VertexHandle v : options.fixed_vertices) require_vertex(name_of<1>("vertex", {v}), v, n_vertices);
  for (const auto& edge : options.fixed_edges) {
    const std::string what = name_of("edge", edge);
    for (VertexHandle v : edge) require_vertex(what, v, n_vertices);
    if (!has_edge(edge)) refuse(what, "there is no such edge");
  }
  for (const auto& face : options.fixed_faces) {
    const std::string what = name_of("face", face);
    for (VertexHandle v : face) require_vertex(what, v, n_vertices);
    if (!has_face(face)) refuse(what, "there is no such face");
  }
  for (int patch : options.fixed_patches)
    if (!labels.contains(patch)) refuse(fmt::format("patch:{}", patch), "no triangle has this label");
}

}  // namespace

std::vector<std::string> notes_on_inner_triangles(const TetMesh& mesh) {
  const auto& faces = mesh.labels().faces;
  const auto is_zero = [](const auto& entry) { return entry.value == 0; };
  if (std::none_of(faces.entries().begin(), faces.entries().end(), is_zero)) return {};
  std::size_t n = 0;
  for_each_face(mesh, [&](HalfFaceHandle h) {
    if (is_surface(mesh, h)) return;
    const int* const label = faces.find(mesh.halfface_vertices(h));
    if (label && *label == 0) ++n;
  });
  if (n == 0) return {};
  return {
      fmt::format("{} triangles of label 0 lie inside and are kept as they are; --ignore-labels goes "
                  "without them",
                  grouped(n))};
}

std::vector<std::string> drop_labels(io::MeshData& data) {
  const bool is_surface_mesh = data.cells.empty();
  const std::size_t n_triangles = is_surface_mesh ? n_labelled(data.triangle_labels) : data.triangles.size();
  auto notes = dropped(n_triangles, data.edges.size(), n_labelled(data.vertex_labels));
  if (!is_surface_mesh) data.triangles.clear();
  data.triangle_labels.clear();
  data.edges.clear();
  data.edge_labels.clear();
  data.vertex_labels.clear();
  return notes;
}

std::vector<std::string> drop_inner_labels(TetMesh& mesh) {
  Labels& labels = mesh.labels();
  if (labels.faces.empty() && labels.edges.empty() && labels.vertices.empty()) return {};
  const OnSurface on_surface(mesh);
  const std::size_t n_faces = keep_only(labels.faces, on_surface.faces);
  const std::size_t n_edges = keep_only(labels.edges, on_surface.edges);
  const std::size_t n_before = n_labelled(labels.vertices);
  for (std::size_t v = 0; v < labels.vertices.size(); ++v)
    if (on_surface.vertices[v] == 0) labels.vertices[v] = 0;
  const std::size_t n_left = n_labelled(labels.vertices);
  if (n_left == 0) labels.vertices.clear();
  return dropped(n_faces, n_edges, n_before - n_left);
}

void require_fixed(const SurfaceOptions& options, const TetMesh& mesh) {
  std::set<int> labels;
  if (!options.fixed_patches.empty())
    for (const auto& entry : mesh.labels().faces.entries()) labels.insert(entry.value);
  // The quick look misses what a walk round a pinched vertex does not see.
  const auto has_cell = [&](const auto& vertices) {
    return std::ranges::any_of(mesh.cells(), [&](CellHandle c) {
      return std::ranges::all_of(vertices, [&](VertexHandle v) { return mesh.cell(c).has(v); });
    });
  };
  require_fixed(
      options, mesh.n_vertices(), labels,
      [&](const auto& edge) { return mesh.find_edge(edge[0], edge[1]).is_valid() || has_cell(edge); },
      [&](const auto& face) { return mesh.find_halfface(face).is_valid() || has_cell(face); });
}

void require_fixed(const SurfaceOptions& options, const io::MeshData& surface) {
  const auto all_in = [](const auto& vertices, const std::array<Index, 3>& triangle) {
    return std::all_of(vertices.begin(), vertices.end(), [&](VertexHandle v) {
      return std::find(triangle.begin(), triangle.end(), v.idx()) != triangle.end();
    });
  };
  const auto has = [&](const auto& vertices) {
    return std::any_of(surface.triangles.begin(), surface.triangles.end(),
                       [&](const auto& triangle) { return all_in(vertices, triangle); });
  };
  require_fixed(options, surface.points.size(),
                std::set<int>(surface.triangle_labels.begin(), surface.triangle_labels.end()), has, has);
}

}  // namespace hfr::app
