// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_RAW_ARRAY_HH
#define HFR_HALFFACE_RAW_ARRAY_HH

#include <cstddef>
#include <type_traits>

namespace hfr {

/// Room for N items, not initialised: a std::array of handles fills itself with invalid ones, which for the
/// scratch memory of one cavity costs more than the work on it.
template <class T, std::size_t N>
class RawArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  T* data() { return reinterpret_cast<T*>(bytes_); }
  const T* data() const { return reinterpret_cast<const T*>(bytes_); }
  T& operator[](std::size_t i) { return data()[i]; }
  const T& operator[](std::size_t i) const { return data()[i]; }
  T* begin() { return data(); }
  T* end() { return data() + N; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + N; }
  static constexpr std::size_t size() { return N; }

 private:
  alignas(T) std::byte bytes_[N * sizeof(T)];
};

}  // namespace hfr

#endif
