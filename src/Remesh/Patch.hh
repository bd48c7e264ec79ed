// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PATCH_HH
#define HFR_REMESH_PATCH_HH

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

/// Labels of the faces of a mesh in which a patch is put back.
class FaceLabels {
 public:
  virtual ~FaceLabels() = default;
  virtual void set(const std::array<VertexHandle, 3>& face, int label) = 0;
  /// A face that may have had none.
  virtual void erase(const std::array<VertexHandle, 3>& face) = 0;
};

/// Some cells of a mesh as a mesh of their own, to be tried on and put back if that has helped. Whatever
/// faces the rest of the mesh, another region or the outside is its boundary, so that a run with a frozen
/// surface leaves a patch that fits. Handles of vertices and cells follow the order in which vertices() and
/// cells() name the whole's.
class Patch {
 public:
  /// The cells within `layers` of cell `centre`, which comes first: those of its region that share a vertex
  /// with it, those that share one with them, and so on. All of them must be positive.
  /// `pinched`: as Workspace has it. Such a vertex has cells that no walk within the patch comes to, although
  /// it may look like an inner one there: it stays.
  Patch(const TetMesh& whole, CellHandle centre, int layers, std::span<const std::uint8_t> pinched = {});

  const TetMesh& mesh() const { return mesh_; }
  const std::vector<CellHandle>& cells() const { return cells_; }
  const std::vector<VertexHandle>& vertices() const { return vertices_; }

  /// False when an edge or a face that `changed` has and mesh() has not is one of the whole's cells outside
  /// of the patch. That can be only where the whole lies over itself: in two of its pinched vertices,
  /// where its boundary is folded, or where its cells cover a direction twice. O(cells of the whole).
  bool fits(const TetMesh& whole, const TetMesh& changed) const;

  /// Writes `changed`, which became of mesh() without collection of garbage, in place of the cells. The whole
  /// must not have changed there meanwhile; its workspace must be attached again before it is used.
  void put_back(TetMesh& whole, const TetMesh& changed) const;
  /// The same where somebody keeps account of the whole's labels of faces, and writes them.
  void put_back(TetMesh& whole, const TetMesh& changed, FaceLabels& labels) const;
  /// put_back() for which the workspace need not be attached again: it has star sizes, pinched vertices and
  /// qualities of what is there now, and the cells and vertices of the patch wait to be looked at. What is
  /// frozen is right as long as the patch has left its boundary alone.
  void put_back(TetMesh& whole, const TetMesh& changed, Workspace& work) const;

 private:
  struct Rim;

  void copy_constraints(const TetMesh& whole, std::span<const std::uint8_t> pinched);
  Rim rim(const TetMesh& whole) const;
  /// Moves, takes away and adds vertices of the whole. Returns them by their number in `changed`; those that
  /// came and went there are invalid.
  std::vector<VertexHandle> put_vertices(TetMesh& whole, TetMesh::Writer& writer,
                                         const TetMesh& changed) const;
  /// Where in the whole each cell of `changed` goes: into the slots of the cells that go, then into free
  /// ones, then into new ones. Slots that are left over become free.
  std::vector<CellHandle> slots_for(TetMesh& whole, TetMesh::Writer& writer, const TetMesh& changed) const;
  /// put_back(); returns where in the whole each cell of `changed` is, invalid for what was deleted there.
  std::vector<CellHandle> write(TetMesh& whole, const TetMesh& changed, FaceLabels& labels) const;

  std::vector<CellHandle> cells_;
  std::vector<VertexHandle> vertices_;
  TetMesh mesh_;
};

}  // namespace hfr

#endif
