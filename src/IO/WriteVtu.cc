// SPDX-License-Identifier: BSD-3-Clause
// VTK XML unstructured grids. The default is raw appended data: arrays are copied to the file as they lie in
// memory. Header words have 64 bits, so arrays may be of any size.
#include <algorithm>
#include <bit>
#include <deque>
#include <limits>
#include <span>
#include <type_traits>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/OutputFile.hh"
#include "IO/VtkGrid.hh"
#include "IO/VtuData.hh"

namespace hfr::io {
namespace {

enum class Variant { kAscii, kBase64, kAppended, kZlib };

/// write_mesh() has refused other names.
Variant variant_of(const std::string& name) {
  if (name == "ascii") return Variant::kAscii;
  if (name == "base64") return Variant::kBase64;
  return name == "zlib" ? Variant::kZlib : Variant::kAppended;
}

template <class T>
constexpr NumberType number_type() {
  if constexpr (std::is_same_v<T, double>) return NumberType::kFloat64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return NumberType::kUInt8;
  return sizeof(T) == 4 ? NumberType::kInt32 : NumberType::kInt64;
}

constexpr const char* type_name(NumberType type) {
  switch (type) {
    case NumberType::kUInt8:
      return "UInt8";
    case NumberType::kInt32:
      return "Int32";
    case NumberType::kInt64:
      return "Int64";
    default:
      return "Float64";
  }
}

/// An array in pieces, each in memory that outlives it.
struct OutArray {
  std::string name;
  NumberType type = NumberType::kFloat64;
  std::size_t components = 1;
  bool in_field_data = false;
  std::vector<std::string_view> pieces;

  std::size_t n_bytes() const {
    std::size_t n = 0;
    for (const std::string_view piece : pieces) n += piece.size();
    return n;
  }
};

template <class T>
std::string_view bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

class VtuWriter {
 public:
  VtuWriter(const std::filesystem::path& path, const MeshData& mesh, Variant variant)
      : mesh_(mesh), out_(path), variant_(variant) {}
  Notes write();

 private:
  /// Keeps `values` until the end.
  template <class T>
  std::string_view own(const std::vector<T>& values);
  template <class T>
  OutArray array(std::string name, std::size_t components, std::string_view bytes);
  OutArray corners();
  template <class T>
  OutArray offsets();
  OutArray types();
  OutArray field_array(const Field& field, std::size_t n_items);
  std::vector<OutArray> point_arrays();
  std::vector<OutArray> cell_arrays();

  void put(const OutArray& array);
  void put_section(const char* tag, const std::vector<OutArray>& arrays);
  void put_text(const OutArray& array);
  void put_appended();

