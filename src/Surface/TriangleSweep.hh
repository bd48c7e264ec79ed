// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_TRIANGLE_SWEEP_HH
#define HFR_SURFACE_TRIANGLE_SWEEP_HH

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// sin² of the smallest angle of a triangle: what sweeps compare by.
double triangle_decision(const Triangle& t);

/// The surface operators on a surface without cells: the worst triangle of a cluster has to get better.
/// Serial, in the order of faces, because OpenMesh is; so the result does not depend on any number of
/// threads.
class TriangleSweep {
 public:
  /// `surface` must be one of a TriangleMesh.
  explicit TriangleSweep(SurfaceMesh& surface);

  /// Triangles of a decision value below this, and what lies round them, are worked on.
  void focus(double below);
  /// Number of triangles below the focus.
  std::size_t n_below() const;
  double worst() const;  ///< infinity without triangles

  /// Each operator looks at clusters in which something has changed since it last did, and returns the number
  /// of its changes.
  std::size_t swap();
  std::size_t collapse();
  std::size_t smooth();
  /// A vertex on an edge of a triangle below the focus, joined to the corners of as many triangles round it
  /// as makes the worst of them better.
  std::size_t split();
  /// Moves vertices of curved facets outwards or inwards by what brings the volume back, where no triangle
  /// gets much worse, nor as bad as the worst.
  std::size_t offset();

  /// Places by vertex; those of new vertices follow those of the input. Removed vertices keep their last.
  const std::vector<Vec3>& points() const { return points_; }

 private:
  using Face = std::array<VertexHandle, 3>;
  enum Kind : std::size_t { kSwap, kCollapse, kSmooth, kSplit, kKinds };
  struct Star;
  struct Insertion;

  Vec3 point(VertexHandle v) const { return points_[v.idx()]; }
  Triangle corners(const Face& f) const { return {point(f[0]), point(f[1]), point(f[2])}; }
  double decision(const Face& f) const { return triangle_decision(corners(f)); }
  bool changed_since(const Face& f, std::uint32_t since) const;
  void touch(VertexHandle v);
  /// Faces that the focus holds and that have changed since an operator last looked, and now counts as
  /// looked.
  std::vector<Face> look(Kind kind);
  /// Vertices of these faces that may move or go, each once, in the order of the faces.
  std::vector<VertexHandle> free_vertices(const std::vector<Face>& faces);
  bool still_there(const Face& f) const;

  bool try_swap(VertexHandle a, VertexHandle b);
  bool try_collapse(VertexHandle v);
  bool try_smooth(VertexHandle v);
  bool try_offset(VertexHandle v);
  bool try_split(VertexHandle a, VertexHandle b);
  bool gather(VertexHandle v, Star& star) const;
  bool find_outside(VertexHandle v, Vec3 sum, Star& star) const;
  void place(Insertion& cavity) const;

  SurfaceMesh& surface_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> changed_;  // per vertex: when
  std::uint32_t clock_ = 1;
  std::array<std::uint32_t, kKinds> looked_{};
  double below_ = std::numeric_limits<double>::infinity();
};

}  // namespace hfr

#endif
