// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/FixedParts.hh"

#include <algorithm>
#include <string>

#include "HalfFace/Errors.hh"
#include "HalfFace/TupleMap.hh"

namespace hfr {
namespace {

template <std::size_t N>
std::string name_of(const char* kind, const std::array<VertexHandle, N>& vertices) {
  std::string text = std::string("fix ") + kind;
  for (std::size_t i = 0; i < N; ++i) text += (i == 0 ? ':' : '-') + std::to_string(vertices[i].idx());
  return text;
}

template <std::size_t N>
void require_vertices(const TetMesh& mesh, const char* kind, const std::array<VertexHandle, N>& vertices) {
  for (VertexHandle v : vertices)
    HFR_REQUIRE(mesh.exists(v), name_of(kind, vertices) + ": there are " + std::to_string(mesh.n_vertices()) +
                                    " vertices, counted from 0");
}

// find_edge() and find_face() see what a walk round a vertex does, which in a pinched one is not all; then
// the cells are looked through.

EdgeHandle handle_of(const TetMesh& mesh, const std::array<VertexHandle, 2>& edge) {
  if (const EdgeHandle e = mesh.find_edge(edge[0], edge[1]); e.is_valid()) return e;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    for (std::size_t e = 0; e < kEdgeCorners.size(); ++e)
      if (AnyOrder::key<2>({v[kEdgeCorners[e][0]], v[kEdgeCorners[e][1]]}) == AnyOrder::key(edge))
        return EdgeHandle(kEdgeCorners.size() * c.idx() + e);
  }
  return {};
}

FaceHandle handle_of(const TetMesh& mesh, const std::array<VertexHandle, 3>& face) {
  if (const FaceHandle f = mesh.find_face(face); f.is_valid()) return f;
  for (CellHandle c : mesh.cells())
    for (int k = 0; k < 4; ++k)
      if (AnyOrder::key(mesh.halfface_vertices(halfface_of(c, k))) == AnyOrder::key(face))
        return FaceHandle(halfface_of(c, k).idx());
  return {};
}

}  // namespace

void require_fixed_parts(const TetMesh& mesh, const SurfaceOptions& options) {
  for (VertexHandle v : options.fixed_vertices) require_vertices<1>(mesh, "vertex", {v});
  for (const auto& edge : options.fixed_edges) {
    require_vertices(mesh, "edge", edge);
    HFR_REQUIRE(handle_of(mesh, edge).is_valid(), name_of("edge", edge) + ": there is no such edge");
  }
  for (const auto& face : options.fixed_faces) {
    require_vertices(mesh, "face", face);
    HFR_REQUIRE(handle_of(mesh, face).is_valid(), name_of("face", face) + ": there is no such face");
  }
  const auto& labelled = mesh.labels().faces.entries();
  for (int patch : options.fixed_patches)
    HFR_REQUIRE(std::ranges::any_of(labelled, [&](const auto& entry) { return entry.value == patch; }),
                "fix patch:" + std::to_string(patch) + ": no face has this label");
}

void rename_fixed(SurfaceOptions& options, std::span<const VertexHandle> new_of) {
  for_each_fixed(options, [&](VertexHandle& v) {
    if (v.idx() < new_of.size()) v = new_of[v.idx()];
  });
}

namespace {

/// Fixes x, and keeps what it was named by if that is new.
template <class Handle, class Name>
void fix(TetMesh& mesh, Handle x, const Name& name, std::vector<Name>& fixed) {
  if (mesh.is_fixed(x)) return;
  mesh.set_fixed(x);
  fixed.push_back(name);
}

}  // namespace

// A patch is labelled, and so kept already where no surface is allowed to change; where one is, Features
// reads the options.
FixedParts::FixedParts(TetMesh& mesh, const SurfaceOptions& options) {
  for (VertexHandle v : options.fixed_vertices) fix(mesh, v, v, vertices_);
  for (const auto& edge : options.fixed_edges) fix(mesh, handle_of(mesh, edge), edge, edges_);
  for (const auto& face : options.fixed_faces) fix(mesh, handle_of(mesh, face), face, faces_);
}

void FixedParts::release(TetMesh& mesh, std::span<const VertexHandle> vertices) {
  const auto now = [&](VertexHandle v) { return vertices.empty() ? v : vertices[v.idx()]; };
  for (VertexHandle v : vertices_) mesh.set_fixed(now(v), false);
  // The last one first: the order of those that the mesh had before stays.
  for (std::size_t i = edges_.size(); i-- > 0;)
    mesh.set_fixed(handle_of(mesh, std::array{now(edges_[i][0]), now(edges_[i][1])}), false);
  for (std::size_t i = faces_.size(); i-- > 0;)
    mesh.set_fixed(handle_of(mesh, std::array{now(faces_[i][0]), now(faces_[i][1]), now(faces_[i][2])}),
                   false);
}

}  // namespace hfr
