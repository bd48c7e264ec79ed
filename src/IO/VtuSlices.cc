// SPDX-License-Identifier: BSD-3-Clause
#include "IO/VtuSlices.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "IO/VtkGrid.hh"
#include "IO/VtuXml.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

using tinyxml2::XMLElement;

constexpr std::string_view kWhatIsNeeded =
    "only a .vtu of one piece whose arrays are raw appended data, not compressed, can be read in ranges; "
    "hfremesh convert writes it";

}  // namespace

/// The elements before the arrays.
class VtuSlices::Header {
 public:
  /// `text`: up to the underscore with which appended data begin.
  Header(VtuSlices& file, const std::string& text) : file_(file), first_byte_(text.size()) {
    const std::string closed = text.substr(0, text.rfind('>') + 1) + "</AppendedData></VTKFile>";
    if (document_.Parse(closed.data(), closed.size()) != tinyxml2::XML_SUCCESS)
      file_.fail("line " + std::to_string(std::max(document_.ErrorLineNum(), 1)) +
                 ": this is not well-formed XML (" + document_.ErrorName() + ")");
  }

  void read() {
    const XMLElement* const root = document_.RootElement();
    if (!root || std::string_view(root->Name()) != "VTKFile" ||
        attribute(*root, "type") != "UnstructuredGrid")
      file_.fail("this is no unstructured grid of VTK");
    read_coding(*root);
    const XMLElement& grid = child(*root, "UnstructuredGrid");
    const XMLElement& piece = child(grid, "Piece");
    if (piece.NextSiblingElement("Piece")) file_.fail(std::string(kWhatIsNeeded));
    file_.n_points_ = number(piece, "NumberOfPoints");
    file_.n_items_ = number(piece, "NumberOfCells");
    // What follows is multiplied by at most 24.
    if (std::max(file_.n_points_, file_.n_items_) > file_.in_.size())
      file_.fail("it announces more points or cells than it has bytes");
    file_.points_ = array(child(child(piece, "Points"), "DataArray"));
    if (file_.points_.components != 3) file_.fail("points must have 3 components");
    const XMLElement& cells = child(piece, "Cells");
    file_.corners_ = named(cells, "connectivity");
    file_.ends_ = named(cells, "offsets");
    file_.types_ = named(cells, "types");
    read_labels(piece);
    if (const XMLElement* const data = grid.FirstChildElement("FieldData")) read_names(*data);
  }

 private:
  const XMLElement& child(const XMLElement& parent, const char* tag) const {
    const XMLElement* const found = parent.FirstChildElement(tag);
    if (!found) file_.fail(std::string("there is no <") + tag + "> in <" + shown(parent.Name()) + ">");
    return *found;
  }
  std::uint64_t number(const XMLElement& element, const char* name) const {
    const auto found = number_attribute(element, name);
    if (!found) file_.fail("<" + shown(element.Name()) + ">: attribute " + name + " must be a number");
    return *found;
  }

  void read_coding(const XMLElement& root) {
    const std::string_view order = attribute(root, "byte_order"), header = attribute(root, "header_type");
    file_.coding_.swap = (order == "BigEndian") != (std::endian::native == std::endian::big);
    file_.coding_.wide_header = header == "UInt64";
    if ((order != "LittleEndian" && order != "BigEndian" && !order.empty()) ||
        (header != "UInt32" && header != "UInt64" && !header.empty()))
      file_.fail("unknown byte_order or header_type");
    if (!attribute(root, "compressor").empty() || attribute(child(root, "AppendedData"), "encoding") != "raw")
      file_.fail(std::string(kWhatIsNeeded));
  }

