// SPDX-License-Identifier: BSD-3-Clause
#include "IO/VtuSlices.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>

#include "HalfFace/Errors.hh"
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
    if (grid.FirstChildElement("FieldData")) file_.notes_.push_back("field data (names of labels) left out");
    file_.n_points_ = number(piece, "NumberOfPoints");
    file_.n_cells_ = number(piece, "NumberOfCells");
    // What follows is multiplied by at most 24.
    if (std::max(file_.n_points_, file_.n_cells_) > file_.size_)
      file_.fail("it announces more points or cells than it has bytes");
    file_.points_ = array(child(child(piece, "Points"), "DataArray"));
    if (file_.points_.components != 3) file_.fail("points must have 3 components");
    const XMLElement& cells = child(piece, "Cells");
    file_.corners_ = named(cells, "connectivity");
    file_.ends_ = named(cells, "offsets");
    file_.types_ = named(cells, "types");
    read_labels(piece);
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
    if (offset > file_.size_ - first_byte_ || word > file_.size_ - first_byte_ - offset)
      file_.fail("array '" + shown(array.name) + "': the file ends too early");
    array.begin = first_byte_ + offset + word;
    return array;
  }
  Array named(const XMLElement& section, std::string_view name) const {
    for (const XMLElement* e = section.FirstChildElement("DataArray"); e;
         e = e->NextSiblingElement("DataArray")) {
      if (attribute(*e, "Name") != name) continue;
      Array found = array(*e);
      if (!is_integer(found.type) || found.components != 1)
        file_.fail("array '" + std::string(name) + "' must hold one integer each");
      return found;
    }
    file_.fail("there is no array '" + std::string(name) + "'");
  }

  void read_labels(const XMLElement& piece) {
    const auto each = [&](const char* section, auto&& use) {
      const XMLElement* const arrays = piece.FirstChildElement(section);
      for (const XMLElement* e = arrays ? arrays->FirstChildElement() : nullptr; e;
           e = e->NextSiblingElement())
        use(*arrays, attribute(*e, "Name"));
    };
    each("PointData", [&](const XMLElement&, std::string_view name) {
      if (name == kVtkLabelArray || name == kVtkFixedArray)
        file_.fail(
            "meshes in parts do not have labelled or fixed faces, edges and vertices yet, and this one "
            "has an array '" +
            shown(name) + "' of points");
      file_.notes_.push_back("array '" + shown(name) + "' of points left out");
    });
    each("CellData", [&](const XMLElement& arrays, std::string_view name) {
      if (name == kVtkRegionArray)
        file_.regions_ = named(arrays, name);
      else
        file_.notes_.push_back("array '" + shown(name) + "' of cells left out");
    });
  }

  VtuSlices& file_;
  std::uint64_t first_byte_;  // of appended data
  tinyxml2::XMLDocument document_;
};

VtuSlices::VtuSlices(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  if (!error) in_.open(path, std::ios::binary);
  if (error || !in_) throw IoError(name_ + ": cannot be opened" + (error ? ": " + error.message() : ""));
  Header(*this, head()).read();
  require_length(points_, n_points_);
  require_length(corners_, 4 * n_cells_);
  require_length(ends_, n_cells_);
  require_length(types_, n_cells_);
  if (has_regions()) require_length(regions_, n_cells_);
}

void VtuSlices::fail(const std::string& message) const { throw InvalidInput(name_ + ": " + message); }

/// Up to the underscore with which appended data begin.
std::string VtuSlices::head() {
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 16, kMost = std::uint64_t{1} << 24;
  std::string text;
  while (text.size() < std::min(size_, kMost)) {
    text += bytes(text.size(), std::min(kPiece, size_ - text.size()));
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

std::string VtuSlices::bytes(std::uint64_t begin, std::uint64_t n) {
  std::string bytes(n, '\0');
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(begin));
  if (!in_.read(bytes.data(), static_cast<std::streamsize>(n)))
    throw IoError(name_ + ": at byte " + std::to_string(begin) + ": cannot be read");
  return bytes;
}

void VtuSlices::require_length(const Array& array, std::uint64_t n) {
  const std::uint64_t word = coding_.wide_header ? 8 : 4;
  const std::string text = bytes(array.begin - word, word);
  const std::uint64_t announced = word == 8 ? loaded<std::uint64_t>(text.data(), coding_.swap)
                                            : loaded<std::uint32_t>(text.data(), coding_.swap);
  const std::uint64_t needed = n * array.components * size_of(array.type);
  const std::string where =
      "at byte " + std::to_string(array.begin - word) + ": array '" + shown(array.name) + "'";
  if (announced != needed)
    fail(where + ": it has " + std::to_string(announced) + " bytes, but " + std::to_string(needed) +
         " are needed for " + std::to_string(n_points_) + " points and " + std::to_string(n_cells_) +
         " tetrahedra: meshes in parts have no other elements yet; without labelled triangles and edges "
         "it would be read, and hfremesh-mpi without 'parts' takes them");
  if (needed > size_ - array.begin) fail(where + ": the file ends too early");
}

template <class T>
std::vector<T> VtuSlices::numbers(const Array& array, std::uint64_t begin, std::uint64_t end) {
  const std::uint64_t size = array.components * size_of(array.type);
  std::vector<T> values((end - begin) * array.components);
  convert_numbers(array.type, coding_.swap, bytes(array.begin + begin * size, (end - begin) * size),
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

std::vector<std::array<std::uint64_t, 4>> VtuSlices::cells(std::uint64_t begin, std::uint64_t end) {
  const auto refuse = [&](std::uint64_t cell, const std::string& message) {
    fail("cell " + std::to_string(cell) + ": " + message);
  };
  {
    const auto types = numbers<std::int64_t>(types_, begin, end),
               ends = numbers<std::int64_t>(ends_, begin, end);
    for (std::uint64_t c = begin; c < end; ++c)
      if (types[c - begin] != kVtkTetra || static_cast<std::uint64_t>(ends[c - begin]) != 4 * (c + 1))
        refuse(c, "meshes in parts have tetrahedra of four vertices alone");
  }
  // Ranges of the array of corners have four numbers for each cell.
  Array by_cell = corners_;
  by_cell.components = 4;
  const std::vector<std::int64_t> corners = numbers<std::int64_t>(by_cell, begin, end);
  std::vector<std::array<std::uint64_t, 4>> cells(end - begin);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      cells[c][k] = static_cast<std::uint64_t>(corners[4 * c + k]);
      if (cells[c][k] >= n_points_)
        refuse(begin + c, "vertex " + std::to_string(corners[4 * c + k]) + " is out of range (there are " +
                              std::to_string(n_points_) + " points)");
      for (std::size_t j = 0; j < k; ++j)
        if (cells[c][j] == cells[c][k]) refuse(begin + c, "two of its vertices are the same");
    }
  return cells;
}

std::vector<std::int32_t> VtuSlices::regions(std::uint64_t begin, std::uint64_t end) {
  const std::vector<std::int64_t> values = numbers<std::int64_t>(regions_, begin, end);
  std::vector<std::int32_t> regions(values.size());
  for (std::size_t c = 0; c < values.size(); ++c) {
    regions[c] = static_cast<std::int32_t>(values[c]);
    if (regions[c] != values[c])
      fail("cell " + std::to_string(begin + c) + ": its region has more than 32 bits");
  }
  return regions;
}

}  // namespace hfr::io
