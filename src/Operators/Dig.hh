// SPDX-License-Identifier: BSD-3-Clause
// Klingner & Shewchuk, Aggressive tetrahedral mesh improvement, 2007: their insertion, with a greedy dig in
// place of their search for the best cavity. A cavity whose outer faces all make positive cells with one
// point is star-shaped, so it is a ball that these cells fill.
#ifndef HFR_OPERATORS_DIG_HH
#define HFR_OPERATORS_DIG_HH

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"
#include "Operators/GrownCells.hh"
#include "Operators/MaxMinForm.hh"

// What operators share that put a new vertex into a cavity. For their sources only: not installed.
namespace hfr::detail {

inline constexpr int kAscent = 12;            // steps of one move of the new vertex
inline constexpr std::size_t kPatience = 12;  // cells dug without finding a better cavity

/// Every outer face of the cavity gets a cell.
struct NoneIsCut {
  bool operator()(HalfFaceHandle) const { return false; }
};

/// Where the new vertex may go; see MaxMinForm::confine().
struct Confine {
  MaxMinForm::Room room = MaxMinForm::Room::kSpace;
  Vec3 axis;
};

/// Whether the worst value comes to `gain` times the old one if it rises once more as from `before` to `now`;
/// true where an old one is not positive.
inline bool is_within_reach(const Site& before, const Site& now, double gain) {
  if (!(before.old_worst > 0 && now.old_worst > 0)) return true;
  const double rise_before = before.new_worst / before.old_worst, rise = now.new_worst / now.old_worst;
  return rise >= gain || rise * rise >= gain * rise_before;
}

/// Finds cavities for a new vertex, on behalf of cell `centre`, which is known to a rim. `is_cut` tells the
/// outer half-faces that the vertex lies in: they get no cell.
template <class Metric, class IsCut = NoneIsCut>
class Digger {
 public:
  Digger(const TetMesh& mesh, const Metric& metric, std::span<const double> quality, std::size_t max_cells,
         CellHandle centre, IsCut is_cut = {}, const CutRim* rim = nullptr)
      : mesh_(mesh),
        metric_(metric),
        quality_(quality),
        max_cells_(std::min(max_cells, Growth::kMaxCells)),
        centre_(centre),
        is_cut_(is_cut),
        rim_(rim) {}

  /// The best cavity on the way of digging behind the worst outer face until that is not possible.
  /// site.new_worst is not positive unless all its cells are.
  Site dig(GrownCells cells, Vec3 place) const {
    Site best;
    double old_worst = std::numeric_limits<double>::infinity();
    for (CellHandle c : cells.cells()) {
      old_worst = std::min(old_worst, quality_[c.idx()]);
      if (rim_) rim_->look(centre_, c);
    }
    std::size_t n_valued = 0;
    for (std::size_t idle = 0; idle < kPatience; ++idle) {
      for (std::size_t i = n_valued; i < cells.outer().size(); ++i)
        cells.value(i) = value(cells.outer()[i], place);
      const auto [worst_face, worst] = cells.least();
      if (worst > best.new_worst) {
        best = {cells.growth(), place, old_worst, worst};
        idle = 0;
      }
      if (cells.cells().size() >= max_cells_ || !worst_face.is_valid() || !cells.grow(worst_face)) break;
      n_valued = cells.n_kept();
      const CellHandle taken = cells.cells()[cells.cells().size() - 1];
      old_worst = std::min(old_worst, quality_[taken.idx()]);
      if (rim_) rim_->look(centre_, taken);
    }
    return best;
  }

  /// Moves the vertex of what was dug, digs on from there, and so on until it brings no more or there were
  /// max_digs of them, the one that found `best` included. It ends as well where the worst value is not
  /// `gain` times the old one yet, nor would be if the next move brought as much as the last.
  Site follow_up(Site best, int max_digs, double gain, Confine confine = {}) const {
    for (int i = 1; i < max_digs && best.new_worst > 0; ++i) {
      const GrownCells now = replay(best.growth);
      MaxMinForm form(best.place, MaxMinForm::kAnglesOf<Metric>);
      form.confine(confine.room, confine.axis);
      for (HalfFaceHandle h : now.outer()) {
        if (is_cut_(h)) continue;
        const auto f = mesh_.halfface_vertices(h);
        form.add(mesh_.point(f[0]), mesh_.point(f[1]), mesh_.point(f[2]));
      }
      const Vec3 moved = form.ascend(best.place, kAscent);
      if (moved == best.place) break;
      const Site next = dig(now, moved);
      if (!(next.new_worst > best.new_worst)) break;
      const bool may_come_to_it = is_within_reach(best, next, gain);
      best = next;
      if (!may_come_to_it) break;
    }
    return best;
  }

 private:
  double value(HalfFaceHandle h, Vec3 p) const {
    if (is_cut_(h)) return std::numeric_limits<double>::infinity();
    const auto f = mesh_.halfface_vertices(h);
    return metric_(mesh_.point(f[0]), mesh_.point(f[1]), mesh_.point(f[2]), p);
  }

  GrownCells replay(const Growth& growth) const {
    GrownCells cells(mesh_, growth.first);
    for (std::size_t i = 0; i < growth.n_steps; ++i)
      cells.grow(halfface_of(cells.cells()[growth.steps[i] / 4U], growth.steps[i] % 4));
    return cells;
  }

  const TetMesh& mesh_;
  const Metric& metric_;
  std::span<const double> quality_;
  std::size_t max_cells_;
  CellHandle centre_;
  IsCut is_cut_;
  const CutRim* rim_;
};

/// Fills the cavity that a growth makes with cells on a new vertex at `place`.
template <class IsCut = NoneIsCut>
void fill_cavity(const TetMesh& mesh, const Growth& growth, Vec3 place, Cavity& out, IsCut is_cut = {}) {
  Scope cells;
  growth.cells(mesh, cells);
  out.clear();
  for (CellHandle c : cells) out.removed.push_back(c);
  for (CellHandle c : cells) {
    for (HalfFaceHandle h : mesh.cell_halffaces(c)) {
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (m.is_valid() && std::find(cells.begin(), cells.end(), cell_of(m)) != cells.end()) continue;
      if (is_cut(h)) continue;
      const auto f = mesh.halfface_vertices(h);
      out.created.push_back({f[0], f[1], f[2], Cavity::kNewVertex});
    }
  }
  out.new_vertex = place;
}

/// The operator's plan for a seed that has found this site.
template <class Op>
typename Op::Plan plan_for(const Op& op, const TetMesh& mesh, const typename Op::Seed& seed,
                           const Site& site) {
  typename Op::Plan plan;
  plan.seed = seed;
  plan.seed.growth = site.growth;
  plan.place = site.place;
  plan.old_worst = site.old_worst;
  plan.new_worst = site.new_worst;
  Cavity cavity;
  op.cavity(mesh, plan, cavity);
  plan.n_removed = static_cast<std::uint32_t>(cavity.removed.size());
  plan.n_created = static_cast<std::uint32_t>(cavity.created.size());
  plan.adds_vertex = true;
  return plan;
}

}  // namespace hfr::detail

#endif
