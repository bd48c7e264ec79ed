// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_FIELD_LAYOUT_HH
#define HFR_IO_FIELD_LAYOUT_HH

#include <array>
#include <concepts>
#include <cstddef>
#include <vector>

#include "HalfFace/Vec3.hh"

namespace hfr::io {

/// How a value type lies in a field: number of components (0 = as the value says) and access to them.
template <class T>
struct Layout {
  static constexpr int kComponents = 1;
  static constexpr bool kInteger = std::integral<T>;
  static double get(const T& value, int) { return static_cast<double>(value); }
  static void set(T& value, int, double x) { value = static_cast<T>(x); }
};
template <>
struct Layout<Vec3> {
  static constexpr int kComponents = 3;
  static constexpr bool kInteger = false;
  static double get(const Vec3& value, int k) { return value[k]; }
  static void set(Vec3& value, int k, double x) { value[k] = x; }
};
template <class T, std::size_t N>
struct Layout<std::array<T, N>> {
  static constexpr int kComponents = static_cast<int>(N);
  static constexpr bool kInteger = std::integral<T>;
  static double get(const std::array<T, N>& value, int k) {
    return static_cast<double>(value[static_cast<std::size_t>(k)]);
  }
  static void set(std::array<T, N>& value, int k, double x) {
    value[static_cast<std::size_t>(k)] = static_cast<T>(x);
  }
};
template <>
struct Layout<std::vector<double>> {
  static constexpr int kComponents = 0;
  static constexpr bool kInteger = false;
  static double get(const std::vector<double>& value, int k) { return value[static_cast<std::size_t>(k)]; }
  static void set(std::vector<double>& value, int k, double x) { value[static_cast<std::size_t>(k)] = x; }
};

}  // namespace hfr::io

#endif
