// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Survey.hh"

#include <algorithm>
#include <limits>
#include <utility>

#include "HalfFace/Errors.hh"
#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"

namespace hfr {
namespace {

bool is_invalid(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  return orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) <= 0;
}

double min_dihedral_of(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  return MinDihedral{}(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
}

/// body(i, decision value of MinDihedral) for the cell slots of [begin, end) that count and of which it is
/// below limit(), or not positive; for others as they come.
template <class Limit, class Body>
void for_low_dihedrals(const TetMesh& mesh, const KnownValues& known, std::size_t begin, std::size_t end,
                       const std::function<bool(CellHandle)>& counts, Limit&& limit, Body&& body) {
  const auto may_be_low = [&](double value) { return value < limit() || !(value > 0); };
  const auto does_count = [&](std::size_t i) { return !counts || counts(CellHandle(i)); };
  HFR_ASSERT(known.dihedrals.empty() || known.dihedrals.size() == mesh.n_cells());
  HFR_ASSERT(known.sines.empty() || known.sines.size() == mesh.n_cells());
  if (!known.dihedrals.empty()) {
    for (std::size_t i = begin; i < end; ++i)
      if (may_be_low(known.dihedrals[i]) && does_count(i)) body(i, known.dihedrals[i]);
  } else if (!known.sines.empty()) {
    // The smallest sine is, of positive cells, never above the smallest dihedral's. Of an inverted cell both
    // are negative, and the smallest sine, which may be an obtuse angle's, is the nearer one to 0.
    for (std::size_t i = begin; i < end; ++i)
      if (may_be_low(known.sines[i]) && does_count(i)) body(i, min_dihedral_of(mesh, CellHandle(i)));
  } else {
    for_decisions(mesh, MinDihedral{}, begin, end, [&](std::size_t i, double value) {
      if (may_be_low(value) && does_count(i)) body(i, value);
    });
  }
}

/// Cells that for_cells(begin, end, found) finds in pieces of the mesh, ascending.
template <class ForCells>
std::vector<CellHandle> cells_that(const TetMesh& mesh, par::Policy policy, ForCells&& for_cells) {
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  std::vector<std::vector<CellHandle>> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    for_cells(par::part_begin(n, n_parts, part), par::part_begin(n, n_parts, part + 1),
              found[static_cast<std::size_t>(part)]);
  });
  std::vector<CellHandle> cells = std::move(found[0]);
  for (std::size_t part = 1; part < found.size(); ++part)
    cells.insert(cells.end(), found[part].begin(), found[part].end());
  return cells;
}

}  // namespace

KnownValues known_values(const Workspace& work) {
  KnownValues known;
  if (work.has_qualities_of<MinSine2>()) known.sines = work.quality;
  if (work.has_qualities_of<MinDihedral>()) known.dihedrals = work.quality;
  return known;
}

Survey survey(const TetMesh& mesh, par::Policy policy, const KnownValues& known,
              const std::function<bool(CellHandle)>& counts) {
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  const bool is_known = !known.sines.empty() || !known.dihedrals.empty();
  std::vector<Survey> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    const std::size_t begin = par::part_begin(n, n_parts, part), end = par::part_begin(n, n_parts, part + 1);
    Survey mine{std::numeric_limits<double>::infinity(), 0};
    const auto see = [&](std::size_t i, double dihedral) {
      mine.worst = std::min(mine.worst, dihedral);
      if (!(dihedral > 0) && is_invalid(mesh, CellHandle(i))) ++mine.n_invalid;
    };
    if (is_known) {
      for_low_dihedrals(
          mesh, known, begin, end, counts, [&] { return mine.worst; }, see);
    } else {  // the smallest sine is the cheaper form
      for_decisions(mesh, MinSine2{}, begin, end, [&](std::size_t i, double sine) {
        if ((sine < mine.worst || !(sine > 0)) && (!counts || counts(CellHandle(i))))
          see(i, min_dihedral_of(mesh, CellHandle(i)));
      });
    }
    found[static_cast<std::size_t>(part)] = mine;
  });
  Survey all{std::numeric_limits<double>::infinity(), 0};
  for (const Survey& part : found) {
    all.worst = std::min(all.worst, part.worst);
    all.n_invalid += part.n_invalid;
  }
  return all;
}

