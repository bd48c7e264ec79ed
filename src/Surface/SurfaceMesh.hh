// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_MESH_HH
#define HFR_SURFACE_SURFACE_MESH_HH

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Surface/SurfaceOptions.hh"
#include "Surface/TriangleMesh.hh"

namespace hfr {

namespace surface {
struct Arrays;
}

/// What a mesh that is a part of a larger one calls the vertices of that one.
class VertexNumbers {
 public:
  virtual ~VertexNumbers() = default;
  /// In the whole, of a vertex of the part.
  virtual std::uint64_t number(VertexHandle v) const = 0;
  /// Invalid where the part has none of that number.
  virtual VertexHandle vertex_at(std::uint64_t number) const = 0;
};

/// What a vertex may do.
enum class SurfaceKind : std::uint8_t {
  kInside,  ///< not on the surface
  kFacet,   ///< may move within its facet
  kCurve,   ///< may move along its two feature edges
  kFixed,   ///< corner, where surfaces meet otherwise, or locked
};

/// Where a vertex of the surface may go: the plane through `anchor` with the normal `axis`, or the line
/// through it in the direction of `axis`, both of length 1. In free mode axis is that of the input near the
/// vertex's first place and only says which side is out.
struct MotionConstraint {
  SurfaceKind kind = SurfaceKind::kInside;
  Vec3 anchor, axis;
};

/// Corners of a triangle, counter-clockwise seen from outside.
using Triangle = std::array<Vec3, 3>;
/// Of the surface round a vertex, for operators that take these: one with more is left alone.
constexpr std::size_t kMaxFacesOfVertex = 64;

/// The boundary of a tetrahedral mesh and the interfaces between its regions as an OpenMesh triangle mesh,
/// which decides what may become of the surface, and the shape that must be kept. Vertices are those of the
/// tetrahedral mesh; where several sheets meet in one, OpenMesh has it several times.
///
/// Const members may be called from several threads at once. What changes the surface is told to it one
/// change at a time, in the order of rank.
class SurfaceMesh {
 public:
  /// Takes the surface as it is now as the shape to keep. Throws InvalidInput for options out of range, and
  /// for periodic patches that do not match.
  SurfaceMesh(const TetMesh& mesh, const SurfaceOptions& options, par::Policy policy = {});
  /// A surface without cells. Members that take a TetMesh or a half-face are not for it.
  SurfaceMesh(const TriangleMesh& mesh, const SurfaceOptions& options);
  /// The surface of a part of a mesh whose surface is `whole`, in flat mode: some cells of one region as a
  /// mesh of their own, whose vertex i is vertices[i] of the whole's. Faces of the whole's boundary may
  /// change as they may there; all others, which face cells that are no part, stay as they are, with their
  /// vertices.
  SurfaceMesh(const TetMesh& part, const SurfaceMesh& whole, std::span<const VertexHandle> vertices);
  /// The surface of a mesh that is cut into parts, for whoever holds one of them. `arrays` have its vertices
  /// alone, in the order of their `numbers`, and its handles count these. Without periodic patches.
  SurfaceMesh(const surface::Arrays& arrays, std::vector<std::uint64_t> numbers,
              const SurfaceOptions& options);
  ~SurfaceMesh();
  SurfaceMesh(const SurfaceMesh&) = delete;
  SurfaceMesh& operator=(const SurfaceMesh&) = delete;

  /// The same surface as a part of the mesh sees it, whose vertices `numbers` tells: what it is asked is said
  /// in handles of the part. What happens to it is told to this one, and shows in both. It must not outlive
  /// `numbers`.
  std::unique_ptr<SurfaceMesh> seen_from(const VertexNumbers& numbers) const;
  /// Of a mesh in parts: the handle by which the surface knows that vertex; invalid where it has none.
  VertexHandle handle_of(std::uint64_t number) const;
  std::uint64_t number_of(VertexHandle v) const;
  /// A vertex will come with that number, which is larger than those of all others.
  VertexHandle announce(std::uint64_t number);

  /// Largest distance that the options allow on this surface; 0 but in free mode.
  static double allowed_distance(const TetMesh& mesh, const SurfaceOptions& options, par::Policy policy = {});
  const SurfaceOptions& options() const;
  /// Largest distance from the input that is allowed; 0 in flat mode.
  double hausdorff() const;

  // --- what there is ---
  std::size_t n_faces() const;
  std::size_t n_edges() const;
  std::size_t n_feature_edges() const;
  std::size_t n_vertices(SurfaceKind kind) const;
  /// Of the mesh that it was made of, those that no face has included, and of vertices that came later.
  std::size_t n_points() const;
  const MotionConstraint& motion_constraint(VertexHandle v) const;
  bool has_interfaces() const;
  /// The vertices that move with v by the same step, itself included; none where it moves alone. See
  /// SurfaceOptions::periodic.
  std::span<const VertexHandle> orbit(VertexHandle v) const;
  bool is_feature(VertexHandle a, VertexHandle b) const;  ///< false when it is no edge of the surface
  /// The half-face of the volume that face number f (0 … n_faces()-1 at first; numbers of deleted faces stay
  /// unused) is the outside of; searched anew when cells have changed. Invalid for a deleted face.
  HalfFaceHandle halfface(const TetMesh& mesh, std::size_t f);
  /// Number of the surface's face with the vertices of h; kNoFace when it is none.
  std::size_t face(const TetMesh& mesh, HalfFaceHandle h) const;
  static constexpr std::size_t kNoFace = ~std::size_t{0};
  bool is_deleted(std::size_t f) const;
  std::array<VertexHandle, 3> face_vertices(std::size_t f) const;  ///< in outward order
  int patch(std::size_t f) const;
  /// Where the vertex is, by the changes that have been told; it must be one of the surface.
  Vec3 point(VertexHandle v) const;
  /// Appends the vertices of all faces at v, whatever sheet they belong to.
  void star(VertexHandle v, std::vector<std::array<VertexHandle, 3>>& out) const;
  /// The vertices across the edge from a to b: on its left, and on its right. Invalid where there is no face,
  /// both where there is no such edge.
  std::array<VertexHandle, 2> across(VertexHandle a, VertexHandle b) const;

