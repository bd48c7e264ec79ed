// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Survey.hh"

#include <algorithm>
#include <limits>
#include <utility>

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

/// Cells with keep(cell, decision value), ascending.
template <class Metric, class Keep>
std::vector<CellHandle> cells_where(const TetMesh& mesh, const Metric& metric, par::Policy policy,
                                    Keep&& keep) {
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  std::vector<std::vector<CellHandle>> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    auto& mine = found[static_cast<std::size_t>(part)];
    for_decisions(mesh, metric, par::part_begin(n, n_parts, part), par::part_begin(n, n_parts, part + 1),
                  [&](std::size_t i, double value) {
                    if (keep(CellHandle(i), value)) mine.push_back(CellHandle(i));
                  });
  });
  std::vector<CellHandle> cells = std::move(found[0]);
  for (std::size_t part = 1; part < found.size(); ++part)
    cells.insert(cells.end(), found[part].begin(), found[part].end());
  return cells;
}

}  // namespace

Survey survey(const TetMesh& mesh, par::Policy policy) {
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  std::vector<Survey> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    Survey mine{std::numeric_limits<double>::infinity(), 0};
    // The smallest sine is the cheaper form and, of positive cells, never above the smallest dihedral's,
    // which therefore only cells that may set a new record are asked for. Of an inverted cell both are
    // negative, and the smallest sine, which may be an obtuse angle's, is the nearer one to 0.
    for_decisions(mesh, MinSine2{}, par::part_begin(n, n_parts, part), par::part_begin(n, n_parts, part + 1),
                  [&](std::size_t i, double value) {
                    if (value < mine.worst || !(value > 0))
                      mine.worst = std::min(mine.worst, min_dihedral_of(mesh, CellHandle(i)));
                    if (!(value > 0) && is_invalid(mesh, CellHandle(i))) ++mine.n_invalid;
                  });
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
                       const std::function<bool(CellHandle)>& counts) {
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
    for_decisions(mesh, MinDihedral{}, par::part_begin(n, n_parts, part),
                  par::part_begin(n, n_parts, part + 1), [&](std::size_t i, double value) {
                    if (!(value < largest) && !(value < mine.worst)) return;
                    if (counts && !counts(CellHandle(i))) return;
                    mine.worst = std::min(mine.worst, value);
                    for (std::size_t k = 0; k < decisions.size(); ++k)
                      mine.n_below[k] += value < decisions[k] ? 1 : 0;
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

double share_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  return static_cast<double>(n_below(mesh, degrees, policy)) / static_cast<double>(mesh.n_logical_cells());
}

std::vector<CellHandle> invalid_cells(const TetMesh& mesh, par::Policy policy) {
  return cells_where(mesh, MinSine2{}, policy,
                     [&](CellHandle c, double value) { return !(value > 0) && is_invalid(mesh, c); });
}

std::vector<CellHandle> cells_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  const double goal = dihedral_decision(degrees);
  return cells_where(mesh, MinDihedral{}, policy, [&](CellHandle, double value) { return value < goal; });
}

std::vector<CellHandle> worst_cells_below(const TetMesh& mesh, double degrees, std::size_t n,
                                          par::Policy policy, std::span<const CellHandle> but) {
  std::vector<std::pair<double, CellHandle>> ranked;
  for (CellHandle c : cells_below(mesh, degrees, policy))
    if (!std::binary_search(but.begin(), but.end(), c)) ranked.emplace_back(min_dihedral_of(mesh, c), c);
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(std::min(n, ranked.size()));
  std::partial_sort(ranked.begin(), end, ranked.end());
  std::vector<CellHandle> cells;
  for (auto at = ranked.begin(); at != end; ++at) cells.push_back(at->second);
  return cells;
}

double degrees_with_few_below(const TetMesh& mesh, double degrees, std::size_t n, par::Policy policy) {
  const auto worst = worst_cells_below(mesh, degrees, n + 1, policy);
  if (worst.size() <= n) return degrees;
  return report_value(Metric::kMinDihedral, min_dihedral_of(mesh, worst.back()));
}

}  // namespace hfr
