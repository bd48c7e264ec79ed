// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <system_error>

#include "IO/Formats.hh"
#include "IO/OutputFile.hh"

namespace hfr::io {
namespace {

/// A number and a space before it.
void put(OutputFile& out, std::int64_t value) { out.text(" ").number(value); }
void put(OutputFile& out, double value) { out.text(" ").number(value); }

/// Without items there are no attributes either: a reader takes their number for more than the file can hold.
std::int64_t width_of(const std::vector<Field>& fields, std::size_t n_items) {
  std::int64_t width = 0;
  if (n_items == 0) return width;
  for (const Field& field : fields) width += field.components;
  return width;
}

void put_values(OutputFile& out, const std::vector<Field>& fields, std::size_t item) {
  for (const Field& field : fields) {
    const auto n = static_cast<std::size_t>(field.components);
    for (std::size_t k = 0; k < n; ++k) put(out, field.values[item * n + k]);
  }
}

void write_nodes(OutputFile& out, const MeshData& mesh) {
  const bool has_labels = !mesh.vertex_labels.empty();
  out.number(static_cast<std::int64_t>(mesh.points.size())).text(" 3");
  put(out, width_of(mesh.point_fields, mesh.points.size()));
  out.text(has_labels ? " 1\n" : " 0\n");
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    out.number(static_cast<std::int64_t>(i + 1));
    const Vec3& p = mesh.points[i];
    put(out, p.x);
    put(out, p.y);
    put(out, p.z);
    put_values(out, mesh.point_fields, i);
    if (has_labels) put(out, std::int64_t{mesh.vertex_labels[i]});
    out.text("\n");
  }
}

void write_cells(OutputFile& out, const MeshData& mesh) {
  // The first attribute is the region: it must be there when others follow.
  const bool has_regions = !mesh.cells.empty() && (!mesh.regions.empty() || !mesh.cell_fields.empty());
  out.number(static_cast<std::int64_t>(mesh.cells.size())).text(" 4");
  put(out, width_of(mesh.cell_fields, mesh.cells.size()) + (has_regions ? 1 : 0));
  out.text("\n");
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    out.number(static_cast<std::int64_t>(i + 1));
    for (const Index corner : mesh.cells[i]) put(out, static_cast<std::int64_t>(corner) + 1);
    if (has_regions) put(out, std::int64_t{mesh.regions.empty() ? 0 : mesh.regions[i]});
    put_values(out, mesh.cell_fields, i);
    out.text("\n");
  }
}

template <class Elements>
void write_elements(OutputFile& out, const Elements& elements, const std::vector<int>& labels) {
  out.number(static_cast<std::int64_t>(elements.size())).text(" 1\n");
  for (std::size_t i = 0; i < elements.size(); ++i) {
    out.number(static_cast<std::int64_t>(i + 1));
    for (const Index corner : elements[i]) put(out, static_cast<std::int64_t>(corner) + 1);
    put(out, std::int64_t{labels.empty() ? 0 : labels[i]});
    out.text("\n");
  }
}

Notes losses(const MeshData& mesh) {
  Notes notes;
  if (!mesh.names.empty()) {
    notes.push_back("TetGen files hold no names: " + std::to_string(mesh.names.size()) +
                    " names of regions and patches are left out");
  }
  if (!mesh.fixed_vertices.empty()) {
    notes.push_back("TetGen files hold no fixed vertices: " + std::to_string(mesh.fixed_vertices.size()) +
                    " are left out");
  }
  std::string fields;
  for (const auto* list : {&mesh.point_fields, &mesh.cell_fields}) {
    for (const Field& field : *list) fields += (fields.empty() ? "'" : ", '") + field.name + "'";
  }
  if (!fields.empty()) {
    notes.push_back("fields become attributes, one a component, without their names: " + fields);
  }
  return notes;
}

}  // namespace

Notes write_tetgen(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& /*options*/) {
  const auto part = [&](const char* extension) { return file_beside(path, extension); };
  OutputFile nodes(part(".node"));
  write_nodes(nodes, mesh);
  OutputFile cells(part(".ele"));
  write_cells(cells, mesh);
  // Faces and edges of a mesh that stood here before would be read with this one: an empty list replaces
  // them.
  std::unique_ptr<OutputFile> faces;
  std::unique_ptr<OutputFile> edges;
  std::error_code ignored;
  const bool asked_for_faces = path == part(".face");
  if (!mesh.triangles.empty() || asked_for_faces || std::filesystem::exists(part(".face"), ignored)) {
    faces = std::make_unique<OutputFile>(part(".face"));
    write_elements(*faces, mesh.triangles, mesh.triangle_labels);
  }
  if (!mesh.edges.empty() || std::filesystem::exists(part(".edge"), ignored)) {
    edges = std::make_unique<OutputFile>(part(".edge"));
    write_elements(*edges, mesh.edges, mesh.edge_labels);
  }
  commit_together({&nodes, &cells, faces.get(), edges.get()});
  return losses(mesh);
}

}  // namespace hfr::io
