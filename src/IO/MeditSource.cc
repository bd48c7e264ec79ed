// SPDX-License-Identifier: BSD-3-Clause
#include "IO/MeditSource.hh"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "HalfFace/Errors.hh"

namespace hfr::io::medit {
namespace {

struct Entry {
  int code;
  std::string_view name;
};

/// Keywords whose sections begin with a count.
constexpr Entry kKeywords[] = {
    {4, "Vertices"},
    {5, "Edges"},
    {6, "Triangles"},
    {7, "Quadrilaterals"},
    {8, "Tetrahedra"},
    {9, "Prisms"},
    {10, "Hexahedra"},
    {13, "Corners"},
    {14, "Ridges"},
    {15, "RequiredVertices"},
    {16, "RequiredEdges"},
    {17, "RequiredTriangles"},
    {18, "RequiredQuadrilaterals"},
    {19, "TangentAtEdgeVertices"},
    {20, "NormalAtVertices"},
    {21, "NormalAtTriangleVertices"},
    {22, "NormalAtQuadrilateralVertices"},
    {24, "TrianglesP2"},
    {25, "EdgesP2"},
    {26, "SolAtPyramids"},
    {27, "QuadrilateralsQ2"},
    {29, "SubDomainFromGeom"},
    {30, "TetrahedraP2"},
    {33, "HexahedraQ2"},
    {40, "VerticesOnGeometricVertices"},
    {41, "VerticesOnGeometricEdges"},
    {42, "VerticesOnGeometricTriangles"},
    {44, "EdgesOnGeometricEdges"},
    {46, "Polyhedra"},
    {49, "Pyramids"},
    {59, "Tangents"},
    {60, "Normals"},
    {61, "TangentAtVertices"},
    {62, "SolAtVertices"},
    {63, "SolAtEdges"},
    {64, "SolAtTriangles"},
    {65, "SolAtQuadrilaterals"},
    {66, "SolAtTetrahedra"},
    {67, "SolAtPrisms"},
    {68, "SolAtHexahedra"},
    {81, "Comments"},
    {86, "PrismsP2"},
    {87, "PyramidsP2"},
    {90, "TrianglesP3"},
    {91, "TrianglesP4"},
    {92, "EdgesP3"},
    {93, "EdgesP4"},
    {96, "TetrahedraP3"},
    {97, "TetrahedraP4"},
    {98, "HexahedraQ3"},
    {99, "HexahedraQ4"},
    {100, "PyramidsP3"},
    {101, "PyramidsP4"},
    {102, "PrismsP3"},
    {103, "PrismsP4"},
};

constexpr bool is_upper(char c) { return 'A' <= c && c <= 'Z'; }

}  // namespace

bool is_keyword(std::string_view word) {
  return !word.empty() && is_upper(word[0]) && std::all_of(word.begin(), word.end(), [](char c) {
    return is_upper(c) || ('a' <= c && c <= 'z') || ('0' <= c && c <= '9') || c == '_';
  });
}

Heading heading_of(std::string_view name) {
  if (name == "Dimension") return {Keyword::kDimension, 3, name};
  if (name == "End") return {Keyword::kEnd, 54, name};
  for (const Entry& entry : kKeywords) {
    if (entry.name == name) return {static_cast<Keyword>(entry.code), entry.code, entry.name};
  }
  return {Keyword::kUnknown, 0, name};
}

Heading heading_of(int code) {
  for (const Entry& entry : kKeywords) {
    if (entry.code == code) return {static_cast<Keyword>(code), code, entry.name};
  }
  if (code == 3 || code == 54) return {static_cast<Keyword>(code), code, ""};
  return {Keyword::kUnknown, code, ""};
}

bool is_unsupported_cell(std::string_view name) {
  constexpr std::array<std::string_view, 15> kCells = {
      "Prisms",      "PrismsP2",    "PrismsP3",    "PrismsP4",     "Hexahedra",
      "HexahedraQ2", "HexahedraQ3", "HexahedraQ4", "Pyramids",     "PyramidsP2",
      "PyramidsP3",  "PyramidsP4",  "Polyhedra",   "TetrahedraP3", "TetrahedraP4"};
  return std::find(kCells.begin(), kCells.end(), name) != kCells.end();
}

int components_of_type(std::int64_t type) {
  constexpr std::array<int, 5> kComponents = {0, 1, 3, 6, 9};
  return type < 1 || type > 4 ? 0 : kComponents[static_cast<std::size_t>(type)];
}

int type_of_components(int components) {
  for (int type = 1; type <= 4; ++type) {
    if (components_of_type(type) == components) return type;
  }
  return 0;
}

std::string too_few_entries(std::string_view name, std::int64_t announced, std::size_t found) {
  return std::string(name) + " announces " + std::to_string(announced) + " entries and has " +
         std::to_string(found);
}

std::string no_medit_file(std::string_view word) {
  // MFEM's own format has the same suffix. What its PrintVTU writes has points of its own for each cell.
  if (word == "MFEM") return "a mesh of MFEM's own format cannot be read: save it with Mesh::PrintVTK";
  return "not a Medit file: no MeshVersionFormatted";
}

bool is_binary(const InputFile& file) {
  const std::string_view bytes = file.bytes();
  return bytes.starts_with(std::string_view("\1\0\0\0", 4)) ||
         bytes.starts_with(std::string_view("\0\0\0\1", 4));
}

// ---------------------------------------------------------------------------------------------------- ASCII

AsciiSource::AsciiSource(const InputFile& file) : text_(file.bytes(), file.path().string(), '#') {
  const std::string_view first = text_.peek_word();
  if (first != "MeshVersionFormatted") text_.fail(no_medit_file(first));
  text_.word();
  text_.integer_in(1, 4, "version");
}

std::optional<Heading> AsciiSource::next() {
  while (!text_.at_end()) {
    const std::string_view word = text_.peek_word();
    if (!is_keyword(word))
      text_.fail("expected a keyword; the section before may have more entries than it says");
    text_.word();
    const Heading heading = heading_of(word);
    if (heading.keyword == Keyword::kEnd) {
      saw_end_ = true;
      return std::nullopt;
    }
    if (heading.keyword != Keyword::kDimension) return heading;
    text_.integer_in(3, 3, "dimension");
  }
  return std::nullopt;
}

std::size_t AsciiSource::count(std::string_view name, std::size_t integers, std::size_t reals) {
  const std::size_t before = text_.offset();
  const std::int64_t n = text_.integer_in(0, std::numeric_limits<std::int64_t>::max(), "number of entries");
  const std::size_t words = integers + reals;
  // A word takes at least one byte and the space before it.
  const std::size_t bytes_left = text_.text().size() - text_.offset();
  if (static_cast<std::size_t>(n) <= bytes_left / 2 / words) return static_cast<std::size_t>(n);
  std::size_t found = 0;
  for (; !at_section_end(); ++found) text_.word();
  text_.seek(before);
  text_.fail(too_few_entries(name, n, found / words));
}

bool AsciiSource::at_section_end() {
  if (text_.at_end()) return true;
  return is_upper(text_.text()[text_.offset()]) && is_keyword(text_.peek_word());
}

std::size_t AsciiSource::announced() {
  if (text_.at_end()) text_.fail("the file ends in the middle of a section");
  const std::string_view first = text_.peek_word();
  const bool is_count = std::all_of(first.begin(), first.end(), [](char c) { return '0' <= c && c <= '9'; });
  return is_count ? static_cast<std::size_t>(text_.integer()) : 0;
}

void AsciiSource::skip() {
  while (!text_.at_end() && !is_keyword(text_.peek_word())) text_.word();
}

// --------------------------------------------------------------------------------------------------- binary

BinarySource::BinarySource(const InputFile& file) : bytes_(file.bytes()), name_(file.path().string()) {
  constexpr std::int32_t kOne = 1;
  constexpr std::int32_t kSwappedOne = 1 << 24;
  const auto magic = take<std::int32_t>();
  if (magic != kOne && magic != kSwappedOne) {
    at_ = 0;
    fail("not a binary Medit file: it does not begin with the integer 1");
  }
  swapped_ = magic == kSwappedOne;
  version_ = take<std::int32_t>();
  if (version_ < 1 || version_ > 4)
    fail("version " + std::to_string(version_) + " is not known (1 to 4 are)");
  next_ = at_;
}

void BinarySource::fail(std::string_view message) const {
  throw InvalidInput(name_ + ": at byte " + std::to_string(at_) + ": " + std::string(message));
}

template <class T>
T BinarySource::take() {
  std::array<char, sizeof(T)> raw;
  if (bytes_.size() - at_ < raw.size()) fail("the file ends too early");
  std::memcpy(raw.data(), bytes_.data() + at_, raw.size());
  if (swapped_) std::reverse(raw.begin(), raw.end());
  at_ += raw.size();
  return std::bit_cast<T>(raw);
}

std::int64_t BinarySource::integer() { return version_ < 4 ? take<std::int32_t>() : take<std::int64_t>(); }

std::int64_t BinarySource::short_integer() { return take<std::int32_t>(); }

std::uint64_t BinarySource::position() {
  return version_ < 3 ? take<std::uint32_t>() : take<std::uint64_t>();
}

double BinarySource::value() { return version_ == 1 ? take<float>() : take<double>(); }

double BinarySource::coordinate() {
  const double found = value();
  if (!std::isfinite(found)) fail("a coordinate is not finite");
  return found;
}

std::int64_t BinarySource::integer_in(std::int64_t low, std::int64_t high, std::string_view what) {
  const std::int64_t found = integer();
  if (found < low || found > high) [[unlikely]] {
    fail(std::string(what) + " " + std::to_string(found) + " is out of range (" + std::to_string(low) +
         " to " + std::to_string(high) + ")");
  }
  return found;
}

std::size_t BinarySource::count(std::string_view name, std::size_t integers, std::size_t reals) {
  const std::int64_t n = integer_in(0, std::numeric_limits<std::int64_t>::max(), "number of entries");
  const std::size_t entry_size = integers * (version_ < 4 ? 4 : 8) + reals * (version_ == 1 ? 4 : 8);
  const std::size_t found = at_section_end() ? 0 : (section_end() - at_) / entry_size;
  if (static_cast<std::size_t>(n) > found) fail(too_few_entries(name, n, found));
  return static_cast<std::size_t>(n);
}

std::optional<Heading> BinarySource::next() {
  while (next_ != 0 && next_ != bytes_.size()) {
    at_ = next_;
    const Heading heading = heading_of(take<std::int32_t>());
    const std::uint64_t following = position();
    if (heading.keyword == Keyword::kEnd) {
      saw_end_ = true;
      return std::nullopt;
    }
    // Positions must grow, or a broken file would be read in circles.
    if (following != 0 && (following < at_ || following > bytes_.size())) {
      fail("the position of the next section, " + std::to_string(following) + ", is outside the file");
    }
    next_ = static_cast<std::size_t>(following);
    if (heading.keyword != Keyword::kDimension) return heading;
    const auto dimension = take<std::int32_t>();
    if (dimension != 3) fail("dimension " + std::to_string(dimension) + ": only 3 is read");
  }
  return std::nullopt;
}

std::size_t BinarySource::announced() {
  const std::int64_t announced = integer();
  return announced < 0 ? 0 : static_cast<std::size_t>(announced);
}

}  // namespace hfr::io::medit
