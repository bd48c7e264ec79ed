// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/EdgeRing.hh"

namespace hfr {
namespace {

/// False, with nothing changed, when there is no room. One vertex more than cells is kept.
bool append(const TetMesh& mesh, RingPlace at, EdgeFan& out) {
  if (out.n_cells + 1 == HFR_MAX_RING) return false;
  const auto i = static_cast<std::size_t>(out.n_cells++);
  out.cells[i] = at.cell;
  out.vertices[i] = mesh.cell(at.cell).v[at.p];
  out.vertices[i + 1] = mesh.cell(at.cell).v[at.q];
  return true;
}

}  // namespace

bool gather_open_ring(const TetMesh& mesh, EdgeHandle e, EdgeRing& out) {
  const auto [a, b] = mesh.edge_vertices(e);
  out.a = a;
  out.b = b;
  out.n_cells = 0;
  Ring ring;
  if (!mesh.gather_ring(ring_start(e), ring) || ring.closed) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(ring.size); ++i)
    if (!append(mesh, ring.places[i], out)) return false;
  return true;
}

bool gather_two_sided_ring(const TetMesh& mesh, EdgeHandle e, TwoSidedRing& out) {
  const auto [a, b] = mesh.edge_vertices(e);
  out.a = a;
  out.b = b;
  Ring ring;
  if (!mesh.gather_ring(ring_start(e), ring) || !ring.closed) return false;
  const auto n = static_cast<std::size_t>(ring.size);
  const auto region = [&](std::size_t i) { return mesh.region(ring.places[i % n].cell); };
  std::size_t first = 0;
  while (first < n && !(region(first + n - 1) > region(first))) ++first;
  if (first == n) return false;
  std::size_t at = first;
  for (EdgeFan& side : out.sides) {
    const int mine = region(at);
    side.n_cells = 0;
    for (; at < first + n && region(at) == mine; ++at)
      if (!append(mesh, ring.places[at % n], side)) return false;
  }
  return at == first + n;  // no third region, nor one that comes twice
}

}  // namespace hfr
