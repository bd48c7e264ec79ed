// SPDX-License-Identifier: BSD-3-Clause
// Files of a mesh in parts. What is written has numbers without gaps, as after TetMesh::collect_garbage():
// each rank knows which vertices and slots of the whole are gone, and so how many are below a number.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>

#include "Distributed/InParts.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeshFile.hh"
#include "IO/OutputFile.hh"
#include "IO/VtkGrid.hh"

namespace hfr::mpi {
namespace {

/// Numbers without gaps.
class Numbering {
 public:
  explicit Numbering(DistributedMesh& mesh) : mesh_(mesh), slots_(mesh.free_slots()) {
    std::vector<std::uint64_t> gone;
    for (std::size_t i = 0; i < mesh.part().n_vertices(); ++i)
      if (const VertexHandle v(i); mesh.is_own(v) && mesh.part().is_deleted(v))
        gone.push_back(mesh.number(v));
    vertices_ = mesh.comm().all_gather(std::span<const std::uint64_t>(gone));
    std::sort(vertices_.begin(), vertices_.end());
    std::sort(slots_.begin(), slots_.end());
  }

  std::uint64_t n_vertices() const { return mesh_.n_vertices() - vertices_.size(); }
  std::uint64_t n_cells() const { return mesh_.n_cells(); }
  std::uint64_t operator()(VertexHandle v) const { return without(vertices_, mesh_.number(v)); }
  std::uint64_t operator()(CellHandle c) const { return without(slots_, mesh_.number(c)); }

 private:
  static std::uint64_t without(const std::vector<std::uint64_t>& gone, std::uint64_t number) {
    return number -
           static_cast<std::uint64_t>(std::lower_bound(gone.begin(), gone.end(), number) - gone.begin());
  }

  const DistributedMesh& mesh_;
  std::vector<std::uint64_t> vertices_, slots_;  // that are gone, ascending
};

std::vector<VertexHandle> own_vertices(const DistributedMesh& mesh) {
  std::vector<VertexHandle> vertices;
  for (std::size_t i = 0; i < mesh.part().n_vertices(); ++i)
    if (const VertexHandle v(i); mesh.is_own(v) && !mesh.part().is_deleted(v)) vertices.push_back(v);
  return vertices;
}

/// In the order of numbers.
std::vector<CellHandle> own_cells(const DistributedMesh& mesh) {
  std::vector<CellHandle> cells;
  for (std::size_t i = 0; i < mesh.part().n_cells(); ++i)
    if (const CellHandle c(i); !mesh.part().is_deleted(c) && mesh.is_own(c)) cells.push_back(c);
  const auto by_number = [&](CellHandle a, CellHandle b) { return mesh.number(a) < mesh.number(b); };
  if (!std::is_sorted(cells.begin(), cells.end(), by_number))
    std::sort(cells.begin(), cells.end(), by_number);
  return cells;
}

/// An edge or a face with a label; of those, a rank writes the ones whose smallest vertex it owns.
template <std::size_t N>
struct Labelled {
  std::uint64_t number = 0;
  std::array<VertexHandle, N> v;
  std::int32_t label = 0;
};

/// In the order of numbers. `number_of`: entry → number.
template <std::size_t N, class NumberOf>
std::vector<Labelled<N>> own_labelled(const DistributedMesh& mesh, const TupleMap<N, int>& map,
                                      NumberOf&& number_of) {
  std::vector<Labelled<N>> own;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto& entry = map.entries()[i];
    if (mesh.is_own(*std::min_element(entry.vertices.begin(), entry.vertices.end())))
      own.push_back({number_of(i), entry.vertices, static_cast<std::int32_t>(entry.value)});
  }
  std::sort(own.begin(), own.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return own;
}

/// What hangs on own vertices, edges and faces, and what of it there is in the whole.
class OwnLabels {
 public:
  explicit OwnLabels(DistributedMesh& mesh) {
    const TetMesh& part = mesh.part();
    const Labels& labels = part.labels();
    const PartLabels& numbers = mesh.label_numbers();
    faces = own_labelled(mesh, labels.faces, [&](std::size_t i) { return numbers.face_number(i); });
    edges = own_labelled(mesh, labels.edges, [&](std::size_t i) { return numbers.edge_number(i); });
    const auto is_set = [](const auto& one) { return one.label != 0; };
    bool has_region =
        std::any_of(faces.begin(), faces.end(), is_set) || std::any_of(edges.begin(), edges.end(), is_set);
    for (std::size_t c = 0; c < part.n_cells() && part.has_regions() && !has_region; ++c)
      has_region = !part.is_deleted(CellHandle(c)) && part.region(CellHandle(c)) != 0;
    std::array<std::uint64_t, 5> sums = {faces.size(), edges.size(), has_region ? 1U : 0U, 0, 0};
    for (VertexHandle v : own_vertices(mesh)) {
      sums[3] += labels.vertex(v) != 0 ? 1 : 0;
      sums[4] += part.is_fixed(v) ? 1 : 0;
    }
    mesh.comm().sum(sums);
    n_faces = sums[0];
    n_edges = sums[1];
    with_regions = sums[2] > 0;
    with_vertex_labels = sums[3] > 0;
    with_fixed = sums[4] > 0;
    io::MeshData named;
    named.names = labels.names;
    names = io::names_text(named);
  }

