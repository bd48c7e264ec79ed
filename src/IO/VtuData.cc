// SPDX-License-Identifier: BSD-3-Clause
#include "IO/VtuData.hh"

#include <zlib.h>

#include <charconv>
#include <limits>
#include <type_traits>
#include <vector>

#include "HalfFace/Errors.hh"
#include "IO/TextScanner.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

constexpr std::array<std::string_view, 10> kVtuNames = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                                        "UInt32", "Int64", "UInt64", "Float32", "Float64"};
constexpr std::array<std::size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

template <class Stored, class T>
void convert_from(bool swap, std::string_view bytes, T* out) {
  const std::size_t n = bytes.size() / sizeof(Stored);
  const char* from = bytes.data();
  if (!swap) {
    if constexpr (std::is_same_v<Stored, T>) {
      if (n > 0) std::memcpy(out, from, n * sizeof(T));
    } else {
      for (std::size_t i = 0; i < n; ++i)
        out[i] = static_cast<T>(loaded<Stored>(from + i * sizeof(Stored), false));
    }
    return;
  }
  for (std::size_t i = 0; i < n; ++i)
    out[i] = static_cast<T>(loaded<Stored>(from + i * sizeof(Stored), true));
}

constexpr std::size_t base64_length(std::size_t n_bytes) { return (n_bytes + 2) / 3 * 4; }

std::array<std::uint8_t, 256> digit_values() {
  std::array<std::uint8_t, 256> values;
  values.fill(255);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    values[static_cast<unsigned char>(kDigits[i])] = static_cast<std::uint8_t>(i);
  return values;
}

/// Appends what `text` stands for: groups of four digits, of which only the last may be padded. Returns false
/// when it is anything else.
bool decode_base64(std::string_view text, std::string& out) {
  static const std::array<std::uint8_t, 256> values = digit_values();
  if (text.size() % 4 != 0) return false;
  if (text.empty()) return true;
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0;
  std::size_t to = out.size();
  out.resize(to + text.size() / 4 * 3);
  unsigned bad = 0;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool padded = i + k + padding >= text.size();
      const unsigned value = padded ? 0 : values[static_cast<unsigned char>(text[i + k])];
      bad |= value;
      group = group << 6 | value;
    }
    out[to++] = static_cast<char>(group >> 16);
    out[to++] = static_cast<char>(group >> 8);
    out[to++] = static_cast<char>(group);
  }
  out.resize(to - padding);
  return bad < 64;
}

/// Reads one block: the parts of a block follow each other, each base64 text of its own or raw.
class BlockReader {
 public:
  BlockReader(std::string_view data, bool base64, const VtuCoding& coding, std::uint64_t n_bytes,
              const BlockFailure& fail)
      : data_(data),
        base64_(base64),
        coding_(coding),
        n_bytes_(n_bytes),
        fail_(fail),
        word_(coding.wide_header ? 8 : 4) {}

  VtuBlock read() { return coding_.zlib ? read_compressed() : read_plain(); }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    fail_(message);
    throw InvalidInput(message);
  }
  std::string decoded(std::size_t begin, std::size_t n_characters) const;
  std::uint64_t word(std::string_view bytes, std::size_t i) const;
  VtuBlock read_plain() const;
  VtuBlock read_compressed() const;
  std::string inflated(std::string_view header, std::string_view bytes) const;

  std::string_view data_;
  bool base64_;
  VtuCoding coding_;
  std::uint64_t n_bytes_;
  const BlockFailure& fail_;
  std::size_t word_;
};

std::string BlockReader::decoded(std::size_t begin, std::size_t n_characters) const {
  if (begin > data_.size() || n_characters > data_.size() - begin) fail("the data end too early");
  std::string bytes;
  if (!decode_base64(data_.substr(begin, n_characters), bytes)) fail("this is not base64 text");
  return bytes;
}

std::uint64_t BlockReader::word(std::string_view bytes, std::size_t i) const {
  if (bytes.size() / word_ <= i) fail("the data end too early");
  const char* const at = bytes.data() + i * word_;
  return word_ == 8 ? loaded<std::uint64_t>(at, coding_.swap) : loaded<std::uint32_t>(at, coding_.swap);
}

VtuBlock BlockReader::read_plain() const {
  const std::string_view too_long = "the header announces more bytes than there are";
  VtuBlock block;
  if (!base64_) {
    const std::uint64_t n = word(data_, 0);
    if (n > data_.size() - word_) fail(std::string(too_long));
    block.in_file = data_.substr(word_, n);
    return block;
  }
  const std::size_t header_length = base64_length(word_);
  const std::uint64_t n = word(decoded(0, header_length), 0);
  if (n > data_.size() / 4 * 3) fail(std::string(too_long));
  // Most writers code header and bytes as one text, some each on its own: then the header's ends with itself.
  if (decoded(0, header_length).size() == word_) {
    block.owned = decoded(header_length, base64_length(n));
  } else {
    block.owned = decoded(0, base64_length(word_ + n));
    block.owned.erase(0, word_);
  }
  if (block.owned.size() != n)
    fail("the header announces " + std::to_string(n) + " bytes, but there are " +
         std::to_string(block.owned.size()));
  return block;
}

