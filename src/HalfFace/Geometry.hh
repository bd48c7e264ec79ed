// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_GEOMETRY_HH
#define HFR_HALFFACE_GEOMETRY_HH

#include <span>

#include "hfremesh/HalfFace/TetMesh.hh"

/// Lengths, normals and volumes of the things of a mesh, in the units of its points. Nothing is checked: the
/// handles are of things that exist.
namespace hfr {

/// From the first end to the second.
inline Vec3 vector(const TetMesh& mesh, HalfEdgeHandle e) {
  return mesh.point(mesh.to_vertex(e)) - mesh.point(mesh.from_vertex(e));
}
inline Vec3 vector(const TetMesh& mesh, EdgeHandle e) { return vector(mesh, TetMesh::halfedge_handle(e, 0)); }
inline double length(const TetMesh& mesh, EdgeHandle e) { return norm(vector(mesh, e)); }
inline double length(const TetMesh& mesh, HalfEdgeHandle e) { return norm(vector(mesh, e)); }

inline Vec3 barycenter(const TetMesh& mesh, VertexHandle v) { return mesh.point(v); }
inline Vec3 barycenter(const TetMesh& mesh, EdgeHandle e) {
  const auto v = mesh.edge_vertices(e);
  return 0.5 * (mesh.point(v[0]) + mesh.point(v[1]));
}
inline Vec3 barycenter(const TetMesh& mesh, HalfEdgeHandle e) {
  return barycenter(mesh, TetMesh::edge_handle(e));
}
inline Vec3 barycenter(const TetMesh& mesh, HalfFaceHandle h) {
  const auto v = mesh.halfface_vertices(h);
  return (1.0 / 3.0) * (mesh.point(v[0]) + mesh.point(v[1]) + mesh.point(v[2]));
}
inline Vec3 barycenter(const TetMesh& mesh, FaceHandle f) {
  return barycenter(mesh, HalfFaceHandle(f.idx()));
}
inline Vec3 barycenter(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell_vertices(c);
  return 0.25 * ((mesh.point(v[0]) + mesh.point(v[1])) + (mesh.point(v[2]) + mesh.point(v[3])));
}

/// Normal to the half-face, as long as twice its area: into the cell of the half-face where that is positive,
/// as OpenVolumeMesh has it.
inline Vec3 area_vector(const TetMesh& mesh, HalfFaceHandle h) {
  const auto v = mesh.halfface_vertices(h);
  const Vec3 a = mesh.point(v[0]);
  return cross(mesh.point(v[1]) - a, mesh.point(v[2]) - a);
}
/// The same of length 1; not a number for a face without area.
inline Vec3 normal(const TetMesh& mesh, HalfFaceHandle h) {
  const Vec3 n = area_vector(mesh, h);
  return (1.0 / norm(n)) * n;
}
inline double area(const TetMesh& mesh, HalfFaceHandle h) { return 0.5 * norm(area_vector(mesh, h)); }
inline double area(const TetMesh& mesh, FaceHandle f) { return area(mesh, HalfFaceHandle(f.idx())); }

/// Signed: negative for an inverted cell.
inline double volume(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell_vertices(c);
  const Vec3 a = mesh.point(v[0]);
  return dot(mesh.point(v[1]) - a, cross(mesh.point(v[2]) - a, mesh.point(v[3]) - a)) / 6.0;
}

}  // namespace hfr

#endif
