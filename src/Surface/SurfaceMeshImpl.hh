// SPDX-License-Identifier: BSD-3-Clause
// What SurfaceMesh is made of: the one file that includes OpenMesh, which takes ten seconds to compile. For
// SurfaceMesh.cc (building and asking), SurfaceMeshShape.cc (what keeps the shape) and SurfaceMeshChanges.cc
// (what has happened).
#ifndef HFR_SURFACE_SURFACE_MESH_IMPL_HH
#define HFR_SURFACE_SURFACE_MESH_IMPL_HH

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// After the mesh, whose traits it specialises.
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include "Operators/Cavity.hh"
#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"
#include "Surface/NearTriangle.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {
namespace surface {

struct Traits : OpenMesh::DefaultTraits {
  using Point = Eigen::Vector3d;
  using Normal = Eigen::Vector3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using Om = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using OmVertex = Om::VertexHandle;
using OmEdge = Om::EdgeHandle;
using OmHalfedge = Om::HalfedgeHandle;
using OmFace = Om::FaceHandle;

inline Eigen::Vector3d eigen(Vec3 p) { return {p.x, p.y, p.z}; }

/// Into how many pieces the edges of a triangle are cut at least and at most, for the points by which its
/// distance is judged.
constexpr int kLeastCuts = 2;
constexpr int kMostCuts = 12;

/// True when f(point) holds for all points inside a triangle that cut its edges into so many pieces.
template <class F>
bool all_inner_points(const Triangle& t, int cuts, F&& f) {
  for (int u = 1; u < cuts; ++u)
    for (int v = 1; u + v < cuts; ++v)
      if (!f(t[0] + (1.0 * u / cuts) * (t[1] - t[0]) + (1.0 * v / cuts) * (t[2] - t[0]))) return false;
  return true;
}

inline double longest_edge2(const Triangle& t) {
  return std::max({norm2(t[1] - t[0]), norm2(t[2] - t[1]), norm2(t[0] - t[2])});
}

/// Bisects a triangle at its longest edge, then its halves, until no edge is longer than `spacing`: f(piece,
/// middle) is told each piece that is cut, with the point that is new. True returned leaves the piece whole.
template <class F>
void bisect(const Triangle& t, double spacing, F&& f, int depth = 0) {
  constexpr int kDeepest = 20;
  std::size_t k = 0;  // where the longest edge begins
  for (std::size_t i = 1; i < 3; ++i)
    if (norm2(t[(i + 1) % 3] - t[i]) > norm2(t[(k + 1) % 3] - t[k])) k = i;
  const Vec3 p = t[k];
  const Vec3 q = t[(k + 1) % 3];
  const Vec3 apex = t[(k + 2) % 3];
  if (!(norm2(q - p) > spacing * spacing) || depth == kDeepest) return;
  const Vec3 middle = p + 0.5 * (q - p);
  if (f(t, middle)) return;
  bisect(Triangle{apex, p, middle}, spacing, f, depth + 1);
  bisect(Triangle{apex, middle, q}, spacing, f, depth + 1);
}

/// Points of the input that travel with the face that they are near to.
struct Samples {
  std::vector<Vec3> points;
  double reach = 0;  // none of them is further from the face
};

/// What is known of a face of the surface.
struct FaceRecord {
  int patch = 0;
  bool locked = false;
  bool interface = false;
  bool inward = false;                   // its label names it as seen from inside
  std::array<std::uint32_t, 2> sides{};  // places of its regions in Impl::regions; the second of interfaces
  HalfFaceHandle inside;                 // of the volume, when last looked up
  std::uint32_t facet = 0;               // flat mode
  std::array<Samples, 2> samples;        // free mode: those `spacing` apart, and those between them
  std::uint32_t beneath = 0;             // free mode: a triangle of the input that lies about there
};

}  // namespace surface

struct SurfaceMesh::Impl {
  using Om = surface::Om;
  using OmVertex = surface::OmVertex;
  using OmHalfedge = surface::OmHalfedge;
  using OmFace = surface::OmFace;
  using FaceRecord = surface::FaceRecord;

