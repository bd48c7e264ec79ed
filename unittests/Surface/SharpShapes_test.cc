// SPDX-License-Identifier: BSD-3-Clause
// Parts with sharp edges and planar faces: what is kept of them to the last bit, or to rounding.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "Surface/InputSurface.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

using Segment = std::array<Vec3, 2>;

struct Plane {
  const char* name;
  std::function<double(Vec3)> distance;
  double rounding;  ///< 0 along an axis: there every bit is kept
};

struct Part {
  const char* name;
  TetMesh mesh;
  std::vector<Plane> planes;
  std::size_t n_faces;    ///< between sharp edges, curved ones included
  std::size_t n_corners;  ///< in which sharp edges meet
};

Plane plane(const char* name, int axis, double at) {
  return {name, [=](Vec3 p) { return std::abs(p[axis] - at); }, 0};
}

std::vector<Part> parts() {
  constexpr double kRounding = 1e-14;
  std::vector<Part> all;
  all.push_back({"cube",
                 built(generate::jittered_box({5, 5, 5}, 0.35, 4)),
                 {plane("x = 0", 0, 0), plane("x = 1", 0, 1), plane("y = 0", 1, 0), plane("y = 1", 1, 1),
                  plane("z = 0", 2, 0), plane("z = 1", 2, 1)},
                 6,
                 8});
  all.push_back({"fandisk",
                 built(generate::fandisk({4, 6, 3}, 0.25, 2)),
                 {plane("bottom", 2, 0),
                  plane("first end", 1, 0),
                  plane("second end", 0, 0),
                  plane("low top", 2, 0.5),
                  {"step", [](Vec3 p) { return p.z < 0.5 ? 1.0 : std::abs(p.x - p.y); }, kRounding},
                  {"high top", [](Vec3 p) { return std::abs(p.z - (1.3 - 0.15 * p.x)); }, kRounding}},
                 8,
                 12});
  generate::Arrays cylinder = generate::cylinder(4, 8, 1, 2, 0, 20);
  generate::jitter_inner(cylinder, 0.35, 5);
  all.push_back({"cylinder", built(cylinder), {plane("bottom", 2, 0), plane("top", 2, 2)}, 3, 0});
  return all;
}

/// What is sharp about a surface, at the default feature angle.
struct Sharp {
  std::set<Place> corners;
  std::vector<Segment> edges;
  std::vector<std::vector<Vec3>> faces;  // points of each, between sharp edges

  explicit Sharp(const TetMesh& mesh) {
    const SurfaceMesh surface(mesh, with(SurfaceMode::kFree).surface);
    std::map<std::array<VertexHandle, 2>, std::vector<std::size_t>> faces_of;
    for (std::size_t f = 0; f < surface.n_faces(); ++f) {
      const auto v = surface.face_vertices(f);
      for (std::size_t k = 0; k < 3; ++k)
        faces_of[AnyOrder::key(std::array{v[k], v[(k + 1) % 3]})].push_back(f);
      for (VertexHandle w : v)
        if (surface.motion_constraint(w).kind == SurfaceKind::kFixed) corners.insert(place_of(mesh, w));
    }
    std::vector<std::size_t> group(surface.n_faces(), surface.n_faces());
    for (const auto& [e, pair] : faces_of)
      if (surface.is_feature(e[0], e[1])) edges.push_back({mesh.point(e[0]), mesh.point(e[1])});
    std::size_t n = 0;
    for (std::size_t seed = 0; seed < group.size(); ++seed) {
      if (group[seed] != group.size()) continue;
      std::vector<std::size_t> front = {seed};
      group[seed] = n;
      faces.emplace_back();
      while (!front.empty()) {
        const auto v = surface.face_vertices(front.back());
        front.pop_back();
        for (std::size_t k = 0; k < 3; ++k) {
          faces.back().push_back(mesh.point(v[k]));
          if (surface.is_feature(v[k], v[(k + 1) % 3])) continue;
          for (std::size_t g : faces_of.at(AnyOrder::key(std::array{v[k], v[(k + 1) % 3]}))) {
            if (group[g] != group.size()) continue;
            group[g] = n;
            front.push_back(g);
          }
        }
      }
      ++n;
    }
  }
};

double distance(Vec3 p, const std::vector<Segment>& segments) {
  double least = std::numeric_limits<double>::infinity();
  for (const Segment& s : segments) least = std::min(least, norm(nearest_point(s, p) - p));
  return least;
}

double length(const std::vector<Segment>& segments) {
  double sum = 0;
  for (const Segment& s : segments) sum += norm(s[1] - s[0]);
  return sum;
}

TEST(SharpShapes, KeepCornersSharpEdgesAndPlanes) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    for (const Part& part : parts()) {
      SCOPED_TRACE(std::string(part.name) + (mode == SurfaceMode::kFlat ? ", flat" : ", free"));
      const Sharp before(part.mesh);
      ASSERT_EQ(before.corners.size(), part.n_corners);
      ASSERT_EQ(before.faces.size(), part.n_faces);
      TetMesh mesh = part.mesh;
      const Result result = improve(mesh, with(mode));
      EXPECT_EQ(check(mesh), Ok);
      EXPECT_TRUE(result.goal_reached);
      EXPECT_GT(surface_changes(result), 20U);
      EXPECT_GT(result.after.min_dihedral.min, result.before.min_dihedral.min);

      const Sharp after(mesh);
      EXPECT_EQ(after.corners, before.corners);  // bit by bit
      for (const Segment& s : after.edges)
        for (Vec3 p : s) EXPECT_LT(distance(p, before.edges), 1e-14);
      const double kept = mode == SurfaceMode::kFlat ? 1e-13 : result.surface.bound;
      for (const Segment& s : before.edges)
        for (Vec3 p : {s[0], 0.5 * (s[0] + s[1])}) EXPECT_LE(distance(p, after.edges), kept);
      if (mode == SurfaceMode::kFlat) {
        EXPECT_NEAR(length(after.edges), length(before.edges), 1e-12);
      }

      EXPECT_EQ(after.faces.size(), part.n_faces);
      for (const Plane& wanted : part.planes) {
        const auto in_it = [&](const std::vector<Vec3>& face) {
          return std::all_of(face.begin(), face.end(),
                             [&](Vec3 p) { return wanted.distance(p) <= wanted.rounding; });
        };
        EXPECT_EQ(std::count_if(before.faces.begin(), before.faces.end(), in_it), 1) << wanted.name;
        EXPECT_EQ(std::count_if(after.faces.begin(), after.faces.end(), in_it), 1) << wanted.name;
      }
    }
  }
}

TEST(SharpShapes, WorseByFarThanWhatTheyCameFrom) {
  // The test above would be easy on meshes that are good as they are.
  for (const Part& part : parts()) {
    TetMesh mesh = part.mesh;
    const Result result = improve(mesh, with(SurfaceMode::kFrozen));
    TetMesh freed = part.mesh;
    EXPECT_GT(improve(freed, with(SurfaceMode::kFree)).after.min_dihedral.min,
              result.after.min_dihedral.min + 1)
        << part.name;
  }
}

}  // namespace
}  // namespace hfr::test
