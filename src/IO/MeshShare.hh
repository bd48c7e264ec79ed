// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_MESH_SHARE_HH
#define HFR_IO_MESH_SHARE_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "HalfFace/Vec3.hh"

/// Mesh files of which each of several processes reads a share, and none the whole.
namespace hfr::io {

/// The processes that read one file at the same time.
struct Processes {
  std::size_t rank = 0, n = 1;
  /// What all have said, in their order. Who throws never calls it again; how others learn of that is the
  /// business of who has made this.
  std::function<std::vector<std::byte>(std::span<const std::byte>)> all_gather;

  template <class T>
  std::vector<T> gather(std::span<const T> mine) const {
    const std::vector<std::byte> all = all_gather(std::as_bytes(mine));
    std::vector<T> values(all.size() / sizeof(T));
    if (!all.empty()) std::memcpy(values.data(), all.data(), all.size());
    return values;
  }
};

/// A user's array, without its values.
struct ShareField {
  std::string name;
  int components = 1;
  bool integer = false;  ///< of the file
};

/// Points with numbers that follow on one another.
struct SharePoints {
  std::uint64_t first = 0;
  std::vector<Vec3> points;
  std::vector<std::int32_t> labels;  ///< one each, or empty
  std::vector<std::uint8_t> fixed;   ///< 1: never moved nor removed; one each, or empty
  std::vector<double> rows;          ///< of each all components of all MeshShare::point_fields()
};

/// Elements of N corners, with numbers among their kind that follow on one another.
template <std::size_t N>
struct ShareElements {
  std::uint64_t first = 0;
  std::vector<std::array<std::uint64_t, N>> corners;
  std::vector<std::int32_t> labels;  ///< one each
};

struct ShareItems {
  ShareElements<4> cells;
  ShareElements<3> triangles;
  ShareElements<2> edges;
  std::vector<std::pair<std::uint64_t, std::int32_t>> vertex_labels;  ///< vertex → label, in file order
  std::vector<std::uint64_t> fixed;                                   ///< vertices
  std::vector<double> cell_rows;  ///< of each cell all components of all MeshShare::cell_fields()
  /// One for each of these fields: whether a triangle or an edge has another value of it than 0. Or empty.
  std::vector<std::uint8_t> has_other_values;
};

/// What this process reads of a file. All processes make one at the same time. All functions throw
/// InvalidInput for what such a file may not have, and IoError where it cannot be read.
class MeshShare {
 public:
  virtual ~MeshShare() = default;

  std::uint64_t n_points() const { return begins_.back(); }
  std::uint64_t n_cells() const { return n_cells_; }
  /// Process r reads the points from number point_begins()[r] to below point_begins()[r + 1].
  std::span<const std::uint64_t> point_begins() const { return begins_; }
  /// (dimension, label) → name, as MeshData has them.
  const std::map<std::pair<int, int>, std::string>& names() const { return names_; }
  /// Arrays that are read; no two of the same name.
  const std::vector<ShareField>& point_fields() const { return point_fields_; }
  const std::vector<ShareField>& cell_fields() const { return cell_fields_; }
  /// One line each: what the file has that is not read, or read as something else. The same for all.
  const std::vector<std::string>& notes() const { return notes_; }

  virtual SharePoints points() = 0;
  /// The elements of this process come in so many portions; of others, there may be more or fewer.
  virtual std::size_t n_portions() const = 0;
  virtual ShareItems portion(std::size_t i) = 0;

 protected:
  std::vector<std::uint64_t> begins_;
  std::uint64_t n_cells_ = 0;
  std::map<std::pair<int, int>, std::string> names_;
  std::vector<ShareField> point_fields_, cell_fields_;
  std::vector<std::string> notes_;
};

/// By extension: .vtu of raw appended data, .mesh, .meshb, .msh. `at_once`: elements of a portion, about.
std::unique_ptr<MeshShare> open_share(const std::filesystem::path& path, const Processes& processes,
                                      std::uint64_t at_once);
/// Whether open_share() knows the extension.
bool has_shares(const std::filesystem::path& path);

// By format.
std::unique_ptr<MeshShare> vtu_share(const std::filesystem::path& path, const Processes& processes,
                                     std::uint64_t at_once);
std::unique_ptr<MeshShare> medit_share(const std::filesystem::path& path, const Processes& processes,
                                       std::uint64_t at_once);
std::unique_ptr<MeshShare> gmsh_share(const std::filesystem::path& path, const Processes& processes,
                                      std::uint64_t at_once);

}  // namespace hfr::io

#endif