  SurfaceOptions options;
  double hausdorff = 0;
  double detail = 0;             // length: what of the shape is no larger is noise
  double spacing = 0;            // length between points by which distances are judged
  double between = 0;            // length between those in between, where `spacing` is more
  bool samples_between = false;  // some face has points in between
  Om om;
  std::vector<VertexHandle> vertex;              // of the volume, per OpenMesh vertex
  std::vector<OmVertex> first;                   // OpenMesh's per vertex of the volume; invalid inside
  std::vector<std::pair<Index, OmVertex>> more;  // OpenMesh's further ones of a vertex, ascending
  std::vector<FaceRecord> faces;
  std::vector<MotionConstraint> motion_constraint;
  std::shared_ptr<const InputSurface> shape, curves;  // free mode
  std::vector<std::array<VertexHandle, 3>> gone;      // labelled faces that are no more
  std::set<int> fresh;              // numbers of labelled faces whose vertices are others now
  Vec3 origin;                      // from which volumes are measured
  double six_volume = 0, area = 0;  // of the input
  double six_gain = 0;              // six times what the volume has gained since
  struct Region {
    double six_volume = 0, six_gain = 0;
  };
  std::vector<Region> regions;  // by ascending number
  bool has_interfaces = false;
  std::vector<std::vector<VertexHandle>> orbits;
  std::vector<std::uint32_t> orbit_of;  // per vertex; empty without orbits
  std::vector<std::uint64_t> in_whole;  // of a mesh in parts: numbers of vertices, ascending
  bool alone = false;                   // there are no cells
  bool is_open = false;                 // a surface without cells that encloses nothing

  bool flat() const { return options.mode != SurfaceMode::kFree; }

  template <class Visit>
  void for_sheets(VertexHandle v, Visit&& visit) const {
    if (v.idx() >= first.size() || !first[v.idx()].is_valid()) return;
    visit(first[v.idx()]);
    auto at = std::lower_bound(more.begin(), more.end(), v.idx(),
                               [](const auto& entry, Index wanted) { return entry.first < wanted; });
    for (; at != more.end() && at->first == v.idx(); ++at) visit(at->second);
  }
  bool has_one_sheet(VertexHandle v) const {
    int n = 0;
    for_sheets(v, [&](OmVertex) { ++n; });
    return n == 1;
  }
  /// Invalid when the surface has no such edge; where it has several, one of them.
  OmHalfedge find(VertexHandle a, VertexHandle b) const {
    OmHalfedge found;
    for_sheets(a, [&](OmVertex from) {
      for (auto it = om.cvoh_iter(from); it.is_valid(); ++it)
        if (vertex[static_cast<std::size_t>(om.to_vertex_handle(*it).idx())] == b) found = *it;
    });
    return found;
  }
  /// Invalid also where the surface has several such edges: what is done to a fan of cells at one of them
  /// would be noted at another.
  OmHalfedge find_only(VertexHandle a, VertexHandle b) const {
    OmHalfedge found;
    int n = 0;
    for_sheets(a, [&](OmVertex from) {
      for (auto it = om.cvoh_iter(from); it.is_valid(); ++it) {
        if (vertex[static_cast<std::size_t>(om.to_vertex_handle(*it).idx())] != b) continue;
        found = *it;
        ++n;
      }
    });
    return n == 1 ? found : OmHalfedge();
  }
  OmFace find(const std::array<VertexHandle, 3>& f) const {
    OmFace found;
    for_sheets(f[0], [&](OmVertex from) {
      for (auto it = om.cvoh_iter(from); it.is_valid(); ++it) {
        if (om.is_boundary(*it)) continue;
        const VertexHandle to = vertex_of(om.to_vertex_handle(*it));
        const VertexHandle third = vertex_of(om.to_vertex_handle(om.next_halfedge_handle(*it)));
        if ((to == f[1] && third == f[2]) || (to == f[2] && third == f[1])) found = om.face_handle(*it);
      }
    });
    return found;
  }
  bool closes(OmHalfedge h) const;
  VertexHandle vertex_of(OmVertex v) const { return vertex[static_cast<std::size_t>(v.idx())]; }
  std::array<VertexHandle, 3> vertices(OmFace f) const {
    OmHalfedge h = om.halfedge_handle(f);
    std::array<VertexHandle, 3> v;
    for (VertexHandle& w : v) {
      w = vertex_of(om.to_vertex_handle(h));
      h = om.next_halfedge_handle(h);
    }
    return v;
  }
  FaceRecord& record(OmFace f) { return faces[static_cast<std::size_t>(f.idx())]; }
  const FaceRecord& record(OmFace f) const { return faces[static_cast<std::size_t>(f.idx())]; }

