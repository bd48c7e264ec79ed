// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceMesh.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "Operators/Clusters.hh"
#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"
#include "Surface/Meshes.hh"

namespace hfr::test {
namespace {

SurfaceOptions free_within(double hausdorff) {
  SurfaceOptions options;
  options.mode = SurfaceMode::kFree;
  options.hausdorff = hausdorff;
  return options;
}

/// A box without some of its cells, chosen at random: pinched vertices and edges.
TetMesh torn(std::uint64_t seed) {
  const generate::Arrays arrays = generate::box({3, 3, 3});
  std::vector<Corners> kept;
  for (std::size_t i = 0; i < arrays.cells.size(); ++i)
    if (generate::random_unit(seed, i) < 0.6) kept.push_back(arrays.cells[i]);
  return build(arrays.points, kept);
}

VertexHandle at(const TetMesh& mesh, Vec3 p) {
  for (VertexHandle v : mesh.vertices())
    if (norm(mesh.point(v) - p) < 1e-12) return v;
  return {};
}

TEST(SurfaceMesh, BoxHasCornersEdgesAndFacets) {
  const TetMesh mesh = built(generate::box({3, 3, 3}));
  for (const SurfaceOptions& options : {flat_surface(), free_within(0.1)}) {
    const SurfaceMesh surface(mesh, options);
    EXPECT_EQ(surface.n_faces(), 6U * 9 * 2);
    EXPECT_EQ(surface.n_feature_edges(), 12U * 3);
    EXPECT_EQ(surface.n_vertices(SurfaceKind::kFixed), 8U);
    EXPECT_EQ(surface.n_vertices(SurfaceKind::kCurve), 12U * 2);
    EXPECT_EQ(surface.n_vertices(SurfaceKind::kFacet), 6U * 4);
    EXPECT_TRUE(surface.in_step(mesh));
  }
}

TEST(SurfaceMesh, BumpsWithinReachAreNoFeaturesAndTheRimIs) {
  TetMesh mesh = built(generate::box({12, 12, 12}));
  const auto on_rim = [](Vec3 p) { return p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1; };
  for (VertexHandle v : mesh.boundary_vertices()) {
    const Vec3 p = mesh.point(v);
    if (p.z == 1 && !on_rim(p))
      mesh.set_point(v, {p.x, p.y, 1 + 0.06 * (generate::random_unit(3, v.idx()) - 0.5)});
  }
  constexpr std::size_t kSharp = 12 * 12;
  EXPECT_GT(SurfaceMesh(mesh, free_within(1e-3)).n_feature_edges(), kSharp + 20);
  const SurfaceMesh surface(mesh, free_within(0.05));
  EXPECT_EQ(surface.n_feature_edges(), kSharp);
  for (int i = 0; i < 12; ++i)
    EXPECT_TRUE(surface.is_feature(at(mesh, {i / 12.0, 0, 1}), at(mesh, {(i + 1) / 12.0, 0, 1})));
}

TEST(SurfaceMesh, FacesAndHalfFacesAreLinkedBothWays) {
  const TetMesh mesh = jittered(3, 0.2, 1);
  SurfaceMesh surface(mesh, flat_surface());
  for (std::size_t f = 0; f < surface.n_faces(); ++f) {
    const HalfFaceHandle h = surface.halfface(mesh, f);
    ASSERT_TRUE(h.is_valid());
    EXPECT_TRUE(mesh.is_boundary(h));
    EXPECT_EQ(surface.face(mesh, h), f);
  }
  for (HalfFaceHandle h : mesh.halffaces()) {
    if (mesh.is_boundary(h)) continue;
    EXPECT_EQ(surface.face(mesh, h), SurfaceMesh::kNoFace);
    break;
  }
}

TEST(SurfaceMesh, EdgesOfSeveralFansAreNeitherSplitNorSwapped) {
  std::size_t n_pinched = 0, n_plain = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const TetMesh mesh = torn(seed);
    const SurfaceMesh surface(mesh, flat_surface());
    std::map<std::pair<VertexHandle, VertexHandle>, int> n_faces;
    for (HalfFaceHandle h : mesh.boundary_halffaces()) {
      const auto f = mesh.halfface_vertices(h);
      for (std::size_t k = 0; k < 3; ++k) ++n_faces[std::minmax(f[k], f[(k + 1) % 3])];
    }
    for (const auto& [edge, n] : n_faces) {
      const auto [a, b] = edge;
      if (n == 2) {
        n_plain += surface.may_split(a, b) ? 1 : 0;
        continue;
      }
      ++n_pinched;
      EXPECT_FALSE(surface.may_split(a, b));
      EXPECT_FALSE(surface.may_swap(a, b));
    }
  }
  EXPECT_GT(n_pinched, 10U);
  EXPECT_GT(n_plain, 100U);
}

TEST(SurfaceMesh, OnlyDiagonalsWithinAFacetMayBeSwapped) {
  const TetMesh mesh = built(generate::box({2, 2, 2}));
  const SurfaceMesh surface(mesh, flat_surface());
  std::size_t n_diagonals = 0;
  for (EdgeHandle e : mesh.boundary_edges()) {
    const auto [a, b] = mesh.edge_vertices(e);
    const Vec3 along = mesh.point(b) - mesh.point(a);
    const int n_axes = (along.x != 0) + (along.y != 0) + (along.z != 0);
    if (surface.is_feature(a, b)) {
      EXPECT_FALSE(surface.may_swap(a, b));
    }
    if (n_axes == 2 && surface.may_swap(a, b)) ++n_diagonals;
  }
  EXPECT_EQ(n_diagonals, 6U * 4);
}

TEST(SurfaceMesh, CollapsesGoAlongTheSurfaceAndAlongItsEdges) {
  const TetMesh mesh = built(generate::box({4, 4, 4}));
  SurfaceMesh surface(mesh, flat_surface());
  std::vector<VertexHandle> targets;
  surface.collapse_targets(at(mesh, {0, 0, 0}), targets);
  EXPECT_TRUE(targets.empty()) << "a corner must stay";
  surface.collapse_targets(at(mesh, {0.5, 0, 0}), targets);
  ASSERT_EQ(targets.size(), 2U);
  for (VertexHandle t : targets) EXPECT_EQ(mesh.point(t).y + mesh.point(t).z, 0);
  targets.clear();
  surface.collapse_targets(at(mesh, {0.5, 0.5, 0}), targets);
  EXPECT_EQ(targets.size(), 6U);
  targets.clear();
  surface.collapse_targets(at(mesh, {0.5, 0.5, 0.5}), targets);
  EXPECT_TRUE(targets.empty()) << "an inner vertex is not the surface's";
}

TEST(SurfaceMesh, PatchBordersAreFeatures) {
  TetMesh mesh = built(generate::box({4, 4, 4}));
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);
    const Vec3 sum = mesh.point(f[0]) + mesh.point(f[1]) + mesh.point(f[2]);
    if (sum.z == 0) mesh.labels().faces.set(f, sum.x < 1.5 ? 1 : 2);
  }
  const SurfaceMesh surface(mesh, flat_surface());
  EXPECT_EQ(surface.n_feature_edges(), 12U * 4 + 4);
  EXPECT_EQ(surface.motion_constraint(at(mesh, {0.5, 0.5, 0})).kind, SurfaceKind::kCurve);
  EXPECT_EQ(surface.motion_constraint(at(mesh, {0.5, 0, 0})).kind, SurfaceKind::kFixed);
}

