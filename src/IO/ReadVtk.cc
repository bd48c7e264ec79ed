// SPDX-License-Identifier: BSD-3-Clause
// Legacy .vtk, versions 1.0 to 5.1. In binary files numbers are big-endian and lie between lines of text.
// The two layouts of cells, "n corners…" (up to 4.2) and offsets with connectivity (5.x), are told apart by
// what stands in the file, not by its version.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/TextScanner.hh"
#include "IO/VtkGrid.hh"
#include "IO/VtuData.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

/// Names are written with %20 for a blank.
std::string unescaped(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned code = 0;
    if (name[i] == '%' && i + 2 < name.size()) {
      const auto [stop, error] = std::from_chars(&name[i + 1], &name[i + 3], code, 16);
      if (error == std::errc{} && stop == &name[i + 3]) {
        result += static_cast<char>(code);
        i += 2;
        continue;
      }
    }
    result += name[i];
  }
  return result;
}

std::string in_quotes(std::string_view word) { return "'" + shown(word) + "'"; }

/// What can be in an array: numbers of a type, bits or strings.
struct ValueType {
  enum class Kind { kNumber, kBit, kString } kind = Kind::kNumber;
  NumberType number = NumberType::kFloat64;
  bool is_real() const { return kind == Kind::kNumber && !is_integer(number); }
};

struct VtkNumber {
  std::string_view name;
  ValueType type;
};

constexpr VtkNumber kVtkNumbers[] = {
    {"bit", {ValueType::Kind::kBit, NumberType::kUInt8}},
    {"char", {ValueType::Kind::kNumber, NumberType::kInt8}},
    {"signed_char", {ValueType::Kind::kNumber, NumberType::kInt8}},
    {"unsigned_char", {ValueType::Kind::kNumber, NumberType::kUInt8}},
    {"short", {ValueType::Kind::kNumber, NumberType::kInt16}},
    {"unsigned_short", {ValueType::Kind::kNumber, NumberType::kUInt16}},
    {"int", {ValueType::Kind::kNumber, NumberType::kInt32}},
    {"vtkidtype", {ValueType::Kind::kNumber, NumberType::kInt32}},  // written as int
    {"unsigned_int", {ValueType::Kind::kNumber, NumberType::kUInt32}},
    {"long", {ValueType::Kind::kNumber, NumberType::kInt64}},
    {"unsigned_long", {ValueType::Kind::kNumber, NumberType::kUInt64}},
    {"vtktypeint8", {ValueType::Kind::kNumber, NumberType::kInt8}},
    {"vtktypeuint8", {ValueType::Kind::kNumber, NumberType::kUInt8}},
    {"vtktypeint16", {ValueType::Kind::kNumber, NumberType::kInt16}},
    {"vtktypeuint16", {ValueType::Kind::kNumber, NumberType::kUInt16}},
    {"vtktypeint32", {ValueType::Kind::kNumber, NumberType::kInt32}},
    {"vtktypeuint32", {ValueType::Kind::kNumber, NumberType::kUInt32}},
    {"vtktypeint64", {ValueType::Kind::kNumber, NumberType::kInt64}},
    {"vtktypeuint64", {ValueType::Kind::kNumber, NumberType::kUInt64}},
    {"float", {ValueType::Kind::kNumber, NumberType::kFloat32}},
    {"double", {ValueType::Kind::kNumber, NumberType::kFloat64}},
    {"string", {ValueType::Kind::kString, NumberType::kUInt8}},
    {"utf8_string", {ValueType::Kind::kString, NumberType::kUInt8}},
};

constexpr ValueType kInt = {ValueType::Kind::kNumber, NumberType::kInt32};

class LegacyReader {
 public:
  explicit LegacyReader(const InputFile& file) : scan_(file.bytes(), file.path().string()) {
    grid_.file = file.path().string();
  }
  MeshData read();

