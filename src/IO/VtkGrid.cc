// SPDX-License-Identifier: BSD-3-Clause
#include "IO/VtkGrid.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "HalfFace/Errors.hh"
#include "IO/Linearise.hh"
#include "IO/Validate.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

enum class Kind : std::uint8_t { kTetrahedron, kTriangle, kEdge, kVertex, kDropped, kRefused };

struct CellType {
  int id;
  const char* name;
  Kind kind;
  int nodes;    ///< exactly so many; 0: at least as many as corners
  bool curved;  ///< only its corners are kept
};

constexpr CellType kCellTypes[] = {
    {0, "EMPTY_CELL", Kind::kDropped, 0, false},
    {1, "VERTEX", Kind::kVertex, 1, false},
    {2, "POLY_VERTEX", Kind::kDropped, 0, false},
    {3, "LINE", Kind::kEdge, 2, false},
    {4, "POLY_LINE", Kind::kDropped, 0, false},
    {5, "TRIANGLE", Kind::kTriangle, 3, false},
    {6, "TRIANGLE_STRIP", Kind::kDropped, 0, false},
    {7, "POLYGON", Kind::kDropped, 0, false},
    {8, "PIXEL", Kind::kDropped, 0, false},
    {9, "QUAD", Kind::kDropped, 0, false},
    {10, "TETRA", Kind::kTetrahedron, 4, false},
    {11, "VOXEL", Kind::kRefused, 0, false},
    {12, "HEXAHEDRON", Kind::kRefused, 0, false},
    {13, "WEDGE", Kind::kRefused, 0, false},
    {14, "PYRAMID", Kind::kRefused, 0, false},
    {15, "PENTAGONAL_PRISM", Kind::kRefused, 0, false},
    {16, "HEXAGONAL_PRISM", Kind::kRefused, 0, false},
    {21, "QUADRATIC_EDGE", Kind::kEdge, 3, true},
    {22, "QUADRATIC_TRIANGLE", Kind::kTriangle, 6, true},
    {23, "QUADRATIC_QUAD", Kind::kDropped, 0, false},
    {24, "QUADRATIC_TETRA", Kind::kTetrahedron, 10, true},
    {25, "QUADRATIC_HEXAHEDRON", Kind::kRefused, 0, false},
    {26, "QUADRATIC_WEDGE", Kind::kRefused, 0, false},
    {27, "QUADRATIC_PYRAMID", Kind::kRefused, 0, false},
    {28, "BIQUADRATIC_QUAD", Kind::kDropped, 0, false},
    {29, "TRIQUADRATIC_HEXAHEDRON", Kind::kRefused, 0, false},
    {30, "QUADRATIC_LINEAR_QUAD", Kind::kDropped, 0, false},
    {31, "QUADRATIC_LINEAR_WEDGE", Kind::kRefused, 0, false},
    {32, "BIQUADRATIC_QUADRATIC_WEDGE", Kind::kRefused, 0, false},
    {33, "BIQUADRATIC_QUADRATIC_HEXAHEDRON", Kind::kRefused, 0, false},
    {34, "BIQUADRATIC_TRIANGLE", Kind::kTriangle, 7, true},
    {35, "CUBIC_LINE", Kind::kEdge, 4, true},
    {36, "QUADRATIC_POLYGON", Kind::kDropped, 0, false},
    {37, "TRIQUADRATIC_PYRAMID", Kind::kRefused, 0, false},
    {41, "CONVEX_POINT_SET", Kind::kRefused, 0, false},
    {42, "POLYHEDRON", Kind::kRefused, 0, false},
    {68, "LAGRANGE_CURVE", Kind::kEdge, 0, true},
    {69, "LAGRANGE_TRIANGLE", Kind::kTriangle, 0, true},
    {70, "LAGRANGE_QUADRILATERAL", Kind::kDropped, 0, false},
    {71, "LAGRANGE_TETRAHEDRON", Kind::kTetrahedron, 0, true},
    {72, "LAGRANGE_HEXAHEDRON", Kind::kRefused, 0, false},
    {73, "LAGRANGE_WEDGE", Kind::kRefused, 0, false},
    {74, "LAGRANGE_PYRAMID", Kind::kRefused, 0, false},
    {75, "BEZIER_CURVE", Kind::kEdge, 0, true},
    {76, "BEZIER_TRIANGLE", Kind::kTriangle, 0, true},
    {77, "BEZIER_QUADRILATERAL", Kind::kDropped, 0, false},
    {78, "BEZIER_TETRAHEDRON", Kind::kTetrahedron, 0, true},
    {79, "BEZIER_HEXAHEDRON", Kind::kRefused, 0, false},
    {80, "BEZIER_WEDGE", Kind::kRefused, 0, false},
    {81, "BEZIER_PYRAMID", Kind::kRefused, 0, false},
};

