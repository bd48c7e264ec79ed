// SPDX-License-Identifier: BSD-3-Clause
// VTK XML unstructured grids. Raw appended data are no XML, so the document is cut at the end of the
// <AppendedData …> tag and closed by hand before it is parsed.
#include <tinyxml2.h>

#include <cmath>
#include <limits>
#include <optional>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/ReserveMore.hh"
#include "IO/VtkGrid.hh"
#include "IO/VtuData.hh"
#include "IO/VtuXml.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

using tinyxml2::XMLElement;

class VtuReader {
 public:
  explicit VtuReader(const InputFile& file) : bytes_(file.bytes()), name_(file.path().string()) {
    grid_.file = name_;
  }
  MeshData read();

 private:
  [[noreturn]] void fail_at_line(int line, const std::string& message) const;
  [[noreturn]] void fail(const XMLElement& element, const std::string& message) const;
  std::size_t number(const XMLElement& element, const char* attribute_name) const;
  const XMLElement& child(const XMLElement& parent, const char* tag) const;
  const XMLElement& named_array(const XMLElement& section, std::string_view array_name) const;

  void parse();
  void read_coding(const XMLElement& root);
  void read_piece(const XMLElement& piece);
  void append_cells(const XMLElement& section, std::size_t n_cells, std::size_t n_points);
  void read_field_data(const XMLElement& section);
  std::vector<Field> read_arrays(const XMLElement* section, std::size_t n_items);
  void merge_arrays(std::vector<Field>& all, std::vector<Field>&& more, std::size_t n_before);
  std::optional<Field> read_field(const XMLElement& element, std::size_t n_items);

  NumberType number_type(const XMLElement& element) const;
  std::size_t components(const XMLElement& element) const;
  /// The `n` numbers of an array; exactly so many must be there.
  template <class T>
  std::vector<T> read_numbers(const XMLElement& element, std::size_t n) const;
  template <class T>
  std::vector<T> read_text(const XMLElement& element, std::size_t n) const;
  template <class T>
  std::vector<T> read_block(const XMLElement& element, std::size_t n, bool appended) const;

  std::string_view bytes_;
  std::string name_;
  tinyxml2::XMLDocument document_;
  VtuCoding coding_;
  std::optional<std::string_view> appended_;  // what follows the underscore
  bool appended_base64_ = false;
  VtkGrid grid_;
};

void VtuReader::fail_at_line(int line, const std::string& message) const {
  throw InvalidInput(name_ + ":" + std::to_string(std::max(line, 1)) + ": " + message);
}

void VtuReader::fail(const XMLElement& element, const std::string& message) const {
  const char* const array = element.Attribute("Name");
  const std::string what = "<" + shown(element.Name()) + (array ? " Name=\"" + shown(array) + "\"" : "");
  fail_at_line(element.GetLineNum(), what + ">: " + message);
}

std::size_t VtuReader::number(const XMLElement& element, const char* attribute_name) const {
  const auto value = number_attribute(element, attribute_name);
  if (!value)
    fail(element, std::string("attribute ") + attribute_name + " must be a number, not '" +
                      shown(attribute(element, attribute_name)) + "'");
  return *value;
}

const XMLElement& VtuReader::child(const XMLElement& parent, const char* tag) const {
  const XMLElement* const found = parent.FirstChildElement(tag);
  if (!found) fail(parent, std::string("there is no <") + tag + "> in it");
  return *found;
}

const XMLElement& VtuReader::named_array(const XMLElement& section, std::string_view array_name) const {
  for (const XMLElement* e = section.FirstChildElement("DataArray"); e;
       e = e->NextSiblingElement("DataArray"))
    if (attribute(*e, "Name") == array_name) return *e;
  fail(section, "there is no array '" + shown(array_name) + "' in it");
}

void VtuReader::parse() {
  std::string_view xml = bytes_;
  std::string closed;
  const std::size_t tag = bytes_.find("<AppendedData");
  if (tag != std::string_view::npos) {
    const std::size_t tag_end = bytes_.find('>', tag);
    const std::size_t data_end = bytes_.rfind("</AppendedData");
    if (tag_end == std::string_view::npos || data_end == std::string_view::npos || data_end < tag_end ||
        bytes_.find("</VTKFile>", data_end) == std::string_view::npos) {
      throw InvalidInput(name_ + ": at byte " + std::to_string(bytes_.size()) +
                         ": the file ends too early: expected </AppendedData> and </VTKFile>");
    }
    closed = std::string(bytes_.substr(0, tag_end + 1)) + "</AppendedData></VTKFile>";
    xml = closed;
    const std::string_view data = bytes_.substr(tag_end + 1, data_end - tag_end - 1);
    const std::size_t underscore = data.find('_');
    if (underscore == std::string_view::npos || !trimmed(data.substr(0, underscore)).empty())
      throw InvalidInput(name_ + ": at byte " + std::to_string(tag_end + 1) +
                         ": expected the underscore with which appended data begin");
    appended_ = data.substr(underscore + 1);
  }
  if (document_.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS)
    fail_at_line(document_.ErrorLineNum(),
                 std::string("this is not well-formed XML, or the file ends too early (") +
                     document_.ErrorName() + ")");
}

