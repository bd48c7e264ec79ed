// SPDX-License-Identifier: BSD-3-Clause
// VTK's files of a mesh in parts: pieces with an index. One file is another format of WriteRanges.cc.
#include <algorithm>
#include <bit>
#include <system_error>
#include <utility>

#include "Distributed/AttachedArrays.hh"
#include "Distributed/InParts.hh"
#include "Distributed/OwnItems.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeditPart.hh"
#include "IO/MeshFile.hh"
#include "IO/OutputFile.hh"
#include "IO/VtkGrid.hh"

namespace hfr::mpi {
namespace {

/// Into the piece, by the places of its points.
template <std::size_t N>
void put_labelled(const std::vector<Labelled<N>>& own, const std::vector<Index>& place,
                  std::vector<std::array<Index, N>>& items, std::vector<int>& labels,
                  std::vector<double>& numbers) {
  for (const Labelled<N>& one : own) {
    auto& item = items.emplace_back();
    for (std::size_t k = 0; k < N; ++k) item[k] = place[one.v[k].idx()];
    labels.push_back(one.label);
    numbers.push_back(static_cast<double>(one.number));
  }
}

/// The points of a piece: own ones, and those that its cells and labels have; place of each, or none.
std::vector<Index> places_in_piece(const DistributedMesh& mesh, const std::vector<CellHandle>& cells,
                                   const OwnLabels& labels) {
  std::vector<Index> place(mesh.part().n_vertices(), VertexHandle::kInvalid);
  const auto take = [&](const auto& vertices) {
    for (VertexHandle v : vertices) place[v.idx()] = 0;
  };
  take(own_vertices(mesh));
  for (CellHandle c : cells) take(mesh.part().cell(c).v);
  for (const auto& face : labels.faces) take(face.v);
  for (const auto& edge : labels.edges) take(edge.v);
  Index n = 0;
  for (Index& at : place)
    if (at != VertexHandle::kInvalid) at = n++;
  return place;
}

io::MeshData piece_of(const DistributedMesh& mesh, const Numbering& numbering, const OwnLabels& labels) {
  const TetMesh& part = mesh.part();
  const std::vector<CellHandle> cells = own_cells(mesh);
  const std::vector<Index> place = places_in_piece(mesh, cells, labels);
  io::MeshData data;
  const std::string number(io::kVtkNumberArray);
  io::Field points{number, 1, false, {}}, numbers{number, 1, false, {}};
  io::Field fixed{std::string(io::kVtkFixedArray), 1, true, {}};  // also where none of this piece is
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == VertexHandle::kInvalid) continue;
    const VertexHandle v(i);
    data.points.push_back(part.point(v));
    points.values.push_back(static_cast<double>(numbering(v)));
    if (labels.with_vertex_labels) data.vertex_labels.push_back(part.labels().vertex(v));
    fixed.values.push_back(part.is_fixed(v) ? 1 : 0);
  }
  data.cells.reserve(cells.size());
  numbers.values.reserve(cells.size());
  for (CellHandle c : cells) {
    auto& corners = data.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) corners[k] = place[part.cell(c).v[k].idx()];
    numbers.values.push_back(static_cast<double>(numbering(c)));
    if (labels.with_regions) data.regions.push_back(part.region(c));
  }
  put_labelled(labels.faces, place, data.triangles, data.triangle_labels, data.triangle_numbers);
  put_labelled(labels.edges, place, data.edges, data.edge_labels, data.edge_numbers);
  data.names = part.labels().names;
  if (labels.n_fixed > 0) data.point_fields.push_back(std::move(fixed));
  data.point_fields.push_back(std::move(points));
  data.cell_fields.push_back(std::move(numbers));
  return data;
}

/// The type of an array that all pieces have: a piece alone might do with a narrower one.
struct DeclaredArray {
  std::string name;
  const char* type = "";
  int components = 1;
};
/// Widens integers of this piece where another piece needs it. All take part.
std::vector<DeclaredArray> widened(Comm& comm, std::vector<io::Field>& fields) {
  std::vector<std::uint64_t> n_wide;
  for (const io::Field& field : fields)
    n_wide.push_back(io::integer_width(field) == io::IntegerWidth::k64 ? 1 : 0);
  comm.sum(n_wide);
  std::vector<DeclaredArray> declared;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    fields[f].wide = n_wide[f] > 0;
    const char* const integers = fields[f].wide ? "Int64" : "Int32";
    declared.push_back({fields[f].name, fields[f].integer ? integers : "Float64", fields[f].components});
  }
  return declared;
}