  Array array(const XMLElement& element) const {
    Array array;
    array.name = attribute(element, "Name");
    const auto type = vtu_number_type(attribute(element, "type"));
    if (!type || attribute(element, "format") != "appended")
      file_.fail("array '" + shown(array.name) + "': " + std::string(kWhatIsNeeded));
    array.type = *type;
    array.components = attribute(element, "NumberOfComponents").empty()
                           ? 1
                           : std::max<std::uint64_t>(number(element, "NumberOfComponents"), 1);
    const std::uint64_t offset = number(element, "offset"), word = file_.coding_.wide_header ? 8 : 4;
    if (offset > file_.in_.size() - first_byte_ || word > file_.in_.size() - first_byte_ - offset)
      file_.fail("array '" + shown(array.name) + "': the file ends too early");
    array.begin = first_byte_ + offset + word;
    return array;
  }
  Array integers(const XMLElement& element) const {
    Array found = array(element);
    if (!is_integer(found.type) || found.components != 1)
      file_.fail("array '" + shown(found.name) + "' must hold one integer each");
    return found;
  }
  Array named(const XMLElement& section, std::string_view name) const {
    for (const XMLElement* e = section.FirstChildElement("DataArray"); e;
         e = e->NextSiblingElement("DataArray"))
      if (attribute(*e, "Name") == name) return integers(*e);
    file_.fail("there is no array '" + std::string(name) + "'");
  }

  /// The array by which the reader for shared memory goes, too: the best name of those that hold labels.
  static const XMLElement* label_array(const XMLElement* arrays, std::span<const std::string_view> names) {
    for (const std::string_view name : names)
      for (const XMLElement* e = arrays ? arrays->FirstChildElement() : nullptr; e;
           e = e->NextSiblingElement()) {
        const auto components = number_attribute(*e, "NumberOfComponents").value_or(1);  // 0 means 1, too
        const auto type = vtu_number_type(attribute(*e, "type"));
        if (lower(std::string(attribute(*e, "Name"))) == name && components <= 1 && type && is_integer(*type))
          return e;
      }
    return nullptr;
  }
  void read_labels(const XMLElement& piece) {
    const XMLElement* const of_points = piece.FirstChildElement("PointData");
    const XMLElement* const of_cells = piece.FirstChildElement("CellData");
    const XMLElement* const labels = label_array(of_points, kVtkPointLabelNames);
    const XMLElement* const fixed = label_array(of_points, {{kVtkFixedArray}});
    const XMLElement* const regions = label_array(of_cells, kVtkCellLabelNames);
    if (labels) file_.vertex_labels_ = integers(*labels);
    if (fixed) file_.fixed_ = integers(*fixed);
    if (regions) file_.regions_ = integers(*regions);
    const auto read_others = [&](const XMLElement* arrays, const char* of,
                                 std::span<const std::string_view> names, const XMLElement* taken,
                                 std::vector<Array>& others) {
      const auto end =
          taken ? std::ranges::find(names, lower(std::string(attribute(*taken, "Name")))) : names.end();
      for (const XMLElement* e = arrays ? arrays->FirstChildElement() : nullptr; e;
           e = e->NextSiblingElement())
        if (e != labels && e != fixed && e != regions) add_other(*e, of, {names.begin(), end}, others);
    };
    read_others(of_points, "points", kVtkPointLabelNames, labels, file_.point_arrays_);
    read_others(of_cells, "cells", kVtkCellLabelNames, regions, file_.cell_arrays_);
  }
  /// `label_names`: of what would be labels rather than those that were found. In shared memory these may be
  /// reals that are all whole, which is for the values to say.
  void add_other(const XMLElement& element, const char* of, std::span<const std::string_view> label_names,
                 std::vector<Array>& others) {
    const std::string name(attribute(element, "Name"));
    const auto type = vtu_number_type(attribute(element, "type"));
    const bool may_be_labels =
        type && !is_integer(*type) && number_attribute(element, "NumberOfComponents").value_or(1) <= 1 &&
        (lower(name) == kVtkFixedArray || std::ranges::find(label_names, lower(name)) != label_names.end());
    if (!type || attribute(element, "format") != "appended" || name == kVtkNumberArray || may_be_labels) {
      file_.notes_.push_back("array '" + shown(name) + "' of " + of + " left out");
      return;
    }
    Array found = array(element);
    if (found.components > kMostComponents) file_.fail("array '" + shown(name) + "': too many components");
    if (name.empty()) found.name = "unnamed";
    if (std::ranges::any_of(others, [&](const Array& other) { return other.name == found.name; }))
      file_.notes_.push_back("a second array '" + shown(found.name) + "' of " + of + " left out");
    else
      others.push_back(std::move(found));
  }
  void read_names(const XMLElement& data) {
    for (const XMLElement* e = data.FirstChildElement("DataArray"); e;
         e = e->NextSiblingElement("DataArray")) {
      if (attribute(*e, "Name") != kVtkNamesArray) {
        file_.notes_.push_back("array '" + shown(attribute(*e, "Name")) + "' of the whole left out");
        continue;
      }
      const Array names = array(*e);
      const std::uint64_t n = file_.announced(names);
      if (names.type != NumberType::kUInt8 || n > kMostNames || n > file_.in_.size() - names.begin)
        file_.fail("array '" + std::string(kVtkNamesArray) + "': these are no names of labels");
      MeshData read;
      io::read_names(file_.in_.bytes(names.begin, n), read);
      file_.names_ = std::move(read.names);
    }
  }