TEST(SurfaceMesh, WhatTheUserHasLockedStays) {
  TetMesh mesh = built(generate::box({4, 4, 4}));
  const VertexHandle middle = at(mesh, {0.5, 0.5, 0});
  const auto kind_with = [&](auto&& lock) {
    SurfaceOptions options = flat_surface();
    lock(options);
    return SurfaceMesh(mesh, options).motion_constraint(middle).kind;
  };
  const VertexHandle next = at(mesh, {0.75, 0.5, 0});
  EXPECT_EQ(kind_with([](SurfaceOptions&) {}), SurfaceKind::kFacet);
  EXPECT_EQ(kind_with([&](SurfaceOptions& o) { o.fixed_vertices = {middle}; }), SurfaceKind::kFixed);
  EXPECT_EQ(kind_with([&](SurfaceOptions& o) { o.fixed_edges = {{middle, next}}; }), SurfaceKind::kFixed);
  std::array<VertexHandle, 3> face;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);
    if (f[0] == middle || f[1] == middle || f[2] == middle) {
      face = f;
      mesh.labels().faces.set(f, 5);
    }
  }
  EXPECT_EQ(kind_with([&](SurfaceOptions& o) { o.fixed_faces = {face}; }), SurfaceKind::kFixed);
  EXPECT_EQ(kind_with([&](SurfaceOptions& o) { o.fixed_patches = {5}; }), SurfaceKind::kFixed);
  mesh.labels().faces.clear();
  mesh.set_fixed(middle);
  EXPECT_EQ(kind_with([](SurfaceOptions&) {}), SurfaceKind::kFixed);
}

