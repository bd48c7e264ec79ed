// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_STAR_FORM_HH
#define HFR_OPERATORS_STAR_FORM_HH

#include <array>
#include <cstdint>
#include <span>

#include "HalfFace/RawArray.hh"
#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"
#include "kernels/newton_step.h"

namespace hfr {

inline hfr_real3 to_kernel(Vec3 a) { return hfr_make3(a.x, a.y, a.z); }

/// Volume-length of a vertex's star as a function of where the vertex stands, relative to its present place.
/// Kept as one array a coefficient, so that the searches work on several cells or places an instruction (see
/// with_widest_vectors()).
class StarForm {
 public:
  static constexpr std::size_t kTrials = 16;
  using Trials = std::array<double, kTrials>;

  /// link: the half-face opposite v of each cell of the star, at most Star::kCapacity.
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

  /// Coefficients as in hfr_star_cell. Up to the next multiple of kBlock, the last cell is repeated.
  static constexpr std::size_t kBlock = 8;
  struct Coefficients {
    using Array = RawArray<double, Star::kCapacity>;
    alignas(64) Array normal_x;
    Array normal_y, normal_z, det, sum_x, sum_y, sum_z, sum2;
  };

 private:
  std::size_t padded() const { return (size_ + kBlock - 1) / kBlock * kBlock; }

  Coefficients cells_;
  std::size_t size_ = 0;
  FixedVector<std::uint8_t, Star::kCapacity> order_;  // in which worst() asks
};
static_assert(Star::kCapacity % StarForm::kBlock == 0);

}  // namespace hfr

#endif
