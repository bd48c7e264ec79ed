// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_SEEDS_HH
#define HFR_DISTRIBUTED_PART_SEEDS_HH

#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Scheduler/Seeds.hh"

namespace hfr::mpi {

/// The seeds of a part: over all parts, those of the whole, each once. The list is of all cells that the part
/// holds; cell c of it is another rank's to name unless it is an own one.
template <class Visit>
void visit_edge_seeds(const DistributedMesh& mesh, const Worklist& list, CellHandle c, Visit&& visit) {
  if (mesh.is_own(c))
    hfr::visit_edge_seeds(mesh.part(), list, c, visit,
                          [&](CellHandle a, CellHandle b) { return mesh.is_before(a, b); });
}

/// Until visit(seed) is true, from the longest edge on.
template <class Visit>
void visit_edge_seeds_until(const DistributedMesh& mesh, const Worklist& list, CellHandle c, Visit&& visit) {
  if (mesh.is_own(c))
    hfr::visit_edge_seeds_until(mesh.part(), list, c, visit,
                                [&](CellHandle a, CellHandle b) { return mesh.is_before(a, b); });
}

template <class Visit>
void visit_face_seeds(const DistributedMesh& mesh, const Worklist& list, CellHandle c, Visit&& visit) {
  if (mesh.is_own(c))
    hfr::visit_face_seeds(mesh.part(), list, c, visit,
                          [&](CellHandle a, CellHandle b) { return mesh.is_before(a, b); });
}

/// Own vertices of the listed cells that an operator may take out.
inline std::vector<VertexHandle> removable_seeds(const DistributedMesh& mesh, const Worklist& list,
                                                 par::Policy policy) {
  std::vector<VertexHandle> vertices = vertex_seeds(mesh.part(), list, mesh.work().frozen, policy);
  std::erase_if(vertices, [&](VertexHandle v) { return !mesh.is_own(v); });
  drop_pinched(mesh.part(), mesh.work(), vertices);
  return vertices;
}

}  // namespace hfr::mpi

#endif
