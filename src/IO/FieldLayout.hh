// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_FIELD_LAYOUT_HH
#define HFR_IO_FIELD_LAYOUT_HH

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "hfremesh/HalfFace/Vec3.hh"

/// In which types of properties fields are kept, whoever makes them: readers of files, or callers with
/// arrays. A scalar is a double, a vector of three a Vec3; 2, 4, 6 and 9 components are a std::array of
/// doubles; of integers all these have std::int64_t instead (three: std::array<std::int64_t, 3>). Any other
/// number of components is a std::vector<double>.
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
  /// What an item lacks is 0.
  static double get(const std::vector<double>& value, int k) {
    return static_cast<std::size_t>(k) < value.size() ? value[static_cast<std::size_t>(k)] : 0.0;
  }
  static void set(std::vector<double>& value, int k, double x) {
    if (static_cast<std::size_t>(k) >= value.size()) value.resize(static_cast<std::size_t>(k) + 1);
    value[static_cast<std::size_t>(k)] = x;
  }
};

/// Components of a property: of vectors as many as the longest has, since each may have a length of its own.
template <class T>
int n_components(const T& preset, const auto& values) {
  if constexpr (Layout<T>::kComponents > 0) {
    return Layout<T>::kComponents;
  } else {
    std::size_t most = preset.size();
    for (const T& value : values) most = std::max(most, value.size());
    return static_cast<int>(most);
  }
}

/// Calls `f.template operator()<T>()` with the type T that a field of this shape is kept in.
template <class F>
decltype(auto) with_field_type(int components, bool integer, F&& f) {
  const auto either = [&]<class Real, class Integer>() -> decltype(auto) {
    return integer ? f.template operator()<Integer>() : f.template operator()<Real>();
  };
  const auto array = [&]<std::size_t N>() -> decltype(auto) {
    return either.template operator()<std::array<double, N>, std::array<std::int64_t, N>>();
  };
  switch (components) {
    case 1:
      return either.template operator()<double, std::int64_t>();
    case 2:
      return array.template operator()<2>();
    case 3:
      return either.template operator()<Vec3, std::array<std::int64_t, 3>>();
    case 4:
      return array.template operator()<4>();
    case 6:
      return array.template operator()<6>();
    case 9:
      return array.template operator()<9>();
    default:
      return f.template operator()<std::vector<double>>();
  }
}

/// What an item of such a field has by default: zeros.
template <class T>
T field_preset(int components) {
  if constexpr (Layout<T>::kComponents == 0)
    return T(static_cast<std::size_t>(components));
  else
    return T{};
}

/// The components of a value, one after the other, in their own type.
template <class T>
auto* components_of(T& value) {
  if constexpr (std::is_arithmetic_v<std::remove_const_t<T>>)
    return &value;
  else if constexpr (std::same_as<std::remove_const_t<T>, Vec3>)
    return &value.x;
  else
    return value.data();
}

}  // namespace hfr::io

#endif
