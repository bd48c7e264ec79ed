// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_MESH_STRETCH_HH
#define HFR_IO_MESH_STRETCH_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "IO/ByteSink.hh"
#include "IO/Formats.hh"
#include "IO/MeshShare.hh"

/// Mesh files of which each of several processes writes a stretch, and none the whole. A writer in shared
/// memory is the same for one process, whose stretch is the mesh.
namespace hfr::io {

/// Rows of vertex numbers, of 32 or 64 bits, that belong to somebody else.
class NumberRows {
 public:
  NumberRows() = default;
  template <class T, std::size_t N>
  explicit NumberRows(const std::vector<std::array<T, N>>& rows) : n_(rows.size()), width_(N) {
    take(rows.empty() ? nullptr : rows.front().data());
  }
  template <class T>
  explicit NumberRows(const std::vector<T>& numbers) : n_(numbers.size()) {
    take(numbers.data());
  }

  std::size_t size() const { return n_; }
  std::size_t width() const { return width_; }
  std::uint64_t operator()(std::size_t row, std::size_t k) const {
    const std::size_t at = row * width_ + k;
    return wide_ ? wide_[at] : narrow_[at];
  }

 private:
  template <class T>
  void take(const T* numbers) {
    if constexpr (sizeof(T) == sizeof(std::uint64_t))
      wide_ = numbers;
    else
      narrow_ = numbers;
  }

  const std::uint64_t* wide_ = nullptr;
  const std::uint32_t* narrow_ = nullptr;
  std::size_t n_ = 0, width_ = 1;
};

/// Elements of one kind with numbers that follow on one another.
struct ElementStretch {
  std::uint64_t total = 0;      ///< of all processes
  NumberRows corners;           ///< of those of this one
  std::span<const int> labels;  ///< one each, or empty
  std::uint64_t first = 0;      ///< number of the first of this process

  int label(std::size_t i) const { return labels.empty() ? 0 : labels[i]; }
};

/// What elements of one dimension with one label fill.
struct LabelBox {
  Vec3 low, high;
};
/// (dimension, label) → box.
class LabelBoxes {
 public:
  /// The box of an element with these corners grows to them.
  void add(int dimension, int label, std::span<const Vec3> corners);
  const std::map<std::pair<int, int>, LabelBox>& all() const { return boxes_; }

 private:
  std::map<std::pair<int, int>, LabelBox> boxes_;
};

/// What one of several processes has of a mesh: of each kind the numbers behind those of the process before
/// it. Arrays and names belong to somebody else.
struct MeshStretch {
  Processes processes;
  std::uint64_t first_point = 0, n_points = 0;  ///< the first of this process; all
  std::span<const Vec3> points;
  std::span<const int> vertex_labels;             ///< one each, or empty
  ElementStretch fixed, edges, triangles, cells;  ///< fixed: numbers of vertices
  /// Whether any process has labels of vertices; regions of cells, or labels of edges or triangles that are
  /// not 0.
  bool with_vertex_labels = false, with_labels = false;
  const std::map<std::pair<int, int>, std::string>* names = nullptr;
  /// With the values of the points and cells of this process; the same arrays on all. Others than .vtu leave
  /// them out.
  std::span<const Field> point_fields, cell_fields;
  /// Of elements whose points this process knows, whoever writes them; all processes together have all. For
  /// formats that want_boxes().
  LabelBoxes boxes;

  bool is_first() const { return processes.rank == 0; }  ///< of the processes: writes what is there once
};
/// Of one process.
MeshStretch stretch_of(const MeshData& mesh);
/// Those of all elements of a mesh, labelled vertices among them.
LabelBoxes boxes_of(const MeshData& mesh);

/// A file that is ready to be written, once or several times: every process puts the same stretches there
/// each time. The mesh stretch has to outlive it.
struct StretchedFile {
  std::function<void(ByteSink&)> write;
  Notes notes;  ///< one line for each thing that the format cannot hold; the same for all
};
/// Throws InvalidInput for other formats than .mesh, .meshb, .msh and .vtu, and for unknown variants; of .vtu
/// there is raw appended data alone.
void require_stretches(const std::filesystem::path& path, const WriteOptions& options);
/// What write_mesh() writes of a mesh, where require_stretches() has nothing against it; fields in .vtu
/// alone. All processes make one at the same time. Throws ResourceLimit where numbers are too wide.
StretchedFile stretched_file(const std::filesystem::path& path, const MeshStretch& mesh,
                             const WriteOptions& options);
/// Whether the format needs MeshStretch::boxes.
bool wants_boxes(const std::filesystem::path& path, const WriteOptions& options);

// By format.
StretchedFile vtu_stretches(const MeshStretch& mesh);
StretchedFile medit_stretches(const std::filesystem::path& path, const MeshStretch& mesh, bool is_binary);
StretchedFile gmsh_stretches(const std::filesystem::path& path, const MeshStretch& mesh,
                             const WriteOptions& options);

/// How long the stretches are that this process puts.
class StretchLengths : public ByteSink {
 public:
  /// In the order of the file, after all has been put.
  std::vector<std::uint64_t> finish();
  void next_stretch() override;

 private:
  void put(std::string_view bytes) override { lengths_.back() += bytes.size(); }

  std::vector<std::uint64_t> lengths_ = {0};
};

}  // namespace hfr::io

#endif