  static constexpr std::uint64_t kMostNames = std::uint64_t{1} << 24;
  static constexpr std::uint64_t kMostComponents = std::uint64_t{1} << 20;

  VtuSlices& file_;
  std::uint64_t first_byte_;  // of appended data
  tinyxml2::XMLDocument document_;
};

VtuSlices::VtuSlices(const std::filesystem::path& path) : in_(path) {
  Header(*this, head()).read();
  require_length(points_, n_points_);
  require_length(ends_, n_items_);
  require_length(types_, n_items_);
  require_length(corners_, n_items_ == 0 ? 0 : ends(n_items_ - 1, n_items_)[0]);
  if (regions_.components > 0) require_length(regions_, n_items_);
  if (vertex_labels_.components > 0) require_length(vertex_labels_, n_points_);
  if (fixed_.components > 0) require_length(fixed_, n_points_);
  for (const Array& array : point_arrays_) require_length(array, n_points_);
  for (const Array& array : cell_arrays_) require_length(array, n_items_);
}

std::vector<ShareField> VtuSlices::shapes(const std::vector<Array>& arrays) {
  std::vector<ShareField> shapes;
  for (const Array& array : arrays)
    shapes.push_back({array.name, static_cast<int>(array.components), is_integer(array.type)});
  return shapes;
}

/// Of each of these points or elements all components of all arrays.
std::vector<double> VtuSlices::rows(const std::vector<Array>& arrays, std::uint64_t begin,
                                    std::uint64_t end) {
  std::size_t width = 0, first = 0;
  for (const Array& array : arrays) width += static_cast<std::size_t>(array.components);
  std::vector<double> rows(width * (end - begin));
  for (const Array& array : arrays) {
    const auto n = static_cast<std::size_t>(array.components);
    const std::vector<double> values = numbers<double>(array, begin, end);
    for (std::size_t i = 0; i < values.size() / n; ++i)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * n), n,
                  rows.begin() + static_cast<std::ptrdiff_t>(i * width + first));
    first += n;
  }
  return rows;
}

/// Those of the tetrahedra, and whether others have values.
void VtuSlices::take_rows(std::uint64_t begin, const std::vector<std::uint8_t>& types, ShareItems& items) {
  if (cell_arrays_.empty()) return;
  const std::vector<double> all = rows(cell_arrays_, begin, begin + types.size());
  const std::size_t width = all.size() / types.size();
  items.has_other_values.assign(cell_arrays_.size(), 0);
  for (std::size_t i = 0; i < types.size(); ++i) {
    auto row = all.begin() + static_cast<std::ptrdiff_t>(i * width);
    if (types[i] == kVtkTetra) {
      items.cell_rows.insert(items.cell_rows.end(), row, row + static_cast<std::ptrdiff_t>(width));
      continue;
    }
    for (std::size_t a = 0; a < cell_arrays_.size(); ++a)
      for (std::uint64_t k = 0; k < cell_arrays_[a].components; ++k)
        if (*row++ != 0.0) items.has_other_values[a] = 1;
  }
}

