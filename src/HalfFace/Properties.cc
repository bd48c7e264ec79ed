// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Properties.hh"

#include <cxxabi.h>

#include <cstdlib>

#include "HalfFace/Errors.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr {
namespace {

std::string type_name(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> readable(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), std::free);
  return readable ? readable.get() : type.name();
}

template <class H>
std::vector<Index> indices(const std::vector<H>& handles) {
  std::vector<Index> result(handles.size());
  for (std::size_t i = 0; i < handles.size(); ++i) result[i] = handles[i].idx();
  return result;
}

}  // namespace

void detail::fail_property_index(std::string_view name, std::size_t i, std::size_t n) {
  throw InvalidInput("property \"" + std::string(name) + "\" has " + std::to_string(n) +
                     " values and was asked for number " + std::to_string(i));
}

void detail::fail_property_type(std::string_view kind, std::string_view name, const std::type_info& holds,
                                const std::type_info& asked) {
  throw InvalidInput(std::string(kind) + " property \"" + std::string(name) + "\" holds " + type_name(holds) +
                     " and was asked for as " + type_name(asked) + "; give one of the two another name");
}

void PropertySet::renumber(const TetMesh& of, const std::vector<VertexHandle>& new_vertex,
                           std::size_t n_vertices, const std::vector<CellHandle>& new_cell,
                           std::size_t n_cells) {
  for (DenseList* list : {&vertices, &cells}) list->drop_unheld();
  for (TupleList* list : {&edges, &halfedges, &faces, &halffaces}) {
    list->drop_unheld();
    for (const auto& p : *list) p->rename(of, new_vertex);
  }
  if (!vertices.empty()) {
    const std::vector<Index> to = indices(new_vertex);
    for (const auto& p : vertices) p->permute(to, n_vertices);
  }
  if (!cells.empty()) {
    const std::vector<Index> to = indices(new_cell);
    for (const auto& p : cells) p->permute(to, n_cells);
  }
}

std::size_t PropertySet::memory_bytes() const {
  std::size_t sum = vertices.memory_bytes() + cells.memory_bytes() + mesh.memory_bytes();
  for (const TupleList* list : {&edges, &halfedges, &faces, &halffaces}) sum += list->memory_bytes();
  return sum;
}

void PropertySet::take(PropertySet& saved, std::size_t n_vertices, std::size_t n_cells) {
  vertices.take(saved.vertices, n_vertices);
  cells.take(saved.cells, n_cells);
  edges.take(saved.edges, 0);
  halfedges.take(saved.halfedges, 0);
  faces.take(saved.faces, 0);
  halffaces.take(saved.halffaces, 0);
  mesh.take(saved.mesh, 0);
}

}  // namespace hfr
