// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_BUFFER_HH
#define HFR_DISTRIBUTED_BUFFER_HH

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::mpi {

/// A message while it is written: values one after the other, as they are in memory. All ranks run one
/// program on machines of one kind.
class Packer {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { append(&value, sizeof(T)); }
  /// How many there are, then the values.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put_all(std::span<const T> values) {
    put(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size_bytes());
  }
  template <class T>
  void put_all(const std::vector<T>& values) {
    put_all(std::span<const T>(values));
  }

  bool empty() const { return bytes_.empty(); }
  std::vector<std::byte>& bytes() { return bytes_; }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  void append(const void* from, std::size_t n) {
    const std::size_t end = bytes_.size();
    bytes_.resize(end + n);
    if (n > 0) std::memcpy(bytes_.data() + end, from, n);
  }

  std::vector<std::byte> bytes_;
};

/// A message while it is read. Throws InternalError beyond its end.
class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    T value;
    take(&value, sizeof(T));
    return value;
  }
  template <class T>
  std::vector<T> get_all() {
    std::vector<T> values;
    append_to(values);
    return values;
  }
  /// Puts what get_all() returns behind the values.
  template <class T>
  void append_to(std::vector<T>& values) {
    const auto n = static_cast<std::size_t>(get<std::uint64_t>());
    if (n > bytes_.size() / sizeof(T)) throw InternalError("a message between ranks is too short");
    const std::size_t end = values.size();
    values.resize(end + n);
    take(values.data() + end, n * sizeof(T));
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  void take(void* to, std::size_t n) {
    if (n > bytes_.size()) throw InternalError("a message between ranks is too short");
    if (n > 0) std::memcpy(to, bytes_.data(), n);
    bytes_ = bytes_.subspan(n);
  }

  std::span<const std::byte> bytes_;
};

/// Bytes whose number is known before they are written; not initialised.
class Block {
 public:
  Block() = default;
  explicit Block(std::size_t size) : bytes_(new std::byte[size]), size_(size) {}

  std::byte* data() { return bytes_.get(); }
  const std::byte* data() const { return bytes_.get(); }
  std::size_t size() const { return size_; }

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t size_ = 0;
};

}  // namespace hfr::mpi

#endif
