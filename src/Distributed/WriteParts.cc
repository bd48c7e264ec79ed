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

bool has_regions(DistributedMesh& mesh) {
  const TetMesh& part = mesh.part();
  bool has = false;
  for (std::size_t c = 0; c < part.n_cells() && part.has_regions() && !has; ++c)
    has = !part.is_deleted(CellHandle(c)) && part.region(CellHandle(c)) != 0;
  return mesh.comm().sum(has ? 1 : 0) > 0;
}

/// What own cells have, and own points that are in none.
io::MeshData piece_of(const DistributedMesh& mesh, const Numbering& numbering, bool with_regions) {
  const TetMesh& part = mesh.part();
  const std::vector<CellHandle> cells = own_cells(mesh);
  std::vector<Index> place(part.n_vertices(), VertexHandle::kInvalid);
  for (VertexHandle v : own_vertices(mesh)) place[v.idx()] = 0;
  for (CellHandle c : cells)
    for (VertexHandle v : part.cell(c).v) place[v.idx()] = 0;
  io::MeshData data;
  io::Field points{"number", 1, false, {}}, numbers{"number", 1, false, {}};
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == VertexHandle::kInvalid) continue;
    place[i] = static_cast<Index>(data.points.size());
    data.points.push_back(part.point(VertexHandle(i)));
    points.values.push_back(static_cast<double>(numbering(VertexHandle(i))));
  }
  data.cells.reserve(cells.size());
  numbers.values.reserve(cells.size());
  for (CellHandle c : cells) {
    auto& corners = data.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) corners[k] = place[part.cell(c).v[k].idx()];
    numbers.values.push_back(static_cast<double>(numbering(c)));
    if (with_regions) data.regions.push_back(part.region(c));
  }
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

void write_index(const std::filesystem::path& path, int n_ranks, bool with_regions) {
  io::OutputFile out(path);
  out.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"");
  out.text(std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian");
  out.text("\" header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n");
  out.text(
      "<PPointData>\n<PDataArray type=\"Float64\" Name=\"number\" "
      "NumberOfComponents=\"1\"/>\n</PPointData>\n");
  out.text("<PCellData>\n");
  if (with_regions)
    out.text("<PDataArray type=\"Int32\" Name=\"")
        .text(io::kVtkRegionArray)
        .text("\" NumberOfComponents=\"1\"/>\n");
  out.text("<PDataArray type=\"Float64\" Name=\"number\" NumberOfComponents=\"1\"/>\n</PCellData>\n");
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
  };

  VtuLayout(std::uint64_t n_points, std::uint64_t n_cells, bool with_regions) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    const bool narrow = sizeof(Index) == 4 && n_points <= kMost, narrow_ends = n_cells <= kMost / 4;
    points = {"Points", "Points", "Float64", 3, 3 * n_points, 8};
    corners = {"Cells", "connectivity", narrow ? "Int32" : "Int64", 1, 4 * n_cells, narrow ? 4U : 8U};
    ends = {"Cells", "offsets", narrow_ends ? "Int32" : "Int64", 1, n_cells, narrow_ends ? 4U : 8U};
    types = {"Cells", "types", "UInt8", 1, n_cells, 1};
    regions = {"CellData", io::kVtkRegionArray, "Int32", 1, with_regions ? n_cells : 0, 4};
    head_ = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"";
    head_ += std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    head_ += "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
             std::to_string(n_points) + "\" NumberOfCells=\"" + std::to_string(n_cells) + "\">\n";
    std::vector<Array*> there = arrays();
    if (!with_regions) there.pop_back();
    std::uint64_t offset = 0;
    for (const char* section : {"Points", "Cells", "PointData", "CellData"}) {
      head_ += std::string("<") + section + ">\n";
      for (Array* array : there)
        if (std::string_view(array->section) == section) {
          head_ += std::string("<DataArray type=\"") + array->type + "\" Name=\"" + std::string(array->name) +
                   "\" NumberOfComponents=\"" + std::to_string(array->components) +
                   "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
          array->begin = offset + sizeof(std::uint64_t);
          offset = array->begin + array->n * array->size;
        }
      head_ += std::string("</") + section + ">\n";
    }
    head_ += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
    for (Array* array : there) array->begin += head_.size();
    end_ = head_.size() + offset;
  }

  Array points, corners, ends, types, regions;
  std::vector<Array*> arrays() { return {&points, &corners, &ends, &types, &regions}; }
  const std::string& head() const { return head_; }
  std::uint64_t end() const { return end_; }  ///< of the arrays
  static constexpr std::string_view kTail = "\n</AppendedData>\n</VTKFile>\n";

 private:
  std::string head_;
  std::uint64_t end_ = 0;
};