TEST(SurfaceMesh, InterfaceBelongsToTheSurfaceAndIsSwappedUnlessFixed) {
  TetMesh mesh = built(generate::two_region_box({4, 4, 4}));
  const SurfaceMesh surface(mesh, flat_surface());
  EXPECT_EQ(surface.n_faces(), 6U * 16 * 2 + 16 * 2);
  EXPECT_TRUE(surface.in_step(mesh));
  const VertexHandle inside = at(mesh, {0.5, 0.5, 0.5});
  EXPECT_EQ(surface.motion_constraint(inside).kind, SurfaceKind::kFacet);
  const auto n_swappable = [&](const SurfaceMesh& of) {
    std::size_t n = 0;
    for (EdgeHandle e : mesh.edges()) {
      const auto [a, b] = mesh.edge_vertices(e);
      if (mesh.point(a).x != 0.5 || mesh.point(b).x != 0.5) continue;
      n += of.may_swap(a, b);
      EXPECT_FALSE(of.may_split(a, b));
      if (mesh.is_boundary(e)) {
        EXPECT_FALSE(of.may_swap(a, b)) << "three faces meet there";
      }
    }
    return n;
  };
  EXPECT_GE(n_swappable(surface), 16U) << "the diagonals";
  for (FaceHandle f : mesh.faces())
    if (std::ranges::all_of(mesh.face_vertices(f), [&](VertexHandle v) { return mesh.point(v).x == 0.5; }))
      mesh.set_fixed(f);
  EXPECT_EQ(n_swappable(SurfaceMesh(mesh, flat_surface())), 0U);
}

TEST(SurfaceMesh, PinchedSurfacesAreTakenApart) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const TetMesh mesh = torn(seed);
    for (const SurfaceOptions& options : {flat_surface(), free_within(0.05)}) {
      const SurfaceMesh surface(mesh, options);
      EXPECT_TRUE(surface.in_step(mesh)) << "seed " << seed;
    }
  }
}

