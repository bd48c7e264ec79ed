// SPDX-License-Identifier: BSD-3-Clause
// VTK's files of a mesh in parts: pieces with an index, and one file.
#include <algorithm>
#include <bit>
#include <limits>
#include <system_error>
#include <type_traits>
#include <utility>

#include "Distributed/InParts.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/SharedFile.hh"
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

std::string piece_name(const std::filesystem::path& path, int rank) {
  const std::string stem = path.stem().string();
  return stem + "/" + stem + "_" + std::to_string(rank) + ".vtu";
}

void write_index(const std::filesystem::path& path, int n_ranks, const OwnLabels& labels) {
  io::OutputFile out(path);
  const auto declare = [&](const char* type, std::string_view name) {
    out.text("<PDataArray type=\"").text(type).text("\" Name=\"").text(name);
    out.text("\" NumberOfComponents=\"1\"/>\n");
  };
  out.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"");
  out.text(std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian");
  out.text("\" header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n");
  out.text("<PPointData>\n");
  if (labels.with_vertex_labels) declare("Int32", io::kVtkLabelArray);
  if (labels.n_fixed > 0) declare("Int32", io::kVtkFixedArray);
  declare("Float64", io::kVtkNumberArray);
  out.text("</PPointData>\n<PCellData>\n");
  if (labels.with_regions) declare("Int32", io::kVtkRegionArray);
  declare("Float64", io::kVtkNumberArray);
  out.text("</PCellData>\n");
  out.text(
      "<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n");
  for (int r = 0; r < n_ranks; ++r)
    out.text("<Piece Source=\"").text(io::xml_escaped(piece_name(path, r))).text("\"/>\n");
  out.text("</PUnstructuredGrid>\n</VTKFile>\n");
  out.commit();
}

std::string names_of(const DistributedMesh& mesh) {
  io::MeshData named;
  named.names = mesh.part().labels().names;
  return io::names_text(named);
}

/// Where the arrays of a .vtu of raw appended data stand, as io::write() lays them out.
class VtuLayout {
 public:
  struct Array {
    const char* section;
    std::string_view name;
    const char* type;
    std::uint64_t components, n, size;  // numbers, and bytes of each
    std::uint64_t begin = 0;            // of its bytes in the file
    bool is_there = true;
  };

  VtuLayout(std::uint64_t n_points, std::uint64_t n_tets, const OwnLabels& labels, std::string names_given)
      : n_cells(n_tets),
        n_faces(labels.n_faces),
        n_edges(labels.n_edges),
        names_text(std::move(names_given)) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    const std::uint64_t n_items = n_cells + n_faces + n_edges;
    const bool narrow = sizeof(Index) == 4 && n_points <= kMost, narrow_ends = n_items <= kMost / 4;
    names = {"FieldData", io::kVtkNamesArray, "UInt8", 1, names_text.size(), 1, 0, !names_text.empty()};
    points = {"Points", "Points", "Float64", 3, 3 * n_points, 8};
    corners = {"Cells", "connectivity", narrow ? "Int32" : "Int64", 1, end_of(n_items), narrow ? 4U : 8U};
    ends = {"Cells", "offsets", narrow_ends ? "Int32" : "Int64", 1, n_items, narrow_ends ? 4U : 8U};
    types = {"Cells", "types", "UInt8", 1, n_items, 1};
    vertex_labels = {"PointData", io::kVtkLabelArray, "Int32", 1, n_points, 4, 0, labels.with_vertex_labels};
    fixed = {"PointData", io::kVtkFixedArray, "Int32", 1, n_points, 4, 0, (labels.n_fixed > 0)};
    regions = {"CellData", io::kVtkRegionArray, "Int32", 1, n_items, 4, 0, labels.with_regions};
    head_ = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"";
    head_ += std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    head_ += "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n";
    if (names.is_there) put_section("FieldData");
    head_ += "<Piece NumberOfPoints=\"" + std::to_string(n_points) + "\" NumberOfCells=\"" +
             std::to_string(n_items) + "\">\n";
    for (const char* section : {"Points", "Cells", "PointData", "CellData"}) put_section(section);
    head_ += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
    for (Array* array : arrays()) array->begin += head_.size();
    end_ += head_.size();
  }

  /// Corners of the elements before number i: tetrahedra, then faces, then edges.
  std::uint64_t end_of(std::uint64_t i) const {
    const std::uint64_t in_cells = std::min(i, n_cells), in_faces = std::min(i - in_cells, n_faces);
    return 4 * in_cells + 3 * in_faces + 2 * (i - in_cells - in_faces);
  }

  std::uint64_t n_cells, n_faces, n_edges;
  std::string names_text;  ///< as io::names_text() has them
  Array names, points, corners, ends, types, vertex_labels, fixed, regions;
  /// Those that are there, in the order of the file.
  std::vector<Array*> arrays() {
    std::vector<Array*> all = {&names, &points, &corners, &ends, &types, &vertex_labels, &fixed, &regions};
    std::erase_if(all, [](const Array* array) { return !array->is_there; });
    return all;
  }
  const std::string& head() const { return head_; }
  std::uint64_t end() const { return end_; }  ///< of the arrays
  static constexpr std::string_view kTail = "\n</AppendedData>\n</VTKFile>\n";

 private:
  void put_section(std::string_view section) {
    head_ += "<" + std::string(section) + ">\n";
    for (Array* array : arrays()) {
      if (array->section != section) continue;
      head_ += std::string("<DataArray type=\"") + array->type + "\" Name=\"" + std::string(array->name) +
               "\" NumberOfComponents=\"" + std::to_string(array->components);
      if (array == &names) head_ += "\" NumberOfTuples=\"" + std::to_string(array->n);
      head_ += "\" format=\"appended\" offset=\"" + std::to_string(end_) + "\"/>\n";
      array->begin = end_ + sizeof(std::uint64_t);
      end_ = array->begin + array->n * array->size;
    }
    head_ += "</" + std::string(section) + ">\n";
  }

  std::string head_;
  std::uint64_t end_ = 0;
};