std::string counted(std::size_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

constexpr double kLowestLabel = std::numeric_limits<int>::min();
constexpr double kHighestLabel = std::numeric_limits<int>::max();

/// Takes the array with the best of the known names out of `fields`. Integers that no label can hold would
/// leave the regions of a mesh unknown, so they are refused; real numbers may well mean something else.
std::optional<Field> take_labels(std::vector<Field>& fields, std::span<const std::string_view> names,
                                 const std::string& kind, const std::string& file,
                                 std::vector<std::string>& notes) {
  for (const std::string_view name : names) {
    for (auto field = fields.begin(); field != fields.end(); ++field) {
      if (lower(field->name) != name || field->components != 1) continue;
      const auto& values = field->values;
      const auto odd = std::find_if_not(values.begin(), values.end(), is_label);
      if (odd == values.end()) {
        Field labels = std::move(*field);
        fields.erase(field);
        return labels;
      }
      const bool whole =
          std::all_of(values.begin(), values.end(), [](double v) { return v == std::trunc(v); });
      if (!whole) continue;
      const std::string what =
          fmt::format("{0} array '{1}': {2} of {0} {3} is no label, as labels go from {4:.0f} to {5:.0f}",
                      kind, field->name, *odd, odd - values.begin(), kLowestLabel, kHighestLabel);
      if (field->integer) throw InvalidInput(file + ": " + what);
      notes.push_back(what + ": the array is kept as a field");
    }
  }
  return std::nullopt;
}

/// 0 means "no label": where all are 0 there are none.
void forget_zeros(std::vector<int>& labels) {
  if (std::all_of(labels.begin(), labels.end(), [](int label) { return label == 0; })) labels.clear();
}

/// Moves what a grid holds into a mesh, step by step.
class GridConverter {
 public:
  GridConverter(VtkGrid&& grid, const CornerFailure& fail) : grid_(std::move(grid)), fail_(fail) {}

  MeshData convert() {
    sort_cells();
    report_kinds();
    distribute_cell_labels();
    distribute_cell_fields();
    mesh_.points = std::move(grid_.points);
    take_point_arrays();
    if (n_curved_ > 0) drop_middle_nodes();
    forget_zeros(mesh_.regions);
    forget_zeros(mesh_.vertex_labels);
    read_names(grid_.names, mesh_);
    mesh_.notes.insert(mesh_.notes.begin(), grid_.notes.begin(), grid_.notes.end());
    return std::move(mesh_);
  }

 private:
  void sort_cells();
  template <std::size_t N>
  std::array<Index, N> corners_of(std::size_t cell, std::size_t begin) const;
  void note_middle_nodes(std::size_t begin, std::size_t end, std::size_t n_corners);
  void report_kinds();
  void distribute_cell_labels();
  void distribute_cell_fields();
  void take_point_arrays();
  void drop_middle_nodes();

  bool only_tetrahedra() const { return mesh_.cells.size() == grid_.types.size(); }
  std::vector<int> gathered(const Field& labels, const std::vector<std::size_t>& cells) const;

  VtkGrid grid_;
  const CornerFailure& fail_;
  MeshData mesh_;
  // Which cells of the file became what; filled from the first cell that is no tetrahedron on.
  std::vector<std::size_t> tetrahedra_, triangles_, edges_, vertices_;
  std::map<int, std::size_t> dropped_;  // cell type → how many
  std::size_t n_curved_ = 0;
  std::vector<Index> middle_;  // nodes of curved cells that are none of their corners
};

template <std::size_t N>
std::array<Index, N> GridConverter::corners_of(std::size_t cell, std::size_t begin) const {
  std::array<Index, N> corners;
  for (std::size_t i = 0; i < N; ++i) {
    const std::int64_t corner = grid_.corners[begin + i];
    if (static_cast<std::uint64_t>(corner) >= grid_.points.size()) [[unlikely]] {
      fail_(cell, begin + i,
            "vertex " + std::to_string(corner) + " is out of range (the file has " +
                counted(grid_.points.size(), "point") + ", counted from 0)");
    }
    corners[i] = static_cast<Index>(corner);
  }
  return corners;
}

void GridConverter::note_middle_nodes(std::size_t begin, std::size_t end, std::size_t n_corners) {
  ++n_curved_;
  for (std::size_t i = begin + n_corners; i < end; ++i) {
    const auto node = static_cast<std::uint64_t>(grid_.corners[i]);
    if (node < grid_.points.size()) middle_.push_back(static_cast<Index>(node));
  }
}

void GridConverter::sort_cells() {
  std::array<const CellType*, 256> types{};
  for (const CellType& type : kCellTypes) types[static_cast<std::size_t>(type.id)] = &type;
  constexpr std::array<std::size_t, 6> kCorners = {4, 3, 2, 1, 0, 0};

  mesh_.cells.reserve(grid_.types.size());
  bool listed = false;  // whether tetrahedra_ lists the tetrahedra so far
  std::size_t begin = 0;
  for (std::size_t cell = 0; cell < grid_.types.size(); ++cell) {
    const auto end = static_cast<std::size_t>(grid_.ends[cell]);
    const CellType* const type = types[grid_.types[cell]];
    if (!type) fail_(cell, begin, "unknown VTK cell type " + std::to_string(grid_.types[cell]));
    const std::size_t n_corners = kCorners[static_cast<std::size_t>(type->kind)];
    const std::size_t n_nodes = end - begin;
    if (type->kind == Kind::kRefused) {
      fail_(cell, begin,
            std::string("cells of type VTK_") + type->name + " are not supported: only tetrahedra are");
    }
    if (n_nodes < n_corners || (type->nodes != 0 && n_nodes != static_cast<std::size_t>(type->nodes))) {
      fail_(cell, begin,
            std::string("a cell of type VTK_") + type->name + " has " + counted(n_nodes, "node"));
    }
    if (type->kind != Kind::kTetrahedron && !listed) {
      listed = true;
      for (std::size_t i = 0; i < cell; ++i) tetrahedra_.push_back(i);
    }
    switch (type->kind) {
      case Kind::kTetrahedron:
        mesh_.cells.push_back(corners_of<4>(cell, begin));
        if (listed) tetrahedra_.push_back(cell);
        break;
      case Kind::kTriangle:
        mesh_.triangles.push_back(corners_of<3>(cell, begin));
        triangles_.push_back(cell);
        break;
      case Kind::kEdge:
        mesh_.edges.push_back(corners_of<2>(cell, begin));
        edges_.push_back(cell);
        break;
      case Kind::kVertex:
        static_cast<void>(corners_of<1>(cell, begin));
        vertices_.push_back(cell);
        break;
      default:
        ++dropped_[type->id];
    }
    if (type->curved) note_middle_nodes(begin, end, n_corners);
    begin = end;
  }
}

void GridConverter::report_kinds() {
  for (const auto& [id, n] : dropped_) {
    const auto* const type = std::find_if(std::begin(kCellTypes), std::end(kCellTypes),
                                          [id = id](const CellType& t) { return t.id == id; });
    mesh_.notes.push_back(counted(n, "cell") + " of type VTK_" + type->name + " dropped");
  }
}

std::vector<int> GridConverter::gathered(const Field& labels, const std::vector<std::size_t>& cells) const {
  std::vector<int> result;
  result.reserve(cells.size());
  for (const std::size_t cell : cells) result.push_back(static_cast<int>(labels.values[cell]));
  return result;
}

void GridConverter::distribute_cell_labels() {
  mesh_.triangle_labels.assign(mesh_.triangles.size(), 0);
  mesh_.edge_labels.assign(mesh_.edges.size(), 0);
  const std::optional<Field> labels =
      take_labels(grid_.cell_arrays, kVtkCellLabelNames, "cell", grid_.file, mesh_.notes);
  if (!labels) return;
  if (only_tetrahedra()) {
    mesh_.regions.assign(labels->values.begin(), labels->values.end());
    return;
  }
  mesh_.regions = gathered(*labels, tetrahedra_);
  mesh_.triangle_labels = gathered(*labels, triangles_);
  mesh_.edge_labels = gathered(*labels, edges_);
  for (const std::size_t cell : vertices_) {
    const auto label = static_cast<int>(labels->values[cell]);
    if (label == 0) continue;
    mesh_.vertex_labels.resize(grid_.points.size());
    const auto begin = cell == 0 ? 0 : static_cast<std::size_t>(grid_.ends[cell - 1]);
    mesh_.vertex_labels[static_cast<std::size_t>(grid_.corners[begin])] = label;
  }
}

void GridConverter::distribute_cell_fields() {
  mesh_.cell_fields = std::move(grid_.cell_arrays);
  if (only_tetrahedra()) return;
  for (Field& field : mesh_.cell_fields) {
    const auto n = static_cast<std::size_t>(field.components);
    if (n == 1 && field.name == kVtkNumberArray) {
      for (const std::size_t cell : triangles_) mesh_.triangle_numbers.push_back(field.values[cell]);
      for (const std::size_t cell : edges_) mesh_.edge_numbers.push_back(field.values[cell]);
    }
    const auto nonzero = static_cast<std::size_t>(
        std::count_if(field.values.begin(), field.values.end(), [](double v) { return v != 0.0; }));
    std::vector<double> kept;
    kept.reserve(n * tetrahedra_.size());
    for (const std::size_t cell : tetrahedra_) {
      const auto* const first = field.values.data() + n * cell;
      kept.insert(kept.end(), first, first + n);
    }
    const auto kept_nonzero =
        static_cast<std::size_t>(std::count_if(kept.begin(), kept.end(), [](double v) { return v != 0.0; }));
    field.values = std::move(kept);
    if (kept_nonzero != nonzero && (n != 1 || field.name != kVtkNumberArray)) {
      mesh_.notes.push_back("cell field '" + field.name +
                            "': only its values on tetrahedra are kept, those on other cells are dropped");
    }
  }
}

void GridConverter::take_point_arrays() {
  std::vector<Field>& fields = grid_.point_arrays;
  if (const auto labels = take_labels(fields, kVtkPointLabelNames, "point", grid_.file, mesh_.notes)) {
    std::size_t n_others = 0;
    mesh_.vertex_labels.resize(labels->values.size(), 0);  // some may have one of a cell of one point
    for (std::size_t i = 0; i < labels->values.size(); ++i) {
      const auto label = static_cast<int>(labels->values[i]);
      if (label == 0) continue;
      if (mesh_.vertex_labels[i] != 0 && mesh_.vertex_labels[i] != label) ++n_others;
      mesh_.vertex_labels[i] = label;
    }
    if (n_others > 0)
      mesh_.notes.push_back(std::to_string(n_others) + " points have one label in point array '" +
                            labels->name + "' and another as a cell; that of the array is taken");
  }
  const auto fixed = std::find_if(fields.begin(), fields.end(), [](const Field& field) {
    return lower(field.name) == kVtkFixedArray && field.components == 1;
  });
  const auto is_flag = [](double v) { return v == 0.0 || v == 1.0; };
  if (fixed != fields.end() && std::all_of(fixed->values.begin(), fixed->values.end(), is_flag)) {
    for (std::size_t i = 0; i < fixed->values.size(); ++i)
      if (fixed->values[i] != 0.0) mesh_.fixed_vertices.push_back(static_cast<Index>(i));
    fields.erase(fixed);
  } else if (fixed != fields.end()) {
    mesh_.notes.push_back("point array '" + fixed->name +
                          "' has other values than 0 and 1: it is kept as a field and fixes no vertex");
  }
  mesh_.point_fields = std::move(fields);
}

void GridConverter::drop_middle_nodes() {
  const std::size_t n_before = mesh_.points.size();
  drop_midside_points(mesh_, middle_);
  mesh_.notes.push_back(counted(n_curved_, "curved cell") + " linearised, " +
                        counted(n_before - mesh_.points.size(), "middle node") + " dropped");
}

/// Labels that are all 0, where a field would be taken for labels without them; else nothing.
std::vector<std::int32_t> zeros_before(const std::vector<Field>& fields, std::string_view array,
                                       std::span<const std::string_view> names, std::size_t n) {
  const auto are_whole = [&](std::size_t i) { return has_whole_values(fields[i]); };
  return std::vector<std::int32_t>(would_be_labels(fields, array, names, are_whole) ? n : 0);
}

}  // namespace

