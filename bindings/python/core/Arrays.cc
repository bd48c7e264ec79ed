// SPDX-License-Identifier: BSD-3-Clause
#include "Arrays.hh"

#include <nanobind/stl/string.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace hfr::python {
namespace {

using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;

[[noreturn]] void fail(const std::string& message) { throw nb::value_error(message.c_str()); }

std::string shape_text(const AnyArray& a) {
  std::string text = "(";
  for (std::size_t i = 0; i < a.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(a.shape(i));
  return text + (a.ndim() == 1 ? ",)" : ")");
}

std::string place(const std::string& name, const AnyArray& a, std::size_t i, std::size_t j) {
  return name + "[" + std::to_string(i) + (a.ndim() > 1 ? ", " + std::to_string(j) : "") + "]";
}

/// What numpy.asarray makes of it, in a form that can be read here: a copy only for the other byte order, odd
/// sizes of floats, and strides that are no whole numbers of items.
AnyArray array_of(nb::handle object, const std::string& name) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  nb::object array = numpy.attr("asarray")(object);
  const std::string kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
  const auto size = nb::cast<std::size_t>(array.attr("dtype").attr("itemsize"));
  if (kind != "i" && kind != "u" && kind != "f")
    fail(name + ": an array of integers or floats is wanted, not of " +
         nb::cast<std::string>(array.attr("dtype").attr("name")));
  const bool odd = kind == "f" && size != 4 && size != 8;
  if (odd || !nb::cast<bool>(array.attr("dtype").attr("isnative"))) {
    const nb::object native =
        odd ? nb::object(numpy.attr("float64")) : array.attr("dtype").attr("newbyteorder")("=");
    array = array.attr("astype")(native);
  }
  AnyArray out;
  const auto size_now = nb::cast<std::int64_t>(array.attr("dtype").attr("itemsize"));
  bool whole = nb::cast<bool>(array.attr("flags").attr("aligned"));
  for (nb::handle stride : nb::cast<nb::tuple>(array.attr("strides")))
    whole = whole && nb::cast<std::int64_t>(stride) % size_now == 0;
  if (!whole) array = array.attr("copy")("C");
  if (!nb::try_cast(array, out)) fail(name + ": this array cannot be read");
  return out;
}

/// Calls read(i, j, value) row by row with the values in their own type.
template <class T, class Read>
void for_each_of(const AnyArray& a, std::size_t rows, std::size_t columns, Read&& read) {
  const T* data = static_cast<const T*>(a.data());
  const std::int64_t down = a.ndim() > 0 ? a.stride(0) : 0, right = a.ndim() > 1 ? a.stride(1) : 0;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j)
      read(i, j, data[static_cast<std::int64_t>(i) * down + static_cast<std::int64_t>(j) * right]);
}

template <class Read>
void for_each_integer(const AnyArray& a, std::size_t rows, std::size_t columns, Read&& read) {
  const auto is = [&](auto type) { return a.dtype() == nb::dtype<decltype(type)>(); };
  if (is(std::int64_t{})) return for_each_of<std::int64_t>(a, rows, columns, read);
  if (is(std::uint64_t{})) return for_each_of<std::uint64_t>(a, rows, columns, read);
  if (is(std::int32_t{})) return for_each_of<std::int32_t>(a, rows, columns, read);
  if (is(std::uint32_t{})) return for_each_of<std::uint32_t>(a, rows, columns, read);
  if (is(std::int16_t{})) return for_each_of<std::int16_t>(a, rows, columns, read);
  if (is(std::uint16_t{})) return for_each_of<std::uint16_t>(a, rows, columns, read);
  if (is(std::int8_t{})) return for_each_of<std::int8_t>(a, rows, columns, read);
  return for_each_of<std::uint8_t>(a, rows, columns, read);
}

template <class Read>
void for_each_number(const AnyArray& a, std::size_t rows, std::size_t columns, Read&& read) {
  if (a.dtype() == nb::dtype<double>()) return for_each_of<double>(a, rows, columns, read);
  if (a.dtype() == nb::dtype<float>()) return for_each_of<float>(a, rows, columns, read);
  return for_each_integer(a, rows, columns, read);
}

bool is_integer(const AnyArray& a) {
  return a.dtype().code != static_cast<std::uint8_t>(nb::dlpack::dtype_code::Float);
}

void require_shape(const AnyArray& a, const std::string& name, bool fits, const std::string& wanted) {
  if (!fits) fail(name + ": an array of shape " + wanted + " is wanted, not " + shape_text(a));
}

void require_integers(const AnyArray& a, const std::string& name) {
  if (!is_integer(a)) fail(name + ": an array of integers is wanted, not of floats");
}

/// An index below n, or ValueError.
template <class T>
Index index_of(const AnyArray& a, const std::string& name, std::size_t i, std::size_t j, T value,
               std::size_t n) {
  if (std::cmp_greater_equal(value, 0) && std::cmp_less(value, n)) return static_cast<Index>(value);
  fail(place(name, a, i, j) + " is " + std::to_string(value) + ", out of range: there are " +
       std::to_string(n) + " points");
}

}  // namespace

