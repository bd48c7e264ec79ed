// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Conserve.hh"

#include <algorithm>
#include <cmath>
#include <limits>

#include "HalfFace/Geometry.hh"
#include "Parallel/DisjointSets.hh"

namespace hfr {
namespace {

Index place_in(std::span<const CellHandle> ascending, CellHandle c) {
  return static_cast<Index>(std::lower_bound(ascending.begin(), ascending.end(), c) - ascending.begin());
}

std::vector<double> volumes(const TetMesh& mesh, std::span<const CellHandle> cells, par::Policy policy) {
  std::vector<double> out(cells.size());
  par::for_each(policy, cells.size(), [&](std::size_t i) { out[i] = volume(mesh, cells[i]); });
  return out;
}

/// Those of created cells again that are known, and what is found of the others.
Overlaps overlaps_of_changed(const TetMesh& old, const TetMesh& now, const Edits& edits,
                             std::span<const CellHandle> new_cells, std::span<const CellHandle> old_cells,
                             par::Policy policy) {
  const Overlaps* of_created = overlaps_of_created(edits);
  if (!of_created) return find_overlaps(old, shapes_of(now, edits, new_cells), old_cells, policy);
  const Overlaps of_moved = find_overlaps(old, shapes_of(now, edits, edits.moved_cells), old_cells, policy);
  Overlaps all;
  all.first.push_back(0);
  std::size_t created = 0, moved = 0;
  for (CellHandle c : new_cells) {
    const bool is_created = created < edits.created_cells.size() && edits.created_cells[created].cell == c;
    const auto parts = is_created ? of_created->of(created++) : of_moved.of(moved++);
    all.parts.insert(all.parts.end(), parts.begin(), parts.end());
    all.first.push_back(all.parts.size());
  }
  return all;
}

}  // namespace

Cavities::Cavities(const TetMesh& old, const TetMesh& now, const Edits& edits, par::Policy policy)
    : old_cells_(changed_old_cells(edits)),
      new_cells_(changed_new_cells(edits)),
      overlaps_(overlaps_of_changed(old, now, edits, new_cells_, old_cells_, policy)),
      old_volume_(volumes(old, old_cells_, policy)),
      new_volume_(volumes(now, new_cells_, policy)),
      beside_(old_cells_beside(old, overlaps_, policy, [&](std::span<const std::size_t> places) {
        std::vector<CellHandle> cells;
        for (const std::size_t i : places) cells.push_back(new_cells_[i]);
        return shapes_of(now, edits, cells);
      })) {
  const std::size_t n_old = old_cells_.size(), n = n_old + new_cells_.size();
  par::DisjointSets<Index> sets(n);
  for (std::size_t i = 0; i < n_old; ++i)
    for (const HalfFaceHandle m : old.cell(old_cells_[i]).mate) {
      if (!m.is_valid()) continue;
      const Index j = place_in(old_cells_, cell_of(m));
      if (j < n_old && old_cells_[j] == cell_of(m)) sets.join(static_cast<Index>(i), j);
    }
  for (std::size_t i = 0; i < new_cells_.size(); ++i) {
    const auto parts = overlaps_.of(i);
    for (const Overlap& part : parts)
      sets.join(place_in(old_cells_, part.old_cell), static_cast<Index>(n_old + i));
    // Where the surface has moved out, a cell may lie beyond the old mesh as a whole: it shares with those
    // beside it, or what it holds would come from nowhere.
    if (!parts.empty()) continue;
    for (const HalfFaceHandle m : now.cell(new_cells_[i]).mate) {
      if (!m.is_valid()) continue;
      const Index j = place_in(new_cells_, cell_of(m));
      if (j < new_cells_.size() && new_cells_[j] == cell_of(m))
        sets.join(static_cast<Index>(n_old) + j, static_cast<Index>(n_old + i));
    }
  }
  constexpr Index kNone = std::numeric_limits<Index>::max();
  std::vector<Index> number(n, kNone);  // by the smallest member
  for (std::size_t i = 0; i < n; ++i) {
    Index& mine = number[sets.find(static_cast<Index>(i))];
    if (mine == kNone) {
      mine = static_cast<Index>(cavities_.size());
      cavities_.emplace_back();
    }
    if (i < n_old)
      cavities_[mine].old_cells.push_back(static_cast<Index>(i));
    else
      cavities_[mine].new_cells.push_back(static_cast<Index>(i - n_old));
  }
}

bool Cavities::is_outside(std::size_t i) const {
  constexpr double kRounding = 1e-9;
  double covered = 0;
  for (const Overlap& part : overlaps_.of(i)) covered += part.volume;
  return std::abs(std::abs(new_volume_[i]) - covered) > kRounding * std::abs(new_volume_[i]);
}

FixedSum sum_of_up_to(double bound) {
  constexpr double kLeast = 0x1p-900;  // below which the units have no numbers
  if (bound < 0x1p1000) return FixedSum(std::max(bound, kLeast));
  FixedSum none;  // a bound that is no number makes a sum that is none
  none.add(std::numeric_limits<double>::quiet_NaN());
  return none;
}

double order_free_sum(std::span<const double> values) {
  double largest = 0;
  for (double x : values) largest = std::max(largest, std::abs(x));
  FixedSum sum = sum_of_up_to(largest);
  for (double x : values) sum.add(x);
  return sum.value();
}

namespace {

/// One component of a field, in all cavities at the same time.
class Conservation {
 public:
  Conservation(const Cavities& cavities, std::span<const double> old_values,
               std::span<const double> old_density, std::span<const double> new_density,
               std::span<const double> fallback, CavityParts* parts)
      : cavities_(cavities),
        old_values_(old_values),
        old_density_(old_density),
        new_density_(new_density),
        fallback_(fallback),
        parts_(parts),
        values_(cavities.new_cells().size()) {}

