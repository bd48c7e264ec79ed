// SPDX-License-Identifier: BSD-3-Clause
#include "IO/FieldProperties.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>

#include "IO/FieldLayout.hh"

namespace hfr::io {
namespace {

using std::int64_t;

/// Integers that a double cannot hold exactly, or that are none, stay doubles.
bool is_integer(const Field& field) {
  return field.integer && std::all_of(field.values.begin(), field.values.end(),
                                      [](double x) { return std::abs(x) <= 0x1p53 && std::trunc(x) == x; });
}

/// `Request` makes the property of type T: request.operator()<T>(name, preset).
template <class Request>
void attach(const std::vector<Field>& fields, std::vector<std::string> names, std::size_t n_items,
            std::string_view kind, std::vector<std::string>* notes, Request&& request) {
  for (const Field& field : fields) {
    HFR_REQUIRE(
        field.components >= 1 && field.values.size() == n_items * static_cast<std::size_t>(field.components),
        "field '" + field.name + "' has " + std::to_string(field.values.size()) + " values for " +
            std::to_string(n_items) + " items of " + std::to_string(field.components) + " components");
    const std::string name = field.name.empty() ? "unnamed" : field.name;  // no name: nobody would find it
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      if (notes) notes->push_back("a second " + std::string(kind) + " field '" + name + "' was left out");
      continue;
    }
    names.push_back(name);
    with_field_type(field.components, is_integer(field), [&]<class T>() {
      auto property = request.template operator()<T>(name, field_preset<T>(field.components));
      const double* value = field.values.data();
      for (T& item : property.values())
        for (int k = 0; k < field.components; ++k) Layout<T>::set(item, k, *value++);
    });
  }
}

/// Appends the field of a property if that holds values of type T.
template <class T, class Handle>
bool detach_as(const TetMesh& mesh, const detail::DenseStored& stored, std::vector<Field>& fields) {
  if (stored.is_anonymous() || stored.type() != typeid(T)) return false;
  auto& property = const_cast<detail::Dense<T>&>(static_cast<const detail::Dense<T>&>(stored));
  Field field;
  field.name = stored.name();
  field.integer = Layout<T>::kInteger;
  field.components = n_components(property.preset, property.values);
  if (field.components == 0) return true;
  field.values.reserve(property.values.size() * static_cast<std::size_t>(field.components));
  for (std::size_t i = 0; i < property.values.size(); ++i) {
    if (mesh.is_deleted(Handle(i))) continue;
    for (int k = 0; k < field.components; ++k) field.values.push_back(Layout<T>::get(property.at(i), k));
  }
  fields.push_back(std::move(field));
  return true;
}

template <class Handle, class... Types>
void detach(const TetMesh& mesh, const detail::DenseStored& stored, std::vector<Field>& fields) {
  (detach_as<Types, Handle>(mesh, stored, fields) || ...);
}

template <class Handle>
std::vector<Field> detach_all(const TetMesh& mesh, const PropertySet::DenseList& properties) {
  std::vector<Field> fields;
  for (const auto& stored : properties)
    detach<Handle, double, float, int, bool, int64_t, Vec3, std::array<double, 2>, std::array<double, 4>,
           std::array<double, 6>, std::array<double, 9>, std::array<int64_t, 2>, std::array<int64_t, 3>,
           std::array<int64_t, 4>, std::array<int64_t, 6>, std::array<int64_t, 9>, std::vector<double>>(
        mesh, *stored, fields);
  return fields;
}

}  // namespace

void attach_fields(TetMesh& mesh, const std::vector<Field>& point_fields,
                   const std::vector<Field>& cell_fields, std::vector<std::string>* notes) {
  attach(point_fields, mesh.properties().vertices.names(), mesh.n_vertices(), "point", notes,
         [&]<class T>(const std::string& name, const T& preset) {
           return mesh.request_vertex_property<T>(name, preset);
         });
  attach(cell_fields, mesh.properties().cells.names(), mesh.n_cells(), "cell", notes,
         [&]<class T>(const std::string& name, const T& preset) {
           return mesh.request_cell_property<T>(name, preset);
         });
}

std::vector<Field> point_fields(const TetMesh& mesh) {
  return detach_all<VertexHandle>(mesh, mesh.properties().vertices);
}

std::vector<Field> cell_fields(const TetMesh& mesh) {
  return detach_all<CellHandle>(mesh, mesh.properties().cells);
}

}  // namespace hfr::io