double smallest_dihedral(const TetMesh& mesh, par::Policy policy) {
  return report_value(Metric::kMinDihedral, std::min(survey(mesh, policy).worst, kRegularDihedral));
}

AngleTally tally_below(const TetMesh& mesh, std::span<const double> degrees, par::Policy policy,
                       const KnownValues& known, const std::function<bool(CellHandle)>& counts) {
  std::vector<double> decisions;
  for (double angle : degrees) decisions.push_back(dihedral_decision(angle));
  const double largest = decisions.empty() ? 0.0 : *std::max_element(decisions.begin(), decisions.end());
  struct Found {
    double worst = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> n_below;
  };
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  std::vector<Found> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    Found mine;
    mine.n_below.assign(decisions.size(), 0);
    for_low_dihedrals(
        mesh, known, par::part_begin(n, n_parts, part), par::part_begin(n, n_parts, part + 1), counts,
        [&] { return std::max(largest, mine.worst); },
        [&](std::size_t, double value) {
          mine.worst = std::min(mine.worst, value);
          for (std::size_t k = 0; k < decisions.size(); ++k) mine.n_below[k] += value < decisions[k] ? 1 : 0;
        });
    found[static_cast<std::size_t>(part)] = std::move(mine);
  });
  AngleTally all;
  all.n_cells = mesh.n_logical_cells();
  all.n_below.assign(decisions.size(), 0);
  all.worst = kRegularDihedral;
  for (const Found& part : found) {
    all.worst = std::min(all.worst, part.worst);
    for (std::size_t k = 0; k < decisions.size(); ++k) all.n_below[k] += part.n_below[k];
  }
  all.smallest = report_value(Metric::kMinDihedral, all.worst);
  return all;
}

std::size_t n_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  return tally_below(mesh, std::span(&degrees, 1), policy).n_below[0];
}

std::vector<CellHandle> invalid_cells(const TetMesh& mesh, par::Policy policy, const KnownValues& known) {
  const std::span<const double> values = known.sines.empty() ? known.dihedrals : known.sines;
  HFR_ASSERT(values.empty() || values.size() == mesh.n_cells());
  return cells_that(mesh, policy, [&](std::size_t begin, std::size_t end, std::vector<CellHandle>& found) {
    const auto see = [&](std::size_t i, double value) {
      if (!(value > 0) && is_invalid(mesh, CellHandle(i))) found.push_back(CellHandle(i));
    };
    if (values.empty())
      for_decisions(mesh, MinSine2{}, begin, end, see);
    else
      for (std::size_t i = begin; i < end; ++i) see(i, values[i]);
  });
}

std::vector<CellHandle> cells_below(const TetMesh& mesh, double degrees, par::Policy policy,
                                    const KnownValues& known) {
  const double goal = dihedral_decision(degrees);
  return cells_that(mesh, policy, [&](std::size_t begin, std::size_t end, std::vector<CellHandle>& found) {
    for_low_dihedrals(
        mesh, known, begin, end, {}, [&] { return goal; },
        [&](std::size_t i, double value) {
          if (value < goal) found.push_back(CellHandle(i));
        });
  });
}

std::vector<CellHandle> worst_cells_below(const TetMesh& mesh, double degrees, std::size_t n,
                                          par::Policy policy, std::span<const CellHandle> but,
                                          const KnownValues& known) {
  std::vector<std::pair<double, CellHandle>> ranked;
  for (CellHandle c : cells_below(mesh, degrees, policy, known))
    if (!std::binary_search(but.begin(), but.end(), c)) ranked.emplace_back(min_dihedral_of(mesh, c), c);
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(std::min(n, ranked.size()));
  std::partial_sort(ranked.begin(), end, ranked.end());
  std::vector<CellHandle> cells;
  for (auto at = ranked.begin(); at != end; ++at) cells.push_back(at->second);
  return cells;
}

double degrees_with_few_below(const TetMesh& mesh, double degrees, std::size_t n, par::Policy policy,
                              const KnownValues& known) {
  const auto worst = worst_cells_below(mesh, degrees, n + 1, policy, {}, known);
  if (worst.size() <= n) return degrees;
  return report_value(Metric::kMinDihedral, min_dihedral_of(mesh, worst.back()));
}

}  // namespace hfr
