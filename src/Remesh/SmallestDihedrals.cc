// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/SmallestDihedrals.hh"

#include <algorithm>
#include <functional>
#include <limits>

#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Survey.hh"

namespace hfr {

SmallestDihedrals::SmallestDihedrals(const Run& run)
    : run_(run), n_cells_(run.n_cells()), values_(run.mesh.n_cells()) {
  const MeshInParts* parts = run.parts();
  const std::span<const double> known = run.known().dihedrals;
  const auto put = [&](std::size_t i, double value) {
    const bool counts = !parts || run.mesh.is_deleted(CellHandle(i)) || parts->is_own(CellHandle(i));
    values_[i] = counts ? value : std::numeric_limits<double>::infinity();
  };
  par::for_ranges(run.policy(), values_.size(), [&](std::size_t begin, std::size_t end) {
    if (known.empty())
      for_decisions(run.mesh, MinDihedral{}, begin, end, put);
    else
      for (std::size_t i = begin; i < end; ++i) put(i, known[i]);
  });
}

SmallestDihedrals::SmallestDihedrals(const Run& run, std::span<const CellHandle> but)
    : SmallestDihedrals(run) {
  for (CellHandle c : but) values_[c.idx()] = std::numeric_limits<double>::infinity();
}

template <class Is>
std::size_t SmallestDihedrals::count(Is&& is) const {
  const std::size_t here = par::reduce(
      run_.policy(), values_.size(), std::size_t{0},
      [&](std::size_t i) -> std::size_t { return is(values_[i]) ? 1 : 0; }, std::plus<>{});
  return run_.is_part() ? run_.parts()->sum(here) : here;
}

std::size_t SmallestDihedrals::n_below(double decision) const {
  return count([&](double value) { return value < decision; });
}

std::size_t SmallestDihedrals::n_invalid() const {
  return count([](double value) { return !(value > 0); });
}

double SmallestDihedrals::smallest(std::size_t rank) {
  if (run_.is_part()) return run_.parts()->smallest(values_, rank);
  const auto at = values_.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::nth_element(values_.begin(), at, values_.end());
  return *at;
}

}  // namespace hfr