  std::vector<Labelled<3>> faces;
  std::vector<Labelled<2>> edges;
  std::uint64_t n_faces = 0, n_edges = 0;               ///< of the whole
  bool with_regions = false;                            ///< or labels of faces or edges
  bool with_vertex_labels = false, with_fixed = false;  ///< vertices
  std::string names;                                    ///< as names_text() has them
};

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
  if (labels.with_fixed) data.point_fields.push_back(std::move(fixed));
  data.point_fields.push_back(std::move(points));
  data.cell_fields.push_back(std::move(numbers));
  return data;
}

std::string piece_name(const std::filesystem::path& path, int rank) {
  const std::string stem = path.stem().string();
  return stem + "/" + stem + "_" + std::to_string(rank) + ".vtu";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
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
  if (labels.with_fixed) declare("Int32", io::kVtkFixedArray);
  declare("Float64", io::kVtkNumberArray);
  out.text("</PPointData>\n<PCellData>\n");
  if (labels.with_regions) declare("Int32", io::kVtkRegionArray);
  declare("Float64", io::kVtkNumberArray);
  out.text("</PCellData>\n");
  out.text(
      "<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n");
  for (int r = 0; r < n_ranks; ++r)
    out.text("<Piece Source=\"").text(escaped(piece_name(path, r))).text("\"/>\n");
  out.text("</PUnstructuredGrid>\n</VTKFile>\n");
  out.commit();
}

/// Writes at offsets of a file that others write to, too; what follows on what was put last goes out with it.
class OffsetFile {
 public:
  explicit OffsetFile(std::filesystem::path path) : path_(std::move(path)) {
    file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    if (file_ < 0) fail();
  }
  ~OffsetFile() {
    if (file_ >= 0) ::close(file_);
  }
  OffsetFile(const OffsetFile&) = delete;
  OffsetFile& operator=(const OffsetFile&) = delete;

  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(std::uint64_t offset, const T& value) { put_bytes(offset, &value, sizeof value); }
  void put_text(std::uint64_t offset, std::string_view text) { put_bytes(offset, text.data(), text.size()); }
  void finish() {
    flush();
    if (::fsync(file_) != 0 && errno != EINVAL) fail();
    if (::close(std::exchange(file_, -1)) != 0) fail();
  }

 private:
  static constexpr std::size_t kBuffer = std::size_t{1} << 20;

  void put_bytes(std::uint64_t offset, const void* bytes, std::size_t n) {
    if (offset != begin_ + buffer_.size() || buffer_.size() >= kBuffer) {
      flush();
      begin_ = offset;
    }
    buffer_.append(static_cast<const char*>(bytes), n);
  }
  void flush() {
    std::string_view left = buffer_;
    for (std::uint64_t at = begin_; !left.empty();) {
      const ssize_t n = ::pwrite(file_, left.data(), left.size(), static_cast<off_t>(at));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) fail();
      at += static_cast<std::uint64_t>(n);
      left.remove_prefix(static_cast<std::size_t>(n));
    }
    buffer_.clear();
  }
  [[noreturn]] void fail() const {
    throw IoError(path_.string() + ": cannot be written: " + std::generic_category().message(errno));
  }

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t begin_ = 0;
  std::string buffer_;
};

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

  VtuLayout(std::uint64_t n_points, std::uint64_t n_tets, const OwnLabels& labels)
      : n_cells(n_tets), n_faces(labels.n_faces), n_edges(labels.n_edges) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    const std::uint64_t n_items = n_cells + n_faces + n_edges;
    const bool narrow = sizeof(Index) == 4 && n_points <= kMost, narrow_ends = n_items <= kMost / 4;
    names = {"FieldData", io::kVtkNamesArray, "UInt8", 1, labels.names.size(), 1, 0, !labels.names.empty()};
    points = {"Points", "Points", "Float64", 3, 3 * n_points, 8};
    corners = {"Cells", "connectivity", narrow ? "Int32" : "Int64", 1, end_of(n_items), narrow ? 4U : 8U};
    ends = {"Cells", "offsets", narrow_ends ? "Int32" : "Int64", 1, n_items, narrow_ends ? 4U : 8U};
    types = {"Cells", "types", "UInt8", 1, n_items, 1};
    vertex_labels = {"PointData", io::kVtkLabelArray, "Int32", 1, n_points, 4, 0, labels.with_vertex_labels};
    fixed = {"PointData", io::kVtkFixedArray, "Int32", 1, n_points, 4, 0, labels.with_fixed};
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
    if (layout_.names.is_there) file_.put_text(layout_.names.begin, labels_.names);
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

void write_pvtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Numbering numbering(mesh);
  const OwnLabels labels(mesh);
  const std::filesystem::path piece = path.parent_path() / piece_name(path, mesh.comm().rank());
  std::error_code error;
  std::filesystem::create_directory(piece.parent_path(), error);  // by whoever comes first
  io::write_mesh(piece, piece_of(mesh, numbering, labels));
  mesh.comm().sum(0);  // all pieces are there, or a rank has failed
  if (mesh.comm().rank() == 0) write_index(path, mesh.comm().size(), labels);
  mesh.comm().sum(0);
}

void write_vtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Numbering numbering(mesh);
  const OwnLabels labels(mesh);
  VtuLayout layout(numbering.n_vertices(), numbering.n_cells(), labels);
  std::optional<io::OutputFile> file;
  std::string name;
  if (mesh.comm().rank() == 0) {
    file.emplace(path);
    name = file->temporary().string();
    if (name.empty()) throw IoError(path.string() + ": cannot be written at offsets: it is no regular file");
  }
  const std::vector<char> temporary = mesh.comm().all_gather(std::span<const char>(name.data(), name.size()));
  VtuShare(mesh, numbering, labels, layout, std::string(temporary.begin(), temporary.end())).write();
  mesh.comm().sum(0);  // all shares are there, or a rank has failed
  if (file) file->commit();
  mesh.comm().sum(0);
}

}  // namespace hfr::mpi
