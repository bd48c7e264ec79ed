// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "HalfFace/Errors.hh"
#include "IO/ReadSurface.hh"
#include "IO/TextScanner.hh"
#include "IO/Validate.hh"
#include "IO/VtuData.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

struct PlyNumber {
  std::string_view name;
  NumberType type;
};

constexpr PlyNumber kPlyNumbers[] = {
    {"char", NumberType::kInt8},       {"int8", NumberType::kInt8},      {"uchar", NumberType::kUInt8},
    {"uint8", NumberType::kUInt8},     {"short", NumberType::kInt16},    {"int16", NumberType::kInt16},
    {"ushort", NumberType::kUInt16},   {"uint16", NumberType::kUInt16},  {"int", NumberType::kInt32},
    {"int32", NumberType::kInt32},     {"uint", NumberType::kUInt32},    {"uint32", NumberType::kUInt32},
    {"int64", NumberType::kInt64},     {"uint64", NumberType::kUInt64},  {"float", NumberType::kFloat32},
    {"float32", NumberType::kFloat32}, {"double", NumberType::kFloat64}, {"float64", NumberType::kFloat64},
};

struct Property {
  std::string name;
  NumberType type = NumberType::kFloat64;
  std::optional<NumberType> list_count;  ///< set where the property is a list
};

struct Element {
  std::string name;
  std::size_t n = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const InputFile& file) : in_(file.bytes(), file.path().string()) {}
  MeshData read();

 private:
  [[noreturn]] void fail(const std::string& message) const;
  NumberType number_type();
  void read_header();
  void read_property(Element& element);
  std::size_t bytes_of_item(const Element& element) const;
  double value(NumberType type);
  std::size_t list_length(const Property& property);
  void read_vertices(const Element& element);
  void read_faces(const Element& element);
  void skip(const Property& property);

  TextScanner in_;
  bool binary_ = false;
  bool swap_ = false;
  std::vector<Element> elements_;
  MeshData mesh_;
};

void PlyReader::fail(const std::string& message) const {
  if (!binary_) in_.fail(message);
  throw InvalidInput(in_.name() + ": at byte " + std::to_string(in_.offset()) + ": " + message);
}

NumberType PlyReader::number_type() {
  const std::string_view name = in_.word();
  for (const PlyNumber& type : kPlyNumbers)
    if (type.name == name) return type.type;
  in_.fail("unknown data type '" + std::string(name.substr(0, 20)) + "'");
}

void PlyReader::read_property(Element& element) {
  Property property;
  if (in_.peek_word() == "list") {
    in_.word();
    property.list_count = number_type();
    if (!is_integer(*property.list_count)) in_.fail("the length of a list must be an integer");
  }
  property.type = number_type();
  property.name = in_.word();
  element.properties.push_back(std::move(property));
}

void PlyReader::read_header() {
  if (in_.word() != "ply") in_.fail("this is no PLY file: it must begin with 'ply'");
  bool have_format = false;
  for (;;) {
    const std::string_view keyword = in_.word();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      const std::string_view format = in_.word();
      if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
        in_.fail("unknown format '" + std::string(format.substr(0, 20)) + "'");
      binary_ = format != "ascii";
      swap_ = (format == "binary_big_endian") != (std::endian::native == std::endian::big);
      have_format = true;
      in_.rest_of_line();
    } else if (keyword == "element") {
      Element element;
      element.name = in_.word();
      // Even without properties an item could be a line; that so many fit is looked at once the header ends.
      element.n = static_cast<std::size_t>(in_.integer_in(0, static_cast<std::int64_t>(in_.text().size()),
                                                          "number of " + shown(element.name)));
      elements_.push_back(std::move(element));
    } else if (keyword == "property") {
      if (elements_.empty()) in_.fail("a property stands before the first element");
      read_property(elements_.back());
    } else if (keyword == "comment" || keyword == "obj_info") {
      in_.rest_of_line();
    } else {
      in_.fail("unknown keyword '" + std::string(keyword.substr(0, 20)) + "'");
    }
  }
  if (!have_format) in_.fail("the header has no format");
  in_.rest_of_line();
  for (const Element& element : elements_) {
    const std::size_t least = bytes_of_item(element), left = in_.text().size() - in_.offset();
    // The last line of a text may have no end.
    if (element.n > (left + (binary_ ? 0 : 1)) / std::max<std::size_t>(least, 1))
      fail("number of " + shown(element.name) + " " + std::to_string(element.n) +
           " is more than the rest of the file can hold");
  }
}

