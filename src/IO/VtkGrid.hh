// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_VTK_GRID_HH
#define HFR_IO_VTK_GRID_HH

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "IO/MeshData.hh"

/// What legacy .vtk and .vtu files have in common: an unstructured grid of mixed cells, and the way in which
/// labels, names and fixed vertices travel in arrays.
namespace hfr::io {

/// Arrays under which this library writes what VTK has no place of its own for.
inline constexpr std::string_view kVtkRegionArray = "region";  ///< cells: region, patch or edge label
inline constexpr std::string_view kVtkLabelArray = "label";    ///< points: vertex label
inline constexpr std::string_view kVtkFixedArray = "fixed";    ///< points: 1 where the vertex is fixed
inline constexpr std::string_view kVtkNamesArray = "names";    ///< field data: bytes of names_text()
inline constexpr std::string_view kVtkNumberArray =
    "number";  ///< of points and cells of a piece, in the whole

/// Cell arrays that hold labels, in order of preference; case does not matter. The first one that is in the
/// file and holds one integer a cell is taken, the others stay fields.
inline constexpr std::array<std::string_view, 16> kVtkCellLabelNames = {
    "region",        "regions",       "material",  "materials", "materialids", "material_id",
    "medit:ref",     "gmsh:physical", "label",     "labels",    "regionid",    "region_id",
    "cellentityids", "cell_tags",     "subdomain", "attribute"};
inline constexpr std::array<std::string_view, 4> kVtkPointLabelNames = {"label", "labels", "medit:ref",
                                                                        "vertex_label"};

inline constexpr std::uint8_t kVtkLine = 3;
inline constexpr std::uint8_t kVtkTriangle = 5;
inline constexpr std::uint8_t kVtkTetra = 10;

/// An unstructured grid as a file holds it. Cell k has the corners [ends[k-1], ends[k]).
struct VtkGrid {
  std::string file;  ///< what messages begin with
  std::vector<Vec3> points;
  std::vector<std::int64_t> corners;
  std::vector<std::int64_t> ends;
  std::vector<std::uint8_t> types;
  std::vector<Field> point_arrays;
  std::vector<Field> cell_arrays;
  std::string names;  ///< as names_text() gives them
  std::vector<std::string> notes;
};

/// Throws InvalidInput with a message that begins with the place in the file of entry `corner` of `corners`,
/// which belongs to cell `cell`.
using CornerFailure = std::function<void(std::size_t cell, std::size_t corner, const std::string& message)>;

/// Sorts cells by kind, turns known arrays into labels and everything else into fields. `ends` must ascend
/// within `corners`, and arrays must have as many entries as there are points and cells.
MeshData to_mesh(VtkGrid&& grid, const CornerFailure& fail);

/// "DIMENSION LABEL NAME" lines, and back; lines that are not of this form are skipped.
std::string names_text(const MeshData& mesh);
void read_names(std::string_view text, MeshData& mesh);

/// Cells of all dimensions: tetrahedra, then triangles, then edges, as the writers order them.
std::size_t n_vtk_cells(const MeshData& mesh);
/// Label of each of these; empty when the mesh has no label at all. Then zeros, here and below, if a field
/// has another name that is read as labels, so that it stays a field.
std::vector<std::int32_t> vtk_regions(const MeshData& mesh);
/// Label of each point; empty when none has one.
std::vector<std::int32_t> vtk_vertex_labels(const MeshData& mesh);
/// 1 for each fixed vertex, 0 for the others; empty when none is fixed.
std::vector<std::int32_t> vtk_fixed(const MeshData& mesh);
/// A line for each field under the very name of one of these arrays.
std::vector<std::string> notes_on_names(const MeshData& mesh);
/// The same, and what becomes of names in XML.
std::vector<std::string> notes_on_vtu_names(const MeshData& mesh);

bool has_whole_values(const Field& field);
/// Whether a reader would take one of these fields for labels, where no array of labels comes before them: it
/// has one of the names, and `are_whole(i)` says so of its values. Not where a field has the very name of the
/// array of labels, which would then be there twice.
bool would_be_labels(std::span<const Field> fields, std::string_view array,
                     std::span<const std::string_view> names,
                     const std::function<bool(std::size_t)>& are_whole);

/// How the values of an integer field can be written: as 32-bit or 64-bit integers, or, when some are none,
/// as doubles.
enum class IntegerWidth { k32, k64, kNone };
IntegerWidth integer_width(const Field& field);

}  // namespace hfr::io

#endif
