// SPDX-License-Identifier: BSD-3-Clause
// What TetMesh::set_fixed() holds through a run: edges, faces and patches, inside and on the surface.
#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Remesh/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

template <std::size_t N>
std::set<Place> places(const TetMesh& mesh, const std::array<VertexHandle, N>& vertices) {
  std::set<Place> all;
  for (VertexHandle v : vertices) all.insert(place_of(mesh, v));
  return all;
}

std::set<std::set<Place>> edges_of(const TetMesh& mesh) {
  std::set<std::set<Place>> all;
  for (EdgeHandle e : mesh.edges()) all.insert(places(mesh, mesh.edge_vertices(e)));
  return all;
}

std::set<std::set<Place>> faces_of(const TetMesh& mesh) {
  std::set<std::set<Place>> all;
  for (FaceHandle f : mesh.faces()) all.insert(places(mesh, mesh.face_vertices(f)));
  return all;
}

ImproveOptions with(SurfaceMode mode) {
  ImproveOptions options = serial();
  options.surface.mode = mode;
  options.raise_min_dihedral = true;
  return options;
}

/// Fixes each seventh edge or face that a run without locks would lose, and expects a run to keep them.
/// Returns how many that were.
template <class Handles, class Vertices, class All>
std::size_t expect_kept(const TetMesh& input, SurfaceMode mode, const Handles& handles,
                        const Vertices& vertices_of, const All& all_of) {
  TetMesh unlocked = input;
  improve(unlocked, with(mode));
  const auto left = all_of(unlocked);
  TetMesh mesh = input;
  std::vector<std::set<Place>> chosen;
  std::size_t at = 0;
  for (const auto handle : handles) {
    const auto corners = places(input, vertices_of(handle));
    if (left.contains(corners) || ++at % 7 != 0) continue;
    mesh.set_fixed(handle);
    chosen.push_back(corners);
  }
  improve(mesh, with(mode));
  EXPECT_EQ(check(mesh), Ok);
  const auto now = all_of(mesh);
  for (const auto& corners : chosen) EXPECT_TRUE(now.contains(corners));
  std::size_t n_fixed = 0;
  if constexpr (std::is_same_v<std::decay_t<decltype(*handles.begin())>, EdgeHandle>)
    for (const EdgeHandle e : mesh.edges()) n_fixed += mesh.is_fixed(e);
  else
    for (const FaceHandle f : mesh.faces()) n_fixed += mesh.is_fixed(f);
  EXPECT_EQ(n_fixed, chosen.size()) << "a lock was lost, or came";
  return chosen.size();
}

TEST(Locks, FixedEdgesStayInsideAndOnTheSurface) {
  const TetMesh input = jittered(5, 0.3, 3);
  const auto vertices_of = [&](EdgeHandle e) { return input.edge_vertices(e); };
  for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree})
    EXPECT_GT(expect_kept(input, mode, input.edges(), vertices_of, edges_of), 40U);
}

TEST(Locks, FixedFacesStayInsideAndOnTheSurface) {
  const TetMesh input = jittered(5, 0.3, 4);
  const auto vertices_of = [&](FaceHandle f) { return input.face_vertices(f); };
  for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree})
    EXPECT_GT(expect_kept(input, mode, input.faces(), vertices_of, faces_of), 60U);
}

TEST(Locks, FixedPatchOfTheMeshIsAsThatOfTheOptions) {
  const auto patch = [](const TetMesh& m, int label) {
    std::set<std::set<Place>> faces;
    for (const auto& [corners, value] : places_of(m, m.labels().faces))
      if (value == label) faces.insert(corners);
    return faces;
  };
  const TetMesh input = labelled_box(5, 0.4, 6);
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = input;
    mesh.set_fixed_patch(3);
    ImproveOptions options = with(mode);
    options.raise_min_dihedral = false;
    improve(mesh, options);
    EXPECT_EQ(patch(mesh, 3), patch(input, 3));
    EXPECT_NE(patch(mesh, 4), patch(input, 4)) << "nothing has changed anywhere";
    EXPECT_TRUE(mesh.is_fixed_patch(3));
    TetMesh other = input;
    options.surface.fixed_patches = {3};
    improve(other, options);
    EXPECT_EQ(patch(other, 4), patch(mesh, 4));
  }
}

}  // namespace
}  // namespace hfr::test
