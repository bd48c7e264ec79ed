// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_VTU_SLICES_HH
#define HFR_IO_VTU_SLICES_HH

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "HalfFace/Vec3.hh"
#include "IO/VtuData.hh"

namespace hfr::io {

/// A .vtu of tetrahedra whose arrays are raw appended data, read a range at a time: each of several processes
/// reads its own, and none the whole. All functions throw InvalidInput for what such a file may not have, and
/// IoError where it cannot be read.
class VtuSlices {
 public:
  /// Reads what stands before the arrays, and compares the lengths that they announce.
  explicit VtuSlices(const std::filesystem::path& path);

  std::uint64_t n_points() const { return n_points_; }
  std::uint64_t n_cells() const { return n_cells_; }
  bool has_regions() const { return regions_.components > 0; }
  /// What the file has beside points, tetrahedra and regions.
  const std::vector<std::string>& notes() const { return notes_; }

  // Those with the numbers begin … end-1.
  std::vector<Vec3> points(std::uint64_t begin, std::uint64_t end);
  std::vector<std::array<std::uint64_t, 4>> cells(std::uint64_t begin, std::uint64_t end);
  std::vector<std::int32_t> regions(std::uint64_t begin, std::uint64_t end);

 private:
  struct Array {
    std::string name;
    NumberType type = NumberType::kFloat64;
    std::uint64_t components = 0;  // 0: it is not there
    std::uint64_t begin = 0;       // of its numbers in the file
  };
  class Header;

  [[noreturn]] void fail(const std::string& message) const;
  std::string head();
  std::string bytes(std::uint64_t begin, std::uint64_t n);
  void require_length(const Array& array, std::uint64_t n);
  template <class T>
  std::vector<T> numbers(const Array& array, std::uint64_t begin, std::uint64_t end);

  std::string name_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  VtuCoding coding_;
  std::uint64_t n_points_ = 0, n_cells_ = 0;
  Array points_, corners_, ends_, types_, regions_;
  std::vector<std::string> notes_;
};

}  // namespace hfr::io

#endif
