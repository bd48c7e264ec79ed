// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_SEEDS_HH
#define HFR_SCHEDULER_SEEDS_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Parallel/Parallel.hh"
#include "hfremesh/Scheduler/ByteTable.hh"
#include "hfremesh/Scheduler/Workspace.hh"

namespace hfr {

/// Cells to be looked at, ascending, and which cells these are.
class Worklist {
 public:
  /// Cells c with keep(c), deleted ones left out.
  template <class Keep>
  Worklist(const TetMesh& mesh, par::Policy policy, Keep&& keep)
      : Worklist(mesh, policy, par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t i) {
                   return !mesh.is_deleted(CellHandle(i)) && keep(CellHandle(i));
                 })) {}

  /// The same for the cells of an ascending list.
  template <class Keep>
  Worklist(const TetMesh& mesh, par::Policy policy, std::span<const Index> list, Keep&& keep)
      : Worklist(mesh, policy, of_list(policy, list, [&](Index c) {
                   return !mesh.is_deleted(CellHandle(c)) && keep(CellHandle(c));
                 })) {}

  std::span<const Index> cells() const { return cells_; }
  bool has(CellHandle c) const { return listed_[c.idx()] != 0; }

 private:
  Worklist(const TetMesh& mesh, par::Policy policy, std::vector<Index>&& cells)
      : cells_(std::move(cells)), listed_(mesh.n_cells(), cells_.size(), 0) {
    if (!listed_.is_for_threads()) policy = {};
    par::for_each(policy, cells_.size(), [&](std::size_t i) { listed_.set(cells_[i], 1); });
  }

  template <class Keep>
  static std::vector<Index> of_list(par::Policy policy, std::span<const Index> list, Keep&& keep) {
    std::vector<Index> cells =
        par::compact<Index>(policy, list.size(), [&](std::size_t i) { return keep(list[i]); });
    for (Index& c : cells) c = list[c];
    return cells;
  }

  std::vector<Index> cells_;
  ByteTable listed_;
};

/// Whether the edge of listed cell c, an inner one, is c's to name: c is the smallest listed cell of the
/// ring. `before(a, b)`: the order of cells, where it is not that of their handles.
template <class Before = std::less<CellHandle>>
bool names_edge(const TetMesh& mesh, const Worklist& list, CellHandle c, int edge, Before&& before = {}) {
  return mesh.walk_ring(c, edge, [&](CellHandle other, VertexHandle, VertexHandle) {
    return !(before(other, c) && list.has(other));
  });
}
/// Calls visit(seed) for the edges that are c's to name. Over all listed cells, each inner edge of theirs is
/// visited once.
template <class Visit, class Before = std::less<CellHandle>>
void visit_edge_seeds(const TetMesh& mesh, const Worklist& list, CellHandle c, Visit&& visit,
                      Before&& before = {}) {
  for (int e = 0; e < 6; ++e)
    if (names_edge(mesh, list, c, e, before)) visit(EdgeHandle(6 * c.idx() + static_cast<Index>(e)));
}
/// The same from the longest edge on, until visit(seed) is true: a poor cell is most often mended by the
/// removal of a long one, and has to be mended once.
template <class Visit, class Before = std::less<CellHandle>>
void visit_edge_seeds_until(const TetMesh& mesh, const Worklist& list, CellHandle c, Visit&& visit,
                            Before&& before = {}) {
  const auto& v = mesh.cell(c).v;
  std::array<double, 6> length2;
  for (std::size_t e = 0; e < 6; ++e)
    length2[e] = norm2(mesh.point(v[kEdgeCorners[e][1]]) - mesh.point(v[kEdgeCorners[e][0]]));
  std::array<int, 6> order = {0, 1, 2, 3, 4, 5};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return length2[static_cast<std::size_t>(a)] > length2[static_cast<std::size_t>(b)];
  });
  for (int e : order)
    if (names_edge(mesh, list, c, e, before) && visit(EdgeHandle(6 * c.idx() + static_cast<Index>(e))))
      return;
}

/// The same for inner faces: from the smaller listed half-face.
template <class Visit, class Before = std::less<CellHandle>>
void visit_face_seeds(const TetMesh& mesh, const Worklist& list, CellHandle c, Visit&& visit,
                      Before&& before = {}) {
  for (int k = 0; k < 4; ++k) {
    const HalfFaceHandle h = halfface_of(c, k);
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (m.is_valid() && (before(c, cell_of(m)) || !list.has(cell_of(m)))) visit(h);
  }
}

/// All of visit_edge_seeds, in the order of the list.
std::vector<EdgeHandle> edge_seeds(const TetMesh& mesh, const Worklist& list, par::Policy policy);
/// All of visit_face_seeds, in the order of the list.
std::vector<HalfFaceHandle> face_seeds(const TetMesh& mesh, const Worklist& list, par::Policy policy);
/// Vertices of the listed cells that are not frozen, ascending.
std::vector<VertexHandle> vertex_seeds(const TetMesh& mesh, const Worklist& list,
                                       std::span<const std::uint8_t> frozen, par::Policy policy);
/// Takes out the vertices whose cells a walk round them would miss in part; see is_pinched().
void drop_pinched(const TetMesh& mesh, const Workspace& work, std::vector<VertexHandle>& vertices);

}  // namespace hfr

#endif
