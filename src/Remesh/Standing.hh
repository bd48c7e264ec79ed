// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_STANDING_HH
#define HFR_REMESH_STANDING_HH

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Remesh/Survey.hh"

namespace hfr {

/// What no run may leave worse than it was.
struct Standing {
  std::size_t n_inverted = 0;
  std::size_t n_flat = 0;
  double overlap = 0;                                      ///< sum of |volume| of the inverted cells
  double worst = std::numeric_limits<double>::infinity();  ///< smallest decision value of MinDihedral

  bool is_valid() const { return n_inverted + n_flat == 0; }
};
/// Of a mesh in which survey() has found that. Does not depend on the order of the cells. Another pass over
/// them where some are invalid.
Standing standing_of(const TetMesh& mesh, const Survey& found, par::Policy policy,
                     const KnownValues& known = {});
/// Inverted and flat cells among some.
struct InvalidVolumes {
  std::size_t n_flat = 0;
  std::vector<double> inverted;  ///< |volume| of each
};
InvalidVolumes volumes_of(const TetMesh& mesh, std::span<const CellHandle> invalid);
/// From the invalid cells of the whole, in any order, and its worst cell.
Standing standing_of(double worst, InvalidVolumes invalid);
/// No more inverted cells, no more inverted and flat ones together, no more overlap, no smaller worst angle.
bool is_no_worse(const Standing& now, const Standing& before);
/// Fewer inverted cells; if as many, fewer inverted and flat ones; if as many, less overlap; if as much, a
/// larger worst angle.
bool is_better(const Standing& a, const Standing& b);

}  // namespace hfr

#endif