/// Up to the underscore with which appended data begin.
std::string VtuSlices::head() {
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 16, kMost = std::uint64_t{1} << 24;
  std::string text;
  while (text.size() < std::min(in_.size(), kMost)) {
    text += in_.bytes(text.size(), std::min(kPiece, in_.size() - text.size()));
    const std::size_t tag = text.find("<AppendedData");
    if (tag == std::string::npos) continue;
    const std::size_t end = text.find('>', tag);
    const std::size_t underscore = end == std::string::npos ? end : text.find('_', end);
    if (underscore == std::string::npos) continue;
    if (!trimmed(std::string_view(text).substr(end + 1, underscore - end - 1)).empty()) break;
    return text.substr(0, underscore + 1);
  }
  fail(std::string(kWhatIsNeeded));
}

/// Bytes that the word before an array tells.
std::uint64_t VtuSlices::announced(const Array& array) {
  const std::uint64_t word = coding_.wide_header ? 8 : 4;
  const std::string text = in_.bytes(array.begin - word, word);
  return word == 8 ? loaded<std::uint64_t>(text.data(), coding_.swap)
                   : loaded<std::uint32_t>(text.data(), coding_.swap);
}

void VtuSlices::require_length(const Array& array, std::uint64_t n) {
  const std::uint64_t found = announced(array), word = coding_.wide_header ? 8 : 4;
  const std::string where =
      "at byte " + std::to_string(array.begin - word) + ": array '" + shown(array.name) + "'";
  const std::uint64_t needed = n * array.components * size_of(array.type);
  if (found != needed || n > in_.size())  // which no product of it has more than 64 bits for
    fail(where + ": it has " + std::to_string(found) + " bytes, but " + std::to_string(n) +
         " entries are needed for " + std::to_string(n_points_) + " points and " + std::to_string(n_items_) +
         " cells");
  if (needed > in_.size() - array.begin) fail(where + ": the file ends too early");
}

template <class T>
std::vector<T> VtuSlices::numbers(const Array& array, std::uint64_t begin, std::uint64_t end) {
  const std::uint64_t size = array.components * size_of(array.type);
  std::vector<T> values((end - begin) * array.components);
  convert_numbers(array.type, coding_.swap, in_.bytes(array.begin + begin * size, (end - begin) * size),
                  values.data());
  return values;
}

