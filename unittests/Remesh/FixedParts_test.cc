// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/FixedParts.hh"

#include <gmock/gmock.h>

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

}  // namespace
}  // namespace hfr