  const MeshData& mesh_;
  OutputFile out_;
  Variant variant_;
  std::deque<std::string> owned_;
  std::vector<OutArray> appended_;  // raw: what follows the XML; zlib: one piece each, header included
  std::uint64_t offset_ = 0;
};

template <class T>
std::string_view VtuWriter::own(const std::vector<T>& values) {
  owned_.emplace_back(bytes_of(std::span<const T>(values)));
  return owned_.back();
}

template <class T>
OutArray VtuWriter::array(std::string name, std::size_t components, std::string_view bytes) {
  return {std::move(name), number_type<T>(), components, false, {bytes}};
}

OutArray VtuWriter::corners() {
  // A 32-bit Index below 2^31 has the bits of an Int32, a 64-bit one those of an Int64.
  using Signed = std::make_signed_t<Index>;
  const bool as_it_is =
      sizeof(Index) == 8 || mesh_.points.size() <= std::size_t{std::numeric_limits<std::int32_t>::max()};
  const auto add = [&](OutArray& to, const auto& items) {
    if (items.empty()) return;
    const std::span<const Index> flat(items[0].data(), items.size() * items[0].size());
    to.pieces.push_back(as_it_is ? bytes_of(flat) : own(std::vector<std::int64_t>(flat.begin(), flat.end())));
  };
  OutArray result =
      as_it_is ? array<Signed>("connectivity", 1, {}) : array<std::int64_t>("connectivity", 1, {});
  add(result, mesh_.cells);
  add(result, mesh_.triangles);
  add(result, mesh_.edges);
  return result;
}

template <class T>
OutArray VtuWriter::offsets() {
  std::vector<T> ends;
  ends.reserve(n_vtk_cells(mesh_));
  T end = 0;
  for (std::size_t i = 0; i < mesh_.cells.size(); ++i) ends.push_back(end += 4);
  for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) ends.push_back(end += 3);
  for (std::size_t i = 0; i < mesh_.edges.size(); ++i) ends.push_back(end += 2);
  return array<T>("offsets", 1, own(ends));
}

OutArray VtuWriter::types() {
  std::vector<std::uint8_t> types(mesh_.cells.size(), kVtkTetra);
  types.resize(types.size() + mesh_.triangles.size(), kVtkTriangle);
  types.resize(types.size() + mesh_.edges.size(), kVtkLine);
  return array<std::uint8_t>("types", 1, own(types));
}

/// Cells behind the tetrahedra, for which the mesh has no values, get zeros: readers of text do not agree on
/// how to spell NaN.
OutArray VtuWriter::field_array(const Field& field, std::size_t n_items) {
  const auto components = static_cast<std::size_t>(field.components);
  const auto add_zeros = [&](OutArray result, std::size_t size) {
    const std::size_t n_missing = n_items * components - field.values.size();
    if (n_missing > 0) result.pieces.push_back(own(std::vector<char>(n_missing * size)));
    return result;
  };
  const auto& values = field.values;
  switch (integer_width(field)) {
    case IntegerWidth::k32:
      return add_zeros(array<std::int32_t>(field.name, components,
                                           own(std::vector<std::int32_t>(values.begin(), values.end()))),
                       4);
    case IntegerWidth::k64:
      return add_zeros(array<std::int64_t>(field.name, components,
                                           own(std::vector<std::int64_t>(values.begin(), values.end()))),
                       8);
    default:
      return add_zeros(array<double>(field.name, components, bytes_of(std::span<const double>(values))), 8);
  }
}

std::vector<OutArray> VtuWriter::point_arrays() {
  std::vector<OutArray> arrays;
  if (const auto labels = vtk_vertex_labels(mesh_); !labels.empty())
    arrays.push_back(array<std::int32_t>(std::string(kVtkLabelArray), 1, own(labels)));
  if (const auto fixed = vtk_fixed(mesh_); !fixed.empty())
    arrays.push_back(array<std::int32_t>(std::string(kVtkFixedArray), 1, own(fixed)));
  for (const Field& field : mesh_.point_fields) arrays.push_back(field_array(field, mesh_.points.size()));
  return arrays;
}

std::vector<OutArray> VtuWriter::cell_arrays() {
  std::vector<OutArray> arrays;
  if (const auto regions = vtk_regions(mesh_); !regions.empty())
    arrays.push_back(array<std::int32_t>(std::string(kVtkRegionArray), 1, own(regions)));
  for (const Field& field : mesh_.cell_fields) {
    const bool is_number =
        field.name == kVtkNumberArray && field.components == 1 && field.values.size() == mesh_.cells.size();
    if (!is_number || (mesh_.triangle_numbers.empty() && mesh_.edge_numbers.empty())) {
      arrays.push_back(field_array(field, n_vtk_cells(mesh_)));
      continue;
    }
    Field longer = field;
    for (const auto* numbers : {&mesh_.triangle_numbers, &mesh_.edge_numbers})
      longer.values.insert(longer.values.end(), numbers->begin(), numbers->end());
    arrays.push_back(array<double>(field.name, 1, own(longer.values)));
  }
  return arrays;
}

template <class T>
void put_numbers(OutputFile& out, std::string_view bytes, std::size_t per_line) {
  std::size_t in_line = 0;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(T)) {
    const T value = loaded<T>(bytes.data() + at, false);
    if constexpr (std::is_floating_point_v<T>) {
      out.number(value);
    } else {
      out.number(static_cast<std::int64_t>(value));
    }
    out.text(++in_line % per_line == 0 ? "\n" : " ");
  }
  out.text("\n");
}

void VtuWriter::put_text(const OutArray& array) {
  constexpr std::size_t kNumbersInLine = 12;
  const std::size_t per_line = array.components > 1 ? array.components : kNumbersInLine;
  for (const std::string_view piece : array.pieces) {
    switch (array.type) {
      case NumberType::kUInt8:
        put_numbers<std::uint8_t>(out_, piece, per_line);
        break;
      case NumberType::kInt32:
        put_numbers<std::int32_t>(out_, piece, per_line);
        break;
      case NumberType::kInt64:
        put_numbers<std::int64_t>(out_, piece, per_line);
        break;
      default:
        put_numbers<double>(out_, piece, per_line);
    }
  }
}

