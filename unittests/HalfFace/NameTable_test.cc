// SPDX-License-Identifier: BSD-3-Clause
// Each row of the table of names in docs/half-face-kernel.md, as calls. That quality(mesh, c, metric) is
// there is shown in unittests/Quality.
#include <gtest/gtest.h>

#include <fstream>
#include <utility>

#include "HalfFace/EdgeList.hh"
#include "HalfFace/Geometry.hh"
#include "HalfFace/TetTopology.hh"
#include "Meshes.hh"

namespace hfr {
namespace {

/// A thing of each kind, on the boundary.
struct Things {
  explicit Things(const TetMesh& m)
      : h(*m.boundary_halffaces().begin()),
        f(m.face_handle(h)),
        c(m.incident_cell(h)),
        he(m.halfface_halfedges(h)[0]),
        e(m.edge_handle(he)),
        v(m.from_vertex(he)) {}
  HalfFaceHandle h;
  FaceHandle f;
  CellHandle c;
  HalfEdgeHandle he;
  EdgeHandle e;
  VertexHandle v;
};

struct Row {
  const char* theirs;
  void (*call)(TetMesh& m, const Things& t);
};

const Row kRows[] = {
    {"`n_vertices() n_cells()`, `n_logical_vertices()` …",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.n_vertices();
       m.n_cells();
       m.n_logical_vertices();
       m.n_logical_cells();
       m.n_edges();
       m.n_faces();
       m.n_halfedges();
       m.n_halffaces();
       m.n_logical_edges();
       m.n_logical_faces();
       m.n_logical_halfedges();
       m.n_logical_halffaces();
     }},
    {"`vertices() edges() halfedges() faces() halffaces() cells()`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.vertices();
       m.edges();
       m.halfedges();
       m.faces();
       m.halffaces();
       m.cells();
       EdgeList{m};
     }},
    {"`boundary_vertices()` …",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.boundary_vertices();
       m.boundary_edges();
       m.boundary_halfedges();
       m.boundary_faces();
       m.boundary_halffaces();
       m.boundary_cells();
     }},
    {"`vertex_vertices vertex_edges vertex_faces vertex_halffaces vertex_cells`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.vertex_vertices(t.v);
       m.vertex_edges(t.v);
       m.vertex_faces(t.v);
       m.vertex_halffaces(t.v);
       m.vertex_cells(t.v);
       m.outgoing_halfedges(t.v);
       m.incoming_halfedges(t.v);
     }},
    {"`edge_faces edge_halffaces edge_cells`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.edge_faces(t.e);
       m.edge_halffaces(t.e);
       m.edge_cells(t.e);
     }},
    {"`halfedge_halffaces halfedge_faces halfedge_cells`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.halfedge_halffaces(t.he);
       m.halfedge_faces(t.he);
       m.halfedge_cells(t.he);
     }},
    {"`edge_vertices face_vertices face_halfedges face_edges face_cells`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.edge_vertices(t.e);
       m.face_vertices(t.f);
       m.face_halfedges(t.f);
       m.face_edges(t.f);
       m.face_cells(t.f);
     }},
    {"`halfface_vertices halfface_halfedges halfface_edges`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.halfface_vertices(t.h);
       m.halfface_halfedges(t.h);
       m.halfface_edges(t.h);
     }},
    {"`get_halfface_vertices(hf, v)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.halfface_vertices(t.h, m.halfface_vertices(t.h)[1]);
     }},
    {"`get_cell_vertices(hf)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.cell_vertices(t.h);
       m.cell_vertices(t.c, m.cell_vertices(t.c)[2]);
     }},
    {"`cell_vertices cell_halffaces cell_faces cell_edges cell_cells`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.cell_vertices(t.c);
       m.cell_halffaces(t.c);
       m.cell_faces(t.c);
       m.cell_edges(t.c);
       m.cell_cells(t.c);
       m.cell_halfedges(t.c);
     }},
    {"`opposite_halfface_handle opposite_halfedge_handle`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.opposite_halfface(t.h);
       m.opposite_halfedge(t.he);
     }},
    {"`halfedge_handle(e, i) halfface_handle(f, i) edge_handle(he) face_handle(hf)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.halfedge_handle(t.e, 0);
       m.halfface_handle(t.f, 0);
       m.edge_handle(t.he);
       m.face_handle(t.h);
     }},
    {"`incident_cell(hf)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) { m.incident_cell(t.h); }},
    {"`adjacent_halfface_in_cell`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.adjacent_halfface_in_cell(t.h, m.halfface_edges(t.h)[0]);
       m.adjacent_halfface_on_surface(t.h, m.halfface_halfedges(t.h)[0]);
     }},
    {"`next_halfedge_in_halfface prev_halfedge_in_halfface`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.next_halfedge_in_halfface(t.he, t.h);
       m.prev_halfedge_in_halfface(t.he, t.h);
     }},
    {"`from_vertex_handle to_vertex_handle`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.from_vertex(t.he);
       m.to_vertex(t.he);
     }},
    {"`find_halfedge find_halfedge_in_cell find_halfface find_halfface_in_cell`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       const auto v = m.cell_vertices(t.c);
       m.find_halfedge(v[0], v[1]);
       m.find_halfedge_in_cell(v[0], v[1], t.c);
       m.find_halfface({v[0], v[1], v[2]});
       m.find_halfface_in_cell({v[0], v[1], v[2]}, t.c);
       m.find_edge(v[0], v[1]);
       m.find_face({v[0], v[1], v[2]});
       m.find_cell(v);
     }},
    {"`halfface_opposite_vertex vertex_opposite_halfface`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.halfface_opposite_vertex(t.h);
       m.vertex_opposite_halfface(t.c, m.cell_vertices(t.c)[0]);
     }},
    {"`valence(x)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.valence(t.v);
       m.valence(t.e);
       m.valence(t.f);
       m.valence(t.c);
     }},
    {"`is_boundary(x)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.is_boundary(t.v);
       m.is_boundary(t.e);
       m.is_boundary(t.he);
       m.is_boundary(t.f);
       m.is_boundary(t.h);
       m.is_boundary(t.c);
     }},
    {"`is_deleted(x)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.is_deleted(t.v);
       m.is_deleted(t.e);
       m.is_deleted(t.he);
       m.is_deleted(t.f);
       m.is_deleted(t.h);
       m.is_deleted(t.c);
     }},
    {"`is_valid(x)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.exists(t.v);
       m.exists(t.e);
       m.exists(t.he);
       m.exists(t.f);
       m.exists(t.h);
       m.exists(t.c);
     }},
    {"`genus()`", []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) { m.genus(); }},
    {"`vertex(v) set_vertex(v, p)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) { m.set_point(t.v, m.point(t.v)); }},
    {"`length(e) vector(e) barycenter(x) normal(hf)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       length(m, t.e);
       vector(m, t.e);
       barycenter(m, t.e);
       barycenter(m, t.f);
       barycenter(m, t.c);
       normal(m, t.h);
       area(m, t.f);
       volume(m, t.c);
     }},
    {"`TetTopology`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) { TetTopology(m, t.c).ab(); }},
    {"`request_vertex_property<T>(name, default)` …",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.request_vertex_property<int>("n", 1);
       m.request_edge_property<int>("n", 1);
       m.request_halfedge_property<int>("n", 1);
       m.request_face_property<int>("n", 1);
       m.request_halfface_property<int>("n", 1);
       m.request_cell_property<int>("n", 1);
       m.request_mesh_property<int>("n", 1);
       m.request_vertex_property<int>();
     }},
    {"`get_property<T, Entity>(name)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.get_vertex_property<int>("n");
       std::as_const(m).get_face_property<int>("n");
     }},
    {"`property[handle] property.at(handle)`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       auto n = m.request_cell_property<int>("n");
       n[t.c] = 1;
       n.at(t.c) = 2;
       auto k = m.request_face_property<int>("k");
       k.set(m, t.f, k.get(m, t.f));
     }},
    {"`add_vertex add_cell delete_vertex delete_cell`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       const VertexHandle v = m.add_vertex({3, 3, 3});
       const auto f = m.halfface_vertices(t.h);
       m.delete_cell(m.add_cell(f[0], f[2], f[1], v));
       m.delete_vertex(v);
     }},
    {"`collect_garbage()`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) { m.collect_garbage(); }},
    {"`split_edge split_face collapse_edge`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.split_edge(t.e);
       m.split_face(*m.faces().begin());
       m.split_cell(*m.cells().begin());
       const HalfEdgeHandle e = *m.halfedges().begin();
       if (m.is_collapse_ok(e)) m.collapse_edge(e);
     }},
    {"`swap_vertex_indices swap_cell_indices`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.swap_vertices(t.v, VertexHandle(2));
       m.swap_cells(t.c, CellHandle(3));
     }},
    {"`reserve_vertices reserve_cells clear`",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       m.reserve_vertices(100);
       m.reserve_cells(100);
       m.clear();
     }},
    {"faces and edges without a cell", []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {}},
    {"both half-faces of a boundary face",
     []([[maybe_unused]] TetMesh& m, [[maybe_unused]] const Things& t) {
       EXPECT_FALSE(m.opposite_halfface(t.h).is_valid());
     }},
};

std::vector<std::string> rows_of_the_page() {
  std::ifstream page(HFR_DOCS "/half-face-kernel.md");
  std::vector<std::string> rows;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) inside = line.find("OpenVolumeMesh's names") != std::string::npos;
    if (!inside || !line.starts_with("| ") || line.starts_with("| OpenVolumeMesh")) continue;
    rows.push_back(line.substr(2, line.find(" |", 2) - 2));
  }
  return rows;
}

TEST(NameTable, EveryRowOfThePageCompilesAndRuns) {
  std::vector<std::string> tested;
  for (const Row& row : kRows) {
    TetMesh mesh = test::kuhn_box(2);
    row.call(mesh, Things(mesh));
    tested.push_back(row.theirs);
  }
  EXPECT_EQ(rows_of_the_page(), tested);
}

}  // namespace
}  // namespace hfr
