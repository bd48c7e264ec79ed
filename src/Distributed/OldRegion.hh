// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_OLD_REGION_HH
#define HFR_DISTRIBUTED_OLD_REGION_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Transfer/Stars.hh"
#include "Transfer/TetBox.hh"

namespace hfr::mpi {

/// Of a mesh in parts as it was, what a rank has asked for: a mesh of its own, whose vertices and cells stand
/// in the order of their numbers, whoever had them. Handles of it are good until the next call that asks; all
/// ranks make each of these calls at the same time.
class OldRegion {
 public:
  /// `old` has to stay. is_changed(c): of a cell with an own vertex, whether it is not there any more, or not
  /// where it was.
  OldRegion(const DistributedMesh& old, std::function<bool(CellHandle)> is_changed, par::Policy policy);

  OldRegion(const OldRegion&) = delete;  // the tree looks at own_boxes_
  OldRegion& operator=(const OldRegion&) = delete;

  /// A vertex, and the rank that owned it.
  struct Named {
    std::uint64_t number = 0;
    std::int64_t owner = 0;

    auto operator<=>(const Named&) const = default;
  };
  /// All cells round these vertices.
  void ask_for_stars(std::vector<Named> vertices);
  /// All changed cells whose boxes meet one of these, and those of this rank.
  void ask_for_changed(std::span<const TetBox> boxes);

  /// Changed cells of this rank.
  std::size_t n_own_changed() const { return own_changed_.size(); }
  const TetMesh& mesh() const { return mesh_; }
  /// By half-face: whether there is a cell behind it that is not in this mesh.
  std::span<const std::uint8_t> is_cut() const { return is_cut_; }
  std::uint64_t number(VertexHandle v) const { return vertices_[v.idx()].number; }
  std::uint64_t number(CellHandle c) const { return cells_[c.idx()].number; }
  /// Invalid where it is not here.
  VertexHandle vertex_at(std::uint64_t number) const;
  CellHandle cell_at(std::uint64_t number) const;
  int owner(VertexHandle v) const { return vertices_[v.idx()].owner; }
  /// The rank to which the cell belonged.
  int owner(CellHandle c) const;
  bool is_changed(CellHandle c) const { return cells_[c.idx()].is_changed != 0; }
  /// visit(number of a changed cell of this rank, number of a cell on one of its faces, whose that is).
  template <class Visit>
  void for_faces_of_own_changed(Visit&& visit) const {
    const TetMesh& part = old_.part();
    for (CellHandle c : own_changed_)
      for (HalfFaceHandle m : part.cell(c).mate) {
        if (!m.is_valid()) continue;
        const auto& v = part.cell(cell_of(m)).v;
        const VertexHandle first = std::min(std::min(v[0], v[1]), std::min(v[2], v[3]));
        visit(old_.number(c), old_.number(cell_of(m)), old_.owner(first));
      }
  }
  Named name(VertexHandle v) const { return {number(v), owner(v)}; }

 private:
  struct VertexRecord {
    std::uint64_t number = 0;
    Vec3 point;
    std::int32_t owner = 0, unused = 0;
  };
  struct CellRecord {
    std::uint64_t number = 0;
    std::array<std::uint64_t, 4> v{};
    std::array<std::uint64_t, 4> mate{};  ///< as 4·cell + corner
    std::uint64_t is_changed = 0;
  };

  void pack(std::vector<CellHandle> cells, Packer& to) const;
  void take(std::vector<Packer>& to);
  void build();

  const DistributedMesh& old_;
  std::function<bool(CellHandle)> has_changed_;
  par::Policy policy_;
  Stars own_stars_;  // of the old part
  std::vector<CellHandle> own_changed_;
  std::vector<TetBox> own_boxes_;  // round these
  BoxTree own_tree_;
  std::vector<std::uint64_t> whole_;  // vertices all of whose cells are here, ascending
  std::vector<VertexRecord> vertices_;
  std::vector<CellRecord> cells_;
  TetMesh mesh_;
  std::vector<std::uint8_t> is_cut_;
};

}  // namespace hfr::mpi

#endif