 private:
  [[noreturn]] void fail(const std::string& message) const;
  /// At a number of those that begin there, of `size` bytes each in a binary file.
  [[noreturn]] void fail_at_value(std::size_t begin, std::size_t value, std::size_t size,
                                  const std::string& message);
  [[noreturn]] void fail_at_corner(std::size_t cell, std::size_t corner, const std::string& message);
  std::string_view word(std::string_view what);
  std::size_t count(std::string_view what);
  ValueType value_type();
  void end_header_line();
  /// Throws when the rest of the file is too short for `n` items of `components` values.
  std::size_t total(std::size_t n, std::size_t components, ValueType type, std::string_view what);
  template <class T>
  void read_values(ValueType type, std::size_t n, T* out);
  void skip_strings(std::size_t n);
  bool is_next_line(std::string_view line);
  void skip_metadata();

  void read_header();
  void read_section(const std::string& keyword);
  void read_points();
  void read_cells();
  void read_old_cells(std::size_t n, std::size_t size);
  void read_new_cells(std::size_t n_offsets, std::size_t n_corners);
  void read_cell_types();
  void begin_attributes(bool of_points);
  void read_scalars();
  void read_array(std::string_view kind, std::size_t components);
  void read_field();
  void skip_table(std::string_view kind);

  TextScanner scan_;
  bool binary_ = false;
  VtkGrid grid_;
  bool have_points_ = false;
  std::size_t corners_offset_ = 0;        // of the numbers in the file
  std::size_t corner_size_ = 4;           // bytes, in a binary file
  bool counts_between_corners_ = false;   // the old layout
  std::vector<Field>* fields_ = nullptr;  // where attributes go; null before POINT_DATA and CELL_DATA
  std::size_t n_items_ = 0;               // points or cells
};

void LegacyReader::fail(const std::string& message) const {
  if (!binary_) scan_.fail(message);
  throw InvalidInput(scan_.name() + ": at byte " + std::to_string(scan_.offset()) + ": " + message);
}

void LegacyReader::fail_at_value(std::size_t begin, std::size_t value, std::size_t size,
                                 const std::string& message) {
  scan_.seek(begin);
  if (binary_) {
    scan_.seek(std::min(begin + value * size, scan_.text().size()));
  } else {
    for (std::size_t i = 0; i < value && !scan_.peek_word().empty(); ++i) scan_.word();
    static_cast<void>(scan_.peek_word());
  }
  fail(message);
}

void LegacyReader::fail_at_corner(std::size_t cell, std::size_t corner, const std::string& message) {
  const std::size_t place = counts_between_corners_ ? corner + cell + 1 : corner;
  fail_at_value(corners_offset_, place, corner_size_, "cell " + std::to_string(cell) + ": " + message);
}

std::string_view LegacyReader::word(std::string_view what) {
  if (scan_.peek_word().empty()) fail("the file ends too early: expected " + std::string(what));
  return scan_.word();
}

std::size_t LegacyReader::count(std::string_view what) {
  const std::string_view text = word(what);
  std::size_t n = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc{} || stop != text.data() + text.size())
    fail("expected " + std::string(what) + ", found " + in_quotes(text));
  return n;
}

ValueType LegacyReader::value_type() {
  const std::string_view text = word("a data type");
  const std::string name = lower(text);
  for (const VtkNumber& type : kVtkNumbers)
    if (type.name == name) return type.type;
  fail("unknown data type " + in_quotes(text));
}

/// Numbers begin with the next line: in a binary file, with the byte after the line break.
void LegacyReader::end_header_line() {
  const std::string_view rest = scan_.rest_of_line();
  if (!rest.empty()) fail("expected the end of the line, found " + in_quotes(rest));
}

