// SPDX-License-Identifier: BSD-3-Clause
#include <optional>

#include "Arrays.hh"
#include "hfremesh/HalfFace/Check.hh"
#include "hfremesh/HalfFace/Circulators.hh"
#include "hfremesh/IO/ReadWrite.hh"

using namespace hfr;
using namespace hfr::c;

namespace {

par::Policy all_threads() { return par::Policy::all(); }

/// The mesh of the handle becomes another one.
void replace_mesh(hfr_mesh& mesh, TetMesh tets) {
  mesh.tets = std::move(tets);
  mesh.maps = {};
  mesh.invalid_cells.clear();
}

std::size_t n_boundary_faces(const TetMesh& mesh) {
  std::size_t n = 0;
  for ([[maybe_unused]] HalfFaceHandle h : mesh.boundary_halffaces()) ++n;
  return n;
}

template <class H>
void get_handles(const hfr_mesh& mesh, const std::vector<H>& handles, const std::string& name,
                 const hfr_array* out) {
  fill(out, name, handles.size(), 1, [&](std::size_t i, std::size_t) { return number(mesh, handles[i]); });
}

double coordinate(Vec3 p, std::size_t j) { return j == 0 ? p.x : j == 1 ? p.y : p.z; }

void get_boundary_faces(const hfr_mesh& mesh, const std::string& name, const hfr_array* out) {
  std::vector<std::array<VertexHandle, 3>> faces;
  for (HalfFaceHandle h : mesh.tets.boundary_halffaces()) {
    const auto f = mesh.tets.halfface_vertices(h);
    faces.push_back({f[0], f[2], f[1]});  // a cell sees its faces from inside
  }
  fill(out, name, faces.size(), 3, [&](std::size_t i, std::size_t j) { return number(mesh, faces[i][j]); });
}

void get_array(const hfr_mesh& mesh, const std::string& what, const hfr_array* out) {
  const TetMesh& tets = mesh.tets;
  const std::size_t n = tets.n_vertices(), m = tets.n_cells();
  if (what == "points")
    fill(out, what, n, 3,
         [&](std::size_t i, std::size_t j) { return coordinate(tets.point(VertexHandle(i)), j); });
  else if (what == "cells")
    fill(out, what, m, 4,
         [&](std::size_t i, std::size_t j) { return number(mesh, tets.cell_vertices(CellHandle(i))[j]); });
  else if (what == "regions")
    fill(out, what, m, 1, [&](std::size_t i, std::size_t) { return tets.region(CellHandle(i)); });
  else if (what == "neighbours")
    fill(out, what, m, 4, [&](std::size_t i, std::size_t j) {
      const HalfFaceHandle mate = tets.opposite_halfface(halfface_of(CellHandle(i), static_cast<int>(j)));
      return number(mesh, mate.is_valid() ? cell_of(mate) : CellHandle());
    });
  else if (what == "boundary_faces")
    get_boundary_faces(mesh, what, out);
  else if (what == "invalid_cells")
    get_handles(mesh, mesh.invalid_cells, what, out);
  else if (what == "map_vertices")
    get_handles(mesh, mesh.maps.vertices, what, out);
  else if (what == "map_cells")
    get_handles(mesh, mesh.maps.cells, what, out);
  else if (what == "source_vertices")
    get_handles(mesh, mesh.maps.sources, what, out);
  else
    throw InvalidInput(
        "there is no '" + what +
        "' to get; there are points, cells, regions, neighbours, boundary_faces, invalid_cells, "
        "map_vertices, map_cells, source_vertices");
}

void set_points(TetMesh& tets, const hfr_array* values) {
  const std::vector<Vec3> points = points_of(values, "points", static_cast<std::int64_t>(tets.n_vertices()));
  for (std::size_t i = 0; i < points.size(); ++i) tets.set_point(VertexHandle(i), points[i]);
}

/// Integers of 32 bits.
std::vector<int> labels_of(const hfr_array& a, const std::string& name, std::int64_t column) {
  std::vector<int> labels(static_cast<std::size_t>(a.rows));
  for_each(a, [&](std::int64_t i, std::int64_t j, auto value) {
    if (j != column) return;
    labels[static_cast<std::size_t>(i)] = static_cast<int>(value);
    HFR_REQUIRE(labels[static_cast<std::size_t>(i)] == value,
                place(name, i, j) + " is more than 32 bits hold");
  });
  return labels;
}

void set_array(hfr_mesh& mesh, const std::string& what, const hfr_array* values) {
  TetMesh& tets = mesh.tets;
  if (what == "points") {
    set_points(tets, values);
  } else if (what == "regions") {
    require_array(values, what, static_cast<std::int64_t>(tets.n_cells()), 1);
    require_integers(*values, what);
    const std::vector<int> regions = labels_of(*values, what, 0);
    for (std::size_t i = 0; i < regions.size(); ++i) tets.set_region(CellHandle(i), regions[i]);
  } else if (what == "fixed_vertices") {
    const auto fixed = indices_of<1>(values, what, 1, mesh.base, tets.n_vertices());
    for (VertexHandle v : tets.vertices()) tets.set_fixed(v, false);
    for (const auto& v : fixed) tets.set_fixed(VertexHandle(v[0]));
  } else if (what == "labelled_faces") {
    const auto faces = indices_of<3>(values, what, 4, mesh.base, tets.n_vertices());
    const std::vector<int> labels = labels_of(*values, what, 3);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const auto& f = faces[i];
      HFR_REQUIRE(tets.find_face({VertexHandle(f[0]), VertexHandle(f[1]), VertexHandle(f[2])}).is_valid(),
                  what + "[" + std::to_string(i) + "]: there is no such face");
    }
    tets.labels().faces = {};
    for (std::size_t i = 0; i < faces.size(); ++i)
      tets.labels().faces.set(
          {VertexHandle(faces[i][0]), VertexHandle(faces[i][1]), VertexHandle(faces[i][2])}, labels[i]);
  } else {
    throw InvalidInput("there is no '" + what +
                       "' to set; there are points, regions, fixed_vertices, labelled_faces");
  }
}