/// The share of one rank: own points and cells, and of what all know its slice.
class VtuShare {
 public:
  VtuShare(DistributedMesh& mesh, const Numbering& numbering, VtuLayout& layout,
           const std::filesystem::path& temporary)
      : mesh_(mesh), part_(mesh.part()), numbering_(numbering), layout_(layout), file_(temporary) {}

  void write(bool with_regions) {
    for (VertexHandle v : own_vertices(mesh_))
      file_.put(layout_.points.begin + sizeof(Vec3) * numbering_(v), part_.point(v));
    const std::vector<CellHandle> cells = own_cells(mesh_);
    if (layout_.corners.size == 4)
      write_corners<std::int32_t>(cells);
    else
      write_corners<std::int64_t>(cells);
    if (with_regions)
      for (CellHandle c : cells)
        file_.put(layout_.regions.begin + sizeof(std::int32_t) * numbering_(c),
                  static_cast<std::int32_t>(part_.region(c)));
    if (layout_.ends.size == 4)
      write_ends<std::int32_t>();
    else
      write_ends<std::int64_t>();
    for_slice([&](std::uint64_t c) { file_.put(layout_.types.begin + c, io::kVtkTetra); });
    if (mesh_.comm().rank() == 0) write_frame(with_regions);
    file_.finish();
  }

 private:
  template <class T>
  void write_corners(const std::vector<CellHandle>& cells) {
    for (CellHandle c : cells) {
      std::array<T, 4> corners{};
      for (std::size_t k = 0; k < 4; ++k) corners[k] = static_cast<T>(numbering_(part_.cell(c).v[k]));
      file_.put(layout_.corners.begin + sizeof corners * numbering_(c), corners);
    }
  }
  template <class T>
  void write_ends() {
    for_slice(
        [&](std::uint64_t c) { file_.put(layout_.ends.begin + sizeof(T) * c, static_cast<T>(4 * (c + 1))); });
  }
  template <class Body>
  void for_slice(Body&& body) {
    const std::uint64_t n = mesh_.comm().n_ranks(), r = static_cast<std::uint64_t>(mesh_.comm().rank());
    for (std::uint64_t c = r * numbering_.n_cells() / n; c < (r + 1) * numbering_.n_cells() / n; ++c) body(c);
  }
  void write_frame(bool with_regions) {
    file_.put_text(0, layout_.head());
    for (const VtuLayout::Array* array : layout_.arrays())
      if (array != &layout_.regions || with_regions)
        file_.put(array->begin - sizeof(std::uint64_t), std::uint64_t{array->n * array->size});
    file_.put_text(layout_.end(), VtuLayout::kTail);
  }

  DistributedMesh& mesh_;
  const TetMesh& part_;
  const Numbering& numbering_;
  VtuLayout& layout_;
  OffsetFile file_;
};

}  // namespace

void write_pvtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Numbering numbering(mesh);
  const bool with_regions = has_regions(mesh);
  const std::filesystem::path piece = path.parent_path() / piece_name(path, mesh.comm().rank());
  std::error_code error;
  std::filesystem::create_directory(piece.parent_path(), error);  // by whoever comes first
  io::write_mesh(piece, piece_of(mesh, numbering, with_regions));
  mesh.comm().sum(0);  // all pieces are there, or a rank has failed
  if (mesh.comm().rank() == 0) write_index(path, mesh.comm().size(), with_regions);
  mesh.comm().sum(0);
}

void write_vtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Numbering numbering(mesh);
  const bool with_regions = has_regions(mesh);
  VtuLayout layout(numbering.n_vertices(), numbering.n_cells(), with_regions);
  std::optional<io::OutputFile> file;
  std::string name;
  if (mesh.comm().rank() == 0) {
    file.emplace(path);
    name = file->temporary().string();
    if (name.empty()) throw IoError(path.string() + ": cannot be written at offsets: it is no regular file");
  }
  const std::vector<char> temporary = mesh.comm().all_gather(std::span<const char>(name.data(), name.size()));
  VtuShare(mesh, numbering, layout, std::string(temporary.begin(), temporary.end())).write(with_regions);
  mesh.comm().sum(0);  // all shares are there, or a rank has failed
  if (file) file->commit();
  mesh.comm().sum(0);
}

}  // namespace hfr::mpi
