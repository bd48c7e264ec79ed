// SPDX-License-Identifier: BSD-3-Clause
// Legacy .vtk, versions 4.2 (which everything reads) and 5.1. Labels go into SCALARS, which the simplest
// readers know, fields into FIELD arrays, which have any number of components.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/OutputFile.hh"
#include "IO/VtkGrid.hh"

namespace hfr::io {
namespace {

constexpr const char* kInt42 = " int";
/// Readers of binary 5.1 files disagree on the size of "int"; they agree on this one.
constexpr const char* kInt51 = " vtktypeint64";

/// Printable, without blanks; VTK writes all else as %XX.
std::string escaped(const std::string& name) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string result;
  for (const char c : name) {
    if (c > ' ' && c <= '~' && c != '%' && c != '"') {
      result += c;
    } else {
      const auto code = static_cast<unsigned char>(c);
      result += {'%', kHex[code >> 4], kHex[code & 15]};
    }
  }
  return result.empty() ? "unnamed" : result;
}

class LegacyWriter {
 public:
  LegacyWriter(const std::filesystem::path& path, const MeshData& mesh, bool binary, bool new_layout)
      : mesh_(mesh), out_(path), binary_(binary), new_layout_(new_layout) {}
  Notes write();

 private:
  /// One value: text with a separator, or big-endian bytes.
  template <class T>
  void put(T value, char separator);
  void put_integer(std::int64_t value, char separator);  ///< in as many bytes as the layout has
  template <class T>
  void put_corners(const std::vector<T>& items);
  void put_line(const std::string& line) { out_.text(line).text("\n"); }
  void end_block() {
    if (binary_) out_.text("\n");
  }

  void write_header();
  void write_points();
  void write_cells();
  void write_offsets();
  void write_cell_types();
  void write_labels(std::string_view name, const std::vector<std::int32_t>& labels);
  void write_fields(const std::vector<Field>& fields, std::size_t n_items);
  void write_field(const Field& field, std::size_t n_items);

  const MeshData& mesh_;
  OutputFile out_;
  bool binary_;
  bool new_layout_;
  Notes notes_ = notes_on_names(mesh_);
};

template <class T>
void LegacyWriter::put(T value, char separator) {
  if (binary_) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::little) std::reverse(bytes.begin(), bytes.end());
    out_.text({bytes.data(), bytes.size()});
    return;
  }
  if constexpr (std::is_floating_point_v<T>) {
    out_.number(value);
  } else {
    out_.number(static_cast<std::int64_t>(value));
  }
  out_.text({&separator, 1});
}

void LegacyWriter::put_integer(std::int64_t value, char separator) {
  if (new_layout_) {
    put(value, separator);
  } else {
    put(static_cast<std::int32_t>(value), separator);
  }
}

Notes LegacyWriter::write() {
  write_header();
  write_points();
  write_cells();
  write_cell_types();
  const std::vector<std::int32_t> regions = vtk_regions(mesh_);
  if (!regions.empty() || !mesh_.cell_fields.empty()) {
    put_line("CELL_DATA " + std::to_string(n_vtk_cells(mesh_)));
    write_labels(kVtkRegionArray, regions);
    write_fields(mesh_.cell_fields, n_vtk_cells(mesh_));
  }
  const std::vector<std::int32_t> fixed = vtk_fixed(mesh_);
  const std::vector<std::int32_t> labels = vtk_vertex_labels(mesh_);
  if (!labels.empty() || !fixed.empty() || !mesh_.point_fields.empty()) {
    put_line("POINT_DATA " + std::to_string(mesh_.points.size()));
    write_labels(kVtkLabelArray, labels);
    write_labels(kVtkFixedArray, fixed);
    write_fields(mesh_.point_fields, mesh_.points.size());
  }
  out_.commit();
  return std::move(notes_);
}

void LegacyWriter::write_header() {
  put_line(new_layout_ ? "# vtk DataFile Version 5.1" : "# vtk DataFile Version 4.2");
  put_line("written by hfremesh");
  put_line(binary_ ? "BINARY" : "ASCII");
  put_line("DATASET UNSTRUCTURED_GRID");
  const std::string names = names_text(mesh_);
  if (names.empty()) return;
  put_line("FIELD FieldData 1");
  put_line(std::string(kVtkNamesArray) + " 1 " + std::to_string(names.size()) +
           (new_layout_ ? kInt51 : kInt42));
  for (const char c : names) put_integer(static_cast<unsigned char>(c), c == '\n' ? '\n' : ' ');
  end_block();
}

void LegacyWriter::write_points() {
  put_line("POINTS " + std::to_string(mesh_.points.size()) + " double");
  for (const Vec3& p : mesh_.points) {
    put(p.x, ' ');
    put(p.y, ' ');
    put(p.z, '\n');
  }
  end_block();
}

