// SPDX-License-Identifier: BSD-3-Clause
// What all versions of the format share: header, names, grouping of elements by label, fields.
#include "IO/WriteGmsh.hh"

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/GmshElements.hh"

namespace hfr::io {
namespace gmsh {
namespace {

/// What Gmsh accepts as a name: at most 127 bytes without quotes and line breaks. Longer names make it refuse
/// the file.
std::string quoted(const std::string& name, Notes& notes) {
  constexpr std::size_t kLongest = 127;
  std::string text = name;
  if (text.size() > kLongest) {
    std::size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
      --end;  // whole UTF-8 characters
    text.resize(end);
  }
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  if (text != name) {
    notes.push_back("Gmsh holds names of 127 bytes without quotes and line breaks: '" + text +
                    "' is written");
  }
  return '"' + text + '"';
}

/// One group a label, in the order of labels. Entities take their label as a tag where it is positive, and
/// the smallest free tag otherwise.
std::vector<Group> groups_of(const std::vector<int>& labels) {
  const std::set<int> distinct(labels.begin(), labels.end());
  std::vector<Group> groups;
  int free = 1;
  for (const int label : distinct) {
    while (label <= 0 && distinct.count(free) > 0) ++free;
    groups.push_back({label, label > 0 ? label : free++});
  }
  return groups;
}

/// `labels`: one an element.
Dimension dimension_of(const std::vector<int>& labels, int type, std::size_t first_tag) {
  Dimension elements{
      .groups = groups_of(labels), .runs = {}, .count = labels.size(), .first_tag = first_tag, .type = type};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (i == 0 || labels[i] != labels[i - 1]) {
      const auto group = std::partition_point(elements.groups.begin(), elements.groups.end(),
                                              [&](Group g) { return g.label < labels[i]; });
      elements.runs.push_back({static_cast<std::size_t>(group - elements.groups.begin()), i, i});
    }
    elements.runs.back().end = i + 1;
  }
  return elements;
}

Layout layout_of(const MeshData& mesh) {
  Layout layout;
  std::array<std::vector<int>, 4> labels = {{{}, mesh.edge_labels, mesh.triangle_labels, mesh.regions}};
  for (std::size_t i = 0; i < mesh.vertex_labels.size(); ++i) {
    if (mesh.vertex_labels[i] == 0) continue;
    labels[0].push_back(mesh.vertex_labels[i]);
    layout.labelled_points.push_back(static_cast<Index>(i));
  }
  labels[1].resize(mesh.edges.size(), 0);
  labels[2].resize(mesh.triangles.size(), 0);
  labels[3].resize(mesh.cells.size(), 0);
  constexpr std::array<int, 4> kTypes = {kPoint, kLine2, kTriangle3, kTetrahedron4};
  std::size_t tag = 1;
  for (std::size_t d = 0; d < 4; ++d) {
    layout.dimensions[d] = dimension_of(labels[d], kTypes[d], tag);
    tag += labels[d].size();
    for (const Group group : layout.dimensions[d].groups) layout.has_labels |= group.label != 0;
  }
  // Nodes need an entity to belong to.
  if (layout.n_elements() == 0) layout.dimensions[3].groups.emplace_back();
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
  // Gmsh gives a name of label 0 the next free label: it must not take one whose name follows.
  for (const bool last : {false, true}) {
    for (const auto& [key, name] : mesh.names) {
      if ((key.second == 0) != last) continue;
      sink.line(std::to_string(key.first) + " " + std::to_string(key.second) + " " + quoted(name, notes));
    }
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
  if (field.integer) notes.push_back("Gmsh has no integer fields: '" + field.name + "' is written as reals");
  if (components != 1 && components != 3 && components != 9) {
    notes.push_back("Gmsh draws fields of 1, 3 or 9 components: '" + field.name + "' keeps its " +
                    std::to_string(components));
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
  return std::any_of(layout.dimensions.begin(), layout.dimensions.end(), [](const Dimension& elements) {
    return !elements.groups.empty() && elements.groups.front().label < 0;
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
    write_field(sink, field, false, mesh.cells.size(), layout.dimensions[3].first_tag, notes);
  }
  out.commit();
  if (has_negative(layout)) notes.push_back("Gmsh takes a negative label for its positive one, reversed");
  if (!mesh.fixed_vertices.empty()) notes.push_back("Gmsh holds no fixed vertices: they are left out");
  return notes;
}

}  // namespace hfr::io