void require_finite(const Vec3* points, std::size_t n, const std::string& name) {
  for (std::size_t i = 0; i < n; ++i) {
    const double p[3] = {points[i].x, points[i].y, points[i].z};
    for (std::size_t j = 0; j < 3; ++j)
      if (!std::isfinite(p[j]))
        fail(name + "[" + std::to_string(i) + ", " + std::to_string(j) + "] is " + std::to_string(p[j]) +
             "; coordinates must be finite");
  }
}

std::vector<Vec3> points_of(nb::handle object, const std::string& name) {
  const AnyArray a = array_of(object, name);
  require_shape(a, name, a.ndim() == 2 && a.shape(1) == 3, "(n, 3)");
  const std::size_t n = a.shape(0);
  if (n >= VertexHandle::kInvalid)
    fail(name + ": " + std::to_string(n) + " points are more than an index counts");
  std::vector<Vec3> points(n);
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && std::is_trivially_copyable_v<Vec3>);
  if (n == 0) return points;
  double* out = &points[0].x;
  if (a.dtype() == nb::dtype<double>() && a.stride(0) == 3 && a.stride(1) == 1)
    std::memcpy(static_cast<void*>(out), a.data(), n * sizeof(Vec3));
  else
    for_each_number(a, n, 3, [&](std::size_t i, std::size_t j, auto value) {
      out[3 * i + j] = static_cast<double>(value);
    });
  require_finite(points.data(), n, name);
  return points;
}

template <std::size_t N>
std::vector<std::array<Index, N>> tuples_of(nb::handle object, const std::string& name,
                                            std::size_t n_points) {
  const AnyArray a = array_of(object, name);
  require_shape(a, name, (a.ndim() == 2 && a.shape(1) == N) || a.size() == 0,
                "(m, " + std::to_string(N) + ")");
  const std::size_t m = a.size() == 0 ? 0 : a.shape(0);
  if (m > 0) require_integers(a, name);
  std::vector<std::array<Index, N>> tuples(m);
  for_each_integer(a, m, N, [&](std::size_t i, std::size_t j, auto value) {
    tuples[i][j] = index_of(a, name, i, j, value, n_points);
  });
  return tuples;
}

template std::vector<std::array<Index, 4>> tuples_of<4>(nb::handle, const std::string&, std::size_t);
template std::vector<std::array<Index, 3>> tuples_of<3>(nb::handle, const std::string&, std::size_t);
template std::vector<std::array<Index, 2>> tuples_of<2>(nb::handle, const std::string&, std::size_t);

std::vector<int> labels_of(nb::handle object, const std::string& name, std::size_t n,
                           const std::string& what) {
  const AnyArray a = array_of(object, name);
  require_shape(a, name, a.ndim() == 1 && a.shape(0) == n,
                "(" + std::to_string(n) + ",), one a " + what + ",");
  if (n > 0) require_integers(a, name);
  std::vector<int> labels(n);
  for_each_integer(a, n, 1, [&](std::size_t i, std::size_t j, auto value) {
    if (std::cmp_less(value, std::numeric_limits<int>::min()) ||
        std::cmp_greater(value, std::numeric_limits<int>::max()))
      fail(place(name, a, i, j) + " is " + std::to_string(value) + ", more than 32 bits hold");
    labels[i] = static_cast<int>(value);
  });
  return labels;
}

std::vector<Index> indices_of(nb::handle object, const std::string& name, std::size_t n) {
  const AnyArray a = array_of(object, name);
  require_shape(a, name, a.ndim() == 1, "(k,)");
  if (a.size() > 0) require_integers(a, name);
  std::vector<Index> indices(a.size());
  for_each_integer(a, a.size(), 1, [&](std::size_t i, std::size_t j, auto value) {
    indices[i] = index_of(a, name, i, j, value, n);
  });
  return indices;
}

io::Field field_of(nb::handle object, const std::string& name, std::size_t n, const std::string& what) {
  constexpr double kLargestWhole = 9007199254740992;  // 2^53: beyond, a double leaves out integers
  const AnyArray a = array_of(object, name);
  const bool fits = (a.ndim() == 1 || (a.ndim() == 2 && a.shape(1) > 0)) && a.shape(0) == n;
  require_shape(a, name, fits,
                "(" + std::to_string(n) + ",) or (" + std::to_string(n) + ", k), one row a " + what + ",");
  io::Field field;
  field.name = name;
  field.components = a.ndim() == 1 ? 1 : static_cast<int>(a.shape(1));
  field.integer = is_integer(a);
  const std::size_t columns = a.ndim() == 1 ? 1 : a.shape(1);
  field.values.resize(n * columns);
  for_each_number(a, n, columns, [&](std::size_t i, std::size_t j, auto value) {
    const auto real = static_cast<double>(value);
    if (field.integer && std::abs(real) > kLargestWhole)
      fail(place(name, a, i, j) + " is " + std::to_string(value) + "; integers of fields go up to 2^53");
    field.values[i * columns + j] = real;
  });
  return field;
}

std::size_t length_of(nb::handle object, const std::string& name) {
  const AnyArray a = array_of(object, name);
  require_shape(a, name, a.ndim() >= 1, "(n,) or (n, k)");
  return a.shape(0);
}

}  // namespace hfr::python