template <class T>
void LegacyWriter::put_corners(const std::vector<T>& items) {
  for (const auto& item : items) {
    if (!new_layout_) put(static_cast<std::int32_t>(item.size()), ' ');
    for (std::size_t k = 0; k < item.size(); ++k) {
      put_integer(static_cast<std::int64_t>(item[k]), k + 1 == item.size() ? '\n' : ' ');
    }
  }
}

void LegacyWriter::write_cells() {
  const std::size_t n = n_vtk_cells(mesh_);
  const std::size_t n_corners = 4 * mesh_.cells.size() + 3 * mesh_.triangles.size() + 2 * mesh_.edges.size();
  if (new_layout_) {
    put_line("CELLS " + std::to_string(n + 1) + " " + std::to_string(n_corners));
    write_offsets();
    put_line("CONNECTIVITY vtktypeint64");
  } else {
    put_line("CELLS " + std::to_string(n) + " " + std::to_string(n + n_corners));
  }
  put_corners(mesh_.cells);
  put_corners(mesh_.triangles);
  put_corners(mesh_.edges);
  end_block();
}

void LegacyWriter::write_offsets() {
  put_line("OFFSETS vtktypeint64");
  std::int64_t offset = 0;
  put(offset, '\n');
  const auto put_ends = [&](std::size_t n_items, std::int64_t n_corners) {
    for (std::size_t i = 0; i < n_items; ++i) put(offset += n_corners, '\n');
  };
  put_ends(mesh_.cells.size(), 4);
  put_ends(mesh_.triangles.size(), 3);
  put_ends(mesh_.edges.size(), 2);
  end_block();
}

void LegacyWriter::write_cell_types() {
  put_line("CELL_TYPES " + std::to_string(n_vtk_cells(mesh_)));
  const auto put_types = [&](std::size_t n_items, std::int32_t type) {
    for (std::size_t i = 0; i < n_items; ++i) put(type, '\n');
  };
  put_types(mesh_.cells.size(), kVtkTetra);
  put_types(mesh_.triangles.size(), kVtkTriangle);
  put_types(mesh_.edges.size(), kVtkLine);
  end_block();
}

void LegacyWriter::write_labels(std::string_view name, const std::vector<std::int32_t>& labels) {
  if (labels.empty()) return;
  put_line("SCALARS " + std::string(name) + (new_layout_ ? kInt51 : kInt42) + " 1");
  put_line("LOOKUP_TABLE default");
  for (const std::int32_t label : labels) put_integer(label, '\n');
  end_block();
}

void LegacyWriter::write_fields(const std::vector<Field>& fields, std::size_t n_items) {
  if (fields.empty()) return;
  put_line("FIELD FieldData " + std::to_string(fields.size()));
  for (const Field& field : fields) write_field(field, n_items);
}

/// Cells behind the tetrahedra, for which the mesh has no values, get zeros: readers of text do not agree on
/// how to spell NaN.
void LegacyWriter::write_field(const Field& field, std::size_t n_items) {
  const IntegerWidth width = integer_width(field);
  const bool as_int64 = width != IntegerWidth::kNone && new_layout_;
  const bool as_int32 = width == IntegerWidth::k32 && !new_layout_;
  if (field.integer && !as_int64 && !as_int32)
    notes_.push_back("field '" + field.name + "': integers of more than 32 bits are written as real numbers");
  const char* const type = as_int64 ? kInt51 : as_int32 ? kInt42 : " double";
  const auto components = static_cast<std::size_t>(field.components);
  put_line(escaped(field.name) + " " + std::to_string(components) + " " + std::to_string(n_items) + " " +
           type);
  for (std::size_t i = 0; i < n_items * components; ++i) {
    const double value = i < field.values.size() ? field.values[i] : 0.0;
    const char separator = (i + 1) % components == 0 ? '\n' : ' ';
    if (as_int64 || as_int32) {
      put_integer(static_cast<std::int64_t>(value), separator);
    } else {
      put(value, separator);
    }
  }
  end_block();
}

}  // namespace

Notes write_vtk(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options) {
  HFR_REQUIRE(options.variant.empty() || options.variant == "4.2" || options.variant == "5.1",
              path.string() + ": unknown variant '" + options.variant + "' of .vtk; known are 4.2 5.1");
  const bool new_layout = options.variant == "5.1";
  constexpr std::size_t kMostPoints = std::numeric_limits<std::int32_t>::max();
  HFR_REQUIRE(new_layout || mesh.points.size() <= kMostPoints,
              path.string() + ": version 4.2 of .vtk holds at most 2147483647 points; write variant 5.1");
  return LegacyWriter(path, mesh, options.binary, new_layout).write();
}

}  // namespace hfr::io
