// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_TET_TOPOLOGY_HH
#define HFR_HALFFACE_TET_TOPOLOGY_HH

#include <array>

#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr {

/// One cell with its corners called a, b, c and d, in a positive order, and what they span: edges ab … cd,
/// half-edges in both directions, faces by the corner opposite. With det(b-a, c-a, d-a) > 0 for a positive
/// cell. Valid until the cell is written.
class TetTopology {
 public:
  /// Corners as the cell stores them.
  TetTopology(const TetMesh& mesh, CellHandle cell) : TetTopology(mesh, cell, mesh.cell_vertices(cell)) {}
  /// Beginning with `a`; throws InvalidInput when that is none of the cell's.
  TetTopology(const TetMesh& mesh, CellHandle cell, VertexHandle a)
      : TetTopology(mesh, cell, mesh.cell_vertices(cell, a)) {}
  /// abc is the half-face, d the corner opposite.
  TetTopology(const TetMesh& mesh, HalfFaceHandle abc)
      : TetTopology(mesh, mesh.incident_cell(abc), mesh.cell_vertices(abc)) {}
  /// The same, beginning with `a`, which is a vertex of abc.
  TetTopology(const TetMesh& mesh, HalfFaceHandle abc, VertexHandle a)
      : TetTopology(mesh, mesh.incident_cell(abc), rotated(mesh, abc, a)) {}

  CellHandle cell() const { return cell_; }
  VertexHandle a() const { return v_[0]; }
  VertexHandle b() const { return v_[1]; }
  VertexHandle c() const { return v_[2]; }
  VertexHandle d() const { return v_[3]; }
  const std::array<VertexHandle, 4>& vertices() const { return v_; }

  /// Half-edges: O(ring) each.
  HalfEdgeHandle ab() const { return halfedge(0, 1); }
  HalfEdgeHandle ac() const { return halfedge(0, 2); }
  HalfEdgeHandle ad() const { return halfedge(0, 3); }
  HalfEdgeHandle ba() const { return halfedge(1, 0); }
  HalfEdgeHandle bc() const { return halfedge(1, 2); }
  HalfEdgeHandle bd() const { return halfedge(1, 3); }
  HalfEdgeHandle ca() const { return halfedge(2, 0); }
  HalfEdgeHandle cb() const { return halfedge(2, 1); }
  HalfEdgeHandle cd() const { return halfedge(2, 3); }
  HalfEdgeHandle da() const { return halfedge(3, 0); }
  HalfEdgeHandle db() const { return halfedge(3, 1); }
  HalfEdgeHandle dc() const { return halfedge(3, 2); }

  /// Half-faces of this cell, as it sees them.
  HalfFaceHandle bdc() const { return opposite(0); }
  HalfFaceHandle acd() const { return opposite(1); }
  HalfFaceHandle adb() const { return opposite(2); }
  HalfFaceHandle abc() const { return opposite(3); }
  HalfFaceHandle opposite_a() const { return opposite(0); }
  HalfFaceHandle opposite_b() const { return opposite(1); }
  HalfFaceHandle opposite_c() const { return opposite(2); }
  HalfFaceHandle opposite_d() const { return opposite(3); }

 private:
  TetTopology(const TetMesh& mesh, CellHandle cell, const std::array<VertexHandle, 4>& v)
      : mesh_(&mesh), cell_(cell), v_(v) {}
  static std::array<VertexHandle, 4> rotated(const TetMesh& mesh, HalfFaceHandle h, VertexHandle a) {
    const auto f = mesh.halfface_vertices(h, a);
    return {f[0], f[1], f[2], mesh.halfface_opposite_vertex(h)};
  }
  HalfEdgeHandle halfedge(std::size_t from, std::size_t to) const {
    const Cell& k = mesh_->cell(cell_);
    return mesh_->halfedge_in_cell(cell_, k.corner(v_[from]), k.corner(v_[to]));
  }
  HalfFaceHandle opposite(std::size_t k) const { return mesh_->vertex_opposite_halfface(cell_, v_[k]); }

  const TetMesh* mesh_;
  CellHandle cell_;
  std::array<VertexHandle, 4> v_;
};

}  // namespace hfr

#endif
