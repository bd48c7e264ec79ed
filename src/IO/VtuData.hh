// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_VTU_DATA_HH
#define HFR_IO_VTU_DATA_HH

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "IO/OutputFile.hh"

/// Arrays of numbers as VTK's files hold them: of any type, in either byte order, and in .vtu coded as base64
/// and compressed.
namespace hfr::io {

enum class NumberType {
  kInt8,
  kUInt8,
  kInt16,
  kUInt16,
  kInt32,
  kUInt32,
  kInt64,
  kUInt64,
  kFloat32,
  kFloat64
};

std::size_t size_of(NumberType type);
bool is_integer(NumberType type);
/// "Int32", "Float64" …, as in .vtu files.
std::optional<NumberType> vtu_number_type(std::string_view name);

/// The T at `bytes`, which need not be aligned.
template <class T>
T loaded(const char* bytes, bool swap) {
  std::array<char, sizeof(T)> copy;
  std::memcpy(copy.data(), bytes, sizeof(T));
  if (swap) std::reverse(copy.begin(), copy.end());
  return std::bit_cast<T>(copy);
}

/// Writes the numbers in `bytes`, which are of type `type` and in the other byte order if `swap`, to `out`.
template <class T>
void convert_numbers(NumberType type, bool swap, std::string_view bytes, T* out);
extern template void convert_numbers(NumberType, bool, std::string_view, double*);
extern template void convert_numbers(NumberType, bool, std::string_view, std::int64_t*);

/// Reads n numbers separated by white space from `text`, which must hold no more than these. On failure
/// returns the offset of what stands in place of a number, or of what follows the last one.
template <class T>
std::optional<std::size_t> parse_numbers(std::string_view text, std::size_t n, T* out);
extern template std::optional<std::size_t> parse_numbers(std::string_view, std::size_t, double*);
extern template std::optional<std::size_t> parse_numbers(std::string_view, std::size_t, std::int64_t*);

/// How a .vtu file codes its binary arrays.
struct VtuCoding {
  bool swap = false;         ///< the byte order is not this machine's
  bool wide_header = false;  ///< header words have 64 bits, not 32
  bool zlib = false;
};

/// Bytes of one array, in the file's memory or in memory of their own.
struct VtuBlock {
  std::string owned;
  std::string_view in_file;
  std::string_view bytes() const { return in_file.data() ? in_file : std::string_view(owned); }
};

/// Must throw.
using BlockFailure = std::function<void(const std::string& message)>;

/// The array that begins at `data`, which may go on behind it: header words, then bytes, base64 if so, and
/// compressed if so. No more memory is taken than `data` can fill, nor for compressed bytes that are not as
/// many as `n_bytes`.
VtuBlock decode_block(std::string_view data, bool base64, const VtuCoding& coding, std::uint64_t n_bytes,
                      const BlockFailure& fail);

/// Base64 text of bytes that come in pieces.
class Base64Writer {
 public:
  explicit Base64Writer(OutputFile& out) : out_(out) {}
  void add(std::string_view bytes);
  void finish();  ///< writes what is left, padded

 private:
  OutputFile& out_;
  std::string rest_;  ///< fewer than three bytes
};

/// Header words (64-bit) and zlib blocks of `bytes`, as a compressed .vtu file holds them.
std::string zlib_block(std::string_view bytes);

}  // namespace hfr::io

#endif