VertexHandle vertex(const hfr_mesh& mesh, std::int64_t v) {
  const std::int64_t index = v - mesh.base;
  HFR_REQUIRE(index >= 0 && std::cmp_less(index, mesh.tets.n_vertices()),
              "vertex " + std::to_string(v) + " is out of range: there are " +
                  std::to_string(mesh.tets.n_vertices()) + ", counted from " + std::to_string(mesh.base));
  return VertexHandle(index);
}

CellHandle cell(const hfr_mesh& mesh, std::int64_t c) {
  const std::int64_t index = c - mesh.base;
  HFR_REQUIRE(index >= 0 && std::cmp_less(index, mesh.tets.n_cells()),
              "cell " + std::to_string(c) + " is out of range: there are " +
                  std::to_string(mesh.tets.n_cells()) + ", counted from " + std::to_string(mesh.base));
  return CellHandle(index);
}

template <class Range>
void put(const hfr_mesh& mesh, Range&& range, int64_t* out, size_t capacity, size_t* n) {
  HFR_REQUIRE(n && (out || capacity == 0), "n is NULL, or out is and capacity is not 0");
  std::size_t count = 0;
  for (const auto handle : range) {
    if (count < capacity) out[count] = number(mesh, handle);
    ++count;
  }
  *n = count;
}

}  // namespace

hfr_mesh* hfr_mesh_new(int index_base) {
  if (index_base != 0 && index_base != 1) return nullptr;
  auto* mesh = new (std::nothrow) hfr_mesh;
  if (mesh) mesh->base = index_base;
  return mesh;
}

void hfr_mesh_free(hfr_mesh* mesh) { delete mesh; }

const char* hfr_mesh_message(const hfr_mesh* mesh) {
  return mesh ? mesh->message.c_str() : "the mesh is NULL";
}

