// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/Periodic.hh"

#include <algorithm>
#include <map>
#include <set>

#include "HalfFace/Errors.hh"
#include "Parallel/DisjointSets.hh"
#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"

namespace hfr::surface {
namespace {

constexpr double kMatch = 1e-9;  // of the diagonal: how far a match may lie from where it should

struct Patch {
  int label = 0;
  std::vector<std::array<VertexHandle, 3>> faces;
  std::vector<VertexHandle> vertices;  // ascending
  Vec3 centre;                         // mean of the vertices
};

Patch patch_of(const Arrays& arrays, int label) {
  Patch patch;
  patch.label = label;
  std::set<VertexHandle> vertices;
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    if (arrays.patch[i] != label) continue;
    patch.faces.push_back(arrays.faces[i]);
    vertices.insert(arrays.faces[i].begin(), arrays.faces[i].end());
  }
  HFR_REQUIRE(!patch.faces.empty(), "periodic patch " + std::to_string(label) + " has no faces");
  patch.vertices.assign(vertices.begin(), vertices.end());
  for (VertexHandle v : patch.vertices) patch.centre = patch.centre + arrays.points[v.idx()];
  patch.centre = (1.0 / static_cast<double>(patch.vertices.size())) * patch.centre;
  return patch;
}

std::string names(const Patch& a, const Patch& b) {
  return "periodic patches " + std::to_string(a.label) + " and " + std::to_string(b.label) +
         " do not match: ";
}

/// For each vertex of patch a, in order, its match on patch b.
std::vector<VertexHandle> match(const Arrays& arrays, const Patch& a, const Patch& b, double tolerance) {
  HFR_REQUIRE(a.vertices.size() == b.vertices.size() && a.faces.size() == b.faces.size(),
              names(a, b) + std::to_string(a.vertices.size()) + " vertices and " +
                  std::to_string(a.faces.size()) + " faces against " + std::to_string(b.vertices.size()) +
                  " and " + std::to_string(b.faces.size()));
  const Vec3 step = b.centre - a.centre;
  std::vector<std::array<Vec3, 2>> places;  // a tree of points, as segments without length
  for (VertexHandle v : b.vertices) places.push_back({arrays.points[v.idx()], arrays.points[v.idx()]});
  const InputSurface tree(places);
  std::vector<VertexHandle> partner;
  std::map<VertexHandle, VertexHandle> to;
  std::set<VertexHandle> taken;
  for (VertexHandle v : a.vertices) {
    const InputSurface::Hit hit = tree.nearest(arrays.points[v.idx()] + step);
    const VertexHandle w = b.vertices[hit.item];
    HFR_REQUIRE(hit.distance <= tolerance && taken.insert(w).second,
                names(a, b) + "vertex " + std::to_string(v.idx()) + " of patch " + std::to_string(a.label) +
                    " has none of patch " + std::to_string(b.label) + " opposite it");
    partner.push_back(w);
    to[v] = w;
  }
  std::set<std::array<VertexHandle, 3>> faces;
  for (const auto& f : b.faces) faces.insert(CyclicOrder::key(f));
  for (const auto& f : a.faces) {  // whose match on b is seen from its other side
    const std::array<VertexHandle, 3> opposite = {to.at(f[0]), to.at(f[2]), to.at(f[1])};
    HFR_REQUIRE(faces.contains(CyclicOrder::key(opposite)),
                names(a, b) + "the face of vertices " + std::to_string(f[0].idx()) + " " +
                    std::to_string(f[1].idx()) + " " + std::to_string(f[2].idx()) + " has none opposite it");
  }
  return partner;
}

}  // namespace

std::vector<std::vector<VertexHandle>> periodic_orbits(const Arrays& arrays, const SurfaceOptions& options) {
  if (options.periodic.empty()) return {};
  HFR_REQUIRE(!arrays.faces.empty(), "a mesh without faces has no periodic patches");
  const double tolerance = kMatch * diagonal(arrays);
  par::DisjointSets<Index> orbit_of(arrays.points.size());
  std::set<VertexHandle> matched;
  for (const auto& [first, second] : options.periodic) {
    HFR_REQUIRE(first != second, "patch " + std::to_string(first) + " cannot be periodic with itself");
    const Patch a = patch_of(arrays, first);
    const Patch b = patch_of(arrays, second);
    const std::vector<VertexHandle> partner = match(arrays, a, b, tolerance);
    for (std::size_t i = 0; i < partner.size(); ++i) {
      orbit_of.join(a.vertices[i].idx(), partner[i].idx());
      matched.insert({a.vertices[i], partner[i]});
    }
  }
  std::map<Index, std::vector<VertexHandle>> sets;
  for (VertexHandle v : matched) sets[orbit_of.find(v.idx())].push_back(v);
  std::vector<std::vector<VertexHandle>> orbits;
  for (auto& [first, orbit] : sets) orbits.push_back(std::move(orbit));
  return orbits;
}

}  // namespace hfr::surface
