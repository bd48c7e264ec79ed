// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/StuckCells.hh"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "Operators/Operator.hh"
#include "Operators/VertexInsertion.hh"
#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "Quality/Wedges.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

/// Degrees by which a wedge may exceed what its cells need by rounding alone.
constexpr double kRounding = 1e-9;
/// Where there is no room for them, no vertex is tried.
constexpr std::size_t kLeastRoom = PassEffort{}.cells_of_vertex;

std::array<Vec3, 4> corners(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  return {mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])};
}

StuckCell unproven(const TetMesh& mesh, CellHandle c) {
  const auto p = corners(mesh, c);
  StuckCell stuck;
  stuck.cell = c;
  stuck.degrees = report_value(Metric::kMinDihedral, MinDihedral{}(p[0], p[1], p[2], p[3]));
  return stuck;
}

/// True when the wedge has cell c.
bool has_cell(const TetMesh& mesh, const Wedge& wedge, VertexHandle a, VertexHandle b, CellHandle c) {
  RingPlace at{cell_of(wedge.first), 0, static_cast<std::uint8_t>(corner_of(wedge.first))};
  const auto& v = mesh.cell(at.cell).v;
  for (std::uint8_t k = 0; k < 4; ++k)
    if (k != at.q && v[k] != a && v[k] != b) at.p = k;
  while (at.cell != c) {
    if (halfface_of(at.cell, at.p) == wedge.last) return false;
    at = mesh.next_in_ring(at);
  }
  return true;
}

/// Tells edges of a cell that no wedge of positive cells can be the proof of: a wedge is no narrower than
/// what the cell takes of it, and holds none of its cells below half of that.
class WideAngles {
 public:
  WideAngles(const TetMesh& mesh, CellHandle c, double degrees) : degrees_(degrees) {
    const auto p = corners(mesh, c);
    frame_ = hfr_make_frame(to_real3(p[0]), to_real3(p[1]), to_real3(p[2]), to_real3(p[3]));
    cosine_ = std::cos(2 * degrees * std::numbers::pi / 180);
  }
  bool has(int edge) const {
    constexpr double kMargin = 1e-9;  // more than rounding
    if (degrees_ >= 90) return false;
    const hfr_cos_sin angle = hfr_dihedral_cos_sin(frame_, edge);
    return angle.cosine < (cosine_ - kMargin) * std::hypot(angle.cosine, angle.sine);
  }

 private:
  double degrees_, cosine_;
  hfr_tet_frame frame_;
};

/// Notes the proof by one of the cell's edges that keeps it below `degrees`: one of the surface, if there is
/// one, then that with the lowest ceiling, then that with the smaller vertices. `frozen`: see
/// constrained_vertices(). `all_positive`: the cells round its edges are.
void prove(const TetMesh& mesh, std::span<const std::uint8_t> frozen, double degrees, bool all_positive,
           StuckCell& stuck) {
  std::optional<WideAngles> wide;
  for (int e = 0; e < 6; ++e) {
    const auto& ends = kEdgeCorners[static_cast<std::size_t>(e)];
    const auto [a, b] = std::minmax(mesh.cell(stuck.cell).v[ends[0]], mesh.cell(stuck.cell).v[ends[1]]);
    if (!frozen[a.idx()] || !frozen[b.idx()]) continue;  // no face there is constrained
    if (all_positive && !wide) wide.emplace(mesh, stuck.cell, degrees);
    if (wide && wide->has(e)) continue;
    const auto found = wedges_at(mesh, stuck.cell, e);
    if (!found) continue;
    for (const Wedge& wedge : found->wedges) {
      // Where every mesh has an invalid cell at the edge, nothing says in which of the wedges.
      const bool may_be_the_one = found->impossible && wedge.degrees <= 0 && stuck.degrees <= 0;
      if (!may_be_the_one && !has_cell(mesh, wedge, a, b, stuck.cell)) continue;
      const double ceiling = wedge_ceiling(mesh, a, b, wedge);
      if (!(ceiling < degrees - kRounding)) continue;
      const bool surface = mesh.is_boundary(wedge.first) && mesh.is_boundary(wedge.last);
      const StuckReason reason = surface ? StuckReason::kSurfaceCeiling : StuckReason::kInputFeature;
      const bool first = !is_proof(stuck.reason) || reason < stuck.reason ||
                         (reason == stuck.reason &&
                          (ceiling < stuck.ceiling ||
                           (ceiling == stuck.ceiling && std::pair(a, b) < std::pair(stuck.a, stuck.b))));
      if (!first) continue;
      stuck.reason = reason;
      stuck.ceiling = ceiling;
      stuck.a = a;
      stuck.b = b;
    }
  }
}

}  // namespace