hfr_status hfr_mesh_build(hfr_mesh* mesh, const hfr_array* points, const hfr_array* cells) {
  return guarded(mesh, [&] {
    std::vector<Vec3> p = points_of(points, "points", -1);
    const auto c = indices_of<4>(cells, "cells", 4, mesh->base, p.size());
    counted_from_zero(*mesh, [&] { replace_mesh(*mesh, build(std::move(p), c, all_threads())); });
  });
}

hfr_status hfr_mesh_read(hfr_mesh* mesh, const char* path) {
  return guarded(mesh, [&] { replace_mesh(*mesh, io::read(text_of(path, "path"), all_threads())); });
}

hfr_status hfr_mesh_write(hfr_mesh* mesh, const char* path, const char* variant) {
  return guarded(mesh, [&] {
    io::WriteOptions options;
    if (variant && std::string_view(variant) == "binary")
      options.binary = true;
    else if (variant)
      options.variant = variant;
    io::write(text_of(path, "path"), mesh->tets, options, all_threads());
  });
}

int64_t hfr_mesh_count(const hfr_mesh* mesh, const char* what) {
  if (!mesh || !what) return -1;
  const std::string_view word = what;
  const auto count = [&]() -> std::optional<std::size_t> {
    if (word == "vertices") return mesh->tets.n_vertices();
    if (word == "cells") return mesh->tets.n_cells();
    if (word == "edges") return mesh->tets.n_edges();
    if (word == "faces") return mesh->tets.n_faces();
    if (word == "boundary_faces") return n_boundary_faces(mesh->tets);
    if (word == "invalid_cells") return mesh->invalid_cells.size();
    if (word == "map_vertices") return mesh->maps.vertices.size();
    if (word == "map_cells") return mesh->maps.cells.size();
    return std::nullopt;
  }();
  return count ? static_cast<int64_t>(*count) : -1;
}

hfr_status hfr_mesh_set(hfr_mesh* mesh, const char* what, const hfr_array* values) {
  return guarded(mesh, [&] { set_array(*mesh, std::string(text_of(what, "what")), values); });
}

hfr_status hfr_mesh_get(hfr_mesh* mesh, const char* what, const hfr_array* values) {
  return guarded(mesh, [&] { get_array(*mesh, std::string(text_of(what, "what")), values); });
}

hfr_status hfr_vertex_cells(hfr_mesh* mesh, int64_t v, int64_t* out, size_t capacity, size_t* n) {
  return guarded(mesh, [&] { put(*mesh, mesh->tets.vertex_cells(vertex(*mesh, v)), out, capacity, n); });
}

hfr_status hfr_vertex_vertices(hfr_mesh* mesh, int64_t v, int64_t* out, size_t capacity, size_t* n) {
  return guarded(mesh, [&] { put(*mesh, mesh->tets.vertex_vertices(vertex(*mesh, v)), out, capacity, n); });
}

hfr_status hfr_edge_cells(hfr_mesh* mesh, int64_t a, int64_t b, int64_t* out, size_t capacity, size_t* n) {
  return guarded(mesh, [&] {
    const EdgeHandle e = mesh->tets.find_edge(vertex(*mesh, a), vertex(*mesh, b));
    HFR_REQUIRE(e.is_valid(), "no edge joins vertices " + std::to_string(a) + " and " + std::to_string(b));
    put(*mesh, mesh->tets.edge_cells(e), out, capacity, n);
  });
}

hfr_status hfr_cell_cells(hfr_mesh* mesh, int64_t c, int64_t* out, size_t capacity, size_t* n) {
  return guarded(mesh, [&] { put(*mesh, mesh->tets.cell_cells(cell(*mesh, c)), out, capacity, n); });
}

hfr_status hfr_mesh_check(hfr_mesh* mesh) {
  return guarded(mesh, [&] {
    const CheckResult found = check(mesh->tets, {.policy = all_threads()});
    counted_from_zero(*mesh, [&] { HFR_REQUIRE(found, found.message); });
  });
}