std::size_t LegacyReader::total(std::size_t n, std::size_t components, ValueType type,
                                std::string_view what) {
  const std::size_t left = scan_.text().size() - scan_.offset();
  std::size_t most = (left + 1) / 2;  // a number and the space before the next
  if (type.kind == ValueType::Kind::kString) most = left;
  if (binary_ && type.kind == ValueType::Kind::kNumber) most = left / size_of(type.number);
  if (binary_ && type.kind == ValueType::Kind::kBit) most = 8 * left;
  if (n > most / std::max<std::size_t>(components, 1)) {
    if (!binary_) scan_.seek(scan_.offset() - 1);  // the line that says how many
    fail(std::to_string(n) + " " + std::string(what) + " are more than the rest of the file can hold");
  }
  return n * components;
}

/// The caller has checked with total() that there may be n values.
template <class T>
void LegacyReader::read_values(ValueType type, std::size_t n, T* out) {
  if (!binary_) {
    for (std::size_t i = 0; i < n; ++i) {
      if constexpr (std::is_integral_v<T>) {
        out[i] = scan_.integer();
      } else {
        out[i] = scan_.field_value();
      }
    }
    return;
  }
  const std::string_view rest = scan_.text().substr(scan_.offset());
  std::size_t n_bytes = n * size_of(type.number);
  if (type.kind == ValueType::Kind::kBit) {
    n_bytes = (n + 7) / 8;
    for (std::size_t i = 0; i < n; ++i)
      out[i] = static_cast<T>(static_cast<unsigned char>(rest[i / 8]) >> (7 - i % 8) & 1);
  } else {
    convert_numbers(type.number, std::endian::native == std::endian::little, rest.substr(0, n_bytes), out);
  }
  scan_.seek(scan_.offset() + n_bytes);
}

/// In ASCII one a line; in binary each with its length before it, in 1, 2, 4 or 8 bytes of which the first
/// two bits say how many.
void LegacyReader::skip_strings(std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::string_view rest = scan_.text().substr(scan_.offset());
    if (rest.empty()) fail("the file ends too early: expected a string");
    if (!binary_) {
      scan_.rest_of_line();
      continue;
    }
    const auto first = static_cast<unsigned char>(rest[0]);
    const std::size_t length_size = std::size_t{8} >> (first >> 6);
    if (rest.size() < length_size) fail("the file ends too early: expected a string");
    std::uint64_t length = first & 63;
    for (std::size_t k = 1; k < length_size; ++k) length = length << 8 | static_cast<unsigned char>(rest[k]);
    if (length > rest.size() - length_size) fail("a string is longer than the rest of the file");
    scan_.seek(scan_.offset() + length_size + length);
  }
}

/// Whether that word comes next and is all of its line: arrays may have such a name.
bool LegacyReader::is_next_line(std::string_view line) {
  scan_.peek_word();
  const std::size_t at = scan_.offset();
  const bool is_it = lower(scan_.rest_of_line()) == line;
  scan_.seek(at);
  return is_it;
}

/// Information on the array before it, up to an empty line.
void LegacyReader::skip_metadata() {
  scan_.rest_of_line();
  while (scan_.offset() < scan_.text().size() && !scan_.rest_of_line().empty()) continue;
}

void LegacyReader::read_header() {
  if (!lower(scan_.text().substr(0, 22)).starts_with("# vtk datafile version")) {
    if (scan_.text().starts_with("<?xml") || scan_.text().starts_with("<VTKFile"))
      scan_.fail("this is a VTK XML file: name it .vtu");
    scan_.fail("this is no legacy VTK file: the first line must be '# vtk DataFile Version x.y'");
  }
  scan_.rest_of_line();
  scan_.rest_of_line();  // the title, free text
  const std::string_view coding = scan_.rest_of_line();
  if (lower(coding) != "ascii" && lower(coding) != "binary")
    scan_.fail("expected ASCII or BINARY, found " + in_quotes(coding));
  binary_ = lower(coding) == "binary";
  const std::string_view dataset = word("DATASET");
  if (lower(dataset) != "dataset") fail("expected DATASET, found " + in_quotes(dataset));
  const std::string_view type = word("the type of the data set");
  if (lower(type) != "unstructured_grid")
    fail("DATASET " + in_quotes(type) + " is not supported: only UNSTRUCTURED_GRID is");
}

