// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Survey.hh"

#include <algorithm>
#include <limits>
#include <numeric>
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

std::size_t n_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  const double goal = dihedral_decision(degrees);
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  std::vector<std::size_t> found(static_cast<std::size_t>(n_parts), 0);
  par::parts(n_parts, [&](int part) {
    std::size_t mine = 0;
    for_decisions(mesh, MinDihedral{}, par::part_begin(n, n_parts, part),
                  par::part_begin(n, n_parts, part + 1),
                  [&](std::size_t, double value) { mine += value < goal ? 1 : 0; });
    found[static_cast<std::size_t>(part)] = mine;
  });
  return std::accumulate(found.begin(), found.end(), std::size_t{0});
}

double share_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  return static_cast<double>(n_below(mesh, degrees, policy)) / static_cast<double>(mesh.n_logical_cells());
}

std::vector<CellHandle> invalid_cells(const TetMesh& mesh, par::Policy policy) {
  const auto indices = par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t i) {
    return !mesh.is_deleted(CellHandle(i)) && is_invalid(mesh, CellHandle(i));
  });
  std::vector<CellHandle> cells;
  cells.reserve(indices.size());
  for (Index i : indices) cells.push_back(CellHandle(i));
  return cells;
}

std::vector<CellHandle> cells_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  const double goal = dihedral_decision(degrees);
  std::vector<CellHandle> cells;
  for (Index i : par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t c) {
         return !mesh.is_deleted(CellHandle(c)) && min_dihedral_of(mesh, CellHandle(c)) < goal;
       }))
    cells.push_back(CellHandle(i));
  return cells;
}

std::vector<CellHandle> worst_cells_below(const TetMesh& mesh, double degrees, std::size_t n,
                                          par::Policy policy) {
  std::vector<std::pair<double, CellHandle>> ranked;
  for (CellHandle c : cells_below(mesh, degrees, policy)) ranked.emplace_back(min_dihedral_of(mesh, c), c);
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