/// The faces at the rim of a thin plate, and the same with a notch that lies between the points by which such
/// large triangles are judged. What is left of the plate is nowhere far from the input.
TEST(SurfaceMesh, NotchInTheRimOfAThinPlateBetweenPointsFarApartIsRefused) {
  constexpr double kThin = 0.005;
  generate::Arrays arrays = generate::box({1, 1, 1});
  for (Vec3& p : arrays.points) p.z *= kThin;
  const TetMesh mesh = built(arrays);
  SurfaceOptions options = free_within(0.02);
  options.feature_angle = options.normal_angle = 180;  // only distances count
  const SurfaceMesh surface(mesh, options);
  const auto at = [&](Vec3 x) {
    for (VertexHandle v : mesh.vertices())
      if (mesh.point(v) == x) return v;
    return VertexHandle();
  };
  const VertexHandle a = at({0, 0, 0}), b = at({1, 0, 0}), c = at({1, 0, kThin}), d = at({0, 0, kThin});
  const VertexHandle below = surface.across(a, b)[1];
  const VertexHandle above = surface.across(d, c)[0];
  ASSERT_EQ(surface.across(a, b)[0], c);
  ASSERT_TRUE(below.is_valid() && above.is_valid());
  const std::array<std::array<VertexHandle, 3>, 4> faces = {
      {{a, b, c}, {a, c, d}, {b, a, below}, {d, c, above}}};
  std::vector<Triangle> removed;
  for (const auto& f : faces) removed.push_back({mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2])});
  const auto keeps_notch = [&](double depth) {
    const std::array<Vec3, 5> rim = {{{0, 0, 0}, {0.22, 0, 0}, {0.3, depth, 0}, {0.38, 0, 0}, {1, 0, 0}}};
    const Vec3 up = {0, 0, kThin};
    std::vector<Triangle> created;
    for (std::size_t i = 0; i + 1 < rim.size(); ++i) {
      const Vec3 p = rim[i];
      const Vec3 q = rim[i + 1];
      created.push_back({p, q, q + up});
      created.push_back({p, q + up, p + up});
      created.push_back({q, p, mesh.point(below)});
      created.push_back({p + up, q + up, mesh.point(above)});
    }
    return surface.keeps_shape(faces, removed, created);
  };
  EXPECT_TRUE(keeps_notch(0.01));
  EXPECT_FALSE(keeps_notch(0.05));
}

TEST(SurfaceMesh, OptionsOutOfRangeAreRefused) {
  const TetMesh mesh = built(generate::box({1, 1, 1}));
  SurfaceOptions options = free_within(-1);
  EXPECT_THROW(SurfaceMesh(mesh, options), InvalidInput);
  options = flat_surface();
  options.feature_angle = 181;
  EXPECT_THROW(SurfaceMesh(mesh, options), InvalidInput);
}

TEST(SurfaceDistance, OfSurfacesThatAreShiftedIsTheShift) {
  const TetMesh mesh = built(generate::box({3, 3, 3}));
  const std::vector<Triangle> here = surface_triangles(mesh);
  ASSERT_EQ(here.size(), 108U);
  std::vector<Triangle> there = here;
  for (Triangle& t : there)
    for (Vec3& p : t) p = p + Vec3{0.125, 0, 0};
  EXPECT_NEAR(surface_distance(here, there, 0.1).hausdorff(), 0.125, 1e-15);
  EXPECT_LT(surface_distance(here, here, 0.1).hausdorff(), 1e-15);
  // A surface that lacks a part is near to the whole, but not the whole to it.
  const SurfaceDistance part = surface_distance(std::span(here).first(18), here, 0.1);
  EXPECT_LT(part.there, 1e-15);
  EXPECT_GT(part.back, 0.5);
}

/// As surface_distance() by its definition: every point of a triangle's grid against every other triangle.
double furthest_of_all(std::span<const Triangle> from, std::span<const Triangle> to, double spacing) {
  double largest = 0;
  for (const Triangle& t : from) {
    const double longest = std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
    const double cuts = std::ceil(longest / spacing);
    for (double u = 0; u <= cuts; ++u) {
      for (double v = 0; u + v <= cuts; ++v) {
        const Vec3 x = t[0] + (u / cuts) * (t[1] - t[0]) + (v / cuts) * (t[2] - t[0]);
        double least = std::numeric_limits<double>::infinity();
        for (const Triangle& other : to) least = std::min(least, norm2(nearest_point(other, x) - x));
        largest = std::max(largest, std::sqrt(least));
      }
    }
  }
  return largest;
}