/// At least; in text a number and what is behind it.
std::size_t PlyReader::bytes_of_item(const Element& element) const {
  std::size_t bytes = 0;
  for (const Property& property : element.properties)
    bytes += binary_ ? size_of(property.list_count.value_or(property.type)) : 2;
  return bytes;
}

double PlyReader::value(NumberType type) {
  if (!binary_) return in_.field_value();
  const std::string_view rest = in_.text().substr(in_.offset());
  if (rest.size() < size_of(type)) fail("the file ends too early");
  double result = 0;
  convert_numbers(type, swap_, rest.substr(0, size_of(type)), &result);
  in_.seek(in_.offset() + size_of(type));
  return result;
}

std::size_t PlyReader::list_length(const Property& property) {
  const double n = value(*property.list_count);
  const std::size_t left = in_.text().size() - in_.offset();
  const std::size_t item = binary_ ? size_of(property.type) : 2;
  if (!(n >= 0 && n <= static_cast<double>((left + 1) / item)) || n != std::trunc(n))
    fail("a list is longer than the rest of the file");
  return static_cast<std::size_t>(n);
}

void PlyReader::skip(const Property& property) {
  const std::size_t n = property.list_count ? list_length(property) : 1;
  for (std::size_t i = 0; i < n; ++i) static_cast<void>(value(property.type));
}

void PlyReader::read_vertices(const Element& element) {
  constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  for (const std::string_view name : kNames) {
    if (std::none_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& p) { return p.name == name && !p.list_count; }))
      fail("the vertices have no property '" + std::string(name) + "'");
  }
  for (std::size_t i = 0; i < element.n; ++i) {
    Vec3 point;
    for (const Property& property : element.properties) {
      const auto* const axis = std::find(kNames.begin(), kNames.end(), property.name);
      if (axis == kNames.end() || property.list_count) {
        skip(property);
        continue;
      }
      const double coordinate = value(property.type);
      if (!std::isfinite(coordinate)) fail("a coordinate is not finite");
      point[static_cast<int>(axis - kNames.begin())] = coordinate;
    }
    mesh_.points.push_back(point);
  }
}

void PlyReader::read_faces(const Element& element) {
  std::size_t n_split = 0;
  std::vector<Index> corners;
  for (std::size_t i = 0; i < element.n; ++i) {
    int label = 0;
    corners.clear();
    for (const Property& property : element.properties) {
      if (property.list_count && (property.name == "vertex_indices" || property.name == "vertex_index")) {
        const std::size_t n = list_length(property);
        if (n < 3) fail("a face has " + std::to_string(n) + " corners");
        for (std::size_t k = 0; k < n; ++k) {
          const double index = value(property.type);
          if (!(index >= 0 && index < static_cast<double>(mesh_.points.size())) || index != std::trunc(index))
            fail("a face has a vertex out of range (the file has " + std::to_string(mesh_.points.size()) +
                 " points, counted from 0)");
          corners.push_back(static_cast<Index>(index));
        }
      } else if (property.name == "label" && !property.list_count) {
        const double number = value(property.type);
        if (!is_label(number)) fail("a label is no integer of 32 bits");
        label = static_cast<int>(number);
      } else {
        skip(property);
      }
    }
    if (corners.empty()) fail("the faces have no property 'vertex_indices'");
    add_polygon(mesh_, corners, label, n_split);
  }
  note_polygons(mesh_, n_split);
}

MeshData PlyReader::read() {
  read_header();
  bool have_vertices = false;
  for (const Element& element : elements_) {
    if (element.n > 0 && element.properties.empty())
      fail("element " + shown(element.name) + " has no properties");
    if (element.name == "vertex") {
      read_vertices(element);
      have_vertices = true;
    } else if (element.name == "face") {
      if (!have_vertices) fail("the faces stand before the vertices");
      read_faces(element);
    } else {
      if (element.name == "tristrips" && element.n > 0)
        fail("triangles in strips (element 'tristrips') are not read: convert them to element 'face'");
      for (std::size_t i = 0; i < element.n; ++i)
        for (const Property& property : element.properties) skip(property);
      if (element.n > 0)
        mesh_.notes.push_back("element " + shown(element.name) + " (" + std::to_string(element.n) +
                              ") is not kept");
    }
  }
  return std::move(mesh_);
}

}  // namespace

MeshData read_ply(const InputFile& file) { return PlyReader(file).read(); }

}  // namespace hfr::io
