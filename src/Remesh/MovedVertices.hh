// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MOVED_VERTICES_HH
#define HFR_REMESH_MOVED_VERTICES_HH

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// The vertices that a displacement moves, and where they were before. Allocates nothing once it has held as
/// many.
class MovedVertices {
 public:
  /// Reads the displacement, an entry a vertex, and notes which are not 0. Returns the first entry that is
  /// not finite, or how many entries there are. Where the vertices are is not known before move().
  std::size_t find(std::span<const Vec3> displacement, par::Policy policy);
  void clear();

  std::size_t size() const { return n_moved_; }
  bool has(VertexHandle v) const { return (bits_[v.idx() / 64] >> v.idx() % 64 & 1U) != 0; }
  /// So many that whoever looks at their cells goes over all cells.
  bool are_many() const { return are_many_; }
  /// Ascending; after move(), where they are not many.
  std::span<const VertexHandle> list() const { return list_; }

  /// Keeps where the vertices are, and moves them by the displacement that find() has read.
  void move(TetMesh& mesh, std::span<const Vec3> displacement, par::Policy policy);
  /// Puts them where move() found them, plus a part of the displacement.
  void put(TetMesh& mesh, std::span<const Vec3> displacement, double fraction, par::Policy policy) const;
  void put_back(TetMesh& mesh, par::Policy policy) const;

  /// visit(v) for each, ascending, until it returns true; whether it did.
  template <class Visit>
  bool find_if(Visit&& visit) const {
    for (std::size_t w = 0; w < bits_.size(); ++w)
      for (std::uint64_t rest = bits_[w]; rest != 0; rest &= rest - 1)
        if (visit(VertexHandle(64 * w + lowest_bit(rest)))) return true;
    return false;
  }

 private:
  struct Part {
    std::size_t n_moved = 0;
    bool is_finite = true;
  };
  static std::size_t lowest_bit(std::uint64_t word);
  template <class Place>
  void set_points(TetMesh& mesh, par::Policy policy, Place&& place) const;

  std::vector<std::uint64_t> bits_;  // by vertex
  std::vector<Part> parts_;          // of the loop over bits_
  std::size_t n_moved_ = 0;
  bool are_many_ = false;
  std::vector<VertexHandle> list_;  // where they are not many
  std::vector<Vec3> was_;           // by place in list_, or by vertex
};

}  // namespace hfr

#endif
