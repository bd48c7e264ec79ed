// SPDX-License-Identifier: BSD-3-Clause
// Patches with their part of a flat surface.
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "HalfFace/Check.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/Patch.hh"
#include "Remesh/PatchSearch.hh"
#include "Remesh/StageBench.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

/// The cell with a corner there.
CellHandle cell_at(const TetMesh& mesh, Vec3 p) {
  for (CellHandle c : mesh.cells())
    for (VertexHandle v : mesh.cell(c).v)
      if (mesh.point(v) == p) return c;
  return {};
}

bool is_whole(const TetMesh& mesh, VertexHandle v, const Patch& patch) {
  Star star;
  mesh.gather_star(v, star);
  for (int k = 0; k < star.size; ++k) {
    const auto& cells = patch.cells();
    if (std::find(cells.begin(), cells.end(), star.cells[static_cast<std::size_t>(k)]) == cells.end())
      return false;
  }
  return true;
}

TEST(SurfacePart, MayDoWhatTheWholeMayAwayFromTheOtherCells) {
  const TetMesh mesh = built(generate::box({6, 6, 6}));
  SurfaceMesh whole(mesh, flat_surface());
  // A corner, the middle of an edge, the middle of a side.
  for (const Vec3 place : {Vec3{0, 0, 0}, Vec3{0.5, 0, 0}, Vec3{0.5, 0.5, 0}}) {
    const Patch patch(mesh, cell_at(mesh, place), 2);
    const TetMesh& here = patch.mesh();
    SurfaceMesh part(here, whole, patch.vertices());
    EXPECT_TRUE(part.in_step(here));
    const auto there = [&](VertexHandle v) { return patch.vertices()[v.idx()]; };
    std::map<SurfaceKind, int> n_alike;
    int n_cut = 0;
    for (VertexHandle v : here.boundary_vertices()) {
      const bool own = is_whole(mesh, there(v), patch);
      n_cut += own ? 0 : 1;
      EXPECT_EQ(part.motion_constraint(v).kind,
                own ? whole.motion_constraint(there(v)).kind : SurfaceKind::kFixed);
      if (!own) continue;
      ++n_alike[part.motion_constraint(v).kind];
      EXPECT_EQ(part.motion_constraint(v).axis, whole.motion_constraint(there(v)).axis);
      EXPECT_EQ(part.motion_constraint(v).anchor, whole.motion_constraint(there(v)).anchor);
    }
    EXPECT_GT(n_cut, 10);
    EXPECT_GT(n_alike[SurfaceKind::kFacet], 0);
    EXPECT_EQ(n_alike[SurfaceKind::kFixed] > 0, place == (Vec3{0, 0, 0}));
    int n_swaps = 0;
    int n_splits = 0;
    for (EdgeHandle e : here.boundary_edges()) {
      const auto [a, b] = here.edge_vertices(e);
      int n_sides = 0;  // of the whole's surface, that are the part's as well
      for (VertexHandle apex : part.across(a, b)) {
        const HalfFaceHandle h =
            apex.is_valid() ? mesh.find_halfface({there(a), there(b), there(apex)}) : HalfFaceHandle();
        const HalfFaceHandle m =
            apex.is_valid() ? mesh.find_halfface({there(b), there(a), there(apex)}) : HalfFaceHandle();
        n_sides += (h.is_valid() && mesh.is_boundary(h)) || (m.is_valid() && mesh.is_boundary(m)) ? 1 : 0;
      }
      EXPECT_EQ(part.may_swap(a, b), n_sides == 2 && whole.may_swap(there(a), there(b)));
      EXPECT_EQ(part.may_split(a, b), n_sides == 2 && whole.may_split(there(a), there(b)));
      EXPECT_TRUE(n_sides < 2 || part.is_feature(a, b) == whole.is_feature(there(a), there(b)));
      n_swaps += part.may_swap(a, b) ? 1 : 0;
      n_splits += part.may_split(a, b) ? 1 : 0;
    }
    EXPECT_GT(n_swaps, 3);
    EXPECT_GT(n_splits, place.y == 0 ? n_swaps : n_swaps - 1) << "edges of the box can be split as well";
  }
}