MeshData LegacyReader::read() {
  read_header();
  while (!scan_.at_end()) {
    const std::string_view keyword = scan_.word();
    read_section(lower(keyword));
  }
  if (!have_points_) fail("the file ends too early: there are no POINTS");
  if (corners_offset_ == 0) fail("the file ends too early: there are no CELLS");
  if (grid_.types.size() != grid_.ends.size()) fail("the file ends too early: there are no CELL_TYPES");
  return to_mesh(std::move(grid_), [this](std::size_t cell, std::size_t corner, const std::string& message) {
    fail_at_corner(cell, corner, message);
  });
}

void LegacyReader::read_section(const std::string& keyword) {
  if (keyword == "points") return read_points();
  if (keyword == "cells") return read_cells();
  if (keyword == "cell_types") return read_cell_types();
  if (keyword == "point_data") return begin_attributes(true);
  if (keyword == "cell_data") return begin_attributes(false);
  if (keyword == "metadata") return skip_metadata();
  if (keyword == "field") return read_field();
  if (!fields_) fail("unknown keyword " + in_quotes(keyword));
  if (keyword == "scalars") return read_scalars();
  if (keyword == "vectors" || keyword == "normals") return read_array(keyword, 3);
  if (keyword == "tensors") return read_array(keyword, 9);
  if (keyword == "tensors6") return read_array(keyword, 6);
  if (keyword == "texture_coordinates") return read_array(keyword, 0);
  if (keyword == "global_ids" || keyword == "pedigree_ids" || keyword == "edge_flags")
    return read_array(keyword, 1);
  if (keyword == "lookup_table" || keyword == "color_scalars") return skip_table(keyword);
  fail("unknown keyword " + in_quotes(keyword));
}

void LegacyReader::read_points() {
  if (have_points_) fail("POINTS come twice");
  const std::size_t n = count("a number of points");
  const ValueType type = value_type();
  if (type.kind != ValueType::Kind::kNumber) fail("points must be numbers");
  end_header_line();
  total(n, 3, type, "points");
  grid_.points.resize(n);
  have_points_ = true;
  if (!binary_) {
    for (Vec3& point : grid_.points) point = {scan_.real(), scan_.real(), scan_.real()};
    return;
  }
  const std::size_t begin = scan_.offset();
  read_values(type, 3 * n, n == 0 ? nullptr : &grid_.points[0].x);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = grid_.points[i];
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
    scan_.seek(begin + i * 3 * size_of(type.number));
    fail("point " + std::to_string(i) + ": a coordinate is not finite");
  }
}

void LegacyReader::read_cells() {
  if (corners_offset_ != 0) fail("CELLS come twice");
  const std::size_t n = count("a number of cells");
  const std::size_t size = count("the size of the cell list");
  end_header_line();
  const std::string_view next = scan_.text().substr(scan_.offset(), 7);
  if (lower(next) == "offsets") return read_new_cells(n, size);
  read_old_cells(n, size);
}

void LegacyReader::read_old_cells(std::size_t n, std::size_t size) {
  total(size, 1, kInt, "entries of the cell list");
  if (n > size)
    fail("a list of " + std::to_string(size) + " entries cannot hold " + std::to_string(n) + " cells");
  corners_offset_ = scan_.offset();
  counts_between_corners_ = true;
  std::vector<std::int64_t>& corners = grid_.corners;
  corners.resize(size);
  read_values(kInt, size, corners.data());
  grid_.ends.reserve(n);
  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t cell = 0; cell < n; ++cell) {
    // The count of a cell stands where fail_at_corner() looks one entry before its first corner.
    if (from == size) fail_at_corner(cell, to, "the cell list ends before it");
    const std::int64_t n_corners = corners[from++];
    if (n_corners < 0 || static_cast<std::uint64_t>(n_corners) > size - from)
      fail_at_corner(cell, to, std::to_string(n_corners) + " corners do not fit into the cell list");
    for (std::int64_t k = 0; k < n_corners; ++k) corners[to++] = corners[from++];
    grid_.ends.push_back(static_cast<std::int64_t>(to));
  }
  if (from != size) fail("the cell list has " + std::to_string(size - from) + " entries too many");
  corners.resize(to);
}

