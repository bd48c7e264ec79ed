// SPDX-License-Identifier: BSD-3-Clause
// Callers' arrays as fields, in properties of the types that io::with_field_type() has for them.
#include <array>
#include <vector>

#include "Arrays.hh"
#include "hfremesh/IO/FieldLayout.hh"

using namespace hfr;
using namespace hfr::c;

namespace {

template <class F>
void with_field_type(const hfr_array& a, F&& f) {
  io::with_field_type(a.columns, a.type == HFR_INT32 || a.type == HFR_INT64, f);
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
void write_values(Property property, const std::string& name, const hfr_array& from) {
  const auto columns = static_cast<std::size_t>(from.columns);
  if constexpr (std::same_as<std::remove_cvref_t<decltype(property.default_value())>, std::vector<double>>)
    HFR_REQUIRE(property.default_value().size() == columns,
                name + " has " + std::to_string(property.default_value().size()) + " components");
  for_each(from, [&](std::int64_t, std::int64_t, auto value) {
    using Number = std::remove_reference_t<decltype(*io::components_of(property[H(0)]))>;
    held<Number>(value, name);
  });
  for_each(from, [&](std::int64_t i, std::int64_t j, auto value) {
    auto& kept = property[H(i)];
    if constexpr (requires { kept.resize(columns); }) kept.resize(columns);
    auto* numbers = io::components_of(kept);
    numbers[j] = static_cast<std::remove_reference_t<decltype(*numbers)>>(value);
  });
}

template <class H, class Property>
void read_values(const Property& property, const std::string& name, const hfr_array& into) {
  for_each(into, [&](std::int64_t i, std::int64_t j, auto& value) {
    const auto& kept = property[H(i)];
    if constexpr (requires { kept.resize(0); })
      HFR_REQUIRE(std::cmp_equal(kept.size(), into.columns),
                  name + " has " + std::to_string(kept.size()) + " components");
    value = held<std::remove_reference_t<decltype(value)>>(io::components_of(kept)[j], name);
  });
}

}  // namespace

hfr_status hfr_mesh_set_field(hfr_mesh* mesh, const char* of, const char* name, const hfr_array* values) {
  return guarded(mesh, [&] {
    const bool of_vertices = is_of_vertices(of);
    const std::string called(text_of(name, "name"));
    require_field(*mesh, of_vertices, called, values);
    with_field_type(*values, [&]<class T>() {
      const T zero = io::field_preset<T>(values->columns);
      if (of_vertices)
        write_values<VertexHandle>(mesh->tets.request_vertex_property<T>(called, zero), called, *values);
      else
        write_values<CellHandle>(mesh->tets.request_cell_property<T>(called, zero), called, *values);
    });
  });
}

hfr_status hfr_mesh_get_field(hfr_mesh* mesh, const char* of, const char* name, const hfr_array* values) {
  return guarded(mesh, [&] {
    const bool of_vertices = is_of_vertices(of);
    const std::string called(text_of(name, "name"));
    require_field(*mesh, of_vertices, called, values);
    with_field_type(*values, [&]<class T>() {
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
