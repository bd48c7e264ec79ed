// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_CELL_WATCH_HH
#define HFR_REMESH_CELL_WATCH_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Remesh/MovedVertices.hh"
#include "Remesh/Remesher.hh"
#include "Remesh/Survey.hh"

namespace hfr {

/// Values by cell or vertex, brought over a repair: those of what is created are `made`. In place where
/// nothing has come to stand behind where it stood.
template <class T, class H>
void carry(std::vector<T>& values, const std::vector<H>& old_of, T made) {
  if (values.empty()) return;
  bool in_place = true;
  for (std::size_t i = 0; i < old_of.size(); ++i)
    in_place = in_place && (!old_of[i].is_valid() || old_of[i].idx() >= i);
  if (in_place) {
    if (values.size() < old_of.size()) values.resize(old_of.size(), made);
    for (std::size_t i = 0; i < old_of.size(); ++i)
      values[i] = old_of[i].is_valid() ? values[old_of[i].idx()] : made;
    values.resize(old_of.size());
    return;
  }
  std::vector<T> now(old_of.size(), made);
  for (std::size_t i = 0; i < now.size(); ++i)
    if (old_of[i].is_valid()) now[i] = values[old_of[i].idx()];
  values = std::move(now);
}

/// What a Remesher knows of the cells of its mesh: the quality of each, which are bad by the triggers, and
/// which of these call for a repair. Looks only at what it is told to look at, and allocates nothing then.
class CellWatch {
 public:
  /// `triggers` and the mesh outlive this object.
  CellWatch(const TetMesh& mesh, const RepairTriggers& triggers, par::Policy policy);

  /// The mesh is another one: nothing is known of it, nothing is excused, and cells have the volumes at rest
  /// that they have now. Looks at every cell.
  void reset();
  std::size_t look_at_all();  ///< returns how many there are
  /// Looks at the cells of the vertices, which are not many; returns how many these are. A walk round each
  /// vertex comes to all its cells.
  std::size_t look_at_cells_of(const MovedVertices& moved);
  /// After a repair: looks at what it has made and moved. What is bad then, and not inverted, will have to
  /// become worse before it calls for the next repair, unless this one was cut short.
  void follow(const Edits& edits, bool was_cut_short);

  /// The strongest cause that a cell gives; kNone for none.
  RepairCause cause() const;
  std::size_t n_inverted() const { return totals_.inverted; }
  std::vector<CellHandle> inverted() const;
  double min_dihedral() const;  ///< degrees
  /// What survey() would find; nothing where a cell is inverted, or may be flat.
  std::optional<Survey> survey() const;

  /// What looking at the same cells again does not bring back.
  struct Memory {
    std::vector<double> left, rest_volume;
    std::vector<std::uint8_t> excused;
  };
  /// Whether repairs have left cells that call for no further one.
  bool has_excuses() const { return has_excused_; }
  Memory memory() const;
  /// The mesh is again the one that the memory is of; look_at_all() is to follow.
  void restore(Memory memory);

 private:
  /// Why a cell is bad, a bit each.
  enum Bad : std::uint8_t {
    kIsInverted = 1,
    kIsBelow = 2,
    kHasMetric = 4,
    kIsSqueezed = 8,
    kIsIndicated = 16
  };
  static constexpr std::size_t kReasons = 5;
  struct Totals {
    std::size_t active = 0;  ///< bad cells that call for a repair
    std::size_t inverted = 0;
    std::array<std::size_t, kReasons> active_by{};  ///< active ones by reason: entry i of bit i
    bool any = false;                               ///< bad cells, active or not

    Totals& operator+=(const Totals& o) {
      active += o.active;
      inverted += o.inverted;
      for (std::size_t i = 0; i < kReasons; ++i) active_by[i] += o.active_by[i];
      any = any || o.any;
      return *this;
    }
    /// The cell that gave `was` gives `is`. Totals of such changes alone count modulo 2⁶⁴.
    void change(const Totals& was, const Totals& is) {
      active += is.active - was.active;
      inverted += is.inverted - was.inverted;
      for (std::size_t i = 0; i < kReasons; ++i) active_by[i] += is.active_by[i] - was.active_by[i];
      any = any || is.any;
    }
  };
  class Batch;

  void find_indicator_field();
  void look_at(std::span<const CellHandle> cells);
  void look_in_parts(std::size_t n, double nanoseconds, const auto& look);
  void take(CellHandle c, double value, Totals& changes);
  void find_worst(bool in_all_blocks);
  void update(CellHandle c, double value);
  Totals judged(CellHandle c, double value);
  bool knows_bad(std::size_t first, std::size_t n) const;
  /// Neither was it bad, nor is it.
  bool stays_good(CellHandle c, double value) const {
    return value >= good_from_ && !asks_more_ && (bad_[c.idx()] | excused_[c.idx()]) == 0;
  }
  Totals totals_of(CellHandle c) const;
  std::uint8_t badness(CellHandle c) const;
  void forget_looks();
  void forget_excuses();
  void excuse();
  template <class Visit>
  void for_bad(Visit&& visit) const;

  const TetMesh& mesh_;
  const RepairTriggers& triggers_;
  par::Policy policy_;
  double trigger_;    // decision value of triggers.min_dihedral
  double good_from_;  // a decision value of this or more is above 0 and not below trigger_
  bool asks_more_;    // triggers look at more of a cell than its dihedrals
  /// Whether triggers.indicator_field is not 0, by number of the cell; for one look, since storage may move.
  std::function<bool(std::size_t)> is_indicated_;

  std::vector<double> quality_;        // by cell: decision value of MinDihedral
  std::vector<std::uint8_t> bad_;      // by cell: bits of Bad
  std::vector<std::uint8_t> excused_;  // by cell: bits that the last repair had to leave
  std::vector<double> left_;           // by cell: its value then
  std::vector<double> rest_volume_;    // by cell, where asked for
  bool has_bad_ = false;               // some entry of bad_ may not be 0
  bool has_excused_ = false;           // some entry of excused_ may not be 0
  Totals totals_;

  // The smallest of quality_, and of each block of kBlock cells; a block that is stale may have another.
  static constexpr std::size_t kBlock = 256;
  double worst_ = 0;
  std::vector<double> block_worst_;
  std::vector<std::uint8_t> stale_;  // by block

  // Of the last look; kept for their memory.
  struct Part {
    Totals totals;
    std::size_t n_cells = 0;
  };
  std::vector<CellHandle> cells_;
  std::vector<Part> parts_;
};

}  // namespace hfr

#endif