TEST(SurfaceDistance, IsThatOfAllPointsFromAllTriangles) {
  const TetMesh mesh = built(generate::box({5, 4, 3}));
  const std::vector<Triangle> here = surface_triangles(mesh);
  for (double bump : {0.0, 1e-9, 0.05}) {
    TetMesh other = built(generate::box({4, 5, 4}));
    for (VertexHandle v : other.boundary_vertices())
      other.set_point(v, other.point(v) + Vec3{0, 0, bump * generate::random_unit(5, v.idx())});
    const std::vector<Triangle> there = surface_triangles(other);
    const SurfaceDistance found = surface_distance(here, there, 0.06);
    const double tolerance = std::max(1e-12 * bump, 1e-16);
    EXPECT_NEAR(found.there, furthest_of_all(here, there, 0.06), tolerance) << bump;
    EXPECT_NEAR(found.back, furthest_of_all(there, here, 0.06), tolerance) << bump;
    EXPECT_GE(found.back, 0.5 * bump);
  }
}

TEST(SurfaceMesh, VertexInWhichTwoPlanesTouchStays) {
  // The middle of the upper side of one box is that of a side of the other.
  for (const bool touch : {false, true}) {
    const generate::Arrays box = generate::box({2, 2, 2});
    generate::Arrays both = box;
    const auto n = static_cast<Index>(box.points.size());
    for (Vec3 p : box.points) both.points.push_back(p + Vec3{0.5, 0, 0.5});
    const Vec3 place = {0.5, 0.5, 1};
    const auto at = [&](Index first) {
      return static_cast<Index>(std::find(both.points.begin() + first, both.points.end(), place) -
                                both.points.begin());
    };
    const Index one = at(0), other = at(n);
    ASSERT_LT(one, n);
    ASSERT_LT(other, 2 * n);
    for (auto cell : box.cells) {
      for (Index& v : cell) v = v + n == other && touch ? one : v + n;
      both.cells.push_back(cell);
    }
    const TetMesh mesh = build(both.points, both.cells);
    SurfaceOptions options;
    options.mode = SurfaceMode::kFlat;
    const SurfaceMesh surface(mesh, options);
    EXPECT_EQ(surface.motion_constraint(V(one)).kind, touch ? SurfaceKind::kFixed : SurfaceKind::kFacet);
  }
}

/// A part of a mesh as it calls the vertices of the whole: backwards, and numbers have gaps.
class Backwards : public VertexNumbers {
 public:
  explicit Backwards(std::size_t n) : n_(n) {}
  std::uint64_t number(VertexHandle v) const override { return 7 * (n_ - 1 - v.idx()) + 3; }
  VertexHandle vertex_at(std::uint64_t number) const override { return here(V((number - 3) / 7)); }
  VertexHandle here(VertexHandle v) const { return v.is_valid() ? V(n_ - 1 - v.idx()) : v; }

 private:
  std::size_t n_;
};

/// A surface as whoever holds a part of the mesh has it: its vertices alone, with their numbers.
struct Numbered {
  std::vector<Vec3> points;
  surface::Arrays arrays;
  std::vector<std::uint64_t> in_whole;

