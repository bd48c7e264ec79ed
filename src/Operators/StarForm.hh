// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_STAR_FORM_HH
#define HFR_OPERATORS_STAR_FORM_HH

#include <array>
#include <cstdint>
#include <span>

#include "HalfFace/SpillArray.hh"
#include "HalfFace/TetMesh.hh"
#include "kernels/newton_step.h"

namespace hfr {

inline hfr_real3 to_kernel(Vec3 a) { return hfr_make3(a.x, a.y, a.z); }

/// Volume-length of a vertex's star as a function of where the vertex stands, relative to its present place.
/// Kept as one row a coefficient in blocks of a few cells, so that the searches work on several cells or
/// places an instruction (see with_widest_vectors()). A star of more than Star::kCapacity cells takes memory
/// from the heap.
class StarForm {
 public:
  static constexpr std::size_t kTrials = 16;
  using Trials = std::array<double, kTrials>;

  /// link: the half-face opposite v of each cell of the star, any number.
  StarForm(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link);

  std::size_t size() const { return size_; }
  hfr_star_cell cell(std::size_t i) const;

  /// worst[t] becomes the smallest decision value with the vertex moved to (x[t], y[t], z[t]). Once no place
  /// is better than floor the rest is not looked at, and every worst[t] is anything ≤ floor. Cells that
  /// ended searches are asked first.
  void worst(const Trials& x, const Trials& y, const Trials& z, double floor, Trials& worst);

  /// Largest m (see kernels/star_newton.h) with the vertex moved by x, or anything ≥ ceiling; infinity where
  /// a cell is not positive.
  double largest_m(hfr_real3 x, double ceiling) const;

  /// Gradient and Hessian of the p-norm of m with the vertex moved by x, where all cells are positive; summed
  /// in the order of the cells.
  hfr_newton_share newton(hfr_real3 x, double m_max) const;

  static constexpr std::size_t kBlock = 8;
  /// Coefficients of a few cells, as in hfr_star_cell. The last block is filled up with the last cell.
  struct Block {
    alignas(64) double normal_x[kBlock];
    double normal_y[kBlock], normal_z[kBlock], det[kBlock];
    double sum_x[kBlock], sum_y[kBlock], sum_z[kBlock], sum2[kBlock];
  };

 private:
  std::size_t n_blocks() const { return (size_ + kBlock - 1) / kBlock; }

  std::size_t size_ = 0;
  std::size_t n_ordered_ = 0;  // size_ once worst() was asked
  SpillArray<Block, Star::kCapacity / kBlock> blocks_;
  SpillArray<std::uint32_t, Star::kCapacity> order_;  // in which worst() asks
};
static_assert(Star::kCapacity % StarForm::kBlock == 0);

}  // namespace hfr

#endif