  Conserved run() {
    find_means();
    find_bounds();
    keep_in_bounds();
    const std::vector<double> held = sums([&](std::size_t a, FixedSum& sum) {
      for (const Index j : cavity(a).old_cells) sum.add(held_by_old(j));
    });
    std::vector<double> missing = missing_now();
    // Twice: the second time for what the first one has rounded.
    for (int turn = 0; turn < 2; ++turn) {
      share_out(missing);
      missing = missing_now();
    }
    return {std::move(values_), total(held), total(missing)};
  }

 private:
  const Cavities::Cavity& cavity(std::size_t a) const { return cavities_.cavities()[a]; }
  double old_mass(Index j) const {
    return cavities_.old_volume(j) * (old_density_.empty() ? 1.0 : old_density_[j]);
  }
  double new_mass(Index i) const {
    return cavities_.new_volume(i) * (new_density_.empty() ? 1.0 : new_density_[i]);
  }
  double held_by_old(Index j) const { return old_mass(j) * old_values_[j]; }

  void find_means() {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      double sum = 0, weight = 0;
      for (const Overlap& part : cavities_.overlaps().of(i)) {
        const Index j = place_in(cavities_.old_cells(), part.old_cell);
        const double w = part.volume * (old_density_.empty() ? 1.0 : old_density_[j]);
        sum += w * old_values_[j];
        weight += w;
      }
      values_[i] = weight > 0 ? sum / weight : fallback_[i];
    }
  }
  void find_bounds() {
    for (const Cavities::Cavity& cavity : cavities_.cavities()) {
      CavityBounds& bounds = bounds_.emplace_back();
      for (const Index j : cavity.old_cells) {
        const double mass = std::abs(old_mass(j));
        bounds.add({old_values_[j], old_values_[j], mass, 0});
      }
      for (const Index i : cavity.new_cells)
        bounds.add({CavityBounds().low, CavityBounds().high, std::abs(new_mass(i)), std::abs(values_[i])});
    }
    if (parts_) parts_->join(std::span(bounds_));
  }
  void keep_in_bounds() {
    for (std::size_t a = 0; a < bounds_.size(); ++a)
      for (const Index i : cavities_.cavities()[a].new_cells)
        if (bounds_[a].low <= bounds_[a].high)
          values_[i] = std::clamp(values_[i], bounds_[a].low, bounds_[a].high);
  }
  /// What a value in the cavity may be, in size.
  double largest_value(std::size_t a) const {
    const CavityBounds& bounds = bounds_[a];
    return bounds.low <= bounds.high ? std::max(std::abs(bounds.low), std::abs(bounds.high))
                                     : bounds.fallback;
  }

  /// One for each cavity, to which add(cavity, sum) adds what is here: products of masses and of values or
  /// their differences.
  template <class Add>
  std::vector<double> sums(Add&& add) {
    std::vector<FixedSum> all;
    for (std::size_t a = 0; a < bounds_.size(); ++a) {
      all.push_back(sum_of_up_to(2 * bounds_[a].mass * largest_value(a)));
      add(a, all[a]);
    }
    if (parts_) parts_->join(std::span(all));
    std::vector<double> values;
    for (const FixedSum& sum : all) values.push_back(sum.value());
    return values;
  }
  /// What the old cells of each cavity held and its new ones do not.
  std::vector<double> missing_now() {
    return sums([&](std::size_t a, FixedSum& sum) {
      for (const Index j : cavity(a).old_cells) sum.add(held_by_old(j));
      for (const Index i : cavity(a).new_cells) sum.add(-new_mass(i) * values_[i]);
    });
  }
  /// In proportion to the room that values have within the bounds.
  void share_out(std::span<const double> missing) {
    const auto bound = [&](std::size_t a) { return missing[a] > 0 ? bounds_[a].high : bounds_[a].low; };
    const auto room = [&](std::size_t a, Index i) {
      const double mass = new_mass(i);
      return mass > 0 ? mass * (bound(a) - values_[i]) : 0.0;
    };
    // Beyond the old mesh, with nobody to share with; or what cells hold is no number, which stays where they
    // were.
    const auto has_share = [&](std::size_t a) {
      return missing[a] != 0 && std::isfinite(missing[a]) && bounds_[a].low <= bounds_[a].high;
    };
    const std::vector<double> all_room = sums([&](std::size_t a, FixedSum& sum) {
      if (!has_share(a)) return;
      for (const Index i : cavity(a).new_cells) sum.add(room(a, i));
    });
    for (std::size_t a = 0; a < all_room.size(); ++a) {
      if (!has_share(a) || all_room[a] == 0) continue;
      const double share = std::min(1.0, missing[a] / all_room[a]);
      for (const Index i : cavity(a).new_cells)
        if (room(a, i) != 0)
          values_[i] =
              std::clamp(values_[i] + share * (bound(a) - values_[i]), bounds_[a].low, bounds_[a].high);
    }
  }
  double total(std::span<const double> by_cavity) {
    return parts_ ? parts_->total(by_cavity) : order_free_sum(by_cavity);
  }

  const Cavities& cavities_;
  std::span<const double> old_values_, old_density_, new_density_, fallback_;
  CavityParts* parts_;
  std::vector<double> values_;  // of new cells
  std::vector<CavityBounds> bounds_;
};

}  // namespace

Conserved conserve(const Cavities& cavities, std::span<const double> old_values,
                   std::span<const double> old_density, std::span<const double> new_density,
                   std::span<const double> fallback, CavityParts* parts) {
  return Conservation(cavities, old_values, old_density, new_density, fallback, parts).run();
}

}  // namespace hfr