MeshData to_mesh(VtkGrid&& grid, const CornerFailure& fail) {
  return GridConverter(std::move(grid), fail).convert();
}

std::string names_text(const MeshData& mesh) {
  std::string text;
  for (const auto& [key, name] : mesh.names) {
    std::string line = name;
    std::replace(line.begin(), line.end(), '\n', ' ');
    text += std::to_string(key.first) + " " + std::to_string(key.second) + " " + line + "\n";
  }
  return text;
}

void read_names(std::string_view text, MeshData& mesh) {
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    const char* const end = line.data() + line.size();
    int dimension = 0;
    int label = 0;
    const auto first = std::from_chars(line.data(), end, dimension);
    if (first.ec != std::errc{} || first.ptr == end) continue;
    const auto second = std::from_chars(first.ptr + 1, end, label);
    if (second.ec != std::errc{} || second.ptr == end) continue;
    mesh.names[{dimension, label}] = std::string(second.ptr + 1, end);
  }
}

std::size_t n_vtk_cells(const MeshData& mesh) {
  return mesh.cells.size() + mesh.triangles.size() + mesh.edges.size();
}

std::vector<std::int32_t> vtk_regions(const MeshData& mesh) {
  const auto is_set = [](int label) { return label != 0; };
  if (mesh.regions.empty() &&
      std::none_of(mesh.triangle_labels.begin(), mesh.triangle_labels.end(), is_set) &&
      std::none_of(mesh.edge_labels.begin(), mesh.edge_labels.end(), is_set)) {
    return zeros_before(mesh.cell_fields, kVtkRegionArray, kVtkCellLabelNames, n_vtk_cells(mesh));
  }
  std::vector<std::int32_t> all(mesh.regions.begin(), mesh.regions.end());
  all.resize(mesh.cells.size());
  all.insert(all.end(), mesh.triangle_labels.begin(), mesh.triangle_labels.end());
  all.resize(mesh.cells.size() + mesh.triangles.size());
  all.insert(all.end(), mesh.edge_labels.begin(), mesh.edge_labels.end());
  all.resize(n_vtk_cells(mesh));
  return all;
}