void VtuReader::read_coding(const XMLElement& root) {
  const std::string_view type = attribute(root, "type");
  if (type != "UnstructuredGrid")
    fail(root, "type \"" + shown(type) + "\" is not supported: only UnstructuredGrid is");
  const std::string_view order = attribute(root, "byte_order");
  if (order != "LittleEndian" && order != "BigEndian" && !order.empty())
    fail(root, "unknown byte_order \"" + shown(order) + "\"");
  coding_.swap = (order == "BigEndian") != (std::endian::native == std::endian::big);
  const std::string_view header = attribute(root, "header_type");
  if (header != "UInt32" && header != "UInt64" && !header.empty())
    fail(root, "unknown header_type \"" + shown(header) + "\"");
  coding_.wide_header = header == "UInt64";
  const std::string_view compressor = attribute(root, "compressor");
  if (compressor != "vtkZLibDataCompressor" && !compressor.empty())
    fail(root, "compressor \"" + shown(compressor) + "\" is not supported: only vtkZLibDataCompressor is");
  coding_.zlib = !compressor.empty();
  if (!appended_) return;
  const std::string_view encoding = attribute(child(root, "AppendedData"), "encoding");
  if (encoding != "raw" && encoding != "base64")
    fail(root, "unknown encoding \"" + shown(encoding) + "\" of the appended data");
  appended_base64_ = encoding == "base64";
}

MeshData VtuReader::read() {
  parse();
  const XMLElement* const root = document_.RootElement();
  if (!root || std::string_view(root->Name()) != "VTKFile") fail_at_line(1, "this is no VTK XML file");
  read_coding(*root);
  const XMLElement& grid = child(*root, "UnstructuredGrid");
  if (const XMLElement* const data = grid.FirstChildElement("FieldData")) read_field_data(*data);
  const XMLElement* piece = &child(grid, "Piece");
  for (; piece; piece = piece->NextSiblingElement("Piece")) read_piece(*piece);
  const int line = child(grid, "Piece").GetLineNum();
  return to_mesh(std::move(grid_), [&](std::size_t cell, std::size_t /*corner*/, const std::string& message) {
    fail_at_line(line, "cell " + std::to_string(cell) + ": " + message);
  });
}

void VtuReader::read_piece(const XMLElement& piece) {
  const std::size_t n_points = number(piece, "NumberOfPoints");
  const std::size_t n_cells = number(piece, "NumberOfCells");
  const std::size_t points_before = grid_.points.size();
  const std::size_t cells_before = grid_.types.size();
  if (n_points > 0) {
    const XMLElement& element = child(child(piece, "Points"), "DataArray");
    if (components(element) != 3) fail(element, "points must have 3 components");
    if (n_points > std::numeric_limits<std::size_t>::max() / 3) fail(piece, "too many points");
    const std::vector<double> values = read_numbers<double>(element, 3 * n_points);
    reserve_more(grid_.points, n_points);
    for (std::size_t i = 0; i < n_points; ++i) {
      const Vec3 p = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        fail(element, "point " + std::to_string(i) + ": a coordinate is not finite");
      grid_.points.push_back(p);
    }
  }
  if (n_cells > 0) append_cells(child(piece, "Cells"), n_cells, n_points);
  std::vector<Field> of_points = read_arrays(piece.FirstChildElement("PointData"), n_points);
  std::vector<Field> of_cells = read_arrays(piece.FirstChildElement("CellData"), n_cells);
  // A piece need not name the arrays of what it has none of.
  const auto take = [&](std::vector<Field>& all, std::vector<Field>&& more, std::size_t n,
                        std::size_t n_before) {
    if (n == 0 && (n_before > 0 || more.empty())) return;
    if (n_before == 0)
      all = std::move(more);
    else
      merge_arrays(all, std::move(more), n_before);
  };
  take(grid_.point_arrays, std::move(of_points), n_points, points_before);
  take(grid_.cell_arrays, std::move(of_cells), n_cells, cells_before);
}

