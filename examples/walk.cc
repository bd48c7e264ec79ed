// SPDX-License-Identifier: BSD-3-Clause
// Walks the shell of an edge and the star of a vertex; docs/half-face-kernel.md explains it.
#include <hfremesh/HalfFace/Circulators.hh>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/HalfFace/TetMesh.hh>
#include <iostream>

int main() {
  const hfr::generate::Arrays arrays = hfr::generate::box({3, 3, 3});
  const hfr::TetMesh mesh = hfr::build(arrays.points, arrays.cells);

  // The shell of an edge: its cells in ring order, one cell record a step.
  const hfr::EdgeHandle edge = *mesh.edges().begin();
  std::cout << "cells round edge " << edge.idx() << ":";
  for (hfr::CellHandle cell : mesh.edge_cells(edge)) std::cout << ' ' << cell.idx();
  std::cout << (mesh.is_boundary(edge) ? " (on the boundary)\n" : "\n");

  // The star of an inner vertex: each cell shows it one face of the link.
  std::size_t link_faces = 0;
  for (hfr::VertexHandle vertex : mesh.vertices()) {
    if (mesh.is_boundary(vertex)) continue;
    link_faces = 0;
    for (hfr::CellHandle cell : mesh.vertex_cells(vertex)) {
      const hfr::HalfFaceHandle link = mesh.vertex_opposite_halfface(cell, vertex);
      if (mesh.halfface_opposite_vertex(link) == vertex) ++link_faces;
    }
    std::cout << "vertex " << vertex.idx() << " has " << link_faces << " cells\n";
  }
  return link_faces == 24 ? 0 : 1;  // inner vertices of a Kuhn grid have 24 cells
}