VtuBlock BlockReader::read_compressed() const {
  const std::size_t n_header_words = 3;
  std::string decoded_header;
  std::string decoded_bytes;
  VtuBlock block;
  const std::uint64_t n_blocks =
      base64_ ? word(decoded(0, base64_length(n_header_words * word_)), 0) : word(data_, 0);
  if (n_blocks > data_.size() / word_) fail("the header announces more blocks than there are");
  const std::size_t header_size = (n_header_words + n_blocks) * word_;
  std::string_view header = data_.substr(0, header_size);
  std::string_view bytes = data_.substr(std::min(header_size, data_.size()));
  if (base64_) {
    decoded_header = decoded(0, base64_length(header_size));
    header = decoded_header;
  }
  if (header.size() != header_size) fail("the data end too early");
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < n_blocks; ++i) {
    const std::uint64_t size = word(header, n_header_words + i);
    if (size > data_.size() - total) fail("the header announces more bytes than there are");
    total += size;
  }
  if (base64_) {
    decoded_bytes = decoded(base64_length(header_size), base64_length(total));
    bytes = decoded_bytes;
  }
  if (total > bytes.size()) fail("the header announces more bytes than there are");
  block.owned = inflated(header, bytes);
  return block;
}

std::string BlockReader::inflated(std::string_view header, std::string_view bytes) const {
  const std::uint64_t n_blocks = word(header, 0);
  const std::uint64_t full = word(header, 1);
  const std::uint64_t partial = word(header, 2);
  const auto packed = [&](std::size_t i) { return word(header, 3 + i); };
  const auto size = [&](std::size_t i) { return i + 1 == n_blocks && partial != 0 ? partial : full; };
  // Whether they can hold so much, and what is needed, is known before the first is unpacked. Deflate makes
  // at most 1032 bytes of one.
  constexpr std::uint64_t kBestRatio = 1032;
  for (std::size_t i = 0; i < n_blocks; ++i)
    if (size(i) > (packed(i) + 1) * kBestRatio) fail("a block is too short for what it should hold");
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < n_blocks; ++i) total += size(i);
  if (total > n_bytes_)
    fail("its blocks hold " + std::to_string(total) + " bytes, and " + std::to_string(n_bytes_) +
         " are needed");
  std::string out;
  for (std::size_t i = 0; i < n_blocks; ++i) {
    const std::size_t begin = out.size();
    out.resize(begin + size(i));
    uLongf n = static_cast<uLongf>(size(i));
    const int status =
        ::uncompress(reinterpret_cast<Bytef*>(out.data() + begin), &n,
                     reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(packed(i)));
    if (status != Z_OK || n != size(i))
      fail("block " + std::to_string(i) + " is not the zlib data it should be");
    bytes.remove_prefix(packed(i));
  }
  return out;
}

}  // namespace

std::size_t size_of(NumberType type) { return kSizes[static_cast<std::size_t>(type)]; }

bool is_integer(NumberType type) { return type != NumberType::kFloat32 && type != NumberType::kFloat64; }

std::optional<NumberType> vtu_number_type(std::string_view name) {
  const auto* const found = std::find(kVtuNames.begin(), kVtuNames.end(), name);
  if (found == kVtuNames.end()) return std::nullopt;
  return static_cast<NumberType>(found - kVtuNames.begin());
}

template <class T>
void convert_numbers(NumberType type, bool swap, std::string_view bytes, T* out) {
  switch (type) {
    case NumberType::kInt8:
      return convert_from<std::int8_t>(swap, bytes, out);
    case NumberType::kUInt8:
      return convert_from<std::uint8_t>(swap, bytes, out);
    case NumberType::kInt16:
      return convert_from<std::int16_t>(swap, bytes, out);
    case NumberType::kUInt16:
      return convert_from<std::uint16_t>(swap, bytes, out);
    case NumberType::kInt32:
      return convert_from<std::int32_t>(swap, bytes, out);
    case NumberType::kUInt32:
      return convert_from<std::uint32_t>(swap, bytes, out);
    case NumberType::kInt64:
      return convert_from<std::int64_t>(swap, bytes, out);
    case NumberType::kUInt64:
      return convert_from<std::uint64_t>(swap, bytes, out);
    case NumberType::kFloat32:
      if constexpr (std::is_floating_point_v<T>) return convert_from<float>(swap, bytes, out);
      break;
    case NumberType::kFloat64:
      if constexpr (std::is_floating_point_v<T>) return convert_from<double>(swap, bytes, out);
      break;
  }
  throw InvalidInput("real numbers stand where integers are needed");
}

