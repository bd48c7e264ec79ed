// SPDX-License-Identifier: BSD-3-Clause
#include "Fields.hh"

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "hfremesh/IO/Assemble.hh"

namespace hfr::python {
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

/// Calls f with a value of the type that the field is kept as.
template <class Number, class F>
void with_value_type(std::size_t n, F&& f) {
  using Three = std::conditional_t<std::is_floating_point_v<Number>, Vec3, std::array<Number, 3>>;
  if (n == 1) return f(Number{});
  if (n == 2) return f(std::array<Number, 2>{});
  if (n == 3) return f(Three{});
  if (n == 4) return f(std::array<Number, 4>{});
  if (n == 6) return f(std::array<Number, 6>{});
  if (n == 9) return f(std::array<Number, 9>{});
  f(std::vector<Number>(n));
}

template <class F>
void with_value_type(const FieldKind& kind, F&& f) {
  const auto n = static_cast<std::size_t>(kind.components);
  if (kind.integer)
    with_value_type<std::int64_t>(n, f);
  else
    with_value_type<double>(n, f);
}

void add_kinds(const std::vector<io::Field>& fields, bool of_vertices, std::vector<FieldKind>& kinds) {
  for (const io::Field& field : fields)
    kinds.push_back({field.name, of_vertices, field.integer, field.components});
}

}  // namespace

std::vector<FieldKind> field_kinds(const TetMesh& mesh) {
  const io::MeshData data = io::disassemble(mesh);
  std::vector<FieldKind> kinds;
  add_kinds(data.point_fields, true, kinds);
  add_kinds(data.cell_fields, false, kinds);
  return kinds;
}

std::vector<double> field_values(const TetMesh& mesh, const FieldKind& kind) {
  const auto k = static_cast<std::size_t>(kind.components);
  std::vector<double> values(k * (kind.of_vertices ? mesh.n_vertices() : mesh.n_cells()));
  with_value_type(kind, [&](auto zero) {
    using T = decltype(zero);
    const auto read = [&]<class H>(H, const auto& property) {
      HFR_REQUIRE(property, "there is no field '" + kind.name + "'");
      for (std::size_t i = 0; k * i < values.size(); ++i)
        for (std::size_t j = 0; j < k; ++j)
          values[k * i + j] = static_cast<double>(components((*property)[H(i)])[j]);
    };
    if (kind.of_vertices)
      read(VertexHandle(), mesh.get_vertex_property<T>(kind.name));
    else
      read(CellHandle(), mesh.get_cell_property<T>(kind.name));
  });
  return values;
}

void set_field_values(TetMesh& mesh, const FieldKind& kind, const std::vector<double>& values) {
  const auto k = static_cast<std::size_t>(kind.components);
  with_value_type(kind, [&](auto zero) {
    using T = decltype(zero);
    const auto write = [&]<class H>(H, auto property) {
      for (std::size_t i = 0; k * i < values.size(); ++i) {
        auto& kept = property[H(i)];
        if constexpr (requires { kept.resize(k); }) kept.resize(k);
        auto* numbers = components(kept);
        for (std::size_t j = 0; j < k; ++j)
          numbers[j] = static_cast<std::remove_reference_t<decltype(*numbers)>>(values[k * i + j]);
      }
    };
    if (kind.of_vertices)
      write(VertexHandle(), mesh.request_vertex_property<T>(kind.name, zero));
    else
      write(CellHandle(), mesh.request_cell_property<T>(kind.name, zero));
  });
}

}  // namespace hfr::python
