// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface: the surface as arrays, and what of its shape has to be kept.
#ifndef HFR_SURFACE_FEATURES_HH
#define HFR_SURFACE_FEATURES_HH

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Surface/SurfaceMesh.hh"
#include "Surface/SurfaceOptions.hh"
#include "Surface/TriangleMesh.hh"

namespace hfr::surface {

/// Triangles of the boundary and of the interfaces, or of a mesh of triangles.
struct Arrays {
  std::span<const Vec3> points;                    ///< per vertex; those of the mesh
  std::vector<std::array<VertexHandle, 3>> faces;  ///< seen from outside, or from the larger region
  std::vector<HalfFaceHandle> halffaces;           ///< inside of each; invalid where there are no cells
  std::vector<std::uint8_t> at_invalid;            ///< the cell inside is inverted or flat
  std::vector<int> patch;                          ///< label, 0 = none
  std::vector<std::uint8_t> inward;                ///< the label names the face as seen from inside
  std::vector<std::uint8_t> interface;             ///< between two regions
  std::vector<std::array<int, 2>> regions;         ///< inside and outside of each; the latter of interfaces
  std::vector<std::uint8_t> locked;                ///< stays a face: fixed, or of a periodic patch
  std::vector<std::uint8_t> fixed;                 ///< locked, and its vertices stay where they are, too
  std::vector<std::array<VertexHandle, 2>> locked_edges;  ///< edges that stay, ends ascending
  std::vector<VertexHandle> locked_vertices;
};
Arrays gather(const TetMesh& mesh, const SurfaceOptions& options, par::Policy policy);
/// Of a part of a mesh what its own cells and vertices say, which no other part does; but for locks, which
/// all may tell that know of them. Faces that have been locked by name are those of TetMesh::locks().
Arrays gather_own(const TetMesh& part, const SurfaceOptions& options,
                  const std::function<bool(CellHandle)>& is_own_cell,
                  const std::function<bool(VertexHandle)>& is_own_vertex);
Arrays gather(const TriangleMesh& mesh, const SurfaceOptions& options);

/// An edge of the surface: faces f[0] and f[1] meet in it, local edge k from corner k to the next.
struct Edge {
  VertexHandle a, b;  ///< ascending
  std::array<std::uint32_t, 2> f{};
  std::array<std::uint8_t, 2> k{};
  bool manifold = false;  ///< exactly two faces, seen from the same side
  bool feature = false;   ///< an edge that no vertex may leave and no swap may take away
  bool locked = false;    ///< a feature that the user wants as it is
};

/// All edges of the faces; none is a feature yet.
std::vector<Edge> find_edges(const Arrays& arrays);

struct Features {
  std::vector<Edge> edges;           ///< by ascending vertices
  std::vector<std::uint32_t> facet;  ///< per face: number of its planar facet; only in flat mode
  std::vector<MotionConstraint> motion_constraint;  ///< per vertex of the volume
};
/// `distance`: how far the surface may go in free mode. Edges that turn, in a set no larger than a few times
/// that, are too small to be features.
Features find_features(const Arrays& arrays, const SurfaceOptions& options, double distance);
/// In free mode, where the same surface had features before it was meshed in another way: edges that lie on
/// those `segments` are features, whatever angle is there by now, and no others for their angle alone. What
/// lies in a `corner` stays there.
Features find_features_again(const Arrays& arrays, const SurfaceOptions& options,
                             std::span<const std::array<Vec3, 2>> segments, std::vector<Vec3> corners);
/// Largest distance from the input that the options allow; 0 but in free mode. Unless they say it, three
/// tenths of the mean edge, but no more than 0.005 of the diagonal of the bounding box.
double allowed_distance(const Arrays& arrays, const SurfaceOptions& options);
/// Diagonal of the bounding box of all corners; 0 without any.
double diagonal(const Arrays& arrays);
/// Mean length of the triangles' edges; 0 without any.
double mean_edge(const Arrays& arrays);
/// Flags of the vertices that stay when folds are opened: fixed ones, ends of edges that stay, and corners of
/// faces that stay or are of an interface.
std::vector<std::uint8_t> held_vertices(const Arrays& arrays);
/// Vertices no further from a plane or line count as in it in flat mode.
double flat_tolerance(const Arrays& arrays);
/// Six times the volume between a triangle and a point, positive seen from outside.
inline double six_volume(const Triangle& t, Vec3 from) {
  return dot(t[0] - from, cross(t[1] - from, t[2] - from));
}

/// The outward normal of a triangle, as long as twice its area.
inline Vec3 scaled_normal(const Triangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }
/// n at length 1, by division, so that a normal along an axis is that axis to the last bit; zero stays zero.
inline Vec3 unit(Vec3 n) {
  const double length = norm(n);
  return length > 0 ? Vec3{n.x / length, n.y / length, n.z / length} : Vec3{};
}
/// Sum of the area vectors at length 1; zero where they cancel out.
inline Vec3 area_normal(std::span<const Triangle> triangles) {
  Vec3 sum;
  for (const Triangle& t : triangles) sum = sum + scaled_normal(t);
  return unit(sum);
}
inline Triangle corners(std::span<const Vec3> points, const std::array<VertexHandle, 3>& f) {
  return {points[f[0].idx()], points[f[1].idx()], points[f[2].idx()]};
}

}  // namespace hfr::surface

#endif
