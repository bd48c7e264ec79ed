// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_OWN_ITEMS_HH
#define HFR_DISTRIBUTED_OWN_ITEMS_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "Distributed/DistributedMesh.hh"

/// What a rank has to write of a mesh in parts. What is written has numbers without gaps, as after
/// TetMesh::collect_garbage(): each rank knows which vertices and slots of the whole are gone, and so how
/// many are below a number.
namespace hfr::mpi {

/// Numbers without gaps. All ranks make one at the same time.
class Numbering {
 public:
  explicit Numbering(DistributedMesh& mesh);

  std::uint64_t n_vertices() const { return n_vertices_; }
  std::uint64_t n_cells() const { return mesh_.n_cells(); }
  std::uint64_t operator()(VertexHandle v) const { return vertex_[v.idx()]; }
  /// Of a vertex by its number in the parts, whoever has it.
  std::uint64_t of_vertex(std::uint64_t number) const {
    return number -
           static_cast<std::uint64_t>(std::lower_bound(gone_.begin(), gone_.end(), number) - gone_.begin());
  }
  std::uint64_t operator()(CellHandle c) const {
    const std::uint64_t number = mesh_.number(c);
    return number - static_cast<std::uint64_t>(std::lower_bound(slots_.begin(), slots_.end(), number) -
                                               slots_.begin());
  }

 private:
  const DistributedMesh& mesh_;
  std::uint64_t n_vertices_ = 0;
  std::vector<std::uint64_t> vertex_;  // by vertex of the part: each is asked for by all its cells
  std::vector<std::uint64_t> slots_;   // that are gone, ascending
  std::vector<std::uint64_t> gone_;    // vertices, likewise
};

std::vector<VertexHandle> own_vertices(const DistributedMesh& mesh);
/// In the order of numbers.
std::vector<CellHandle> own_cells(const DistributedMesh& mesh);

/// An edge or a face with a label; of those, a rank writes the ones whose smallest vertex it owns.
template <std::size_t N>
struct Labelled {
  std::uint64_t number = 0;
  std::array<VertexHandle, N> v;
  std::int32_t label = 0;
};

/// What hangs on own vertices, edges and faces, and what of it there is in the whole. All ranks make one at
/// the same time.
class OwnLabels {
 public:
  explicit OwnLabels(DistributedMesh& mesh);

  std::vector<Labelled<3>> faces;  ///< in the order of numbers
  std::vector<Labelled<2>> edges;
  std::uint64_t n_faces = 0, n_edges = 0, n_fixed = 0;  ///< of the whole
  bool with_regions = false;                            ///< or labels of faces or edges
  bool with_vertex_labels = false;
};

}  // namespace hfr::mpi

#endif