template void convert_numbers(NumberType, bool, std::string_view, double*);
template void convert_numbers(NumberType, bool, std::string_view, std::int64_t*);

template <class T>
std::optional<std::size_t> parse_numbers(std::string_view text, std::size_t n, T* out) {
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  const char* at = begin;
  for (std::size_t i = 0; i < n; ++i) {
    while (at != end && is_space(*at)) ++at;
    const auto [stop, error] = std::from_chars(at, end, out[i]);
    const bool whole = stop == end || is_space(*stop);
    if (error != std::errc{} || !whole) [[unlikely]] {
      if constexpr (!std::is_floating_point_v<T>) return static_cast<std::size_t>(at - begin);
      // A sign, an exponent or a size that from_chars does not take.
      try {
        TextScanner rest({at, static_cast<std::size_t>(end - at)}, "");
        out[i] = static_cast<T>(rest.field_value());
        at += rest.offset();
        continue;
      } catch (const InvalidInput&) {
        return static_cast<std::size_t>(at - begin);
      }
    }
    at = stop;
  }
  while (at != end && is_space(*at)) ++at;
  if (at != end) return static_cast<std::size_t>(at - begin);
  return std::nullopt;
}

template std::optional<std::size_t> parse_numbers(std::string_view, std::size_t, double*);
template std::optional<std::size_t> parse_numbers(std::string_view, std::size_t, std::int64_t*);

VtuBlock decode_block(std::string_view data, bool base64, const VtuCoding& coding, std::uint64_t n_bytes,
                      const BlockFailure& fail) {
  return BlockReader(data, base64, coding, n_bytes, fail).read();
}

void Base64Writer::add(std::string_view bytes) {
  constexpr std::size_t kChunk = 3 << 14;
  std::string text;
  const auto encode = [&](std::string_view whole) {  // a multiple of three bytes
    text.clear();
    for (std::size_t i = 0; i < whole.size(); i += 3) {
      const auto group = static_cast<std::uint32_t>(static_cast<unsigned char>(whole[i])) << 16 |
                         static_cast<std::uint32_t>(static_cast<unsigned char>(whole[i + 1])) << 8 |
                         static_cast<std::uint32_t>(static_cast<unsigned char>(whole[i + 2]));
      for (int shift = 18; shift >= 0; shift -= 6) text += kDigits[group >> shift & 63];
    }
    out_.text(text);
  };
  if (!rest_.empty()) {
    const std::size_t missing = std::min(3 - rest_.size(), bytes.size());
    rest_ += bytes.substr(0, missing);
    bytes.remove_prefix(missing);
    if (rest_.size() < 3) return;
    encode(rest_);
    rest_.clear();
  }
  while (bytes.size() >= 3) {
    const std::size_t n = std::min(bytes.size() / 3 * 3, kChunk);
    encode(bytes.substr(0, n));
    bytes.remove_prefix(n);
  }
  rest_ = bytes;
}

void Base64Writer::finish() {
  const std::size_t n = rest_.size();
  if (n == 0) return;
  rest_.resize(3);
  const std::uint32_t group = static_cast<std::uint32_t>(static_cast<unsigned char>(rest_[0])) << 16 |
                              static_cast<std::uint32_t>(static_cast<unsigned char>(rest_[1])) << 8;
  std::string text = {kDigits[group >> 18 & 63], kDigits[group >> 12 & 63],
                      n == 2 ? kDigits[group >> 6 & 63] : '=', '='};
  out_.text(text);
  rest_.clear();
}

std::string zlib_block(std::string_view bytes) {
  constexpr std::size_t kBlock = std::size_t{1} << 18;
  constexpr int kLevel = 5;  // VTK's default
  const std::size_t n_blocks = (bytes.size() + kBlock - 1) / kBlock;
  std::vector<std::uint64_t> header = {n_blocks, kBlock, bytes.size() % kBlock};
  std::string packed;
  for (std::size_t i = 0; i < n_blocks; ++i) {
    const std::string_view block = bytes.substr(i * kBlock, kBlock);
    const std::size_t begin = packed.size();
    uLongf n = ::compressBound(static_cast<uLong>(block.size()));
    packed.resize(begin + n);
    const int status =
        ::compress2(reinterpret_cast<Bytef*>(packed.data() + begin), &n,
                    reinterpret_cast<const Bytef*>(block.data()), static_cast<uLong>(block.size()), kLevel);
    if (status != Z_OK) throw ResourceLimit("zlib has not enough memory to compress an array");
    packed.resize(begin + n);
    header.push_back(n);
  }
  std::string all(reinterpret_cast<const char*>(header.data()), header.size() * sizeof(header[0]));
  return all += packed;
}

}  // namespace hfr::io
