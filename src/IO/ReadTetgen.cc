// SPDX-License-Identifier: BSD-3-Clause
// The file formats of TetGen: H. Si, "TetGen, a Delaunay-based quality tetrahedral mesh generator", ACM TOMS
// 41(2), 2015, and its manual. One mesh is several files of one stem: .node, .ele, .face and .edge.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/Linearise.hh"
#include "IO/TextScanner.hh"
#include "IO/Validate.hh"

namespace hfr::io {
namespace {

/// A file of the set, or nothing when there is none.
struct Part {
  Part(const std::filesystem::path& any, const char* extension) : path(file_beside(any, extension)) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return;
    file.emplace(path);
    text.emplace(file->bytes(), path.string(), '#');
  }
  std::filesystem::path path;
  std::optional<InputFile> file;
  std::optional<TextScanner> text;
};

class TetgenReader {
 public:
  explicit TetgenReader(const std::filesystem::path& path)
      : nodes_(path, ".node"), cells_(path, ".ele"), faces_(path, ".face"), edges_(path, ".edge") {}

  MeshData read() {
    if (!nodes_.file) {
      throw IoError(nodes_.path.string() + ": cannot be opened: the points of a TetGen mesh are missing");
    }
    read_nodes(*nodes_.text);
    if (cells_.text) {
      read_cells(*cells_.text);
    } else {
      mesh_.notes.push_back("there is no " + cells_.path.filename().string() + ": the mesh has no cells");
    }
    if (faces_.text) read_elements<3>(*faces_.text, mesh_.triangles, mesh_.triangle_labels);
    if (edges_.text) read_elements<2>(*edges_.text, mesh_.edges, mesh_.edge_labels);
    drop_midside_points(mesh_, midside_);
    return std::move(mesh_);
  }

 private:
  /// The number that a line begins with: counted from 0 or from 1, as the first one says.
  static void take_number(TextScanner& in, std::size_t i, std::int64_t& first) {
    if (i == 0) {
      first = in.integer_in(0, 1, "first number");
    } else {
      const auto expected = first + static_cast<std::int64_t>(i);
      in.integer_in(expected, expected, "number");
    }
  }

  void expect_end(TextScanner& in) {
    if (!in.at_end()) in.fail("more lines than the first line says");
    if (!in.ends_with_line_break()) {
      mesh_.notes.push_back(std::filesystem::path(in.name()).filename().string() +
                            ": the last line has no end; the file may have been cut short");
    }
  }

  static int label(TextScanner& in) {
    using Limits = std::numeric_limits<int>;
    return static_cast<int>(in.integer_in(Limits::min(), Limits::max(), "boundary marker"));
  }

  Index vertex(TextScanner& in) const {
    const auto n = static_cast<std::int64_t>(mesh_.points.size());
    return static_cast<Index>(in.integer_in(base_, n - 1 + base_, "vertex") - base_);
  }

  static std::vector<Field> attributes(std::int64_t n, std::size_t n_items) {
    std::vector<Field> fields(static_cast<std::size_t>(n));
    for (std::size_t i = 0; i < fields.size(); ++i) {
      fields[i].name = "attribute_" + std::to_string(i + 1);
      fields[i].values.reserve(n_items);
    }
    return fields;
  }

  void read_nodes(TextScanner& in) {
    const std::size_t n = in.count(4, "number of points");
    in.integer_in(3, 3, "dimension");
    const std::int64_t n_attributes = in.integer_in(0, most_attributes(in, n), "number of attributes");
    const bool has_markers = in.integer_in(0, 1, "boundary marker flag") == 1;
    mesh_.points.reserve(n);
    mesh_.point_fields = attributes(n_attributes, n);
    for (std::size_t i = 0; i < n; ++i) {
      take_number(in, i, base_);
      Vec3 p;
      p.x = in.real();
      p.y = in.real();
      p.z = in.real();
      mesh_.points.push_back(p);
      for (Field& field : mesh_.point_fields) field.values.push_back(in.field_value());
      if (has_markers) mesh_.vertex_labels.push_back(label(in));
    }
    expect_end(in);
  }

