// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/FixedParts.hh"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <vector>

#include "HalfFace/Errors.hh"
#include "HalfFace/Generate.hh"
#include "Remesh/Improve.hh"

namespace hfr {
namespace {

using ::testing::HasSubstr;
using V = VertexHandle;

TetMesh box() {
  const generate::Arrays arrays = generate::box({2, 2, 2});
  TetMesh mesh = build(arrays.points, arrays.cells);
  mesh.labels().faces.set({V(0), V(1), V(4)}, 7);
  return mesh;
}

template <class Fix>
std::string refusal(Fix&& fix) {
  TetMesh mesh = box();
  ImproveOptions options;
  fix(options.surface);
  try {
    improve(mesh, options);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(FixedParts, WhatTheMeshDoesNotHaveIsNamed) {
  using S = SurfaceOptions;
  EXPECT_THAT(refusal([](S& s) {
                s.fixed_vertices = {V(3), V(27)};
              }),
              HasSubstr("fix vertex:27: there are 27 vertices"));
  EXPECT_THAT(refusal([](S& s) {
                s.fixed_edges = {{V(0), V(99)}};
              }),
              HasSubstr("fix edge:0-99: there are 27"));
  EXPECT_THAT(refusal([](S& s) {
                s.fixed_edges = {{V(0), V(8)}};
              }),
              HasSubstr("fix edge:0-8: there is no such edge"));
  EXPECT_THAT(refusal([](S& s) {
                s.fixed_faces = {{V(0), V(1), V(8)}};
              }),
              HasSubstr("fix face:0-1-8: there is no such face"));
  EXPECT_THAT(refusal([](S& s) {
                s.fixed_patches = {7, 8};
              }),
              HasSubstr("fix patch:8: no face has this label"));
}

TEST(FixedParts, WhatItHasIsTaken) {
  EXPECT_EQ(refusal([](SurfaceOptions& s) {
              s.fixed_patches = {7};
              s.fixed_vertices = {V(26)};
              s.fixed_edges = {{V(1), V(0)}};
              s.fixed_faces = {{V(4), V(1), V(0)}};
            }),
            "");
}

/// A box whose inner vertices are displaced, so that a run has them all to move.
TetMesh shaken_box() {
  generate::Arrays arrays = generate::box({8, 8, 8});
  generate::jitter_inner(arrays, 0.45, 7);
  return build(arrays.points, arrays.cells);
}

// It counted for parts of the surface only.
TEST(FixedParts, WhatIsInsideStaysInEveryMode) {
  for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = shaken_box();
    std::vector<V> inside;
    for (V v : mesh.vertices())
      if (!mesh.is_boundary(v)) inside.push_back(v);
    ASSERT_GT(inside.size(), 100U);
    ImproveOptions options;
    options.maps = true;
    options.surface.mode = mode;
    options.surface.fixed_vertices = {inside[10], inside[20], inside[30]};
    const auto edges = mesh.vertex_edges(inside[40]);
    const EdgeHandle e = *edges.begin();
    options.surface.fixed_edges = {mesh.edge_vertices(e)};
    const auto face = mesh.halfface_vertices(halfface_of(mesh.incident_cell(inside[60]), 1));
    options.surface.fixed_faces = {face};
    mesh.set_fixed(inside[10]);  // by the caller, who finds it so again
    std::map<V, Vec3> where;
    for (V v : options.surface.fixed_vertices) where[v] = mesh.point(v);
    for (V v : mesh.edge_vertices(e)) where[v] = mesh.point(v);
    for (V v : face) where[v] = mesh.point(v);

    const Result result = improve(mesh, options);
    ASSERT_TRUE(result.changed);
    const auto now = [&](V v) { return result.maps.vertices.empty() ? v : result.maps.vertices[v.idx()]; };
    for (const auto& [v, point] : where) {
      ASSERT_TRUE(now(v).is_valid()) << v.idx();
      EXPECT_EQ(mesh.point(now(v)), point) << v.idx();
    }
    const auto& edge = options.surface.fixed_edges[0];
    EXPECT_TRUE(mesh.find_edge(now(edge[0]), now(edge[1])).is_valid());
    EXPECT_TRUE(mesh.find_face(std::array{now(face[0]), now(face[1]), now(face[2])}).is_valid());
    EXPECT_TRUE(mesh.locks().empty());
    EXPECT_EQ(std::ranges::count_if(mesh.vertices(), [&](V v) { return mesh.is_fixed(v); }), 1);
    EXPECT_TRUE(mesh.is_fixed(now(inside[10])));
  }
}

// A walk round a pinched vertex does not come to all its edges and faces.
TEST(FixedParts, WhatNoWalkComesToIsFoundAllTheSame) {
  const generate::Arrays arrays = generate::box({3, 3, 3});
  std::vector<std::array<Index, 4>> kept;
  for (std::size_t i = 0; i < arrays.cells.size(); ++i)
    if (generate::random_unit(2, i) < 0.2) kept.push_back(arrays.cells[i]);
  TetMesh mesh = build(arrays.points, kept);
  ImproveOptions options;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    if (!mesh.find_edge(v[0], v[1]).is_valid()) options.surface.fixed_edges.push_back({v[0], v[1]});
    if (!mesh.find_face({v[0], v[1], v[2]}).is_valid())
      options.surface.fixed_faces.push_back({v[2], v[1], v[0]});
  }
  ASSERT_FALSE(options.surface.fixed_edges.empty());
  ASSERT_FALSE(options.surface.fixed_faces.empty());
  {
    FixedParts fixed(mesh, options.surface);
    EXPECT_EQ(mesh.locks().edges.size(), options.surface.fixed_edges.size());
    EXPECT_EQ(mesh.locks().faces.size(), options.surface.fixed_faces.size());
    fixed.release(mesh, {});
    EXPECT_TRUE(mesh.locks().empty());
  }
  improve(mesh, options);
  EXPECT_TRUE(mesh.locks().empty());
}

// Handles in the options are those of before: a mesh with gaps is closed up first.
TEST(FixedParts, OfAMeshWithDeletedVerticesTheOnesThatAreNamedStay) {
  TetMesh mesh = shaken_box();
  std::vector<V> inside;
  for (V v : mesh.vertices())
    if (!mesh.is_boundary(v)) inside.push_back(v);
  mesh.delete_vertex(V(0));
  ImproveOptions options;
  options.maps = true;
  options.surface.fixed_vertices = {inside[10], inside[40], inside[90]};
  std::map<V, Vec3> where;
  for (V v : options.surface.fixed_vertices) where[v] = mesh.point(v);
  const Result result = improve(mesh, options);
  ASSERT_TRUE(result.changed);
  for (const auto& [v, point] : where) {
    ASSERT_TRUE(result.maps.vertices[v.idx()].is_valid());
    EXPECT_EQ(mesh.point(result.maps.vertices[v.idx()]), point);
  }
  EXPECT_EQ(std::ranges::count_if(mesh.vertices(), [&](V v) { return mesh.is_fixed(v); }), 0);
}

}  // namespace
}  // namespace hfr