void LegacyReader::read_new_cells(std::size_t n_offsets, std::size_t n_corners) {
  word("OFFSETS");
  ValueType type = value_type();
  if (type.kind != ValueType::Kind::kNumber || type.is_real()) fail("offsets must be integers");
  end_header_line();
  total(n_offsets, 1, type, "offsets");
  grid_.ends.resize(n_offsets);
  read_values(type, n_offsets, grid_.ends.data());
  std::int64_t last = 0;
  for (std::size_t i = 0; i < n_offsets; ++i) {
    const std::int64_t offset = grid_.ends[i];
    if (offset < last || static_cast<std::uint64_t>(offset) > n_corners || (i == 0 && offset != 0))
      fail("offset " + std::to_string(i) + " of the cells is " + std::to_string(offset) +
           ": offsets must rise from 0 to " + std::to_string(n_corners));
    last = offset;
  }
  if (static_cast<std::size_t>(last) != n_corners)
    fail("the last offset of the cells is " + std::to_string(last) + ", but there are " +
         std::to_string(n_corners) + " corners");
  if (n_offsets > 0) grid_.ends.erase(grid_.ends.begin());

  const std::string_view keyword = word("CONNECTIVITY");
  if (lower(keyword) != "connectivity") fail("expected CONNECTIVITY, found " + in_quotes(keyword));
  type = value_type();
  if (type.kind != ValueType::Kind::kNumber || type.is_real()) fail("the connectivity must be integers");
  end_header_line();
  total(n_corners, 1, type, "corners");
  corners_offset_ = scan_.offset();
  corner_size_ = size_of(type.number);
  grid_.corners.resize(n_corners);
  read_values(type, n_corners, grid_.corners.data());
}

void LegacyReader::read_cell_types() {
  const std::size_t n = count("a number of cell types");
  if (n != grid_.ends.size())
    fail(std::to_string(n) + " cell types for " + std::to_string(grid_.ends.size()) + " cells");
  end_header_line();
  total(n, 1, kInt, "cell types");
  const std::size_t begin = scan_.offset();
  std::vector<std::int64_t> types(n);
  read_values(kInt, n, types.data());
  grid_.types.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (types[i] < 0 || types[i] > std::numeric_limits<std::uint8_t>::max())
      fail_at_value(begin, i, size_of(kInt.number), "unknown VTK cell type " + std::to_string(types[i]));
    grid_.types.push_back(static_cast<std::uint8_t>(types[i]));
  }
}

void LegacyReader::begin_attributes(bool of_points) {
  n_items_ = of_points ? grid_.points.size() : grid_.ends.size();
  fields_ = of_points ? &grid_.point_arrays : &grid_.cell_arrays;
  const std::size_t n = count("a number of entries");
  if (n != n_items_)
    fail(std::string(of_points ? "POINT_DATA" : "CELL_DATA") + " has " + std::to_string(n) + " entries for " +
         std::to_string(n_items_) + (of_points ? " points" : " cells"));
}

