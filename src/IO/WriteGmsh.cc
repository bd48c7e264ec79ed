// SPDX-License-Identifier: BSD-3-Clause
// What all versions of the format share: header, names, grouping of elements by label, fields.
#include "IO/WriteGmsh.hh"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"

namespace hfr::io {
namespace gmsh {
namespace {

/// What Gmsh accepts in a "…": no quotes, no line breaks.
std::string quoted(const std::string& name, Notes& notes) {
  std::string text = name;
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  if (text != name)
    notes.push_back("Gmsh holds no quotes or line breaks in names: '" + text + "' is written");
  return '"' + text + '"';
}

/// One group a label, in the order of labels. Entities take their label as a tag where it is positive, and
/// the smallest free tag otherwise.
std::vector<Group> grouped(std::size_t count, const std::vector<int>& labels, bool skip_unlabelled) {
  std::map<int, std::size_t> group_of;
  for (const int label : labels) {
    if (label != 0 || !skip_unlabelled) group_of.emplace(label, 0);
  }
  if (labels.empty() && count > 0 && !skip_unlabelled) group_of.emplace(0, 0);
  std::vector<Group> groups;
  int free = 1;
  for (auto& [label, position] : group_of) {
    position = groups.size();
    while (label <= 0 && group_of.count(free) > 0) ++free;
    groups.push_back({.label = label, .entity = label > 0 ? label : free++});
  }
  for (std::size_t i = 0; i < count; ++i) {
    const int label = labels.empty() ? 0 : labels[i];
    if (label == 0 && skip_unlabelled) continue;
    groups[group_of.find(label)->second].items.push_back(static_cast<Index>(i));
  }
  return groups;
}

Layout layout_of(const MeshData& mesh) {
  Layout layout;
  layout.groups[0] = grouped(mesh.vertex_labels.size(), mesh.vertex_labels, /*skip_unlabelled=*/true);
  layout.groups[1] = grouped(mesh.edges.size(), mesh.edge_labels, false);
  layout.groups[2] = grouped(mesh.triangles.size(), mesh.triangle_labels, false);
  layout.groups[3] = grouped(mesh.cells.size(), mesh.regions, false);
  std::size_t tag = 1;
  for (std::size_t d = 0; d < 4; ++d) {
    for (const Group& group : layout.groups[d]) layout.counts[d] += group.items.size();
    layout.first_tag[d] = tag;
    tag += layout.counts[d];
  }
  // Nodes need an entity to belong to.
  if (layout.n_elements() == 0) layout.groups[3].emplace_back();
  return layout;
}

void require_32bit(const MeshData& mesh, const Layout& layout, const std::filesystem::path& path) {
  constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  if (mesh.points.size() > kMost || layout.n_elements() > kMost) {
    throw ResourceLimit(path.string() +
                        ": Gmsh numbers nodes and elements with 32 bits here; write 4.1 without fields");
  }
}

void write_names(Sink& sink, const MeshData& mesh, Notes& notes) {
  if (mesh.names.empty()) return;
  sink.line("$PhysicalNames");
  sink.line(mesh.names.size());
  for (const auto& [key, name] : mesh.names) {
    sink.line(std::to_string(key.first) + " " + std::to_string(key.second) + " " + quoted(name, notes));
  }
  sink.line("$EndPhysicalNames");
}

void write_field(Sink& sink, const Field& field, bool on_points, std::size_t count, std::size_t first_tag,
                 Notes& notes) {
  const auto components = static_cast<std::size_t>(field.components);
  constexpr std::size_t kMostComponents = 9;
  if (components < 1 || components > kMostComponents) {
    notes.push_back("Gmsh holds fields of 1 to 9 components: '" + field.name + "' is left out");
    return;
  }
  sink.line(on_points ? "$NodeData" : "$ElementData");
  sink.line("1");
  sink.line(quoted(field.name, notes));
  sink.line("1\n0\n3\n0");  // one real tag, time 0; three integer tags, the first being time step 0
  sink.line(components);
  sink.line(count);
  for (std::size_t i = 0; i < count; ++i) {
    sink.int32(static_cast<std::int64_t>(first_tag + i));
    for (std::size_t c = 0; c < components; ++c) sink.real(field.values[i * components + c]);
    sink.end_line();
  }
  sink.end_data();
  sink.line(on_points ? "$EndNodeData" : "$EndElementData");
}

void write_header(Sink& sink, const std::string& variant) {
  sink.line("$MeshFormat");
  sink.line(variant + (sink.binary() ? " 1 8" : " 0 8"));
  if (sink.binary()) sink.int32(1);  // tells the byte order
  sink.end_data();
  sink.line("$EndMeshFormat");
}

bool has_negative(const Layout& layout) {
  return std::any_of(layout.groups.begin(), layout.groups.end(), [](const std::vector<Group>& groups) {
    return !groups.empty() && groups.front().label < 0;
  });
}

}  // namespace
}  // namespace gmsh

Notes write_gmsh(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options) {
  using namespace gmsh;
  const std::string variant = options.variant.empty() ? "4.1" : options.variant;
  HFR_REQUIRE(variant == "2.2" || variant == "4.0" || variant == "4.1",
              path.string() + ": Gmsh's format has no variant '" + variant + "'; known are 2.2, 4.0 and 4.1");
  const Layout layout = layout_of(mesh);
  const bool has_fields = !mesh.point_fields.empty() || !mesh.cell_fields.empty();
  if (variant != "4.1" || has_fields) require_32bit(mesh, layout, path);

  Notes notes;
  OutputFile out(path);
  Sink sink(out, options.binary);
  write_header(sink, variant);
  write_names(sink, mesh, notes);
  if (variant == "2.2") {
    write_mesh2(sink, mesh, layout);
  } else {
    write_mesh4(sink, mesh, layout, variant == "4.1");
  }
  for (const Field& field : mesh.point_fields) write_field(sink, field, true, mesh.points.size(), 1, notes);
  for (const Field& field : mesh.cell_fields) {
    write_field(sink, field, false, mesh.cells.size(), layout.first_tag[3], notes);
  }
  out.commit();
  if (has_negative(layout)) notes.push_back("Gmsh takes a negative label for its positive one, reversed");
  if (!mesh.fixed_vertices.empty()) notes.push_back("Gmsh holds no fixed vertices: they are left out");
  return notes;
}

}  // namespace hfr::io
