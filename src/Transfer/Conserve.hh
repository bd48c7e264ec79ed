// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_CONSERVE_HH
#define HFR_TRANSFER_CONSERVE_HH

#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "Quality/FixedSum.hh"
#include "Transfer/Overlaps.hh"

namespace hfr {

/// The changed cells of a mesh, old and new, cut into cavities: the smallest sets such that no old cell of
/// one shares volume or a face with an old or new cell of another, and that a new cell which covers nothing
/// of the old mesh is in the set of the new cells on its faces. What the old cells of a cavity hold is what
/// its new cells share.
class Cavities {
 public:
  Cavities(const TetMesh& old, const TetMesh& now, const Edits& edits, par::Policy policy);
  struct Cavity {
    std::vector<Index> old_cells, new_cells;  ///< by their place in the lists, ascending
  };
  /// Of a part of a mesh: `old_cells` are all that the overlaps name, those of `cavities` the ones that are
  /// counted here. Both lists of cells ascending; `beside`: see below.
  Cavities(std::vector<CellHandle> old_cells, std::vector<CellHandle> new_cells, Overlaps overlaps,
           std::vector<double> old_volume, std::vector<double> new_volume, std::vector<CellHandle> beside,
           std::vector<Cavity> cavities)
      : old_cells_(std::move(old_cells)),
        new_cells_(std::move(new_cells)),
        overlaps_(std::move(overlaps)),
        old_volume_(std::move(old_volume)),
        new_volume_(std::move(new_volume)),
        beside_(std::move(beside)),
        cavities_(std::move(cavities)) {}

  std::span<const CellHandle> old_cells() const { return old_cells_; }
  std::span<const CellHandle> new_cells() const { return new_cells_; }
  const Overlaps& overlaps() const { return overlaps_; }
  /// Signed volume of old cell i of the list, and of new cell i.
  double old_volume(std::size_t i) const { return old_volume_[i]; }
  double new_volume(std::size_t i) const { return new_volume_[i]; }
  /// Whether a part of new cell i lies beyond the old mesh.
  bool is_outside(std::size_t i) const;
  /// Where new cell i covers nothing of the old mesh: the old cell whose value it begins with; see
  /// old_cells_beside(). Otherwise invalid.
  CellHandle beside(std::size_t i) const { return beside_[i]; }

  const std::vector<Cavity>& cavities() const { return cavities_; }

 private:
  std::vector<CellHandle> old_cells_, new_cells_;
  Overlaps overlaps_;
  std::vector<double> old_volume_, new_volume_;
  std::vector<CellHandle> beside_;
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

/// What is known of a cavity before anything is added up.
struct CavityBounds {
  double low = std::numeric_limits<double>::infinity(), high = -low;  ///< of the old values
  double mass = 0,
         fallback = 0;  ///< the largest volume times density, and value of a cell that covers nothing

  void add(const CavityBounds& o) {
    low = std::min(low, o.low);
    high = std::max(high, o.high);
    mass = std::max(mass, o.mass);
    fallback = std::max(fallback, o.fallback);
  }
};

/// Where cells of one cavity are in several parts of a mesh: makes what each part knows of its cavities, by
/// their place in the list, what all of them know.
class CavityParts {
 public:
  virtual ~CavityParts() = default;
  virtual void join(std::span<CavityBounds> bounds) = 0;
  virtual void join(std::span<FixedSum> sums) = 0;
  /// Of the values that all parts have for cavities, each of which counts once; see order_free_sum().
  virtual double total(std::span<const double> by_cavity) = 0;
};
/// For numbers up to `bound` in size.
FixedSum sum_of_up_to(double bound);
/// The sum of these, which does not depend on their order.
double order_free_sum(std::span<const double> values);

/// Each new cell has the mean of what it covers; then what rounding, or a surface that has changed, makes the
/// sum of a cavity differ by is shared out among its cells in proportion to the room that their values have
/// within the range of the cavity's old ones. `old_density`, `new_density`: by place; empty for 1.
/// `fallback`: value of a new cell that covers nothing. No sum depends on the order of cells. `parts`: of a
/// mesh of which this is one.
///
/// Source of the shared-out correction: Bochev, Ridzal & Shashkov, "Fast optimization-based conservative
/// remap of scalar fields through aggregate mass transfer" (2013), in its simplest form.
Conserved conserve(const Cavities& cavities, std::span<const double> old_values,
                   std::span<const double> old_density, std::span<const double> new_density,
                   std::span<const double> fallback, CavityParts* parts = nullptr);

}  // namespace hfr

#endif