struct AddedArrays {
  std::vector<DeclaredArray> points, cells;
};
/// To the piece, behind what is there. All take part.
AddedArrays add_arrays(const DistributedMesh& mesh, const OwnLabels& labels, io::MeshData& data) {
  AddedArrays added;
  if (!mesh.arrays()) return added;
  const std::vector<CellHandle> cells = own_cells(mesh);
  const std::vector<Index> place = places_in_piece(mesh, cells, labels);
  std::vector<std::uint64_t> points, of_cells;
  for (std::size_t i = 0; i < place.size(); ++i)
    if (place[i] != VertexHandle::kInvalid) points.push_back(mesh.source(VertexHandle(i)));
  for (CellHandle c : cells) of_cells.push_back(mesh.source(c));
  const auto add = [&](std::vector<io::Field> fields, std::vector<io::Field>& to) {
    std::vector<DeclaredArray> list = widened(mesh.comm(), fields);
    to.insert(to.end(), std::make_move_iterator(fields.begin()), std::make_move_iterator(fields.end()));
    return list;
  };
  added.points = add(mesh.arrays()->points.fields_of(mesh.comm(), points), data.point_fields);
  added.cells = add(mesh.arrays()->cells.fields_of(mesh.comm(), of_cells), data.cell_fields);
  return added;
}

std::string piece_name(const std::filesystem::path& path, int rank) {
  const std::string stem = path.stem().string();
  return stem + "/" + stem + "_" + std::to_string(rank) + ".vtu";
}

void write_index(const std::filesystem::path& path, int n_ranks, const OwnLabels& labels,
                 const AddedArrays& added) {
  io::OutputFile out(path);
  const auto declare = [&](const char* type, std::string_view name, int components = 1) {
    out.text("<PDataArray type=\"").text(type).text("\" Name=\"").text(io::xml_escaped(name));
    out.text("\" NumberOfComponents=\"").number(std::int64_t{components}).text("\"/>\n");
  };
  const auto declare_all = [&](const std::vector<DeclaredArray>& arrays) {
    for (const DeclaredArray& one : arrays) declare(one.type, one.name, one.components);
  };
  out.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"");
  out.text(std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian");
  out.text("\" header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n");
  out.text("<PPointData>\n");
  if (labels.with_vertex_labels) declare("Int32", io::kVtkLabelArray);
  if (labels.n_fixed > 0) declare("Int32", io::kVtkFixedArray);
  declare("Float64", io::kVtkNumberArray);
  declare_all(added.points);
  out.text("</PPointData>\n<PCellData>\n");
  if (labels.with_regions) declare("Int32", io::kVtkRegionArray);
  declare("Float64", io::kVtkNumberArray);
  declare_all(added.cells);
  out.text("</PCellData>\n");
  out.text(
      "<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n");
  for (int r = 0; r < n_ranks; ++r)
    out.text("<Piece Source=\"").text(io::xml_escaped(piece_name(path, r))).text("\"/>\n");
  out.text("</PUnstructuredGrid>\n</VTKFile>\n");
  out.commit();
}

}  // namespace

std::filesystem::path part_path(const std::filesystem::path& path, int rank) {
  if (path.extension() != ".pvtu") return io::medit_part_path(path, rank);
  return path.parent_path() / piece_name(path, rank);
}

void write_pvtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Numbering numbering(mesh);
  const OwnLabels labels(mesh);
  const std::filesystem::path piece = path.parent_path() / piece_name(path, mesh.comm().rank());
  std::error_code error;
  std::filesystem::create_directory(piece.parent_path(), error);  // by whoever comes first
  // Pieces that were there before, and are read with the index, go when all new ones are whole.
  const std::filesystem::path fresh = piece.parent_path() / ("." + piece.stem().string() + ".new.vtu");
  AddedArrays added;
  try {
    io::MeshData data = piece_of(mesh, numbering, labels);
    added = add_arrays(mesh, labels, data);
    io::write_mesh(fresh, data);
    mesh.comm().sum(0);  // all pieces are there, or a rank has failed
  } catch (...) {
    std::filesystem::remove(fresh, error);
    throw;
  }
  std::filesystem::rename(fresh, piece, error);
  if (error) throw IoError(piece.string() + ": cannot be written: " + error.message());
  mesh.comm().sum(0);
  if (mesh.comm().rank() == 0) write_index(path, mesh.comm().size(), labels, added);
  mesh.comm().sum(0);
}

void write_vtu(DistributedMesh& mesh, const std::filesystem::path& path) { write_ranges(mesh, path); }

}  // namespace hfr::mpi
