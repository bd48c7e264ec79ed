// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Standing.hh"

#include <algorithm>
#include <cmath>
#include <utility>

#include "Quality/Metrics.hh"

namespace hfr {
namespace {

/// Relative: sums of volumes and angles that are nothing but rounded otherwise are the same.
constexpr double kSmallestGain = 1e-12;

bool is_more(double a, double b) { return a > b + kSmallestGain * std::abs(b); }

}  // namespace

Standing standing_of(const TetMesh& mesh, const Survey& found, par::Policy policy, const KnownValues& known) {
  if (found.n_invalid == 0) return standing_of(found.worst, {});
  return standing_of(found.worst, volumes_of(mesh, invalid_cells(mesh, policy, known)));
}

InvalidVolumes volumes_of(const TetMesh& mesh, std::span<const CellHandle> invalid) {
  InvalidVolumes found;
  for (CellHandle c : invalid) {
    const auto& v = mesh.cell(c).v;
    const Vec3 a = mesh.point(v[0]), b = mesh.point(v[1]), p = mesh.point(v[2]), q = mesh.point(v[3]);
    if (orientation(a, b, p, q) == 0)
      ++found.n_flat;
    else
      found.inverted.push_back(std::abs(Volume{}(a, b, p, q)) / 6.0);
  }
  return found;
}

Standing standing_of(double worst, InvalidVolumes invalid) {
  Standing standing;
  standing.worst = worst;
  standing.n_flat = invalid.n_flat;
  standing.n_inverted = invalid.inverted.size();
  std::sort(invalid.inverted.begin(), invalid.inverted.end());  // so that their sum is the same in any order
  for (double volume : invalid.inverted) standing.overlap += volume;
  return standing;
}

bool is_no_worse(const Standing& now, const Standing& before) {
  return now.n_inverted <= before.n_inverted &&
         now.n_inverted + now.n_flat <= before.n_inverted + before.n_flat &&
         !is_more(now.overlap, before.overlap) && !is_more(before.worst, now.worst);
}

bool is_better(const Standing& a, const Standing& b) {
  if (a.n_inverted != b.n_inverted) return a.n_inverted < b.n_inverted;
  if (a.n_flat != b.n_flat) return a.n_flat < b.n_flat;
  if (is_more(a.overlap, b.overlap) || is_more(b.overlap, a.overlap)) return a.overlap < b.overlap;
  return a.worst > b.worst;
}

}  // namespace hfr
