// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_SMALLEST_DIHEDRALS_HH
#define HFR_REMESH_SMALLEST_DIHEDRALS_HH

#include <cstddef>
#include <span>
#include <vector>

#include "Remesh/Run.hh"

namespace hfr {

/// The smallest dihedral of each cell as the mesh of a run stands, as decision values of MinDihedral: 8 bytes
/// a cell slot. All answers are of the whole.
class SmallestDihedrals {
 public:
  explicit SmallestDihedrals(const Run& run);
  /// Without these, of a mesh in parts own ones.
  SmallestDihedrals(const Run& run, std::span<const CellHandle> but);

  std::size_t n_cells() const { return n_cells_; }
  std::size_t n_below(double decision) const;
  /// Cells with an angle that is not positive.
  std::size_t n_invalid() const;
  /// The `rank` smallest one, counted from 1; changes the order of what is kept. Needs so many cells.
  double smallest(std::size_t rank);

 private:
  template <class Is>
  std::size_t count(Is&& is) const;

  Run run_;
  std::size_t n_cells_;
  std::vector<double> values_;  // infinity in deleted slots, for cells of other parts and those left out
};

}  // namespace hfr

#endif