  Numbered(const TetMesh& mesh, const SurfaceOptions& options, const Backwards& numbers)
      : arrays(surface::gather(mesh, options, {})) {
    std::vector<VertexHandle> used;
    for (const auto& f : arrays.faces) used.insert(used.end(), f.begin(), f.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (VertexHandle v : used) {
      points.push_back(mesh.point(v));
      in_whole.push_back(numbers.number(numbers.here(v)));
    }
    for (auto& f : arrays.faces)
      for (VertexHandle& v : f) v = V(std::lower_bound(used.begin(), used.end(), v) - used.begin());
    arrays.points = points;
  }
  Numbered(const Numbered&) = delete;
  Numbered& operator=(const Numbered&) = delete;
};

/// The surface alone, with numbers of its vertices.
std::unique_ptr<SurfaceMesh> numbered(const TetMesh& mesh, const SurfaceOptions& options,
                                      const Backwards& numbers) {
  const Numbered all(mesh, options, numbers);
  return std::make_unique<SurfaceMesh>(all.arrays, all.in_whole, options);
}

/// Of all edges, and of all vertices.
void expect_same_answers(SurfaceMesh& plain, SurfaceMesh& seen, const TetMesh& mesh, const Backwards& part) {
  std::size_t n_swaps = 0, n_targets = 0;
  for (VertexHandle v : mesh.vertices()) {
    const MotionConstraint &a = plain.motion_constraint(v), &b = seen.motion_constraint(part.here(v));
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.axis, b.axis);
    if (a.kind == SurfaceKind::kInside) continue;
    EXPECT_EQ(plain.point(v), seen.point(part.here(v)));
    const Vec3 moved = mesh.point(v) + Vec3{0.01, 0.02, 0.03};
    EXPECT_EQ(plain.project(v, moved), seen.project(part.here(v), moved));
    std::vector<VertexHandle> targets, others;
    plain.collapse_targets(v, targets);
    seen.collapse_targets(part.here(v), others);
    std::ranges::transform(targets, targets.begin(), [&](VertexHandle u) { return part.here(u); });
    EXPECT_EQ(targets, others);
    n_targets += targets.size();
    std::vector<std::array<VertexHandle, 3>> star, other_star;
    plain.star(v, star);
    seen.star(part.here(v), other_star);
    ASSERT_EQ(star.size(), other_star.size());
    for (std::size_t i = 0; i < star.size(); ++i) {
      std::vector<Triangle> removed(1), created(1);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(part.here(star[i][k]), other_star[i][k]);
        removed[0][k] = mesh.point(star[i][k]);
        created[0][k] = star[i][k] == v ? moved : removed[0][k];
      }
      const std::array<VertexHandle, 3>&f = star[i], &g = other_star[i];
      EXPECT_EQ(plain.keeps_shape({&f, 1}, removed, created), seen.keeps_shape({&g, 1}, removed, created));
      const VertexHandle w = star[i][0] == v ? star[i][1] : star[i][0];
      const VertexHandle p = part.here(v), q = part.here(w);
      n_swaps += plain.may_swap(v, w) ? 1 : 0;
      EXPECT_EQ(plain.may_swap(v, w), seen.may_swap(p, q));
      EXPECT_EQ(plain.may_split(v, w), seen.may_split(p, q));
      EXPECT_EQ(plain.is_inner(v, w), seen.is_inner(p, q));
      EXPECT_EQ(plain.is_feature(v, w), seen.is_feature(p, q));
      const auto apexes = plain.across(v, w), other_apexes = seen.across(p, q);
      for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(part.here(apexes[k]), other_apexes[k]);
    }
  }
  EXPECT_GT(n_swaps, 20U);
  EXPECT_GT(n_targets, 20U);
}

TEST(SurfaceMesh, APartSeesTheSurfaceOfTheWhole) {
  const TetMesh mesh = jittered(4, 0.2, 3);
  const Backwards part(mesh.n_vertices());
  for (const SurfaceOptions& options : {flat_surface(), free_within(0.05)}) {
    SurfaceMesh plain(mesh, options);
    const auto whole = numbered(mesh, options, part);
    const auto seen = whole->seen_from(part);
    expect_same_answers(plain, *seen, mesh, part);
    EXPECT_EQ(plain.hausdorff(), seen->hausdorff());
    const auto before = seen->copy();
    std::array<VertexHandle, 2> edge;  // what is told to the whole shows in the part
    for (VertexHandle v : mesh.vertices()) {
      std::vector<std::array<VertexHandle, 3>> star;
      plain.star(v, star);
      for (const auto& f : star)
        if (plain.may_swap(f[0], f[1])) edge = {f[0], f[1]};
    }
    ASSERT_TRUE(edge[0].is_valid());
    const auto told = [&](VertexHandle v) { return whole->handle_of(part.number(part.here(v))); };
    plain.on_swap(edge[0], edge[1]);
    whole->on_swap(told(edge[0]), told(edge[1]));
    EXPECT_EQ(whole->number_of(told(edge[0])), part.number(part.here(edge[0])));
    expect_same_answers(plain, *seen, mesh, part);
    EXPECT_EQ(plain.volume_gain(), seen->volume_gain());
    EXPECT_FALSE(seen->may_swap(part.here(edge[0]), part.here(edge[1])));
    seen->take_back(*before);  // and the other way round
    EXPECT_TRUE(whole->may_swap(told(edge[0]), told(edge[1])));
  }
}

