// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_CUTOUT_HH
#define HFR_DISTRIBUTED_CUTOUT_HH

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/NumberIndex.hh"
#include "Operators/GrownCells.hh"

namespace hfr::mpi {

/// The surroundings of some cells, brought together on a rank as a mesh of their own, for work that
/// reaches further than what each part holds. Vertices and cells stand in the order of their numbers in the
/// whole.
class Cutout {
 public:
  enum class Where : std::uint8_t { kOnOwners, kOnAll };
  /// `cells`: numbers, ascending, the same on all ranks, of which each takes its own ones, or all the same;
  /// `depth`, of each of them: vertices are taken that so many edges lead to, and all cells that have one of
  /// these. All take part. A cell of it whose vertices are all such has all its neighbours; others are its
  /// rim.
  Cutout(const DistributedMesh& parts, std::span<const std::uint64_t> cells,
         std::span<const std::uint8_t> depth, Where where = Where::kOnOwners);

  TetMesh& mesh() { return mesh_; }
  Workspace& work() { return work_; }
  const CutRim& rim() const { return rim_; }

  /// Of the cells those whose surroundings are here, ascending.
  const std::vector<std::uint64_t>& centres() const { return centres_; }
  std::uint64_t number(VertexHandle v) const {
    return v.idx() < vertices_.size() ? vertices_[v.idx()].number : new_number_[v.idx() - vertices_.size()];
  }
  /// Of the vertices that will be added, in that order: ascending, larger than those of all others.
  void number_new_vertices(std::vector<std::uint64_t> numbers) { new_number_ = std::move(numbers); }
  /// Number of cells of a vertex before anything was changed; 0 for one that has come since.
  std::uint32_t star_before(VertexHandle v) const { return is_new(v) ? 0 : vertices_[v.idx()].star_size; }
  std::uint64_t number(CellHandle c) const { return cell_number_[c.idx()]; }
  /// A vertex that has come since.
  bool is_new(VertexHandle v) const { return v.idx() >= vertices_.size(); }
  CellHandle cell_at(std::uint64_t number) const;
  /// Of those that it was built with.
  VertexHandle vertex_at(std::uint64_t number) const;
  /// A new deleted slot, with that number.
  CellHandle add_slot(std::uint64_t number);
  /// What the whole is to be told of them.
  DistributedMesh::VertexRecord record(VertexHandle v) const;
  DistributedMesh::CellRecord record(CellHandle c) const;
  void set_face_label(const std::array<VertexHandle, 3>& face, int label) {
    labels_.set_face(mesh_, face, label);
  }
  /// False where it has none.
  bool erase_face_label(const std::array<VertexHandle, 3>& face) { return labels_.erase_face(mesh_, face); }
  std::vector<LabelRecord> labels_of(std::span<const CellHandle> cells,
                                     std::span<const VertexHandle> vertices) const {
    return labels_.of(mesh_, work_.frozen, cells, vertices, [this](VertexHandle v) { return number(v); });
  }

 private:
  void build(const std::vector<DistributedMesh::CellRecord>& cells, const std::vector<std::uint64_t>& taken,
             bool has_pinched);

  TetMesh mesh_;
  Workspace work_;
  CutRim rim_;
  PartLabels labels_;
  std::vector<DistributedMesh::VertexRecord> vertices_;  // as they were
  std::vector<std::uint64_t> cell_number_;               // by slot
  NumberIndex vertex_index_, cell_index_;                // of what it was built with
  std::vector<std::uint64_t> centres_, new_number_;
};

}  // namespace hfr::mpi

#endif
