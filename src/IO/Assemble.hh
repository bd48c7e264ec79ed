// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_ASSEMBLE_HH
#define HFR_IO_ASSEMBLE_HH

#include <string>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshData.hh"
#include "hfremesh/Parallel/Parallel.hh"

namespace hfr::io {

/// Connectivity and everything else that a file says, in one mesh: regions, labels of triangles, edges and
/// vertices, fixed vertices, names, and fields as properties of vertices and cells. Handles equal the indices
/// of `data`. A triangle or edge that appears twice keeps its first place and its last label; `notes`, where
/// given, gets one line for each thing that could not be kept. Throws what build() throws.
/// With NonManifold::kSplit, copies of vertices come after those of `data`, each with the label, the fields
/// and the fixing of its vertex; a label on a triangle or edge goes to what its cells have there now, of
/// edges to all that came apart.
TetMesh assemble(MeshData data, par::Policy policy = {}, BuildReport* report = nullptr,
                 std::vector<std::string>* notes = nullptr, NonManifold non_manifold = NonManifold::kKeep);

/// The way back. Deleted cells and vertices are left out and the rest keeps its order; triangles and edges
/// keep the order and direction in which the file gave them. Regions and labels that are all absent give
/// empty lists.
MeshData disassemble(const TetMesh& mesh, par::Policy policy = {});

}  // namespace hfr::io

#endif
