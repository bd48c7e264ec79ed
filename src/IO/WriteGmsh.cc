// SPDX-License-Identifier: BSD-3-Clause
// What all versions of the format share: header, names, fields.
#include "IO/WriteGmsh.hh"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/OutputFile.hh"

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

void require_32bit(const MeshStretch& mesh, const Layout& layout, const std::filesystem::path& path) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (mesh.n_points > kMost || layout.n_elements() > kMost) {
    throw ResourceLimit(path.string() +
                        ": Gmsh numbers nodes and elements with 32 bits here; write 4.1 without fields");
  }
}

/// The lines of the section.
std::vector<std::string> names_of(const MeshStretch& mesh, Notes& notes) {
  std::vector<std::string> lines;
  // Gmsh gives a name of label 0 the next free label: it must not take one whose name follows.
  for (const bool last : {false, true}) {
    for (const auto& [key, name] : *mesh.names) {
      if ((key.second == 0) != last) continue;
      lines.push_back(std::to_string(key.first) + " " + std::to_string(key.second) + " " +
                      quoted(name, notes));
    }
  }
  return lines;
}

void write_names(Sink& sink, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  sink.line("$PhysicalNames");
  sink.line(lines.size());
  for (const std::string& line : lines) sink.line(line);
  sink.line("$EndPhysicalNames");
}

void write_field(Sink& sink, const Field& field, bool on_points, std::size_t count, std::uint64_t first_tag,
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

/// What is written of the mesh, and how.
struct Plan {
  Layout layout;
  std::string variant;
  bool binary = false;
  std::vector<std::string> names;
  Notes notes;

  Plan(const std::filesystem::path& path, const MeshStretch& mesh, const WriteOptions& options,
       bool has_fields)
      : variant(options.variant.empty() ? "4.1" : options.variant), binary(options.binary) {
    HFR_REQUIRE(
        variant == "2.2" || variant == "4.0" || variant == "4.1",
        path.string() + ": Gmsh's format has no variant '" + variant + "'; known are 2.2, 4.0 and 4.1");
    lay_out(mesh, layout);
    if (variant != "4.1" || has_fields) require_32bit(mesh, layout, path);
    names = names_of(mesh, notes);
  }
};

void write_mesh(Sink& sink, const MeshStretch& mesh, const Plan& plan) {
  if (mesh.is_first()) {
    write_header(sink, plan.variant);
    write_names(sink, plan.names);
  }
  if (plan.variant == "2.2") {
    write_mesh2(sink, mesh, plan.layout);
  } else {
    write_mesh4(sink, mesh, plan.layout, plan.variant == "4.1");
  }
}

void note_losses(const MeshStretch& mesh, const Layout& layout, Notes& notes) {
  if (has_negative(layout)) notes.push_back("Gmsh takes a negative label for its positive one, reversed");
  if (mesh.fixed.total > 0) notes.push_back("Gmsh holds no fixed vertices: they are left out");
}

}  // namespace
}  // namespace gmsh

Notes write_gmsh(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options) {
  using namespace gmsh;
  MeshStretch stretch = stretch_of(mesh);
  if (options.variant != "2.2") stretch.boxes = boxes_of(mesh);
  const bool has_fields = !mesh.point_fields.empty() || !mesh.cell_fields.empty();
  const Plan plan(path, stretch, options, has_fields);
  Notes notes = plan.notes;
  OutputFile out(path);
  Sink sink(out, options.binary);
  gmsh::write_mesh(sink, stretch, plan);
  for (const Field& field : mesh.point_fields) write_field(sink, field, true, mesh.points.size(), 1, notes);
  for (const Field& field : mesh.cell_fields) {
    write_field(sink, field, false, mesh.cells.size(), plan.layout.dimensions[3].first_tag, notes);
  }
  out.commit();
  note_losses(stretch, plan.layout, notes);
  return notes;
}

StretchedFile gmsh_stretches(const std::filesystem::path& path, const MeshStretch& mesh,
                             const WriteOptions& options) {
  using namespace gmsh;
  const auto plan = std::make_shared<const Plan>(path, mesh, options, false);
  StretchedFile file;
  file.notes = plan->notes;
  note_losses(mesh, plan->layout, file.notes);
  file.write = [&mesh, plan](ByteSink& out) {
    Sink sink(out, plan->binary);
    gmsh::write_mesh(sink, mesh, *plan);
  };
  return file;
}

}  // namespace hfr::io
