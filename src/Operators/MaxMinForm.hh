// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_MAX_MIN_FORM_HH
#define HFR_OPERATORS_MAX_MIN_FORM_HH

#include <cstddef>
#include <type_traits>

#include "HalfFace/SpillArray.hh"
#include "HalfFace/TetMesh.hh"
#include "Quality/Metrics.hh"

namespace hfr {

namespace detail {

/// A few cells of a MaxMinForm, one array a number, so that they are worked on several an instruction (see
/// with_widest_vectors()). The last block of a form is filled up with its last cell.
struct MaxMinBlock {
  static constexpr std::size_t kSize = 8;
  using Row = double[kSize];

  alignas(64) Row px[3];             // corners of the triangle
  Row py[3], pz[3];                  // until it is scaled, that is all
  Row ex[3], ey[3], ez[3];           // e[k] = p[k+1] - p[k]
  Row e2[3];                         // squared lengths
  Row normal_x, normal_y, normal_z;  // of the triangle, towards the point; gradient of 6V
  Row q;                             // normal²
};
struct MaxMinSlopes;

}  // namespace detail

/// The dihedral angles of all cells that triangles make with one free point, as functions of where the point
/// stands. Lengths are in units of the mean edge of the triangles, relative to an origin near the point, so
/// that neither scale nor place of the mesh matters.
class MaxMinForm {
 public:
  /// Which angles count: all (sin² of the worst, as MinSine2), or acute ones only (as MinDihedral).
  enum class Angles { kAll, kAcute };
  /// What a metric wants; for one that measures no angles all of them are a fair substitute.
  template <class Metric>
  static constexpr Angles kAnglesOf = std::is_same_v<Metric, MinDihedral> ? Angles::kAcute : Angles::kAll;

  explicit MaxMinForm(Vec3 origin, Angles angles = Angles::kAll) : origin_(origin), angles_(angles) {}

  /// Where the point may go: anywhere, in the plane through its place normal to `axis`, or along `axis`,
  /// which has length 1.
  enum class Room { kSpace, kPlane, kLine };
  void confine(Room room, Vec3 axis) {
    room_ = room;
    axis_ = axis;
  }

  /// Adds the cell (a, b, c, point); positive in this order. Cells beyond Star::kCapacity take memory from
  /// the heap.
  void add(Vec3 a, Vec3 b, Vec3 c);

  /// Place at which the smallest sin² is as large as a non-smooth steepest ascent from `start` takes it;
  /// `start` itself when some cell is not positive there, or nothing is gained.
  Vec3 ascend(Vec3 start, int iterations);

 private:
  void scale();
  double worst(Vec3 x, double floor);
  void slopes(Vec3 x, double below, detail::MaxMinSlopes& out) const;
  std::size_t n_blocks() const { return (size_ + Block::kSize - 1) / Block::kSize; }

  using Block = detail::MaxMinBlock;
  static_assert(Star::kCapacity % Block::kSize == 0);

  Vec3 origin_;
  Angles angles_;
  Room room_ = Room::kSpace;
  Vec3 axis_;
  double unit_ = 0;
  std::size_t size_ = 0;
  std::size_t asked_first_ = 0;  // block with which worst() begins: the one that ended it last time
  SpillArray<Block, Star::kCapacity / Block::kSize> blocks_;
};

}  // namespace hfr

#endif