std::vector<Vec3> VtuSlices::points(std::uint64_t begin, std::uint64_t end) {
  const std::vector<double> values = numbers<double>(points_, begin, end);
  std::vector<Vec3> points;
  points.reserve(end - begin);
  for (std::size_t i = 0; i < values.size(); i += 3) {
    points.push_back({values[i], values[i + 1], values[i + 2]});
    if (const Vec3 p = points.back(); !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      fail("point " + std::to_string(begin + i / 3) + ": a coordinate is not finite");
  }
  return points;
}

std::vector<std::uint8_t> VtuSlices::types(std::uint64_t begin, std::uint64_t end) {
  std::vector<std::uint8_t> types;
  types.reserve(end - begin);
  for (std::int64_t type : numbers<std::int64_t>(types_, begin, end)) {
    if (type != kVtkTetra && type != kVtkTriangle && type != kVtkLine)
      fail(
          "cell " + std::to_string(begin + types.size()) +
          ": meshes in parts have tetrahedra, triangles and lines of as many vertices as these have corners, "
          "and this is of type " +
          std::to_string(type));
    types.push_back(static_cast<std::uint8_t>(type));
  }
  return types;
}

/// Where the corners of these elements end; within the file, and ascending.
std::vector<std::uint64_t> VtuSlices::ends(std::uint64_t begin, std::uint64_t end) {
  std::vector<std::uint64_t> ends;
  ends.reserve(end - begin);
  for (std::int64_t one : numbers<std::int64_t>(ends_, begin, end)) {
    const std::uint64_t least = ends.empty() ? 0 : ends.back();
    if (one < 0 || static_cast<std::uint64_t>(one) > in_.size() || static_cast<std::uint64_t>(one) < least)
      fail("cell " + std::to_string(begin + ends.size()) + ": its offset " + std::to_string(one) +
           " does not ascend, or there are not so many corners");
    ends.push_back(static_cast<std::uint64_t>(one));
  }
  return ends;
}

VtuSlices::Kinds VtuSlices::kinds(std::uint64_t begin, std::uint64_t end) {
  Kinds kinds;
  for (std::uint8_t type : types(begin, end))
    ++(type == kVtkTetra ? kinds.cells : type == kVtkTriangle ? kinds.triangles : kinds.edges);
  return kinds;
}

template <std::size_t N>
void VtuSlices::take(ShareElements<N>& elements, std::uint64_t number, const std::int64_t* corners,
                     std::int32_t label) const {
  const auto refuse = [&](const std::string& message) {
    fail("cell " + std::to_string(number) + ": " + message);
  };
  auto& v = elements.corners.emplace_back();
  for (std::size_t k = 0; k < N; ++k) {
    v[k] = static_cast<std::uint64_t>(corners[k]);
    if (v[k] >= n_points_)
      refuse("vertex " + std::to_string(corners[k]) + " is out of range (there are " +
             std::to_string(n_points_) + " points)");
    for (std::size_t j = 0; j < k; ++j)
      if (v[j] == v[k]) refuse("two of its vertices are the same");
  }
  elements.labels.push_back(label);
}

ShareItems VtuSlices::items(std::uint64_t begin, std::uint64_t end) {
  ShareItems items;
  if (begin == end) return items;
  const std::vector<std::uint8_t> types = this->types(begin, end);
  const std::vector<std::uint64_t> ends = this->ends(begin, end);
  const std::uint64_t first = begin == 0 ? 0 : this->ends(begin - 1, begin)[0];
  std::vector<std::int32_t> labels(types.size(), 0);
  if (regions_.components > 0) labels = this->labels(regions_, "cell", begin, end);
  for (std::size_t i = 0, at = first; i < types.size(); at = ends[i++]) {
    const std::uint64_t n = types[i] == kVtkTetra ? 4 : types[i] == kVtkTriangle ? 3 : 2;
    if (ends[i] < at || ends[i] - at != n)
      fail("cell " + std::to_string(begin + i) + ": it has another number of corners than its type");
  }
  const std::vector<std::int64_t> corners = numbers<std::int64_t>(corners_, first, ends.back());
  for (std::size_t i = 0, at = 0; i < types.size(); at = ends[i++] - first) {
    if (types[i] == kVtkTetra) take(items.cells, begin + i, &corners[at], labels[i]);
    if (types[i] == kVtkTriangle) take(items.triangles, begin + i, &corners[at], labels[i]);
    if (types[i] == kVtkLine) take(items.edges, begin + i, &corners[at], labels[i]);
  }
  take_rows(begin, types, items);
  return items;
}

std::vector<std::int32_t> VtuSlices::labels(const Array& array, const char* of, std::uint64_t begin,
                                            std::uint64_t end) {
  const std::vector<std::int64_t> values = numbers<std::int64_t>(array, begin, end);
  std::vector<std::int32_t> labels(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    labels[i] = static_cast<std::int32_t>(values[i]);
    if (labels[i] != values[i])
      fail(std::string(of) + " " + std::to_string(begin + i) + ": its label has more than 32 bits");
  }
  return labels;
}

std::vector<std::int32_t> VtuSlices::vertex_labels(std::uint64_t begin, std::uint64_t end) {
  if (vertex_labels_.components == 0) return {};
  return labels(vertex_labels_, "point", begin, end);
}

std::vector<std::uint8_t> VtuSlices::fixed(std::uint64_t begin, std::uint64_t end) {
  std::vector<std::uint8_t> fixed;
  if (fixed_.components == 0) return fixed;
  fixed.reserve(end - begin);
  for (std::int64_t value : numbers<std::int64_t>(fixed_, begin, end)) {
    if (value != 0 && value != 1)
      fail("point " + std::to_string(begin + fixed.size()) + ": 0 or 1 has to stand in the array 'fixed'");
    fixed.push_back(static_cast<std::uint8_t>(value));
  }
  return fixed;
}

}  // namespace hfr::io
