// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_CONSERVE_HH
#define HFR_TRANSFER_CONSERVE_HH

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "Transfer/Overlaps.hh"

namespace hfr {

/// The changed cells of a mesh, old and new, cut into cavities: the smallest sets such that no old cell of
/// one shares volume or a face with an old or new cell of another, and that a new cell which covers nothing
/// of the old mesh is in the set of the new cells on its faces. What the old cells of a cavity hold is what
/// its new cells share.
class Cavities {
 public:
  Cavities(const TetMesh& old, const TetMesh& now, const Edits& edits, par::Policy policy);

  std::span<const CellHandle> old_cells() const { return old_cells_; }
  std::span<const CellHandle> new_cells() const { return new_cells_; }
  const Overlaps& overlaps() const { return overlaps_; }
  /// Signed volume of old cell i of the list, and of new cell i.
  double old_volume(std::size_t i) const { return old_volume_[i]; }
  double new_volume(std::size_t i) const { return new_volume_[i]; }
  /// Whether a part of new cell i lies beyond the old mesh.
  bool is_outside(std::size_t i) const;

  struct Cavity {
    std::vector<Index> old_cells, new_cells;  ///< by their place in the lists, ascending
  };
  const std::vector<Cavity>& cavities() const { return cavities_; }

 private:
  std::vector<CellHandle> old_cells_, new_cells_;
  Overlaps overlaps_;
  std::vector<double> old_volume_, new_volume_;
  std::vector<Cavity> cavities_;
};

/// One component of a field in old cells, by their place in the list, made into values of the new ones.
struct Conserved {
  std::vector<double> values;  ///< of the new cells, by their place in the list
  double integral = 0;         ///< what the old cells held
  /// What of it found no place within the bounds of its cavity; less than 0 where these, or the fallback of
  /// cells beyond the old mesh with no changed one beside them, add something.
  double lost = 0;
};

/// Each new cell has the mean of what it covers; then what rounding, or a surface that has changed, makes the
/// sum of a cavity differ by is shared out among its cells in proportion to the room that their values have
/// within the range of the cavity's old ones. `old_density`, `new_density`: by place; empty for 1.
/// `fallback`: value of a new cell that covers nothing.
///
/// Source of the shared-out correction: Bochev, Ridzal & Shashkov, "Fast optimization-based conservative
/// remap of scalar fields through aggregate mass transfer" (2013), in its simplest form.
Conserved conserve(const Cavities& cavities, std::span<const double> old_values,
                   std::span<const double> old_density, std::span<const double> new_density,
                   std::span<const double> fallback);

}  // namespace hfr

#endif
