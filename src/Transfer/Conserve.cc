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

/// The parents of created cells again, and what is found of the others.
Overlaps overlaps_of_changed(const TetMesh& old, const TetMesh& now, const Edits& edits,
                             std::span<const CellHandle> new_cells, std::span<const CellHandle> old_cells,
                             par::Policy policy) {
  if (!edits.has_parents()) return find_overlaps(old, edits, shapes_of(now, new_cells), old_cells, policy);
  const Parents& parents = edits.parents();
  const Overlaps of_moved = find_overlaps(old, edits, shapes_of(now, edits.moved_cells), old_cells, policy);
  Overlaps all;
  all.first.push_back(0);
  std::size_t created = 0, moved = 0;
  for (CellHandle c : new_cells) {
    if (created < edits.created_cells.size() && edits.created_cells[created].cell == c) {
      const double whole = std::abs(volume(now, c));
      for (const ParentCell& parent : parents.of(created))
        all.parts.push_back({parent.old_cell, parent.share * whole});
      std::sort(all.parts.begin() + static_cast<std::ptrdiff_t>(all.first.back()), all.parts.end(),
                [](const Overlap& a, const Overlap& b) { return a.old_cell < b.old_cell; });
      ++created;
    } else {
      const auto parts = of_moved.of(moved++);
      all.parts.insert(all.parts.end(), parts.begin(), parts.end());
    }
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
      new_volume_(volumes(now, new_cells_, policy)) {
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

Conserved conserve(const Cavities& cavities, std::span<const double> old_values,
                   std::span<const double> old_density, std::span<const double> new_density,
                   std::span<const double> fallback) {
  const auto density = [](std::span<const double> d, std::size_t i) { return d.empty() ? 1.0 : d[i]; };
  Conserved out;
  out.values.assign(cavities.new_cells().size(), 0);
  for (const Cavities::Cavity& cavity : cavities.cavities()) {
    double low = std::numeric_limits<double>::infinity(), high = -low, held = 0;
    for (const Index j : cavity.old_cells) {
      low = std::min(low, old_values[j]);
      high = std::max(high, old_values[j]);
      held += cavities.old_volume(j) * density(old_density, j) * old_values[j];
    }
    out.integral += held;
    double missing = held;
    for (const Index i : cavity.new_cells) {
      double sum = 0, weight = 0;
      for (const Overlap& part : cavities.overlaps().of(i)) {
        const Index j = place_in(cavities.old_cells(), part.old_cell);
        const double w = part.volume * density(old_density, j);
        sum += w * old_values[j];
        weight += w;
      }
      double value = weight > 0 ? sum / weight : fallback[i];
      if (low <= high) value = std::clamp(value, low, high);
      out.values[i] = value;
      missing -= cavities.new_volume(i) * density(new_density, i) * value;
    }
    // Beyond the old mesh, with nobody to share with; or what cells hold is no number, which stays where they
    // were.
    if (cavity.old_cells.empty() || !std::isfinite(missing)) {
      out.lost += missing;
      continue;
    }
    // Twice: the second time for what the first one has rounded.
    for (int turn = 0; turn < 2 && missing != 0; ++turn) {
      const double bound = missing > 0 ? high : low;
      const auto room = [&](Index i) {
        const double mass = cavities.new_volume(i) * density(new_density, i);
        return mass > 0 ? mass * (bound - out.values[i]) : 0.0;
      };
      double all_room = 0;
      for (const Index i : cavity.new_cells) all_room += room(i);
      if (all_room == 0) break;
      const double share = std::min(1.0, missing / all_room);
      missing = held;
      for (const Index i : cavity.new_cells) {
        if (room(i) != 0)
          out.values[i] = std::clamp(out.values[i] + share * (bound - out.values[i]), low, high);
        missing -= cavities.new_volume(i) * density(new_density, i) * out.values[i];
      }
    }
    out.lost += missing;
  }
  return out;
}

}  // namespace hfr