std::vector<StuckCell> without_proofs(const TetMesh& mesh, std::span<const CellHandle> cells,
                                      par::Policy policy) {
  std::vector<StuckCell> stuck(cells.size());
  par::for_each(policy, cells.size(), [&](std::size_t i) { stuck[i] = unproven(mesh, cells[i]); });
  return stuck;
}

bool are_positive(std::span<const StuckCell> cells) {
  return std::ranges::all_of(cells, [](const StuckCell& cell) { return cell.degrees > kRounding; });
}

void prove_kept(const TetMesh& mesh, std::span<const std::uint8_t> frozen, std::span<StuckCell> cells,
                double by, bool all_positive, par::Policy policy) {
  par::for_each(policy, cells.size(),
                [&](std::size_t i) { prove(mesh, frozen, cells[i].degrees + by, all_positive, cells[i]); });
}

std::vector<StuckCell> stuck_cells(const TetMesh& mesh, double degrees,
                                   std::span<const HalfFaceHandle> unfillable, par::Policy policy,
                                   const KnownValues& known) {
  const std::vector<std::uint8_t> frozen = constrained_vertices(mesh, policy);
  std::vector<std::uint8_t> on_fold(unfillable.empty() ? 0 : mesh.n_vertices(), 0);
  for (HalfFaceHandle h : unfillable)
    for (VertexHandle v : mesh.halfface_vertices(h)) on_fold[v.idx()] = 1;
  std::vector<StuckCell> cells = without_proofs(mesh, cells_below(mesh, degrees, policy, known), policy);
  const bool all_positive = are_positive(cells);
  par::for_each(policy, cells.size(), [&](std::size_t i) {
    StuckCell& stuck = cells[i];
    const auto p = corners(mesh, stuck.cell);
    bool folds = false;
    for (VertexHandle v : mesh.cell(stuck.cell).v) {
      stuck.n_frozen_vertices += frozen[v.idx()];
      folds = folds || (!on_fold.empty() && on_fold[v.idx()]);
    }
    if (folds && orientation(p[0], p[1], p[2], p[3]) <= 0)
      stuck.reason = StuckReason::kFoldedSurface;
    else
      prove(mesh, frozen, degrees, all_positive, stuck);
  });
  return cells;
}

CellBoundMet blame_max_cells(const TetMesh& mesh, std::vector<StuckCell>& stuck, double degrees,
                             std::size_t max_cells, par::Policy policy) {
  using Op = VertexInsertion<MinDihedral>;
  std::vector<double> quality(mesh.n_cells());
  par::for_ranges(policy, mesh.n_cells(), [&](std::size_t begin, std::size_t end) {
    for_decisions(mesh, MinDihedral{}, begin, end, [&](std::size_t i, double value) { quality[i] = value; });
  });
  Op op{MinDihedral{}, quality};
  op.poor_below = dihedral_decision(degrees);
  const std::size_t n_cells = mesh.n_logical_cells();
  const auto n_open = std::ranges::count(stuck, StuckReason::kNotFound, &StuckCell::reason);
  std::vector<std::size_t> n_more(stuck.size(), 0);
  par::for_each_dynamic(policy.for_items_of(Op::kSeedNanoseconds), stuck.size(), 1, [&](std::size_t i) {
    if (stuck[i].reason != StuckReason::kNotFound) return;
    const auto plan = op.evaluate(mesh, typename Op::Seed(stuck[i].cell));
    if (!plan) return;
    Cavity cavity;
    op.cavity(mesh, *plan, cavity);
    const std::size_t n_after = n_cells + cavity.created.size() - cavity.removed.size();
    if (n_after <= max_cells && n_cells + kLeastRoom <= max_cells) return;
    stuck[i].reason = StuckReason::kMaxCells;
    n_more[i] = std::max(n_after, n_cells + kLeastRoom) - n_cells;
  });
  CellBoundMet met;
  for (std::size_t more : n_more) {
    met.cells += more > 0 ? 1 : 0;
    met.wanted += more;
  }
  if (met.cells > 0)
    met.wanted += n_cells;
  else if (n_open == 0 || n_cells + kLeastRoom <= max_cells)
    return {};
  met.bound = max_cells;
  return met;
}

std::array<std::size_t, kStuckReasonNames.size()> count_reasons(const std::vector<StuckCell>& cells) {
  std::array<std::size_t, kStuckReasonNames.size()> counts{};
  for (const StuckCell& stuck : cells) ++counts[static_cast<std::size_t>(stuck.reason)];
  return counts;
}

std::vector<CellHandle> cells_held_back(const std::vector<StuckCell>& stuck) {
  std::vector<CellHandle> cells;
  for (const StuckCell& cell : stuck)
    if (is_proof(cell.reason) || (cell.reason == StuckReason::kNotFound && cell.n_frozen_vertices == 4))
      cells.push_back(cell.cell);
  return cells;
}

}  // namespace hfr
