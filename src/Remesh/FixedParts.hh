// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_FIXED_PARTS_HH
#define HFR_REMESH_FIXED_PARTS_HH

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {

/// Throws InvalidInput that names the first of options.fixed_… that the mesh does not have: one that is
/// misspelt would hold nothing, and nobody would know. O(star) for each edge and face.
void require_fixed_parts(const TetMesh& mesh, const SurfaceOptions& options);

/// Calls f(VertexHandle&) with each vertex by which `options` name something fixed.
template <class Options, class F>
void for_each_fixed(Options& options, F&& f) {
  for (auto& v : options.fixed_vertices) f(v);
  for (auto& edge : options.fixed_edges) std::ranges::for_each(edge, f);
  for (auto& face : options.fixed_faces) std::ranges::for_each(face, f);
}

/// What is fixed keeps its vertices under their new handles: nothing that is fixed goes. `new_of`: by old
/// handle; empty where they are the same.
void rename_fixed(SurfaceOptions& options, std::span<const VertexHandle> new_of);

/// What SurfaceOptions name as fixed, fixed in the mesh itself for as long as a run takes: no operator moves
/// or removes it, on the surface or inside.
class FixedParts {
 public:
  /// The mesh has what `options` name.
  FixedParts(TetMesh& mesh, const SurfaceOptions& options);

  /// Frees what the constructor has fixed, which leaves what the mesh had fixed before. `vertices`: old → new
  /// handles of these; empty where they are the same.
  void release(TetMesh& mesh, std::span<const VertexHandle> vertices);

 private:
  // What was not fixed before.
  std::vector<VertexHandle> vertices_;
  std::vector<std::array<VertexHandle, 2>> edges_;
  std::vector<std::array<VertexHandle, 3>> faces_;
};

}  // namespace hfr

#endif
