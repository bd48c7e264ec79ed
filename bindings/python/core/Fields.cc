// SPDX-License-Identifier: BSD-3-Clause
#include "Fields.hh"

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "hfremesh/IO/Assemble.hh"
#include "hfremesh/IO/FieldLayout.hh"

namespace hfr::python {
namespace {

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
  io::with_field_type(kind.components, kind.integer, [&]<class T>() {
    const auto read = [&]<class H>(H, const auto& property) {
      HFR_REQUIRE(property, "there is no field '" + kind.name + "'");
      for (std::size_t i = 0; k * i < values.size(); ++i)
        for (std::size_t j = 0; j < k; ++j)
          values[k * i + j] = static_cast<double>(io::components_of((*property)[H(i)])[j]);
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
  io::with_field_type(kind.components, kind.integer, [&]<class T>() {
    const auto write = [&]<class H>(H, auto property) {
      for (std::size_t i = 0; k * i < values.size(); ++i) {
        auto& kept = property[H(i)];
        if constexpr (requires { kept.resize(k); }) kept.resize(k);
        auto* numbers = io::components_of(kept);
        for (std::size_t j = 0; j < k; ++j)
          numbers[j] = static_cast<std::remove_reference_t<decltype(*numbers)>>(values[k * i + j]);
      }
    };
    const T zero = io::field_preset<T>(kind.components);
    if (kind.of_vertices)
      write(VertexHandle(), mesh.request_vertex_property<T>(kind.name, zero));
    else
      write(CellHandle(), mesh.request_cell_property<T>(kind.name, zero));
  });
}

}  // namespace hfr::python