void VtuReader::append_cells(const XMLElement& section, std::size_t n_cells, std::size_t n_points) {
  const XMLElement& end_element = named_array(section, "offsets");
  const std::vector<std::int64_t> ends = read_numbers<std::int64_t>(end_element, n_cells);
  std::int64_t last = 0;
  for (std::size_t i = 0; i < n_cells; ++i) {
    if (ends[i] < last)
      fail(end_element, "offset " + std::to_string(i) + " is " + std::to_string(ends[i]) + " after " +
                            std::to_string(last) + ": offsets must not fall");
    last = ends[i];
  }
  const XMLElement& corner_element = named_array(section, "connectivity");
  std::vector<std::int64_t> corners =
      read_numbers<std::int64_t>(corner_element, static_cast<std::size_t>(last));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (static_cast<std::uint64_t>(corners[i]) < n_points) continue;
    fail(corner_element, "entry " + std::to_string(i) + ": vertex " + std::to_string(corners[i]) +
                             " is out of range (the piece has " + std::to_string(n_points) + " points)");
  }
  const XMLElement& type_element = named_array(section, "types");
  const std::vector<std::int64_t> types = read_numbers<std::int64_t>(type_element, n_cells);
  reserve_more(grid_.types, n_cells);
  for (const std::int64_t type : types) {
    if (type < 0 || type > std::numeric_limits<std::uint8_t>::max())
      fail(type_element, "unknown VTK cell type " + std::to_string(type));
    grid_.types.push_back(static_cast<std::uint8_t>(type));
  }
  if (grid_.ends.empty()) {
    grid_.ends = ends;
    grid_.corners = std::move(corners);
    return;
  }
  const auto first_point = static_cast<std::int64_t>(grid_.points.size() - n_points);
  const auto first_corner = static_cast<std::int64_t>(grid_.corners.size());
  for (const std::int64_t end : ends) grid_.ends.push_back(first_corner + end);
  for (const std::int64_t corner : corners) grid_.corners.push_back(first_point + corner);
}

/// Only the names of labels are of use; all else (time, cycle) is dropped without a word.
void VtuReader::read_field_data(const XMLElement& section) {
  for (const XMLElement* e = section.FirstChildElement("DataArray"); e;
       e = e->NextSiblingElement("DataArray")) {
    if (attribute(*e, "Name") != kVtkNamesArray || number_type(*e) != NumberType::kUInt8) continue;
    for (const std::int64_t byte : read_numbers<std::int64_t>(*e, number(*e, "NumberOfTuples")))
      grid_.names += static_cast<char>(byte & 255);
  }
}

std::vector<Field> VtuReader::read_arrays(const XMLElement* section, std::size_t n_items) {
  std::vector<Field> fields;
  if (!section) return fields;
  for (const XMLElement* e = section->FirstChildElement(); e; e = e->NextSiblingElement())
    if (auto field = read_field(*e, n_items)) fields.push_back(std::move(*field));
  return fields;
}

std::optional<Field> VtuReader::read_field(const XMLElement& element, std::size_t n_items) {
  const std::string_view array_name = attribute(element, "Name");
  const std::string_view type = attribute(element, "type");
  if (type == "String" || type == "Bit") {
    grid_.notes.push_back("array '" + shown(array_name) + "' of type " + shown(type) + " dropped");
    return std::nullopt;
  }
  Field field;
  field.name = array_name;
  const std::size_t n_components = components(element);
  if (n_items > std::numeric_limits<std::size_t>::max() / n_components) fail(element, "too many values");
  field.components = static_cast<int>(n_components);
  field.integer = is_integer(number_type(element));
  field.values = read_numbers<double>(element, n_items * n_components);
  return field;
}

void VtuReader::merge_arrays(std::vector<Field>& all, std::vector<Field>&& more, std::size_t n_before) {
  std::erase_if(all, [&](Field& field) {
    for (const Field& next : more) {
      if (next.name != field.name || next.components != field.components) continue;
      field.integer = field.integer && next.integer;
      field.values.insert(field.values.end(), next.values.begin(), next.values.end());
      return false;
    }
    grid_.notes.push_back("array '" + field.name + "' dropped: not all pieces have it");
    return true;
  });
  for (const Field& next : more) {
    const bool known = std::any_of(all.begin(), all.end(), [&](const Field& field) {
      return field.name == next.name &&
             field.values.size() > n_before * static_cast<std::size_t>(field.components);
    });
    if (!known) grid_.notes.push_back("array '" + next.name + "' dropped: not all pieces have it");
  }
}