TEST(SurfacePart, WhatIsLockedPeriodicOrAnInterfaceStays) {
  TetMesh mesh = labelled_box(4, 0.1, 1);
  SurfaceOptions options = flat_surface();
  options.fixed_patches = {5};  // z = 0
  SurfaceMesh whole(mesh, options);
  std::size_t n_interface = 0;
  std::size_t n_locked = 0;
  for (CellHandle c : mesh.cells()) {
    if (c.idx() % 31 != 0) continue;
    const Patch patch(mesh, c, 2);
    const SurfaceMesh part(patch.mesh(), whole, patch.vertices());
    for (HalfFaceHandle h : patch.mesh().boundary_halffaces()) {
      const auto f = patch.mesh().halfface_vertices(h);
      const auto in_plane = [&](int axis, double value) {
        return std::all_of(f.begin(), f.end(),
                           [&](VertexHandle v) { return patch.mesh().point(v)[axis] == value; });
      };
      const HalfFaceHandle there = mesh.find_halfface(
          {patch.vertices()[f[0].idx()], patch.vertices()[f[1].idx()], patch.vertices()[f[2].idx()]});
      const bool interface =
          !mesh.is_boundary(there) &&
          mesh.region(cell_of(there)) != mesh.region(cell_of(mesh.opposite_halfface(there)));
      if (!interface && !in_plane(2, 0)) continue;
      ++(interface ? n_interface : n_locked);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(part.motion_constraint(f[k]).kind, SurfaceKind::kFixed);
        EXPECT_FALSE(part.may_swap(f[k], f[(k + 1) % 3]));
        EXPECT_FALSE(part.may_split(f[k], f[(k + 1) % 3]));
      }
    }
  }
  EXPECT_GT(n_interface, 50U);
  EXPECT_GT(n_locked, 50U);
}

/// A run of search_patches() over a flat box, and what became of the surface.
struct Searched {
  TetMesh mesh;
  bool changed = false;
  bool in_step = false;
  bool same_faces = false;
};
Searched searched(TetMesh mesh, const SurfaceOptions& wanted, int threads) {
  const auto boundary = boundary_of(mesh);
  ImproveOptions options;
  options.policy = {threads, 1};
  options.surface = wanted;
  SurfaceMesh surface(mesh, wanted);
  StageBench bench(mesh, options, &surface);
  const bool changed = search_patches(bench.run, 40, kLittleEffort);
  const bool in_step = surface.in_step(mesh);
  const bool same_faces = boundary_of(mesh) == boundary;
  return {std::move(mesh), changed, in_step, same_faces};
}

/// A box with labelled sides, some of them as seen from inside, after a cheap run that leaves its surface
/// alone.
TetMesh box_with_patches(std::uint64_t seed) {
  TetMesh mesh = jittered(4, 0.25, seed);
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    auto f = mesh.halfface_vertices(h);
    for (int i = 0; i < 3; ++i)
      for (const double side : {0.0, 1.0})
        if (mesh.point(f[0])[i] == side && mesh.point(f[1])[i] == side && mesh.point(f[2])[i] == side) {
          if (i > 0) std::swap(f[0], f[1]);
          mesh.labels().faces.set(f, 1 + 2 * i + static_cast<int>(side));
        }
  }
  ImproveOptions options = serial();
  options.ops = Ops::kEdge | Ops::kFace | Ops::kSmooth;
  improve(mesh, options);
  return mesh;
}

TEST(SurfacePart, SearchChangesTheSurfaceAndKeepsShapeLabelsAndBits) {
  int n_changed = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const TetMesh first = box_with_patches(seed);
    const double before = smallest_dihedral(first, {});
    ASSERT_GT(before, 0);
    std::optional<TetMesh> alone;
    for (const int threads : {1, 2, 3, 7}) {
      const Searched done = searched(first, flat_surface(), threads);
      const TetMesh& mesh = done.mesh;
      EXPECT_EQ(check(mesh), Ok);
      EXPECT_TRUE(done.in_step);
      EXPECT_GT(smallest_dihedral(mesh, {}), before);
      EXPECT_NEAR(volume(mesh), volume(first), 1e-14);
      n_changed += done.same_faces ? 0 : 1;
      const auto& labels = mesh.labels().faces;
      std::size_t n_faces = 0;
      for (HalfFaceHandle h : mesh.boundary_halffaces()) {
        ++n_faces;
        const auto f = mesh.halfface_vertices(h);
        const std::size_t at = labels.position(f);
        ASSERT_LT(at, labels.size()) << "a face without its label";
        const int side = labels.entries()[at].value - 1;
        for (VertexHandle v : f) EXPECT_NEAR(mesh.point(v)[side / 2], side % 2, 1e-15);
        EXPECT_EQ(CyclicOrder::key(labels.entries()[at].vertices) == CyclicOrder::key(f), side / 2 == 0);
      }
      EXPECT_EQ(labels.size(), n_faces);
      if (!alone) alone = mesh;
      EXPECT_TRUE(std::equal(mesh.points().begin(), mesh.points().end(), alone->points().begin(),
                             alone->points().end()));
    }
  }
  EXPECT_GT(n_changed, 8);
}

TEST(SurfacePart, SearchLeavesCurvedSurfacesAlone) {
  // Their shape is that of the input, which a patch does not know.
  SurfaceOptions curved = flat_surface();
  curved.mode = SurfaceMode::kFree;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Searched done = searched(box_with_patches(seed), curved, 1);
    EXPECT_TRUE(done.changed);
    EXPECT_TRUE(done.same_faces);
    EXPECT_TRUE(done.in_step);
  }
}

}  // namespace
}  // namespace hfr::test