  // --- what is legal: topology by OpenMesh, features, labels, locks ---
  /// Has the edge from a to b two faces of one facet and label, and is nothing about it to be kept?
  bool is_inner(VertexHandle a, VertexHandle b) const;
  /// May the edge from a to b be swapped? It must be an inner one, of the boundary or of an interface.
  bool may_swap(VertexHandle a, VertexHandle b) const;
  /// May the edge from a to b be split? Not where an interface meets it.
  bool may_split(VertexHandle a, VertexHandle b) const;
  /// Appends the vertices onto which v may be collapsed. Not for several threads: OpenMesh tags vertices.
  void collapse_targets(VertexHandle v, std::vector<VertexHandle>& out);

  // --- the shape ---
  /// Point of the shape that v may move to, nearest to x. In free mode only curves hold a vertex: one on a
  /// facet moves where keeps_shape() allows it.
  Vec3 project(VertexHandle v, Vec3 x) const;
  /// What the enclosed volume has gained, as a share of it. In free mode changes of a region's volume are
  /// bounded, too, by the same share of that region.
  double volume_gain() const;
  /// By how far the whole surface would have to move outwards for the volume to be what it was; at most a
  /// tenth of hausdorff() either way.
  double outward() const;
  /// May the triangles `created` replace `removed` (vertices in outward order; a vertex that is moved or new
  /// stands with its new place in `created`)? Orientation and normals, and in free mode the distance from the
  /// input and of the input from them.
  bool keeps_shape(std::span<const std::array<VertexHandle, 3>> faces_removed,
                   std::span<const Triangle> removed, std::span<const Triangle> created) const;

  // --- what has happened ---
  /// Vertices of the list may have been moved.
  void on_move(const TetMesh& mesh, std::span<const VertexHandle> vertices);
  void on_move(VertexHandle v, Vec3 place);
  void on_swap(VertexHandle a, VertexHandle b);
  void on_collapse(VertexHandle v, VertexHandle onto);
  /// The edge from a to b has got the vertex `middle`.
  void on_split(VertexHandle a, VertexHandle b, VertexHandle middle, Vec3 place);
  /// After cells have been replaced that nobody told of: the surface as it is meshed now, which must have the
  /// shape that it had before. What is allowed still counts from the shape that it was made with; in flat
  /// mode planes are those of now. Labels must have been written.
  void rebuild(const TetMesh& mesh, par::Policy policy = {});
  /// The same of a mesh in parts, as the constructor takes it.
  void rebuild(const surface::Arrays& arrays, std::vector<std::uint64_t> numbers);
  /// The surface as it is now, for take_back().
  std::unique_ptr<SurfaceMesh> copy() const;
  /// The surface as it was when it was copied, after the volume has been put back to what it was then.
  void take_back(const SurfaceMesh& copied);
  /// Brings patch labels of the volume up to date with what has happened since.
  void write_labels(TetMesh& mesh);
  /// What write_labels() does, in that order: labels of faces that are no more, and those that are set.
  struct LabelChanges {
    std::vector<std::array<VertexHandle, 3>> gone;
    struct Set {
      std::array<VertexHandle, 3> vertices;
      int label = 0;
    };
    std::vector<Set> set;
  };
  LabelChanges take_label_changes();

  /// True when the surface is that of the mesh, face by face and point by point.
  bool in_step(const TetMesh& mesh) const;

 private:
  struct Impl;
  explicit SurfaceMesh(std::shared_ptr<Impl> impl, const VertexNumbers* numbers = nullptr);
  /// Between handles of whoever asks and those of the surface.
  VertexHandle inner(VertexHandle v) const { return numbers_ ? handle_of(numbers_->number(v)) : v; }
  VertexHandle outer(VertexHandle v) const { return numbers_ ? numbers_->vertex_at(number_of(v)) : v; }
  std::array<VertexHandle, 3> outer(const std::array<VertexHandle, 3>& f) const {
    return {outer(f[0]), outer(f[1]), outer(f[2])};
  }

  std::shared_ptr<Impl> impl_;
  const VertexNumbers* numbers_ = nullptr;  // where it is seen from a part
};

/// Largest distance of the points of one surface from another (`there`), and the other way round (`back`).
/// The points are spread over all triangles, at most `spacing` apart. Independent of what the operators keep
/// account of.
struct SurfaceDistance {
  double there = 0, back = 0;
  double hausdorff() const { return there > back ? there : back; }
};
SurfaceDistance surface_distance(std::span<const Triangle> from, std::span<const Triangle> to, double spacing,
                                 par::Policy policy = {});
/// Triangles of the boundary, counter-clockwise seen from outside, and of the interfaces, each once.
std::vector<Triangle> surface_triangles(const TetMesh& mesh, par::Policy policy = {});

}  // namespace hfr

#endif
