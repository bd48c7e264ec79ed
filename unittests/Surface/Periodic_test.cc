// SPDX-License-Identifier: BSD-3-Clause
// Patches that match by a translation: their vertices move together, and are never torn apart.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/PatchSearch.hh"
#include "Remesh/StageBench.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

ImproveOptions with(SurfaceMode mode, std::vector<std::array<int, 2>> periodic) {
  ImproveOptions options = serial();
  options.surface.mode = mode;
  options.surface.periodic = std::move(periodic);
  return options;
}

/// A box of n³ cubes with patches 1 … 6 (x = 0, x = 1, y = 0, …), deformed by a periodic field, so that
/// opposite sides match, badly enough for cells at the sides to be poor. With `bend`, the sides along x are
/// no planes.
TetMesh periodic_box(Index n, double amplitude, double bend = 0) {
  TetMesh mesh = built(generate::box({n, n, n}));
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);
    for (int i = 0; i < 3; ++i)
      for (const double side : {0.0, 1.0})
        if (mesh.point(f[0])[i] == side && mesh.point(f[1])[i] == side && mesh.point(f[2])[i] == side)
          mesh.labels().faces.set(f, 1 + 2 * i + static_cast<int>(side));
  }
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    Vec3 q = p;
    for (int i = 0; i < 3; ++i) {
      if (p[i] == 0 || p[i] == 1) continue;
      // The same on both of two opposite sides: from the number of the vertex there, not of this one.
      std::uint64_t place = 0;
      for (int k = 0; k < 3; ++k)
        place = place * n + static_cast<std::uint64_t>(std::lround(p[k] * static_cast<double>(n))) % n;
      q[i] += amplitude / static_cast<double>(n) *
              (2 * generate::random_unit(7, 3 * place + static_cast<std::uint64_t>(i)) - 1);
    }
    q.x += bend * std::sin(std::numbers::pi * q.y) * std::sin(std::numbers::pi * q.z);
    mesh.set_point(v, q);
  }
  return mesh;
}

/// Corners of each face of a patch, but for the coordinate across it.
using Shadow = std::set<std::set<std::pair<double, double>>>;
Shadow shadow(const TetMesh& mesh, int patch) {
  const int across = (patch - 1) / 2;
  Shadow faces;
  for (const auto& entry : mesh.labels().faces.entries()) {
    if (entry.value != patch) continue;
    std::set<std::pair<double, double>> corners;
    for (VertexHandle v : entry.vertices)
      corners.emplace(mesh.point(v)[(across + 1) % 3], mesh.point(v)[(across + 2) % 3]);
    faces.insert(corners);
  }
  return faces;
}

std::size_t moves(const Result& result) {
  std::size_t n = 0;
  for (const PassReport& pass : result.passes)
    if (pass.op == "surface smooth") n += pass.winners;
  return n;
}

TEST(Periodic, SidesMoveTogetherAndTheirWorstCellsGetBetter) {
  const TetMesh input = periodic_box(6, 0.42);
  ASSERT_EQ(shadow(input, 1).size(), 72U);
  ASSERT_EQ(shadow(input, 1), shadow(input, 2));
  TetMesh held = input;
  ImproveOptions fixed = with(SurfaceMode::kFlat, {});
  fixed.surface.fixed_patches = {1, 2, 3, 4, 5, 6};
  const Result kept = improve(held, fixed);
  TetMesh mesh = input;
  const Result result = improve(mesh, with(SurfaceMode::kFlat, {{{1, 2}}, {{3, 4}}, {{5, 6}}}));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(moves(result), 20U);
  EXPECT_GT(result.after.min_dihedral.min, kept.after.min_dihedral.min + 1);
  for (const int patch : {1, 3, 5}) {
    EXPECT_EQ(shadow(mesh, patch).size(), 72U) << "faces of periodic patches stay the same ones";
    EXPECT_EQ(shadow(mesh, patch), shadow(mesh, patch + 1)) << "torn apart";
    EXPECT_NE(shadow(mesh, patch), shadow(input, patch)) << "nothing has moved";
  }
  EXPECT_NEAR(volume(mesh), 1, 1e-13);
}

