// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_C_ARRAYS_HH
#define HFR_BINDINGS_C_ARRAYS_HH

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "Handles.hh"

/// Callers' arrays. Whatever does not fit throws InvalidInput that names the first row and column at fault.
namespace hfr::c {

/// Throws InvalidInput unless there is an array of the shape; rows < 0: of any number of rows.
void require_array(const hfr_array* array, const std::string& name, std::int64_t rows, int columns);
void require_integers(const hfr_array& array, const std::string& name);

template <class T>
T& element(const hfr_array& a, std::int64_t i, std::int64_t j) {
  const std::int64_t stride =
      a.row_stride != 0 ? a.row_stride : static_cast<std::int64_t>(sizeof(T)) * a.columns;
  return reinterpret_cast<T*>(static_cast<char*>(a.data) + i * stride)[j];
}

/// Calls visit(i, j, element) row by row, with elements in their own type; they may be written.
template <class Visit>
void for_each(const hfr_array& a, Visit&& visit) {
  const auto all = [&](auto zero) {
    for (std::int64_t i = 0; i < a.rows; ++i)
      for (std::int64_t j = 0; j < a.columns; ++j) visit(i, j, element<decltype(zero)>(a, i, j));
  };
  if (a.type == HFR_INT32) return all(std::int32_t{});
  if (a.type == HFR_INT64) return all(std::int64_t{});
  if (a.type == HFR_FLOAT32) return all(float{});
  return all(double{});
}

/// "cells[5][2]", rows counted from 0 as C does.
std::string place(const std::string& name, std::int64_t row, std::int64_t column);

std::vector<Vec3> points_of(const hfr_array* array, const std::string& name, std::int64_t rows);
/// Indices of `base` 0 or 1 below base + n, as handles' numbers; of the first N columns.
template <std::size_t N>
std::vector<std::array<Index, N>> indices_of(const hfr_array* array, const std::string& name, int columns,
                                             int base, std::size_t n);

/// As a number of an array; throws where that cannot hold it.
template <class To, class From>
To held(From x, const std::string& name) {
  if constexpr (std::integral<To>) {
    bool fits = false;
    if constexpr (std::integral<From>)
      fits = std::in_range<To>(x);
    else
      fits =
          x == std::trunc(x) && x >= -0x1p63 && x < 0x1p63 && std::in_range<To>(static_cast<std::int64_t>(x));
    HFR_REQUIRE(fits, name + ": there are values that these integers cannot hold; use wider ones or doubles");
  } else if constexpr (std::integral<From>) {
    // 2^63 as a floating-point number is one more than an integer has.
    const auto real = static_cast<To>(x);
    HFR_REQUIRE(static_cast<double>(real) < 0x1p63 && static_cast<From>(real) == x,
                name + ": there are integers that floating-point numbers of this width do not have");
  }
  return static_cast<To>(x);
}

/// Writes value(i, j) into the array, which must be rows x columns.
template <class Value>
void fill(const hfr_array* array, const std::string& name, std::size_t rows, int columns, Value&& value) {
  require_array(array, name, static_cast<std::int64_t>(rows), columns);
  for_each(*array, [&](std::int64_t i, std::int64_t j, auto& out) {
    out = held<std::remove_reference_t<decltype(out)>>(
        value(static_cast<std::size_t>(i), static_cast<std::size_t>(j)), name);
  });
}

/// As callers count; base - 1 for an invalid handle.
template <class H>
std::int64_t number(const hfr_mesh& mesh, H handle) {
  return handle.is_valid() ? static_cast<std::int64_t>(handle.idx()) + mesh.base : mesh.base - 1;
}

}  // namespace hfr::c

#endif