NumberType VtuReader::number_type(const XMLElement& element) const {
  const std::string_view type = attribute(element, "type");
  const auto known = vtu_number_type(type);
  if (!known) fail(element, "unknown type \"" + shown(type) + "\"");
  return *known;
}

std::size_t VtuReader::components(const XMLElement& element) const {
  // Some writers leave the attribute empty.
  if (attribute(element, "NumberOfComponents").empty()) return 1;
  constexpr std::size_t kMost = 1 << 20;
  const std::size_t n = number(element, "NumberOfComponents");
  if (n == 0) return 1;  // as VTK does
  if (n > kMost) fail(element, "too many components");
  return n;
}

template <class T>
std::vector<T> VtuReader::read_numbers(const XMLElement& element, std::size_t n) const {
  if constexpr (std::is_integral_v<T>) {
    if (!is_integer(number_type(element))) fail(element, "this array must hold integers");
  }
  const std::string_view format = attribute(element, "format");
  if (format == "ascii" || format.empty()) return read_text<T>(element, n);
  if (format == "binary") return read_block<T>(element, n, false);
  if (format == "appended") return read_block<T>(element, n, true);
  fail(element, "unknown format \"" + shown(format) + "\"");
}

std::string_view text_of(const XMLElement& element) {
  for (const tinyxml2::XMLNode* node = element.FirstChild(); node; node = node->NextSibling())
    if (const tinyxml2::XMLText* const text = node->ToText()) return text->Value();
  return {};
}

template <class T>
std::vector<T> VtuReader::read_text(const XMLElement& element, std::size_t n) const {
  const std::string_view text = text_of(element);
  if (n > (text.size() + 1) / 2)
    fail(element, std::to_string(n) + " numbers are needed, but the text is too short");
  static_cast<void>(number_type(element));
  std::vector<T> values(n);
  const auto bad = parse_numbers(text, n, values.data());
  if (!bad) return values;
  const std::string_view before = text.substr(0, *bad);
  const std::string_view found = trimmed(text.substr(*bad)).substr(0, 20);
  const auto line = element.FirstChild()->GetLineNum() + std::count(before.begin(), before.end(), '\n');
  fail_at_line(static_cast<int>(line),
               "array '" + shown(attribute(element, "Name")) + "': " +
                   (found.empty() ? std::to_string(n) + " numbers are needed, but there are fewer"
                                  : "expected " + std::to_string(n) + " numbers and no more, found '" +
                                        std::string(found.substr(0, found.find_first_of(" \t\r\n"))) + "'"));
}

template <class T>
std::vector<T> VtuReader::read_block(const XMLElement& element, std::size_t n, bool appended) const {
  const NumberType type = number_type(element);
  std::string_view data;
  std::string compact;  // base64 text without the line breaks that some writers put into it
  if (appended) {
    const std::size_t offset = number(element, "offset");
    if (!appended_) fail(element, "there are no appended data");
    if (offset > appended_->size())
      fail(element, "offset " + std::to_string(offset) + " is behind the appended data");
    data = appended_->substr(offset);
  } else {
    data = trimmed(text_of(element));
    if (data.find_first_of(" \t\r\n") != std::string_view::npos) {
      for (const char c : data)
        if (c != ' ' && c != '\t' && c != '\r' && c != '\n') compact += c;
      data = compact;
    }
  }
  const auto fail_here = [&](const std::string& message) {
    if (!appended) fail(element, message);
    throw InvalidInput(name_ + ": at byte " + std::to_string(data.data() - bytes_.data()) + ": array '" +
                       shown(attribute(element, "Name")) + "': " + message);
  };
  if (n == 0 && data.empty()) return {};
  const VtuBlock block =
      decode_block(data, !appended || appended_base64_, coding_, n * size_of(type), fail_here);
  const std::string_view bytes = block.bytes();
  if (bytes.size() % size_of(type) != 0 || bytes.size() / size_of(type) != n)
    fail_here("it has " + std::to_string(bytes.size()) + " bytes, but " + std::to_string(n) + " numbers of " +
              std::to_string(size_of(type)) + " bytes are needed");
  std::vector<T> values(n);
  convert_numbers(type, coding_.swap, bytes, values.data());
  return values;
}

}  // namespace

MeshData read_vtu(const InputFile& file) { return VtuReader(file).read(); }

}  // namespace hfr::io