/// May the vertex be moved by that step, as far as the surface is concerned?
bool may_move(const SurfaceMesh& surface, VertexHandle v, Vec3 step) {
  std::vector<std::array<VertexHandle, 3>> star;
  surface.star(v, star);
  std::vector<Triangle> removed, created;
  for (const auto& f : star) {
    Triangle t = {surface.point(f[0]), surface.point(f[1]), surface.point(f[2])};
    removed.push_back(t);
    for (std::size_t k = 0; k < 3; ++k)
      if (f[k] == v) t[k] = t[k] + step;
    created.push_back(t);
  }
  return surface.keeps_shape(star, removed, created);
}

/// Moves a vertex of the mesh and tells the surface.
void move(TetMesh& mesh, SurfaceMesh& surface, VertexHandle v, Vec3 step) {
  mesh.set_point(v, mesh.point(v) + step);
  surface.on_move(v, mesh.point(v));
}

TEST(SurfaceMesh, WhatIsAllowedCountsFromTheFirstShapeAlsoAfterwards) {
  const Vec3 up = {0, 0, 0.05};
  TetMesh mesh = built(generate::box({4, 4, 4}));
  SurfaceMesh surface(mesh, free_within(0.1));
  const VertexHandle v = at(mesh, {0.5, 0.5, 1}), w = at(mesh, {0.5, 0.5, 0});
  ASSERT_TRUE(may_move(surface, v, up));
  move(mesh, surface, v, up);
  move(mesh, surface, w, up);  // the volume stays what it was
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(may_move(surface, v, up));
    EXPECT_TRUE(may_move(surface, v, -0.2 * up));
    EXPECT_TRUE(surface.in_step(mesh));
    EXPECT_NEAR(surface.volume_gain(), 0, 1e-12);
    surface.rebuild(mesh);
  }
}

TEST(SurfaceMesh, MeshedAgainItKeepsDistanceVolumeAndFeatures) {
  const TetMesh coarse = built(generate::box({2, 2, 2}));
  TetMesh fine = built(generate::box({4, 4, 4}));
  SurfaceOptions options;
  options.mode = SurfaceMode::kFree;  // the distance is one of the mean edge, or of the diagonal
  SurfaceMesh surface(coarse, options);
  const double allowed = surface.hausdorff();
  surface.rebuild(fine);
  EXPECT_TRUE(surface.in_step(fine));
  EXPECT_EQ(surface.hausdorff(), allowed);
  EXPECT_NEAR(surface.volume_gain(), 0, 1e-12);
  EXPECT_EQ(surface.n_feature_edges(), 12U * 4);
  EXPECT_EQ(surface.n_vertices(SurfaceKind::kFixed), 8U);
  const VertexHandle top = at(fine, {0.5, 0.5, 1}), rim = at(fine, {0.25, 0, 1});
  EXPECT_EQ(surface.motion_constraint(rim).kind, SurfaceKind::kCurve);
  EXPECT_NEAR(norm(surface.project(rim, {0.3, 0.1, 1.1}) - Vec3{0.3, 0, 1}), 0, 1e-15);
  EXPECT_TRUE(may_move(surface, top, {0, 0, 0.5 * allowed}));
  EXPECT_FALSE(may_move(surface, top, {0, 0, 0.8 * allowed}));
  EXPECT_FALSE(may_move(surface, top, {0, 0, -0.8 * allowed}));
}

