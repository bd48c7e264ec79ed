// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_HALFFACE_ORACLE_HH
#define HFR_UNITTESTS_HALFFACE_ORACLE_HH

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr::test {

template <class T>
using Set = std::set<T>;

/// Neighbourhoods by comparing vertices of all cells with each other: nothing of mates, incident cells or
/// rings.
class Oracle {
 public:
  explicit Oracle(const TetMesh& mesh) {
    for (std::size_t i = 0; i < mesh.n_cells(); ++i)
      if (!mesh.is_deleted(CellHandle(i))) vertices_[CellHandle(i)] = mesh.cell(CellHandle(i)).v;
    for (const auto& [c, v] : vertices_)
      for (std::size_t k = 0; k < 4; ++k) {
        cells_of_vertex_[v[k]].insert(c);
        for (std::size_t j = 0; j < 4; ++j)
          if (v[k] < v[j]) cells_of_edge_[{v[k], v[j]}].insert(c);
        std::array<VertexHandle, 3> f = {v[(k + 1) % 4], v[(k + 2) % 4], v[(k + 3) % 4]};
        std::sort(f.begin(), f.end());
        cells_of_face_[f].insert(c);
      }
  }

  const std::map<CellHandle, std::array<VertexHandle, 4>>& cells() const { return vertices_; }
  const std::map<std::array<VertexHandle, 2>, Set<CellHandle>>& edges() const { return cells_of_edge_; }
  const std::map<std::array<VertexHandle, 3>, Set<CellHandle>>& faces() const { return cells_of_face_; }
  Set<CellHandle> cells_of(VertexHandle v) const {
    const auto at = cells_of_vertex_.find(v);
    return at == cells_of_vertex_.end() ? Set<CellHandle>() : at->second;
  }

  /// Those of `cells` that connect to `seed` through faces with all of `core`'s vertices.
  template <std::size_t N>
  Set<CellHandle> component(const Set<CellHandle>& cells, CellHandle seed,
                            const std::array<VertexHandle, N>& core) const {
    Set<CellHandle> seen{seed};
    std::vector<CellHandle> todo{seed};
    while (!todo.empty()) {
      const CellHandle c = todo.back();
      todo.pop_back();
      for (CellHandle d : cells)
        if (!seen.contains(d) && share_face_with(c, d, core)) {
          seen.insert(d);
          todo.push_back(d);
        }
    }
    return seen;
  }

  /// One set of cells per ring: more than one where an edge is not manifold.
  std::vector<Set<CellHandle>> rings(const std::array<VertexHandle, 2>& edge) const {
    Set<CellHandle> left = cells_of_edge_.at(edge);
    std::vector<Set<CellHandle>> all;
    while (!left.empty()) {
      all.push_back(component(left, *left.begin(), edge));
      for (CellHandle c : all.back()) left.erase(c);
    }
    return all;
  }

  bool is_boundary_face(std::array<VertexHandle, 3> f) const {
    std::sort(f.begin(), f.end());
    return cells_of_face_.at(f).size() == 1;
  }

 private:
  template <std::size_t N>
  bool share_face_with(CellHandle c, CellHandle d, const std::array<VertexHandle, N>& core) const {
    const auto& a = vertices_.at(c);
    const auto& b = vertices_.at(d);
    std::size_t shared = 0;
    std::size_t of_core = 0;
    for (VertexHandle v : a) {
      if (std::find(b.begin(), b.end(), v) == b.end()) continue;
      ++shared;
      of_core += static_cast<std::size_t>(std::count(core.begin(), core.end(), v));
    }
    return shared == 3 && of_core == N;
  }

  std::map<CellHandle, std::array<VertexHandle, 4>> vertices_;
  std::map<VertexHandle, Set<CellHandle>> cells_of_vertex_;
  std::map<std::array<VertexHandle, 2>, Set<CellHandle>> cells_of_edge_;
  std::map<std::array<VertexHandle, 3>, Set<CellHandle>> cells_of_face_;
};

/// The items of a range as a set; `repeated` says whether one came twice.
template <class Range>
auto set_of(Range&& range, bool& repeated) {
  Set<std::remove_cvref_t<decltype(*range.begin())>> items;
  repeated = false;
  for (const auto& item : range) repeated = !items.insert(item).second || repeated;
  return items;
}

template <class Range>
auto vector_of(Range&& range) {
  return std::vector(range.begin(), range.end());
}

}  // namespace hfr::test

#endif
