// SPDX-License-Identifier: BSD-3-Clause
#include "hfremesh/Transfer/Edits.hh"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "Arrays.hh"
#include "Mesh.hh"
#include "hfremesh/Transfer/Fields.hh"

namespace hfr::python {
namespace {

/// One number of each item.
template <class Item, class Value>
auto column(const std::vector<Item>& items, Value&& value) {
  std::vector<decltype(value(items[0]))> values;
  values.reserve(items.size());
  for (const Item& item : items) values.push_back(value(item));
  return values;
}

std::int64_t number(auto handle) { return handle.is_valid() ? static_cast<std::int64_t>(handle.idx()) : -1; }

Array<double> points_array(const std::vector<PlacedVertex>& vertices) {
  std::vector<double> flat;
  for (const PlacedVertex& v : vertices) flat.insert(flat.end(), {v.point.x, v.point.y, v.point.z});
  return to_array(std::move(flat), {vertices.size(), 3});
}

Array<double> weights_array(const std::vector<PlacedVertex>& vertices) {
  std::vector<double> flat;
  for (const PlacedVertex& v : vertices) flat.insert(flat.end(), v.weights.begin(), v.weights.end());
  return to_array(std::move(flat), {vertices.size(), 4});
}

Array<std::int64_t> vertices_array(const std::vector<PlacedVertex>& vertices) {
  return to_array(column(vertices, [](const PlacedVertex& v) { return number(v.vertex); }));
}

Array<std::int64_t> old_cells_array(const std::vector<PlacedVertex>& vertices) {
  return to_array(column(vertices, [](const PlacedVertex& v) { return number(v.old_cell); }));
}

/// Which may take a while when it is the first time.
const Parents& parents(const Edits& edits) {
  nb::gil_scoped_release others_run;
  return edits.parents();
}

void bind_cells(nb::class_<Edits>& type) {
  type.def_prop_ro(
          "removed_cells", [](const Edits& e) { return handle_array(e.removed_cells); }, kOwned,
          "(k,) int64, old cells.")
      .def_prop_ro(
          "created_cells",
          [](const Edits& e) {
            return to_array(column(e.created_cells, [](const CreatedCell& c) { return number(c.cell); }));
          },
          kOwned, "(k,) int64, new cells.")
      .def_prop_ro(
          "created_cell_vertices",
          [](const Edits& e) {
            return tuple_array(column(e.created_cells, [](const CreatedCell& c) { return c.vertices; }));
          },
          kOwned, "(k, 4) int64, new vertices of each created cell.")
      .def_prop_ro(
          "parent_offsets",
          [](const Edits& e) {
            return to_array(
                column(parents(e).first, [](std::size_t i) { return static_cast<std::int64_t>(i); }));
          },
          kOwned,
          "(k + 1,) int64: the parents of created cell i are parent_cells[offsets[i]:offsets[i + 1]]. They "
          "are "
          "found when they are first asked for; ValueError: left out by parents=False.")
      .def_prop_ro(
          "parent_cells",
          [](const Edits& e) {
            return to_array(column(parents(e).all, [](const ParentCell& p) { return number(p.old_cell); }));
          },
          kOwned, "(p,) int64, old cells; of each created cell the largest share first.")
      .def_prop_ro(
          "parent_shares",
          [](const Edits& e) {
            return to_array(column(parents(e).all, [](const ParentCell& p) { return p.share; }));
          },
          kOwned, "(p,) float64: the common volume as a share of the created cell's.")
      .def_prop_ro(
          "moved_cells", [](const Edits& e) { return handle_array(e.moved_cells); }, kOwned,
          "(k,) int64, new cells that have their old vertices, one of which has moved.");
}

void bind_vertices(nb::class_<Edits>& type) {
  type.def_prop_ro(
          "removed_vertices", [](const Edits& e) { return handle_array(e.removed_vertices); }, kOwned,
          "(k,) int64, old vertices.")
      .def_prop_ro(
          "created_vertices", [](const Edits& e) { return vertices_array(e.created_vertices); }, kOwned,
          "(k,) int64, new vertices.")
      .def_prop_ro(
          "created_points", [](const Edits& e) { return points_array(e.created_vertices); }, kOwned,
          "(k, 3) float64.")
      .def_prop_ro(
          "created_old_cells", [](const Edits& e) { return old_cells_array(e.created_vertices); }, kOwned,
          "(k,) int64: the old cell in which each was made; -1: none is near.")
      .def_prop_ro(
          "created_weights", [](const Edits& e) { return weights_array(e.created_vertices); }, kOwned,
          "(k, 4) float64: barycentric coordinates in that cell.")
      .def_prop_ro(
          "moved_vertices", [](const Edits& e) { return vertices_array(e.moved_vertices); }, kOwned,
          "(k,) int64, new vertices that the repair itself has moved.")
      .def_prop_ro(
          "moved_points", [](const Edits& e) { return points_array(e.moved_vertices); }, kOwned,
          "(k, 3) float64: where they are.")
      .def_prop_ro(
          "moved_old_cells", [](const Edits& e) { return old_cells_array(e.moved_vertices); }, kOwned,
          "(k,) int64: the old cell in which each now lies; -1: none is near.")
      .def_prop_ro(
          "moved_weights", [](const Edits& e) { return weights_array(e.moved_vertices); }, kOwned,
          "(k, 4) float64: barycentric coordinates in that cell.");
}

}  // namespace

void bind_edits(nb::module_& module) {
  nb::class_<MeshMaps>(
      module, "Maps",
      "What became of vertices and cells; old ones are those of the mesh before, new ones those "
      "after. int64, -1 for none.")
      .def_prop_ro(
          "vertices", [](const MeshMaps& m) { return handle_array(m.vertices); }, kOwned,
          "By old vertex: the new one, which may have moved; -1: removed.")
      .def_prop_ro(
          "cells", [](const MeshMaps& m) { return handle_array(m.cells); }, kOwned,
          "By old cell: the new one of the same four vertices; -1: its place was filled otherwise.")
      .def_prop_ro(
          "old_vertices", [](const MeshMaps& m) { return handle_array(m.old_vertices); }, kOwned,
          "By new vertex: the old one; -1: inserted.")
      .def_prop_ro(
          "old_cells", [](const MeshMaps& m) { return handle_array(m.old_cells); }, kOwned,
          "By new cell: the old one of the same four vertices; -1: none.")
      .def_prop_ro(
          "sources", [](const MeshMaps& m) { return handle_array(m.sources); }, kOwned,
          "By new vertex: the old one whose field values it has.");
  nb::class_<Edits> type(
      module, "Edits",
      "What a repair did to a mesh, element by element: enough for a solver to bring its arrays, "
      "its matrix and its own fields up to date. Ascending lists.");
  type.def_ro("maps", &Edits::maps)
      .def_prop_ro("empty", &Edits::empty, "Whether nothing was done.")
      .def("__repr__", [](const Edits& e) {
        return "<hfremesh.Edits: " + std::to_string(e.removed_cells.size()) + " cells removed, " +
               std::to_string(e.created_cells.size()) + " created; " +
               std::to_string(e.removed_vertices.size()) + " vertices removed, " +
               std::to_string(e.created_vertices.size()) + " created, " +
               std::to_string(e.moved_vertices.size()) + " moved>";
      });
  bind_cells(type);
  bind_vertices(type);
  nb::class_<FieldReport>(module, "FieldReport", "What became of a field that was carried over.")
      .def_ro("name", &FieldReport::name)
      .def_ro("n_changed", &FieldReport::n_changed, "Values that were written.")
      .def_ro("n_outside", &FieldReport::n_outside,
              "Of these, for things that lie beyond the mesh as it was, in part or as a whole.")
      .def_ro("integral", &FieldReport::integral,
              "With 'conserve', by component: what the changed cells held.")
      .def_ro(
          "lost", &FieldReport::lost,
          "What of it found no place within the range of the old values; rounding where the surface stays.");
}

}  // namespace hfr::python
