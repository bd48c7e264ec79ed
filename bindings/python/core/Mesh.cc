// SPDX-License-Identifier: BSD-3-Clause
#include "Mesh.hh"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <map>
#include <optional>
#include <variant>

#include "Arrays.hh"
#include "hfremesh/HalfFace/Check.hh"
#include "hfremesh/HalfFace/Circulators.hh"
#include "hfremesh/IO/Assemble.hh"
#include "hfremesh/IO/Hash.hh"

namespace hfr::python {
namespace {

using namespace nb::literals;
using Names = std::map<std::pair<int, int>, std::string>;

/// Of the width of an index, with a sign: NumPy's arithmetic with unsigned integers surprises.
using SignedIndex = std::make_signed_t<Index>;

struct MeshArguments {
  nb::object regions, fields, point_fields, cell_fields, triangles, triangle_labels, edges, edge_labels;
  nb::object vertex_labels, fixed_vertices;
};

/// The items of a mapping of names to arrays.
nb::dict items_of(nb::handle fields, const char* argument) {
  const nb::object mapping = nb::module_::import_("collections.abc").attr("Mapping");
  if (!nb::isinstance(fields, mapping))
    throw nb::value_error((std::string(argument) + ": a mapping of names to arrays is wanted").c_str());
  nb::dict items = nb::borrow<nb::dict>(nb::module_::import_("builtins").attr("dict")(fields));
  for (auto [key, value] : items)
    if (!nb::isinstance<nb::str>(key))
      throw nb::value_error(
          (std::string(argument) + ": the name " + nb::repr(key).c_str() + " is no string").c_str());
  return items;
}

void add_fields(nb::handle fields, const char* argument, std::size_t n, const char* what,
                std::vector<io::Field>& out) {
  if (fields.is_none()) return;
  for (auto [key, value] : items_of(fields, argument)) {
    const std::string name = nb::cast<std::string>(key);
    io::Field field = field_of(value, std::string(argument) + "['" + name + "']", n, what);
    field.name = name;
    out.push_back(std::move(field));
  }
}

/// `fields`: to the points or to the cells, whichever have that many.
void add_fields_by_length(nb::handle fields, io::MeshData& data) {
  if (fields.is_none()) return;
  const std::size_t n = data.points.size(), m = data.cells.size();
  for (auto [key, value] : items_of(fields, "fields")) {
    const std::string name = nb::cast<std::string>(key);
    const std::string shown = "fields['" + name + "']";
    const std::size_t length = length_of(value, shown);
    if (n == m || (length != n && length != m))
      throw nb::value_error((shown + " has " + std::to_string(length) + " rows, and there are " +
                             std::to_string(n) + " points and " + std::to_string(m) + " cells" +
                             (n == m ? ": use point_fields or cell_fields" : ""))
                                .c_str());
    io::Field field = field_of(value, shown, length, length == n ? "point" : "cell");
    field.name = name;
    (length == n ? data.point_fields : data.cell_fields).push_back(std::move(field));
  }
}

void require_different_names(const std::vector<io::Field>& fields, const char* kind) {
  for (std::size_t i = 0; i < fields.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (fields[i].name == fields[j].name)
        throw nb::value_error(
            (std::string("two fields of ") + kind + " are called '" + fields[i].name + "'").c_str());
}

template <std::size_t N>
void add_labelled(nb::handle items, nb::handle labels, const std::string& name, std::size_t n_points,
                  std::vector<std::array<Index, N>>& out, std::vector<int>& out_labels) {
  const std::string label_name = name.substr(0, name.size() - 1) + "_labels";
  if (items.is_none() && !labels.is_none())
    throw nb::value_error((label_name + " were given without " + name).c_str());
  if (items.is_none()) return;
  out = tuples_of<N>(items, name, n_points);
  if (labels.is_none())
    out_labels.assign(out.size(), 0);
  else
    out_labels = labels_of(labels, label_name, out.size(), name.substr(0, name.size() - 1));
}

io::MeshData mesh_data(nb::handle points, nb::handle cells, const MeshArguments& given,
                       std::optional<Names> names) {
  io::MeshData data;
  data.points = points_of(points, "points");
  const std::size_t n = data.points.size();
  data.cells = tuples_of<4>(cells, "cells", n);
  if (!given.regions.is_none()) data.regions = labels_of(given.regions, "regions", data.cells.size(), "cell");
  add_labelled(given.triangles, given.triangle_labels, "triangles", n, data.triangles, data.triangle_labels);
  add_labelled(given.edges, given.edge_labels, "edges", n, data.edges, data.edge_labels);
  if (!given.vertex_labels.is_none())
    data.vertex_labels = labels_of(given.vertex_labels, "vertex_labels", n, "point");
  if (!given.fixed_vertices.is_none())
    data.fixed_vertices = indices_of(given.fixed_vertices, "fixed_vertices", n);
  if (names) data.names = std::move(*names);
  add_fields_by_length(given.fields, data);
  add_fields(given.point_fields, "point_fields", n, "point", data.point_fields);
  add_fields(given.cell_fields, "cell_fields", data.cells.size(), "cell", data.cell_fields);
  require_different_names(data.point_fields, "points");
  require_different_names(data.cell_fields, "cells");
  return data;
}

void make_mesh(Mesh* self, nb::handle points, nb::handle cells, nb::object regions, nb::object fields,
               nb::object point_fields, nb::object cell_fields, nb::object triangles,
               nb::object triangle_labels, nb::object edges, nb::object edge_labels, nb::object vertex_labels,
               nb::object fixed_vertices, std::optional<Names> names, int threads) {
  const MeshArguments given = {regions,         fields, point_fields, cell_fields,   triangles,
                               triangle_labels, edges,  edge_labels,  vertex_labels, fixed_vertices};
  io::MeshData data = mesh_data(points, cells, given, std::move(names));
  Mesh mesh;
  {
    const par::Policy policy = policy_of(threads);
    nb::gil_scoped_release others_run;
    mesh.tets = io::assemble(std::move(data), policy, &mesh.build, &mesh.notes);
  }
  new (self) Mesh(std::move(mesh));
}

// --- arrays ---

auto points_view(Mesh& mesh) {
  return nb::ndarray<nb::numpy, double, nb::ndim<2>>(mesh.tets.point_data(), {mesh.tets.n_vertices(), 3},
                                                     nb::find(&mesh));
}

auto cells_view(Mesh& mesh) {
  static_assert(sizeof(VertexHandle) == sizeof(Index) && sizeof(Cell) % sizeof(Index) == 0);
  const std::size_t n = mesh.tets.n_cells();
  const void* first = n == 0 ? nullptr : &mesh.tets.cell(CellHandle(0)).v;
  return nb::ndarray<nb::numpy, const SignedIndex, nb::ndim<2>>(
      first, {n, 4}, nb::find(&mesh), {static_cast<std::int64_t>(sizeof(Cell) / sizeof(Index)), 1});
}

Array<int> regions_array(const Mesh& mesh) {
  std::vector<int> regions(mesh.tets.n_cells());
  for (std::size_t c = 0; c < regions.size(); ++c) regions[c] = mesh.tets.region(CellHandle(c));
  return to_array(std::move(regions));
}

Array<std::int64_t> neighbours_array(const Mesh& mesh) {
  std::vector<std::int64_t> cells(4 * mesh.tets.n_cells());
  for (std::size_t h = 0; h < cells.size(); ++h) {
    const HalfFaceHandle mate = mesh.tets.opposite_halfface(HalfFaceHandle(h));
    cells[h] = mate.is_valid() ? static_cast<std::int64_t>(cell_of(mate).idx()) : -1;
  }
  return to_array(std::move(cells), {mesh.tets.n_cells(), 4});
}

Array<std::int64_t> boundary_faces_array(const Mesh& mesh) {
  std::vector<std::array<VertexHandle, 3>> faces;
  for (HalfFaceHandle h : mesh.tets.boundary_halffaces()) {
    const auto f = mesh.tets.halfface_vertices(h);
    faces.push_back({f[0], f[2], f[1]});  // a cell sees its faces from inside
  }
  return tuple_array(faces);
}

nb::dict fields_dict(const std::vector<io::Field>& fields) {
  nb::dict dict;
  for (const io::Field& field : fields) {
    const auto k = static_cast<std::size_t>(field.components);
    const std::size_t n = field.values.size() / k;
    const auto put = [&](auto values) {
      dict[field.name.c_str()] =
          k == 1 ? nb::cast(to_array(std::move(values))) : nb::cast(to_array(std::move(values), {n, k}));
    };
    if (field.integer)
      put(std::vector<std::int64_t>(field.values.begin(), field.values.end()));
    else
      put(field.values);
  }
  return dict;
}

/// Everything that hangs on a mesh, as one dict.
nb::dict attachments(const Mesh& mesh) {
  io::MeshData data;
  {
    nb::gil_scoped_release others_run;
    data = io::disassemble(mesh.tets);
  }
  nb::dict dict;
  dict["point_fields"] = fields_dict(data.point_fields);
  dict["cell_fields"] = fields_dict(data.cell_fields);
  dict["triangles"] = tuple_array(data.triangles);
  data.triangle_labels.resize(data.triangles.size());
  dict["triangle_labels"] = to_array(std::move(data.triangle_labels));
  dict["edges"] = tuple_array(data.edges);
  data.edge_labels.resize(data.edges.size());
  dict["edge_labels"] = to_array(std::move(data.edge_labels));
  data.vertex_labels.resize(data.points.size());
  dict["vertex_labels"] = to_array(std::move(data.vertex_labels));
  dict["fixed_vertices"] =
      to_array(std::vector<std::int64_t>(data.fixed_vertices.begin(), data.fixed_vertices.end()));
  dict["names"] = nb::cast(data.names);
  return dict;
}

// --- queries ---

template <class H>
H checked(std::int64_t index, std::size_t n, const char* kind) {
  if (index >= 0 && static_cast<std::size_t>(index) < n) return H(index);
  throw nb::index_error(
      (std::string(kind) + " " + std::to_string(index) + " is out of range: there are " + std::to_string(n))
          .c_str());
}
VertexHandle vertex(const Mesh& mesh, std::int64_t v) {
  return checked<VertexHandle>(v, mesh.tets.n_vertices(), "vertex");
}
CellHandle cell(const Mesh& mesh, std::int64_t c) {
  return checked<CellHandle>(c, mesh.tets.n_cells(), "cell");
}

EdgeHandle edge(const Mesh& mesh, std::int64_t a, std::int64_t b) {
  const EdgeHandle e = mesh.tets.find_edge(vertex(mesh, a), vertex(mesh, b));
  if (!e.is_valid())
    throw nb::value_error(
        ("no edge joins vertices " + std::to_string(a) + " and " + std::to_string(b)).c_str());
  return e;
}

using Pair = std::array<std::int64_t, 2>;

void bind_arrays(nb::class_<Mesh>& type) {
  type.def_prop_ro(
          "n_vertices", [](const Mesh& m) { return m.tets.n_vertices(); }, "Number of vertices.")
      .def_prop_ro(
          "n_cells", [](const Mesh& m) { return m.tets.n_cells(); }, "Number of tetrahedra.")
      .def_prop_ro(
          "n_edges", [](const Mesh& m) { return m.tets.n_edges(); }, "Number of edges; O(n).")
      .def_prop_ro(
          "n_faces", [](const Mesh& m) { return m.tets.n_faces(); }, "Number of faces; O(n).")
      .def_prop_ro("points", &points_view,
                   "(n, 3) float64: a view of the coordinates, no copy. Writing into it moves the vertices.",
                   kOwned)
      .def_prop_ro(
          "cells", &cells_view,
          "(m, 4) int32: a read-only view of the cells' vertices, no copy. Their order is that of the "
          "mesh, in which det(p1-p0, p2-p0, p3-p0) > 0 for a positive cell.",
          kOwned)
      .def_prop_ro("regions", &regions_array, "(m,) int32: the region of each cell; 0 where none was given.",
                   kOwned)
      .def_prop_ro("neighbors", &neighbours_array,
                   "(m, 4) int64: the cell behind the face opposite each vertex; -1 on the boundary.", kOwned)
      .def_prop_ro("boundary_faces", &boundary_faces_array,
                   "(k, 3) int64: vertices of the boundary faces, counter-clockwise seen from outside.",
                   kOwned)
      .def_prop_ro(
          "edges",
          [](const Mesh& m) {
            std::vector<std::array<VertexHandle, 2>> edges;
            for (EdgeHandle e : m.tets.edges()) edges.push_back(m.tets.edge_vertices(e));
            return tuple_array(edges);
          },
          "(k, 2) int64: the vertices of every edge.", kOwned)
      .def_prop_ro("attachments", &attachments,
                   "What hangs on the mesh, as a dict of copies: point_fields, cell_fields, triangles, "
                   "triangle_labels, edges, edge_labels, vertex_labels, fixed_vertices, names.");
}

void bind_queries(nb::class_<Mesh>& type) {
  type.def(
          "vertex_cells",
          [](const Mesh& m, std::int64_t v) { return handle_array(m.tets.vertex_cells(vertex(m, v))); },
          "v"_a, "Cells round a vertex, (k,) int64. O(k).")
      .def(
          "vertex_vertices",
          [](const Mesh& m, std::int64_t v) { return handle_array(m.tets.vertex_vertices(vertex(m, v))); },
          "v"_a, "Vertices that an edge joins with v, (k,) int64. O(k).")
      .def(
          "edge_cells",
          [](const Mesh& m, Pair e) { return handle_array(m.tets.edge_cells(edge(m, e[0], e[1]))); }, "e"_a,
          "Cells round the edge of two vertices (a, b), (k,) int64, in ring order; a fan starts at the "
          "boundary. ValueError where no edge joins them.")
      .def(
          "cell_cells",
          [](const Mesh& m, std::int64_t c) { return handle_array(m.tets.cell_cells(cell(m, c))); }, "c"_a,
          "Cells that share a face with c, at most four, (k,) int64.")
      .def(
          "cell_vertices",
          [](const Mesh& m, std::int64_t c) { return handle_array(m.tets.cell_vertices(cell(m, c))); }, "c"_a,
          "The four vertices of a cell, (4,) int64.")
      .def(
          "find_cell",
          [](const Mesh& m, std::array<std::int64_t, 4> v) {
            const CellHandle c =
                m.tets.find_cell({vertex(m, v[0]), vertex(m, v[1]), vertex(m, v[2]), vertex(m, v[3])});
            return c.is_valid() ? std::optional<std::int64_t>(c.idx()) : std::nullopt;
          },
          "vertices"_a, "The cell of four vertices in any order; None where there is none.")
      .def(
          "is_boundary_vertex",
          [](const Mesh& m, std::int64_t v) { return m.tets.is_boundary(vertex(m, v)); }, "v"_a,
          "Whether the vertex lies on the boundary.")
      .def(
          "is_boundary_cell", [](const Mesh& m, std::int64_t c) { return m.tets.is_boundary(cell(m, c)); },
          "c"_a, "Whether a face of the cell lies on the boundary.");
}

void bind_facts(nb::class_<Mesh>& type) {
  type.def_prop_ro(
          "flipped", [](const Mesh& m) { return m.build.flipped; },
          "Whether the cells came the other way round, all of them, and were turned as a whole.")
      .def_prop_ro(
          "reoriented", [](const Mesh& m) { return handle_array(m.build.reoriented); },
          "(k,) int64: cells whose order contradicted their neighbours' and was turned.", kOwned)
      .def_prop_ro(
          "notes", [](const Mesh& m) { return m.notes; },
          "One line for each thing that was skipped, or could not be kept, while the mesh was made.")
      .def_prop_ro(
          "hash", [](const Mesh& m) { return io::hash_text(io::mesh_hash(m.tets)); },
          "16 hexadecimal digits of coordinates, cells, regions and labels: what the tool prints.")
      .def(
          "copy", [](const Mesh& m) { return Mesh(m); }, "A mesh of its own with all that hangs on this one.")
      .def("__repr__", [](const Mesh& m) {
        return "<hfremesh.Mesh: " + std::to_string(m.tets.n_vertices()) + " vertices, " +
               std::to_string(m.tets.n_cells()) + " cells>";
      });
}

void bind_structure(nb::module_& module) {
  module.def(
      "structure",
      [](const Mesh& m, int threads) {
        const par::Policy policy = policy_of(threads);
        CheckResult found;
        {
          nb::gil_scoped_release others_run;
          found = check(m.tets, {.policy = policy});
        }
        return nb::make_tuple(std::string(rule_name(found.rule)), found.message, handle_array(found.vertices),
                              handle_array(found.cells));
      },
      "mesh"_a, "threads"_a = 0, "The first rule that the mesh breaks: its name, a line, vertices, cells.");
}

}  // namespace

par::Policy policy_of(int threads) {
  constexpr int kMost = 1024;
  if (threads < 0 || threads > kMost)
    throw nb::value_error(
        ("threads: a whole number from 0 to 1024 is wanted, not " + std::to_string(threads)).c_str());
  par::Policy policy = par::Policy::all();
  if (threads > 0) policy.threads = threads;
  return policy;
}

void bind_mesh(nb::module_& module) {
  nb::class_<Mesh> type(
      module, "Mesh",
      "Tetrahedral mesh with its half-face connectivity.\n\n"
      "points: (n, 3), cells: (m, 4) indices of points; arrays of any integer or float type and memory "
      "order.\n"
      "Cells may come in either orientation: those that contradict their neighbours are turned, which may "
      "make "
      "them inverted, and the order of a cell's vertices may change.\n\n"
      "regions: (m,) integers. triangles, edges: (k, 3), (k, 2) labelled faces and edges, which are kept as "
      "they are. fixed_vertices: (k,) vertices that stay where they are. fields: name to array of n or m "
      "rows; "
      "point_fields and cell_fields say which. names: {(dimension, label): name}. threads: 0 is every "
      "core.\n\n"
      "Raises ValueError that names the first index at fault: a wrong shape, an index out of range, a "
      "coordinate "
      "that is not finite, a repeated vertex, a face of three cells.\n\n"
      "Connectivity never changes: improve() gives another mesh. Reading from several threads is safe.");
  type.def("__init__", &make_mesh, "points"_a, "cells"_a, nb::kw_only(), "regions"_a = nb::none(),
           "fields"_a = nb::none(), "point_fields"_a = nb::none(), "cell_fields"_a = nb::none(),
           "triangles"_a = nb::none(), "triangle_labels"_a = nb::none(), "edges"_a = nb::none(),
           "edge_labels"_a = nb::none(), "vertex_labels"_a = nb::none(), "fixed_vertices"_a = nb::none(),
           "names"_a = nb::none(), "threads"_a = 0,
           nb::sig("def __init__(self, points: numpy.typing.ArrayLike, cells: numpy.typing.ArrayLike, *, "
                   "regions: numpy.typing.ArrayLike | None = None, "
                   "fields: dict[str, numpy.typing.ArrayLike] | None = None, "
                   "point_fields: dict[str, numpy.typing.ArrayLike] | None = None, "
                   "cell_fields: dict[str, numpy.typing.ArrayLike] | None = None, "
                   "triangles: numpy.typing.ArrayLike | None = None, "
                   "triangle_labels: numpy.typing.ArrayLike | None = None, "
                   "edges: numpy.typing.ArrayLike | None = None, "
                   "edge_labels: numpy.typing.ArrayLike | None = None, "
                   "vertex_labels: numpy.typing.ArrayLike | None = None, "
                   "fixed_vertices: numpy.typing.ArrayLike | None = None, "
                   "names: dict[tuple[int, int], str] | None = None, threads: int = 0) -> None"));
  bind_arrays(type);
  bind_queries(type);
  bind_facts(type);
  bind_structure(module);
}

}  // namespace hfr::python