void VtuWriter::put(const OutArray& array) {
  const std::uint64_t n_bytes = array.n_bytes();
  out_.text("<DataArray type=\"")
      .text(type_name(array.type))
      .text("\" Name=\"")
      .text(array.name.empty() ? "unnamed" : xml_escaped(array.name));
  out_.text("\" NumberOfComponents=\"").number(static_cast<std::int64_t>(array.components));
  if (array.in_field_data) out_.text("\" NumberOfTuples=\"").number(static_cast<std::int64_t>(n_bytes));
  if (variant_ == Variant::kAscii) {
    out_.text("\" format=\"ascii\">\n");
    put_text(array);
    out_.text("</DataArray>\n");
    return;
  }
  if (variant_ == Variant::kBase64) {
    out_.text("\" format=\"binary\">\n");
    Base64Writer coder(out_);
    coder.add({reinterpret_cast<const char*>(&n_bytes), sizeof n_bytes});
    for (const std::string_view piece : array.pieces) coder.add(piece);
    coder.finish();
    out_.text("\n</DataArray>\n");
    return;
  }
  out_.text("\" format=\"appended\" offset=\"").number(static_cast<std::int64_t>(offset_)).text("\"/>\n");
  appended_.push_back(array);
  if (variant_ == Variant::kAppended) {
    offset_ += sizeof n_bytes + n_bytes;
    return;
  }
  std::string whole;
  whole.reserve(n_bytes);
  for (const std::string_view piece : array.pieces) whole += piece;
  owned_.push_back(zlib_block(whole));
  appended_.back().pieces = {owned_.back()};
  offset_ += owned_.back().size();
}

void VtuWriter::put_section(const char* tag, const std::vector<OutArray>& arrays) {
  out_.text("<").text(tag).text(">\n");
  for (const OutArray& array : arrays) put(array);
  out_.text("</").text(tag).text(">\n");
}

void VtuWriter::put_appended() {
  if (appended_.empty()) return;
  out_.text("<AppendedData encoding=\"raw\">\n_");
  for (const OutArray& array : appended_) {
    if (variant_ == Variant::kAppended) out_.raw(std::uint64_t{array.n_bytes()});
    for (const std::string_view piece : array.pieces) out_.text(piece);
  }
  out_.text("\n</AppendedData>\n");
}

Notes VtuWriter::write() {
  out_.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"");
  out_.text(std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian");
  out_.text("\" header_type=\"UInt64\"");
  if (variant_ == Variant::kZlib) out_.text(" compressor=\"vtkZLibDataCompressor\"");
  out_.text(">\n<UnstructuredGrid>\n");
  const std::string names = names_text(mesh_);
  if (!names.empty()) {
    OutArray bytes = array<std::uint8_t>(std::string(kVtkNamesArray), 1, names);
    bytes.in_field_data = true;
    owned_.push_back(names);
    bytes.pieces = {owned_.back()};
    put_section("FieldData", {bytes});
  }
  out_.text("<Piece NumberOfPoints=\"").number(static_cast<std::int64_t>(mesh_.points.size()));
  out_.text("\" NumberOfCells=\"").number(static_cast<std::int64_t>(n_vtk_cells(mesh_))).text("\">\n");
  put_section("Points", {array<double>("Points", 3, bytes_of(std::span<const Vec3>(mesh_.points)))});
  // Every offset is at most four corners a cell.
  const bool narrow = n_vtk_cells(mesh_) <= std::size_t{std::numeric_limits<std::int32_t>::max()} / 4;
  put_section("Cells", {corners(), narrow ? offsets<std::int32_t>() : offsets<std::int64_t>(), types()});
  put_section("PointData", point_arrays());
  put_section("CellData", cell_arrays());
  out_.text("</Piece>\n</UnstructuredGrid>\n");
  put_appended();
  out_.text("</VTKFile>\n");
  out_.commit();
  return notes_on_vtu_names(mesh_);
}

}  // namespace

Notes write_vtu(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options) {
  return VtuWriter(path, mesh, variant_of(options.variant)).write();
}

}  // namespace hfr::io