std::vector<std::int32_t> vtk_vertex_labels(const MeshData& mesh) {
  if (mesh.vertex_labels.empty())
    return zeros_before(mesh.point_fields, kVtkLabelArray, kVtkPointLabelNames, mesh.points.size());
  return {mesh.vertex_labels.begin(), mesh.vertex_labels.end()};
}

std::vector<std::int32_t> vtk_fixed(const MeshData& mesh) {
  if (mesh.fixed_vertices.empty())
    return zeros_before(mesh.point_fields, kVtkFixedArray, {{kVtkFixedArray}}, mesh.points.size());
  std::vector<std::int32_t> fixed(mesh.points.size());
  for (const Index vertex : mesh.fixed_vertices) fixed[vertex] = 1;
  return fixed;
}

std::vector<std::string> notes_on_names(const MeshData& mesh) {
  std::vector<std::string> notes;
  const auto look = [&](const std::vector<Field>& fields, const char* kind, std::string_view name,
                        const char* meaning) {
    for (const Field& field : fields)
      if (field.name == name)
        notes.push_back(fmt::format("{} field '{}' is written under a name that is read as {}", kind,
                                    field.name, meaning));
  };
  look(mesh.cell_fields, "cell", kVtkRegionArray, "labels");
  look(mesh.point_fields, "point", kVtkLabelArray, "labels");
  look(mesh.point_fields, "point", kVtkFixedArray, "fixed vertices");
  return notes;
}

