// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_LABELS_HH
#define HFR_HALFFACE_LABELS_HH

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr {

/// What a file says of vertices, edges and faces, and the names of such numbers. A labelled face or edge is a
/// constraint: no operator removes it. A labelled vertex may move but is not removed.
struct Labels {
  TupleMap<3, int> faces;     ///< patch label per labelled face: boundary, interface or inside a region
  TupleMap<2, int> edges;     ///< label per labelled edge
  std::vector<int> vertices;  ///< label per vertex, 0 = none; empty when no vertex has one
  std::map<std::pair<int, int>, std::string> names;  ///< (dimension, label or region) → name

  int vertex(VertexHandle v) const { return vertices.empty() ? 0 : vertices[v.idx()]; }
};

/// Edges, faces and patches that the user has fixed; see TetMesh::set_fixed().
struct Locks {
  TupleMap<3, bool> faces;
  TupleMap<2, bool> edges;
  std::set<int> patches;  ///< labels of faces

  bool empty() const { return faces.empty() && edges.empty() && patches.empty(); }
};

}  // namespace hfr

#endif