void LegacyReader::read_scalars() {
  Field field;
  field.name = unescaped(word("a name"));
  const ValueType type = value_type();
  const std::string_view rest = scan_.rest_of_line();
  if (!rest.empty()) {
    const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), field.components);
    if (error != std::errc{} || stop != rest.data() + rest.size() || field.components < 1)
      fail("expected a number of components, found " + in_quotes(rest));
  }
  // "LOOKUP_TABLE name" should follow, but some writers leave it out.
  const std::size_t after_header = scan_.offset();
  const bool has_table = lower(scan_.peek_word().substr(0, 13)) == "lookup_table";
  scan_.seek(after_header);
  if (has_table) {
    scan_.word();
    scan_.rest_of_line();
  }
  if (type.kind == ValueType::Kind::kString) fail("SCALARS must be numbers");
  field.integer = !type.is_real();
  field.values.resize(total(n_items_, static_cast<std::size_t>(field.components), type, "values"));
  read_values(type, field.values.size(), field.values.data());
  fields_->push_back(std::move(field));
}

/// Arrays of one line of header; `components` is 0 where the line says how many.
void LegacyReader::read_array(std::string_view kind, std::size_t components) {
  Field field;
  field.name = unescaped(word("a name"));
  if (components == 0) components = count("a number of components");
  constexpr std::size_t kMost = 1 << 16;
  if (components == 0 || components > kMost) fail("bad number of components of " + std::string(kind));
  const ValueType type = value_type();
  end_header_line();
  const std::size_t n = total(n_items_, components, type, "values");
  if (type.kind == ValueType::Kind::kString) {
    grid_.notes.push_back("strings '" + field.name + "' dropped");
    return skip_strings(n);
  }
  field.components = static_cast<int>(components);
  field.integer = !type.is_real();
  field.values.resize(n);
  read_values(type, n, field.values.data());
  fields_->push_back(std::move(field));
}

void LegacyReader::read_field() {
  word("a name");
  const std::size_t n_arrays = count("a number of arrays");
  for (std::size_t i = 0; i < n_arrays; ++i) {
    while (is_next_line("metadata")) skip_metadata();
    const bool is_missing = is_next_line("null_array");
    Field field;
    field.name = unescaped(word("a name"));
    if (is_missing) continue;
    const std::size_t components = count("a number of components");
    const std::size_t n_tuples = count("a number of entries");
    const ValueType type = value_type();
    end_header_line();
    if (n_tuples > 0 && components > std::numeric_limits<int>::max() / 2) fail("too many components");
    const std::size_t n = total(n_tuples, components, type, "values");
    if (type.kind == ValueType::Kind::kString) {
      grid_.notes.push_back("strings '" + field.name + "' dropped");
      skip_strings(n);
      continue;
    }
    field.components = static_cast<int>(components);
    field.integer = !type.is_real();
    field.values.resize(n);
    read_values(type, n, field.values.data());
    if (fields_ && n_tuples == n_items_ && components > 0) {
      fields_->push_back(std::move(field));
    } else if (!fields_ && field.name == kVtkNamesArray && field.integer) {
      for (const double byte : field.values)
        grid_.names += byte >= 0 && byte < 256 ? static_cast<char>(static_cast<int>(byte)) : '?';
    } else {
      grid_.notes.push_back("array '" + field.name + "' dropped: its entries belong to no point or cell");
    }
  }
}

/// LOOKUP_TABLE: four values a colour; COLOR_SCALARS: so many as it says an item. Bytes in a binary file.
void LegacyReader::skip_table(std::string_view kind) {
  const std::string name = unescaped(word("a name"));
  const bool table = kind == "lookup_table";
  const std::size_t n = count(table ? "a number of colours" : "a number of components");
  end_header_line();
  const ValueType bytes = {ValueType::Kind::kNumber, NumberType::kUInt8};
  const std::size_t n_values = table ? total(n, 4, bytes, "colours") : total(n_items_, n, bytes, "colours");
  if (binary_) {
    scan_.seek(scan_.offset() + n_values);
  } else {
    for (std::size_t i = 0; i < n_values; ++i) static_cast<void>(scan_.field_value());
  }
  if (!table) grid_.notes.push_back("colours '" + name + "' dropped");
}

}  // namespace

MeshData read_vtk(const InputFile& file) { return LegacyReader(file).read(); }

}  // namespace hfr::io
