// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_CHANGES_HH
#define HFR_DISTRIBUTED_PART_CHANGES_HH

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "Distributed/DistributedMesh.hh"

namespace hfr::mpi {

/// What has become of the cells and vertices of a mesh in parts, by their numbers: `old` is a copy of it as
/// it was. See transfer_in_parts().
class PartChanges {
 public:
  PartChanges(const DistributedMesh& old, const DistributedMesh& now,
              std::span<const std::pair<std::uint64_t, std::uint64_t>> renumbered)
      : old_(old), now_(now), by_old_(renumbered), by_new_(renumbered.begin(), renumbered.end()) {
    std::ranges::sort(by_new_, {}, &std::pair<std::uint64_t, std::uint64_t>::second);
  }

  bool is_old(std::uint64_t vertex) const { return vertex < old_.n_vertices(); }

  /// The old cell that an own cell is, with the same vertices in the same order and place; invalid: created.
  CellHandle old_cell(CellHandle now) const {
    std::uint64_t number = now_.number(now);
    if (!by_new_.empty()) {
      const auto at =
          std::ranges::lower_bound(by_new_, number, {}, &std::pair<std::uint64_t, std::uint64_t>::second);
      if (at == by_new_.end() || at->second != number) return {};
      number = at->first;
    }
    const CellHandle c = old_.cell_at(number);
    return c.is_valid() && has_same_vertices(c, now) ? c : CellHandle();
  }
  /// Of an old cell with an own vertex: whether it is gone, or a vertex of it is elsewhere.
  bool has_changed(CellHandle old) const {
    std::uint64_t number = old_.number(old);
    if (!by_old_.empty()) {
      const auto at =
          std::ranges::lower_bound(by_old_, number, {}, &std::pair<std::uint64_t, std::uint64_t>::first);
      if (at == by_old_.end() || at->first != number) return true;
      number = at->second;
    }
    const CellHandle c = now_.cell_at(number);
    return !c.is_valid() || !has_same_vertices(old, c) || has_moved(old, c);
  }
  /// Both are one cell.
  bool has_moved(CellHandle old, CellHandle now) const {
    for (std::size_t k = 0; k < 4; ++k)
      if (!(old_.part().point(old_.part().cell(old).v[k]) == now_.part().point(now_.part().cell(now).v[k])))
        return true;
    return false;
  }

 private:
  bool has_same_vertices(CellHandle old, CellHandle now) const {
    if (old_.part().is_deleted(old) || now_.part().is_deleted(now)) return false;
    for (std::size_t k = 0; k < 4; ++k)
      if (old_.number(old_.part().cell(old).v[k]) != now_.number(now_.part().cell(now).v[k])) return false;
    return true;
  }

  const DistributedMesh &old_, &now_;
  std::span<const std::pair<std::uint64_t, std::uint64_t>> by_old_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> by_new_;
};

}  // namespace hfr::mpi

#endif