TEST(Periodic, PatchesThatAreSearchedLeaveThemAlone) {
  TetMesh mesh = periodic_box(6, 0.3);
  ImproveOptions options = with(SurfaceMode::kFlat, {{{1, 2}}, {{3, 4}}});
  options.ops = Ops::kEdge | Ops::kFace | Ops::kSmooth;
  improve(mesh, options);
  options.ops = ImproveOptions{}.ops;
  std::array<decltype(shadow(mesh, 1)), 2> before = {shadow(mesh, 1), shadow(mesh, 3)};
  const double worst = smallest_dihedral(mesh, {});
  SurfaceMesh surface(mesh, options.surface);
  StageBench bench(mesh, options, &surface);
  EXPECT_TRUE(search_patches(bench.run, 40, kLittleEffort));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(surface.in_step(mesh));
  EXPECT_GT(smallest_dihedral(mesh, {}), worst);
  for (const int patch : {1, 3}) {
    EXPECT_EQ(shadow(mesh, patch), before[static_cast<std::size_t>(patch / 2)]);
    EXPECT_EQ(shadow(mesh, patch), shadow(mesh, patch + 1));
  }
}

TEST(Periodic, WhatIsNotPeriodicChangesAsEver) {
  TetMesh mesh = periodic_box(6, 0.42);
  const Result result = improve(mesh, with(SurfaceMode::kFlat, {{{1, 2}}}));
  EXPECT_EQ(shadow(mesh, 1), shadow(mesh, 2));
  EXPECT_EQ(shadow(mesh, 1).size(), 72U);
  EXPECT_NE(shadow(mesh, 3).size(), 72U) << "no collapse on a side that may";
  EXPECT_LT(result.surface.hausdorff, 1e-14);
}

TEST(Periodic, BentSidesKeepTheirDistanceInFree) {
  const TetMesh input = periodic_box(6, 0.42, 0.1);
  TetMesh mesh = input;
  const Result result = improve(mesh, with(SurfaceMode::kFree, {{{1, 2}}}));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(result.after.min_dihedral.min, result.before.min_dihedral.min);
  EXPECT_LE(result.surface.hausdorff, 1.1 * result.surface.bound);
  // As before every vertex of one side is one of the other's, moved by 1 along x.
  ImproveOptions again = with(SurfaceMode::kFree, {{{1, 2}}});
  const SurfaceMesh surface(mesh, again.surface);  // throws where they do not match
  std::size_t n_moved = 0;
  for (const auto& entry : mesh.labels().faces.entries()) {
    if (entry.value != 1) continue;
    for (VertexHandle v : entry.vertices) {
      const auto orbit = surface.orbit(v);
      ASSERT_EQ(orbit.size(), 2U);
      EXPECT_LT(norm(mesh.point(orbit[1]) - mesh.point(orbit[0]) - Vec3{1, 0, 0}), 1e-12);
      bool as_before = false;
      for (VertexHandle w : input.vertices()) as_before = as_before || input.point(w) == mesh.point(v);
      n_moved += !as_before;
    }
  }
  EXPECT_GT(n_moved, 10U);
}

TEST(Periodic, PatchesThatDoNotMatchAreRefusedInOneLine) {
  const auto message_of = [](const TetMesh& mesh, std::array<int, 2> pair) {
    SurfaceOptions options;
    options.mode = SurfaceMode::kFlat;
    options.periodic = {pair};
    try {
      const SurfaceMesh surface(mesh, options);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  TetMesh mesh = periodic_box(4, 0.2);
  EXPECT_EQ(message_of(mesh, {1, 2}), "");
  EXPECT_NE(message_of(mesh, {1, 1}).find("itself"), std::string::npos);
  EXPECT_NE(message_of(mesh, {1, 9}).find("patch 9 has no faces"), std::string::npos);
  EXPECT_NE(message_of(mesh, {1, 3}).find("do not match"), std::string::npos);
  TetMesh moved = mesh;
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    if (p.x != 1 || p.y == 0 || p.y == 1 || p.z == 0 || p.z == 1) continue;
    moved.set_point(v, p + Vec3{0, 1e-4, 0});
    break;
  }
  const std::string text = message_of(moved, {1, 2});
  EXPECT_NE(text.find("do not match: vertex"), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
  TetMesh fewer = mesh;
  for (const auto& entry : mesh.labels().faces.entries())
    if (entry.value == 2) {
      fewer.labels().faces.set(entry.vertices, 8);
      break;
    }
  EXPECT_NE(message_of(fewer, {1, 2}).find("32 faces against"), std::string::npos);
}

TEST(Periodic, EveryNumberOfThreadsGivesTheSameBits) {
  std::optional<std::uint64_t> first;
  for (const int threads : {1, 2, 3, 7}) {
    TetMesh mesh = periodic_box(5, 0.42);
    ImproveOptions options = with(SurfaceMode::kFlat, {{{1, 2}}, {{3, 4}}});
    options.policy = {threads, /*serial_below=*/1};
    EXPECT_GT(moves(improve(mesh, options)), 10U);
    const std::uint64_t hash = io::mesh_hash(mesh);
    if (!first) first = hash;
    EXPECT_EQ(hash, *first) << threads << " threads";
  }
}

}  // namespace
}  // namespace hfr::test