std::vector<std::string> notes_on_vtu_names(const MeshData& mesh) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' '; };
  std::vector<std::string> notes = notes_on_names(mesh);
  for (const auto* const fields : {&mesh.point_fields, &mesh.cell_fields})
    for (const Field& field : *fields)
      if (std::any_of(field.name.begin(), field.name.end(), is_control))
        notes.push_back("control characters in the name of a field are written as blanks");
  return notes;
}

bool has_whole_values(const Field& field) {
  return std::ranges::all_of(field.values, [](double v) { return v == std::trunc(v); });
}

bool would_be_labels(std::span<const Field> fields, std::string_view array,
                     std::span<const std::string_view> names,
                     const std::function<bool(std::size_t)>& are_whole) {
  bool any = false;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].name == array) return false;
    any = any || (fields[i].components == 1 &&
                  std::ranges::find(names, lower(fields[i].name)) != names.end() && are_whole(i));
  }
  return any;
}

IntegerWidth integer_width(const Field& field) {
  constexpr double kLow32 = std::numeric_limits<std::int32_t>::min();
  constexpr double kHigh32 = std::numeric_limits<std::int32_t>::max();
  constexpr double kLimit64 = 9223372036854775808.0;  // 2^63
  if (!field.integer) return IntegerWidth::kNone;
  IntegerWidth width = field.wide ? IntegerWidth::k64 : IntegerWidth::k32;
  for (const double v : field.values) {
    if (!(v >= -kLimit64 && v < kLimit64) || v != std::trunc(v)) return IntegerWidth::kNone;
    if (v < kLow32 || v > kHigh32) width = IntegerWidth::k64;
  }
  return width;
}

}  // namespace hfr::io
