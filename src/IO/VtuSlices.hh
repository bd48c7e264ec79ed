// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_VTU_SLICES_HH
#define HFR_IO_VTU_SLICES_HH

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "HalfFace/Vec3.hh"
#include "IO/ByteRanges.hh"
#include "IO/MeshShare.hh"
#include "IO/VtuData.hh"

namespace hfr::io {

/// A .vtu of tetrahedra, and triangles and lines among them, whose arrays are raw appended data, read a range
/// at a time: each of several processes reads its own, and none the whole. All functions throw InvalidInput
/// for what such a file may not have, and IoError where it cannot be read.
class VtuSlices {
 public:
  /// Reads what stands before the arrays, and compares the lengths that they announce.
  explicit VtuSlices(const std::filesystem::path& path);

  std::uint64_t n_points() const { return n_points_; }
  /// Tetrahedra, triangles and lines.
  std::uint64_t n_items() const { return n_items_; }
  const std::map<std::pair<int, int>, std::string>& names() const { return names_; }
  /// The other arrays of numbers; no two of the same name.
  std::vector<ShareField> point_fields() const { return shapes(point_arrays_); }
  std::vector<ShareField> cell_fields() const { return shapes(cell_arrays_); }
  /// What the file has beside all these.
  const std::vector<std::string>& notes() const { return notes_; }

  // Those with the numbers begin … end-1.
  std::vector<Vec3> points(std::uint64_t begin, std::uint64_t end);
  std::vector<std::int32_t> vertex_labels(std::uint64_t begin, std::uint64_t end);  ///< empty: none has one
  std::vector<std::uint8_t> fixed(std::uint64_t begin, std::uint64_t end);          ///< empty: none is
  std::vector<double> point_rows(std::uint64_t begin, std::uint64_t end) {
    return rows(point_arrays_, begin, end);
  }
  struct Kinds {
    std::uint64_t cells = 0, triangles = 0, edges = 0;
    Kinds& operator+=(const Kinds& o) {
      cells += o.cells, triangles += o.triangles, edges += o.edges;
      return *this;
    }
  };
  Kinds kinds(std::uint64_t begin, std::uint64_t end);
  /// Their numbers among their kind are left 0, and so are the labels where the file has none.
  ShareItems items(std::uint64_t begin, std::uint64_t end);

 private:
  struct Array {
    std::string name;
    NumberType type = NumberType::kFloat64;
    std::uint64_t components = 0;  // 0: it is not there
    std::uint64_t begin = 0;       // of its numbers in the file
  };
  class Header;

  static std::vector<ShareField> shapes(const std::vector<Array>& arrays);

  [[noreturn]] void fail(const std::string& message) const { in_.fail(message); }
  std::string head();
  std::uint64_t announced(const Array& array);
  void require_length(const Array& array, std::uint64_t n);
  template <class T>
  std::vector<T> numbers(const Array& array, std::uint64_t begin, std::uint64_t end);
  std::vector<std::int32_t> labels(const Array& array, const char* of, std::uint64_t begin,
                                   std::uint64_t end);
  std::vector<double> rows(const std::vector<Array>& arrays, std::uint64_t begin, std::uint64_t end);
  void take_rows(std::uint64_t begin, const std::vector<std::uint8_t>& types, ShareItems& items);
  std::vector<std::uint8_t> types(std::uint64_t begin, std::uint64_t end);
  std::vector<std::uint64_t> ends(std::uint64_t begin, std::uint64_t end);
  template <std::size_t N>
  void take(ShareElements<N>& elements, std::uint64_t number, const std::int64_t* corners,
            std::int32_t label) const;

  ByteRanges in_;
  VtuCoding coding_;
  std::uint64_t n_points_ = 0, n_items_ = 0;
  Array points_, corners_, ends_, types_, regions_, vertex_labels_, fixed_;
  std::vector<Array> point_arrays_, cell_arrays_;
  std::map<std::pair<int, int>, std::string> names_;
  std::vector<std::string> notes_;
};

}  // namespace hfr::io

#endif