/// A spike, whose tip is far from whatever is a little lower, while that is near the spike's sides.
TEST(SurfaceMesh, InputIsNearTheResultAlsoWhenItIsMeshedAgain) {
  TetMesh mesh = built(generate::box({2, 2, 2}));
  const VertexHandle tip = at(mesh, {0.5, 0.5, 1});
  mesh.set_point(tip, {0.5, 0.5, 2});
  SurfaceOptions options = free_within(0.1);
  options.feature_angle = options.normal_angle = 180;  // only distances count
  SurfaceMesh surface(mesh, options);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(may_move(surface, tip, {0, 0, -0.05}));
    EXPECT_FALSE(may_move(surface, tip, {0, 0, -0.1}));
    surface.rebuild(mesh);
  }
}

/// A bend between two feature edges, hardly large enough for a corner, and smaller once a neighbour has
/// moved.
TEST(SurfaceMesh, CornersStayCornersWhenItIsMeshedAgain) {
  TetMesh mesh = built(generate::box({2, 2, 2}));
  const VertexHandle corner = at(mesh, {0.5, 0, 1}), beside = at(mesh, {1, 0, 1});
  mesh.set_point(corner, {0.5, -0.2, 1});  // the rim turns by 43.6 degrees here
  const SurfaceOptions options = free_within(0.05);
  SurfaceMesh surface(mesh, options);
  ASSERT_EQ(surface.motion_constraint(corner).kind, SurfaceKind::kFixed);
  move(mesh, surface, beside, {0, -0.045, 0});
  EXPECT_EQ(SurfaceMesh(mesh, options).motion_constraint(corner).kind, SurfaceKind::kCurve);
  surface.rebuild(mesh);
  EXPECT_EQ(surface.motion_constraint(corner).kind, SurfaceKind::kFixed);
}

/// A roof whose ridge is hardly sharp enough for a feature, and flatter than that after a move.
TEST(SurfaceMesh, FeaturesStayFeaturesWhenItIsMeshedAgain) {
  TetMesh mesh = built(generate::box({2, 2, 2}));
  std::vector<VertexHandle> ridge;
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    if (p.z != 1 || p.x != 0.5) continue;
    ridge.push_back(v);
    mesh.set_point(v, p + Vec3{0, 0, 0.19});
  }
  ASSERT_EQ(ridge.size(), 3U);
  const Backwards part(mesh.n_vertices());
  const SurfaceOptions options = free_within(0.05);
  SurfaceMesh surface(mesh, options);
  const auto whole = numbered(mesh, options, part);
  const VertexHandle middle = at(mesh, {0.5, 0.5, 1.19}), end = at(mesh, {0.5, 0, 1.19});
  ASSERT_TRUE(surface.is_feature(middle, end));
  for (VertexHandle v : ridge) {
    move(mesh, surface, v, {0, 0, -0.015});
    whole->on_move(whole->handle_of(part.number(part.here(v))), mesh.point(v));
  }
  EXPECT_FALSE(SurfaceMesh(mesh, options).is_feature(middle, end));
  surface.rebuild(mesh);
  EXPECT_TRUE(surface.is_feature(middle, end));
  EXPECT_EQ(surface.motion_constraint(middle).kind, SurfaceKind::kCurve);
  const Numbered now(mesh, options, part);
  const auto seen = whole->seen_from(part);  // which sees what becomes of the whole
  whole->rebuild(now.arrays, now.in_whole);
  EXPECT_TRUE(seen->is_feature(part.here(middle), part.here(end)));
  EXPECT_EQ(seen->volume_gain(), surface.volume_gain());
  EXPECT_NEAR(surface.volume_gain(), -0.015 / 2 / 1.095, 1e-4);
}

}  // namespace
}  // namespace hfr::test