  void build(const surface::Arrays& arrays, const surface::Features& features);
  void take_shape(const surface::Arrays& arrays, const surface::Features& features);
  void begin(const surface::Arrays& arrays, const SurfaceOptions& wanted);
  /// The surface of `before` meshed in another way, told by nobody: it keeps the shape that `before` keeps,
  /// with the features that lie where those of `before` lie now. In flat mode the shape is that of now.
  void begin_again(const surface::Arrays& arrays, const Impl& before);
  std::vector<std::array<Vec3, 2>> feature_segments() const;
  std::vector<Vec3> fixed_points() const;
  /// The vertices of each orbit move together; not at all where they are of several kinds.
  void bind(std::vector<std::vector<VertexHandle>> found);

  /// Triangles of the input that may be the nearest ones.
  using Guesses = FixedVector<std::uint32_t, 64>;
  bool are_near(std::span<const Triangle> created, std::span<const Triangle> removed, Guesses& beneath,
                double distance) const;
  bool are_near_between(std::span<const Triangle> created, Guesses& beneath, double distance) const;
  bool turn_little(std::span<const Triangle> created, std::span<const Triangle> removed,
                   const Guesses& beneath, double distance) const;

  OmVertex add_vertex(VertexHandle v, Vec3 p);
  bool is_inner(VertexHandle a, VertexHandle b) const;
  Vec3 point(VertexHandle v) const {
    const auto& p = om.point(first[v.idx()]);
    return {p[0], p[1], p[2]};
  }
  /// To be called before the vertices of a face change: its label has to go from them (write_labels()).
  void note_gone(OmFace f) {
    if (record(f).patch != 0) gone.push_back(vertices(f));
  }
  void note_fresh(OmFace f) {
    if (record(f).patch != 0) fresh.insert(f.idx());
  }
  Triangle corners(OmFace f) const {
    OmHalfedge h = om.halfedge_handle(f);
    Triangle t;
    for (Vec3& p : t) {
      const auto& q = om.point(om.to_vertex_handle(h));
      p = {q[0], q[1], q[2]};
      h = om.next_halfedge_handle(h);
    }
    return t;
  }
  /// Adds what the faces bound to what has been gained, or takes it away: sign 1 or -1.
  void account(const std::vector<OmFace>& some, double sign);
  /// True when a volume that has lost or gained much already would lose or gain more.
  static bool is_too_much(const Region& region, double six_more, double share);
  bool keeps_shape(std::span<const std::array<VertexHandle, 3>> faces_removed,
                   std::span<const Triangle> removed, std::span<const Triangle> created) const;
  bool keeps_regions(std::span<const std::array<VertexHandle, 3>> faces_removed,
                     std::span<const Triangle> removed, std::span<const Triangle> created) const;
  int cuts_of(const Triangle& t) const {
    const double cuts = std::ceil(std::sqrt(surface::longest_edge2(t)) / spacing);
    return cuts < surface::kMostCuts ? std::max(static_cast<int>(cuts), surface::kLeastCuts)
                                     : surface::kMostCuts;  // also where it is no number
  }
  /// Are the points by which a triangle is judged so far apart that others between them have to be asked?
  bool has_between(const Triangle& t) const {
    const double apart = cuts_of(t) * between;
    return surface::longest_edge2(t) > apart * apart;
  }
  double spacing_between(std::span<const Triangle> input) const;
  /// Gives the points that the faces of `before` have to the nearest faces.
  void take_samples(const Impl& before);
  /// A sample stays where it is while that face is near enough, and goes to the nearest of these faces
  /// otherwise; so do those that have no face.
  void share_samples(const std::vector<OmFace>& among, std::array<std::vector<Vec3>, 2> homeless);
  std::vector<OmFace> live_faces() const {
    std::vector<OmFace> live;
    for (OmFace f : om.all_faces())
      if (!om.status(f).deleted()) live.push_back(f);
    return live;
  }
  std::vector<OmFace> faces_round(OmVertex v) const {
    std::vector<OmFace> round;
    for (auto it = om.cvf_iter(v); it.is_valid(); ++it) round.push_back(*it);
    return round;
  }
};

}  // namespace hfr

#endif