/// The share of one rank: own points, cells and labels, and of what all know its slice.
class VtuShare {
 public:
  VtuShare(DistributedMesh& mesh, const Numbering& numbering, const OwnLabels& labels, VtuLayout& layout,
           const std::filesystem::path& temporary)
      : mesh_(mesh),
        part_(mesh.part()),
        numbering_(numbering),
        labels_(labels),
        layout_(layout),
        file_(temporary) {}

  void write() {
    write_vertices();
    const std::vector<CellHandle> cells = own_cells(mesh_);
    if (layout_.corners.size == 4)
      write_corners<std::int32_t>(cells);
    else
      write_corners<std::int64_t>(cells);
    if (labels_.with_regions) write_labels(cells);
    if (layout_.ends.size == 4)
      write_ends<std::int32_t>();
    else
      write_ends<std::int64_t>();
    for_slice([&](std::uint64_t i) {
      const std::uint64_t n = layout_.n_cells;
      file_.put(layout_.types.begin + i, i < n                     ? io::kVtkTetra
                                         : i < n + layout_.n_faces ? io::kVtkTriangle
                                                                   : io::kVtkLine);
    });
    if (mesh_.comm().rank() == 0) write_frame();
    file_.finish();
  }

 private:
  void write_vertices() {
    const std::vector<VertexHandle> vertices = own_vertices(mesh_);
    for (VertexHandle v : vertices)
      file_.put(layout_.points.begin + sizeof(Vec3) * numbering_(v), part_.point(v));
    const auto put = [&](const VtuLayout::Array& array, auto&& value) {
      if (!array.is_there) return;
      for (VertexHandle v : vertices)
        file_.put(array.begin + sizeof(std::int32_t) * numbering_(v), static_cast<std::int32_t>(value(v)));
    };
    put(layout_.vertex_labels, [&](VertexHandle v) { return part_.labels().vertex(v); });
    put(layout_.fixed, [&](VertexHandle v) { return part_.is_fixed(v) ? 1 : 0; });
  }
  template <class T>
  void write_corners(const std::vector<CellHandle>& cells) {
    const auto put = [&](std::uint64_t item, const auto& vertices) {
      std::array<T, std::tuple_size_v<std::remove_cvref_t<decltype(vertices)>>> corners{};
      for (std::size_t k = 0; k < corners.size(); ++k) corners[k] = static_cast<T>(numbering_(vertices[k]));
      file_.put(layout_.corners.begin + sizeof(T) * layout_.end_of(item), corners);
    };
    for (CellHandle c : cells) put(numbering_(c), part_.cell(c).v);
    for (const auto& face : labels_.faces) put(layout_.n_cells + face.number, face.v);
    for (const auto& edge : labels_.edges) put(layout_.n_cells + layout_.n_faces + edge.number, edge.v);
  }
  void write_labels(const std::vector<CellHandle>& cells) {
    const auto put = [&](std::uint64_t item, int label) {
      file_.put(layout_.regions.begin + sizeof(std::int32_t) * item, static_cast<std::int32_t>(label));
    };
    for (CellHandle c : cells) put(numbering_(c), part_.region(c));
    for (const auto& face : labels_.faces) put(layout_.n_cells + face.number, face.label);
    for (const auto& edge : labels_.edges) put(layout_.n_cells + layout_.n_faces + edge.number, edge.label);
  }
  template <class T>
  void write_ends() {
    for_slice([&](std::uint64_t i) {
      file_.put(layout_.ends.begin + sizeof(T) * i, static_cast<T>(layout_.end_of(i + 1)));
    });
  }
  template <class Body>
  void for_slice(Body&& body) {
    const std::uint64_t n = mesh_.comm().n_ranks(), r = static_cast<std::uint64_t>(mesh_.comm().rank());
    const std::uint64_t n_items = layout_.types.n;
    for (std::uint64_t i = r * n_items / n; i < (r + 1) * n_items / n; ++i) body(i);
  }
  void write_frame() {
    file_.put_text(0, layout_.head());
    for (const VtuLayout::Array* array : layout_.arrays())
      file_.put(array->begin - sizeof(std::uint64_t), std::uint64_t{array->n * array->size});
    if (layout_.names.is_there) file_.put_text(layout_.names.begin, layout_.names_text);
    file_.put_text(layout_.end(), VtuLayout::kTail);
  }

  DistributedMesh& mesh_;
  const TetMesh& part_;
  const Numbering& numbering_;
  const OwnLabels& labels_;
  VtuLayout& layout_;
  OffsetFile file_;
};

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
  try {
    io::write_mesh(fresh, piece_of(mesh, numbering, labels));
    mesh.comm().sum(0);  // all pieces are there, or a rank has failed
  } catch (...) {
    std::filesystem::remove(fresh, error);
    throw;
  }
  std::filesystem::rename(fresh, piece, error);
  if (error) throw IoError(piece.string() + ": cannot be written: " + error.message());
  mesh.comm().sum(0);
  if (mesh.comm().rank() == 0) write_index(path, mesh.comm().size(), labels);
  mesh.comm().sum(0);
}

void write_vtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Numbering numbering(mesh);
  const OwnLabels labels(mesh);
  VtuLayout layout(numbering.n_vertices(), numbering.n_cells(), labels, names_of(mesh));
  SharedFile file(mesh.comm(), path);
  VtuShare(mesh, numbering, labels, layout, file.temporary()).write();
  file.commit();
}

}  // namespace hfr::mpi
