// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_EDGE_RING_HH
#define HFR_OPERATORS_EDGE_RING_HH

#include <array>
#include <cstddef>

#include "HalfFace/TetMesh.hh"
#include "kernels/klincsek.h"

/// The cells round an edge with their other vertices, which are the polygon that Klincsek's programme
/// triangulates: all round an inner edge, from boundary to boundary, or on each side of an interface.
namespace hfr {

/// Cells in a row round an edge a→b, counter-clockwise: cell i is (a, b, vertex i, vertex i+1). Where they go
/// all the way round, the vertex after the last one is the first, and stands there once.
struct EdgeFan {
  int n_cells = 0;
  RawArray<CellHandle, HFR_MAX_RING> cells;
  RawArray<VertexHandle, HFR_MAX_RING> vertices;

  const CellHandle* begin() const { return cells.data(); }
  const CellHandle* end() const { return cells.data() + n_cells; }
};

struct EdgeRing : EdgeFan {
  VertexHandle a, b;
};

/// Where a walk round an edge begins: with the cell and the direction of the handle, whether or not it is the
/// canonical one.
inline RingPlace ring_start(EdgeHandle e) {
  const auto& opposite = kEdgeOpposite[e.idx() % 6];
  return {CellHandle(e.idx() / 6), opposite[0], opposite[1]};
}

/// The cells all the way round, from the start on. False, with a part of them, when the boundary is met or
/// there are more than HFR_MAX_RING.
inline bool gather_closed_fan(const TetMesh& mesh, RingPlace start, EdgeFan& out) {
  out.n_cells = 0;
  RingPlace at = start;
  do {
    if (out.n_cells == HFR_MAX_RING) return false;
    const auto i = static_cast<std::size_t>(out.n_cells++);
    out.cells[i] = at.cell;
    out.vertices[i] = mesh.cell(at.cell).v[at.p];
    at = mesh.next_in_ring(at);
    if (!at.cell.is_valid()) return false;
  } while (at.cell != start.cell);
  return true;
}
inline bool gather_closed_ring(const TetMesh& mesh, EdgeHandle e, EdgeRing& out) {
  const auto [a, b] = mesh.edge_vertices(e);
  out.a = a;
  out.b = b;
  return gather_closed_fan(mesh, ring_start(e), out);
}

/// The cells from boundary to boundary. False when they go all the way round or their vertices are more than
/// HFR_MAX_RING.
bool gather_open_ring(const TetMesh& mesh, EdgeHandle e, EdgeRing& out);

/// The cells round an edge of the interface between two regions, those of each in a row of their own. The
/// rows share their first and last vertices: sides[0] ends where sides[1] begins.
struct TwoSidedRing {
  VertexHandle a, b;
  std::array<EdgeFan, 2> sides;  ///< the smaller region first
};

/// False unless the cells go all the way round, lie in two regions that meet in two faces, and the vertices
/// of either region are at most HFR_MAX_RING.
bool gather_two_sided_ring(const TetMesh& mesh, EdgeHandle e, TwoSidedRing& out);

}  // namespace hfr

#endif