  /// So many attributes at most can stand in the rest of the file; with no items, a limit all the same.
  static std::int64_t most_attributes(const TextScanner& in, std::size_t n_items) {
    constexpr std::size_t kMost = 10000;
    return static_cast<std::int64_t>(
        std::min(kMost, in.text().size() / 2 / std::max<std::size_t>(n_items, 1)));
  }

  void read_cells(TextScanner& in) {
    const std::size_t n = in.count(5, "number of cells");
    const std::int64_t n_corners = in.integer();
    if (n_corners != 4 && n_corners != 10)
      in.fail("cells of " + std::to_string(n_corners) + " points: only 4 or 10 are read");
    std::vector<Field> fields =
        attributes(in.integer_in(0, most_attributes(in, n), "number of attributes"), n);
    mesh_.cells.reserve(n);
    std::int64_t first = 0;
    for (std::size_t i = 0; i < n; ++i) {
      take_number(in, i, first);
      std::array<Index, 4> cell;
      for (Index& corner : cell) corner = vertex(in);
      for (std::int64_t k = 4; k < n_corners; ++k) midside_.push_back(vertex(in));
      mesh_.cells.push_back(cell);
      for (Field& field : fields) field.values.push_back(in.field_value());
    }
    expect_end(in);
    if (n_corners == 10 && n > 0) {
      mesh_.notes.push_back(std::to_string(n) +
                            " cells of 10 points were made linear: the points of their edges are left out");
    }
    take_regions(fields);
    mesh_.cell_fields = std::move(fields);
  }

  /// The first attribute is the region if it is whole everywhere, even when it is written as 3.0.
  void take_regions(std::vector<Field>& fields) {
    if (fields.empty()) return;
    const std::vector<double>& values = fields[0].values;
    const auto is_whole = [](double value) { return value == std::trunc(value); };
    if (!std::all_of(values.begin(), values.end(), is_whole)) return;
    const auto beyond = std::find_if_not(values.begin(), values.end(), is_label);
    if (beyond != values.end()) {
      mesh_.notes.push_back("the first attribute of cell " + std::to_string(beyond - values.begin()) +
                            " is larger than a region's number can be: the attributes are kept as a field");
      return;
    }
    mesh_.regions.assign(values.begin(), values.end());
    fields.erase(fields.begin());
  }

  /// Number of words on the first line of elements. TetGen's -o2 and -nn add columns that no header
  /// announces.
  static std::int64_t columns(const TextScanner& in) {
    TextScanner ahead = in;
    if (ahead.at_end()) return 0;
    TextScanner line(ahead.rest_of_line(), in.name(), '#');
    std::int64_t n = 0;
    for (; !line.at_end(); ++n) line.word();
    return n;
  }

  template <std::size_t N>
  void read_elements(TextScanner& in, std::vector<std::array<Index, N>>& elements, std::vector<int>& labels) {
    constexpr std::int64_t kMidside = N == 3 ? 3 : 1;
    const std::size_t n = in.count(N + 1, N == 3 ? "number of faces" : "number of edges");
    const std::string_view flag = in.rest_of_line();
    // It may be left out: then the first line shows whether something stands behind the corners.
    const bool has_markers =
        flag.empty() ? columns(in) > 1 + static_cast<std::int64_t>(N) : !flag.starts_with('0');
    const std::int64_t extra = columns(in) - 1 - static_cast<std::int64_t>(N) - (has_markers ? 1 : 0);
    const bool second_order = N == 3 ? extra >= kMidside : extra >= kMidside && !midside_.empty();
    elements.reserve(n);
    std::int64_t first = 0;
    for (std::size_t i = 0; i < n; ++i) {
      take_number(in, i, first);
      std::array<Index, N> element;
      for (Index& corner : element) corner = vertex(in);
      for (std::int64_t k = 0; second_order && k < kMidside; ++k) midside_.push_back(vertex(in));
      elements.push_back(element);
      labels.push_back(has_markers ? label(in) : 0);
      in.rest_of_line();
    }
    expect_end(in);
  }

  Part nodes_;
  Part cells_;
  Part faces_;
  Part edges_;
  MeshData mesh_;
  std::vector<Index> midside_;
  std::int64_t base_ = 0;
};

}  // namespace

MeshData read_tetgen(const InputFile& file) { return TetgenReader(file.path()).read(); }

}  // namespace hfr::io
