// SPDX-License-Identifier: BSD-3-Clause
// Fields are properties of the types that files have them in (IO/ReadWrite.hh): a scalar, a vector of three,
// 2, 4, 6 or 9 components, or any other number of them.
#include <array>
#include <vector>

#include "Arrays.hh"

using namespace hfr;
using namespace hfr::c;

namespace {

template <class T>
auto* components(T& value) {
  if constexpr (std::is_arithmetic_v<std::remove_const_t<T>>)
    return &value;
  else if constexpr (std::is_same_v<std::remove_const_t<T>, Vec3>)
    return &value.x;
  else
    return value.data();
}

/// Calls f with a value of the type that a field of `columns` numbers of Number is kept as.
template <class Number, class F>
void with_value_type(int columns, F&& f) {
  const auto n = static_cast<std::size_t>(columns);
  if (n == 1) return f(Number{});
  if constexpr (std::is_floating_point_v<Number>) {
    if (n == 3) return f(Vec3{});
  } else {
    if (n == 3) return f(std::array<Number, 3>{});
  }
  if (n == 2) return f(std::array<Number, 2>{});
  if (n == 4) return f(std::array<Number, 4>{});
  if (n == 6) return f(std::array<Number, 6>{});
  if (n == 9) return f(std::array<Number, 9>{});
  f(std::vector<Number>(n));
}

template <class F>
void with_value_type(const hfr_array& a, F&& f) {
  if (a.type == HFR_INT32 || a.type == HFR_INT64)
    with_value_type<std::int64_t>(a.columns, f);
  else
    with_value_type<double>(a.columns, f);
}

bool is_of_vertices(const char* of) {
  const std::string_view word = text_of(of, "of");
  HFR_REQUIRE(word == "vertices" || word == "cells",
              "a field is of 'vertices' or of 'cells', not of '" + std::string(word) + "'");
  return word == "vertices";
}

void require_field(const hfr_mesh& mesh, bool of_vertices, const std::string& name, const hfr_array* array) {
  const std::size_t n = of_vertices ? mesh.tets.n_vertices() : mesh.tets.n_cells();
  HFR_REQUIRE(!name.empty(), "a field has a name");
  HFR_REQUIRE(array && array->columns > 0, name + ": an array with columns is wanted");
  require_array(array, name, static_cast<std::int64_t>(n), array->columns);
}

template <class H, class Property>
void write_values(Property property, const hfr_array& from, std::size_t columns) {
  for_each(from, [&](std::int64_t i, std::int64_t j, auto value) {
    auto& kept = property[H(i)];
    if constexpr (requires { kept.resize(columns); }) kept.resize(columns);
    auto* numbers = components(kept);
    numbers[j] = static_cast<std::remove_reference_t<decltype(*numbers)>>(value);
  });
}

template <class H, class Property>
void read_values(const Property& property, const std::string& name, const hfr_array& into) {
  for_each(into, [&](std::int64_t i, std::int64_t j, auto& value) {
    const auto& kept = property[H(i)];
    if constexpr (requires { kept.resize(0); })
      HFR_REQUIRE(std::cmp_less(j, kept.size()),
                  name + " has " + std::to_string(kept.size()) + " components");
    value = static_cast<std::remove_reference_t<decltype(value)>>(components(kept)[j]);
  });
}

}  // namespace

hfr_status hfr_mesh_set_field(hfr_mesh* mesh, const char* of, const char* name, const hfr_array* values) {
  return guarded(mesh, [&] {
    const bool of_vertices = is_of_vertices(of);
    const std::string called(text_of(name, "name"));
    require_field(*mesh, of_vertices, called, values);
    with_value_type(*values, [&](auto zero) {
      using T = decltype(zero);
      const auto columns = static_cast<std::size_t>(values->columns);
      if (of_vertices)
        write_values<VertexHandle>(mesh->tets.request_vertex_property<T>(called, zero), *values, columns);
      else
        write_values<CellHandle>(mesh->tets.request_cell_property<T>(called, zero), *values, columns);
    });
  });
}

hfr_status hfr_mesh_get_field(hfr_mesh* mesh, const char* of, const char* name, const hfr_array* values) {
  return guarded(mesh, [&] {
    const bool of_vertices = is_of_vertices(of);
    const std::string called(text_of(name, "name"));
    require_field(*mesh, of_vertices, called, values);
    with_value_type(*values, [&](auto zero) {
      using T = decltype(zero);
      const auto read = [&](auto handle, const auto& property) {
        HFR_REQUIRE(property, "no field of " + std::string(of) + " is called '" + called + "'");
        read_values<decltype(handle)>(*property, called, *values);
      };
      if (of_vertices)
        read(VertexHandle(), std::as_const(mesh->tets).get_vertex_property<T>(called));
      else
        read(CellHandle(), std::as_const(mesh->tets).get_cell_property<T>(called));
    });
  });
}
