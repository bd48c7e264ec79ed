// SPDX-License-Identifier: BSD-3-Clause
#include "Arrays.hh"

#include <cmath>

namespace hfr::c {
namespace {

std::string shape_text(std::int64_t rows, std::int64_t columns) {
  return (rows < 0 ? "any number" : std::to_string(rows)) + " x " + std::to_string(columns);
}

std::int64_t size_of(std::int32_t type) { return type == HFR_INT32 || type == HFR_FLOAT32 ? 4 : 8; }

}  // namespace

std::string place(const std::string& name, std::int64_t row, std::int64_t column) {
  return name + "[" + std::to_string(row) + "][" + std::to_string(column) + "]";
}

void require_array(const hfr_array* array, const std::string& name, std::int64_t rows, int columns) {
  HFR_REQUIRE(array, name + ": the array is NULL");
  HFR_REQUIRE(array->type >= HFR_INT32 && array->type <= HFR_FLOAT64,
              name + ": " + std::to_string(array->type) + " is no hfr_type");
  const bool fits = array->rows >= 0 && (rows < 0 || array->rows == rows) && array->columns == columns;
  HFR_REQUIRE(fits, name + ": an array of " + shape_text(rows, columns) + " is wanted, not of " +
                        shape_text(array->rows, array->columns));
  HFR_REQUIRE(array->rows == 0 || array->data, name + ": the array's data is NULL");
  const std::int64_t row = size_of(array->type) * columns;
  const bool strides = array->row_stride == 0 ||
                       (std::abs(array->row_stride) >= row && array->row_stride % size_of(array->type) == 0);
  HFR_REQUIRE(strides, name + ": a row_stride of " + std::to_string(array->row_stride) +
                           " bytes is no whole number of items, or shorter than a row");
}

void require_integers(const hfr_array& array, const std::string& name) {
  HFR_REQUIRE(array.type == HFR_INT32 || array.type == HFR_INT64, name + ": integers are wanted");
}

std::vector<Vec3> points_of(const hfr_array* array, const std::string& name, std::int64_t rows) {
  require_array(array, name, rows, 3);
  std::vector<Vec3> points(static_cast<std::size_t>(array->rows));
  for_each(*array, [&](std::int64_t i, std::int64_t j, auto value) {
    const auto real = static_cast<double>(value);
    HFR_REQUIRE(std::isfinite(real), place(name, i, j) + " is not finite");
    Vec3& p = points[static_cast<std::size_t>(i)];
    (j == 0 ? p.x : j == 1 ? p.y : p.z) = real;
  });
  return points;
}

template <std::size_t N>
std::vector<std::array<Index, N>> indices_of(const hfr_array* array, const std::string& name, int columns,
                                             int base, std::size_t n) {
  require_array(array, name, -1, columns);
  require_integers(*array, name);
  std::vector<std::array<Index, N>> all(static_cast<std::size_t>(array->rows));
  for_each(*array, [&](std::int64_t i, std::int64_t j, auto value) {
    if (j >= static_cast<std::int64_t>(N)) return;
    const auto index = static_cast<std::int64_t>(value) - base;
    HFR_REQUIRE(index >= 0 && std::cmp_less(index, n),
                place(name, i, j) + " is " + std::to_string(index + base) + ", out of range: there are " +
                    std::to_string(n) + " vertices, counted from " + std::to_string(base));
    all[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = static_cast<Index>(index);
  });
  return all;
}

template std::vector<std::array<Index, 1>> indices_of<1>(const hfr_array*, const std::string&, int, int,
                                                         std::size_t);
template std::vector<std::array<Index, 3>> indices_of<3>(const hfr_array*, const std::string&, int, int,
                                                         std::size_t);
template std::vector<std::array<Index, 4>> indices_of<4>(const hfr_array*, const std::string&, int, int,
                                                         std::size_t);

}  // namespace hfr::c
