// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_CELL_BLOCK_HH
#define HFR_QUALITY_CELL_BLOCK_HH

#include <array>
#include <cstddef>

#include "HalfFace/Vec3.hh"

/// Quality of many cells at once, internal to this folder: coordinates gathered into arrays, so that the
/// compiler makes vector instructions of the kernels' formulas.
namespace hfr::detail {

struct CellBlock {
  static constexpr std::size_t kSize = 64;
  using Lane = std::array<double, kSize>;

  void set_corner(std::size_t corner, std::size_t i, Vec3 p) {
    x[corner][i] = p.x;
    y[corner][i] = p.y;
    z[corner][i] = p.z;
  }

  std::array<Lane, 4> x{}, y{}, z{};

  Lane det;                     ///< 6V, 0 when flat
  Lane min_dihedral;            ///< decision form
  Lane max_dihedral;            ///< decision form
  Lane volume_length;           ///< decision form
  Lane q;                       ///< report form of volume_length
  std::array<Lane, 6> length2;  ///< of the edges, squared
  Lane min_length2, max_length2;
  Lane length_sum;  ///< of the six edges
  /// Only for cells with min_dihedral > 0:
  std::array<Lane, 6> cosine;  ///< of the dihedrals, by local edge
  Lane angle_sum;              ///< of the six dihedrals, radians
  Lane min_angle;              ///< radians
};

/// Fills the results of all kSize cells; the same bits on every machine.
void evaluate(CellBlock& block);

}  // namespace hfr::detail

#endif
