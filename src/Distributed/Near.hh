// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_NEAR_HH
#define HFR_DISTRIBUTED_NEAR_HH

#include "Distributed/RankSets.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr::mpi {

/// Owners within one edge, and within two, of the vertices of these cells; others stay as they are.
template <class Cells, class Owner>
void find_near(const TetMesh& mesh, const Cells& cells, const Owner& owner, RankSets& one, RankSets& two) {
  const auto for_live = [&](auto&& body) {
    for (Index c : cells)
      if (!mesh.is_deleted(CellHandle(c))) body(mesh.cell(CellHandle(c)).v);
  };
  for_live([&](const auto& v) {
    for (VertexHandle u : v) {
      one.set_only(u.idx(), owner(u));
      two.set_only(u.idx(), owner(u));
    }
  });
  for_live([&](const auto& v) {
    for (VertexHandle u : v)
      for (VertexHandle w : v) one.add(u.idx(), owner(w));
  });
  for_live([&](const auto& v) {
    for (VertexHandle u : v)
      for (VertexHandle w : v) two.add(u.idx(), one[w.idx()]);
  });
}

}  // namespace hfr::mpi

#endif
