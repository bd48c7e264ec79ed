// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_NON_MANIFOLD_HH
#define HFR_HALFFACE_NON_MANIFOLD_HH

#include <array>
#include <optional>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// Takes a mesh apart at its pinched vertices: of the parts into which the cells of a vertex fall, connected
/// through faces, each but that of the smallest cell gets a copy of the vertex. Afterwards no vertex is
/// pinched, and the edges at which only such parts met are manifold. Returns for each new vertex the one that
/// it is a copy of. Copies points, no data. For a mesh that has just been built; allocates 16 bytes a cell.
std::vector<VertexHandle> split_pinched(TetMesh& mesh);

/// Two vertices with more than one ring or fan of cells, and the smallest cells of two of them.
struct DoubleEdge {
  std::array<VertexHandle, 2> vertices;
  std::array<CellHandle, 2> cells;
};

/// The first edge that breaks Rule::kDuplicateEdge: cells go all the way round it, and others have it, too.
/// Relies on the rules before that one. Linear in the mesh; allocates 32 bytes a vertex.
std::optional<DoubleEdge> find_double_edge(const TetMesh& mesh, par::Policy policy);

}  // namespace hfr

#endif
