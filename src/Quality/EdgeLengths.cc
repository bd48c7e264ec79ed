// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/EdgeLengths.hh"

#include <algorithm>
#include <bit>
#include <cmath>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr::detail {
namespace {

/// Bits of a squared length below those that number its bin: 32 bins double it, so 64 double a length.
constexpr int kShift = 47;

std::uint64_t bin_of(double length2) { return std::bit_cast<std::uint64_t>(length2) >> kShift; }
double end_of(std::uint64_t bin) { return std::bit_cast<double>((bin + 1) << kShift); }

}  // namespace

Distribution edge_length_percentiles(const TetMesh& mesh, par::Policy policy, double least, double most) {
  Distribution d;
  const std::size_t n = mesh.n_cells();
  const std::uint64_t first = bin_of(least * least);
  if (n == 0 || !(most > 0)) return d;
  // The squares of rounded roots may be a bit smaller or larger than what the roots were taken of.
  const std::uint64_t low = first > 0 ? first - 1 : 0;
  const std::size_t n_bins = bin_of(most * most) - low + 2;
  const int n_parts = par::thread_count(policy, n);
  std::vector<std::vector<std::uint64_t>> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    std::vector<std::uint64_t> mine(n_bins, 0);
    const std::size_t end = par::part_begin(n, n_parts, part + 1);
    for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i) {
      if (mesh.is_deleted(CellHandle(i))) continue;
      const auto& v = mesh.cell(CellHandle(i)).v;
      for (const auto& e : kEdgeCorners) {
        const std::uint64_t bin = bin_of(norm2(mesh.point(v[e[0]]) - mesh.point(v[e[1]])));
        ++mine[std::clamp<std::uint64_t>(bin, low, low + n_bins - 1) - low];
      }
    }
    found[static_cast<std::size_t>(part)] = std::move(mine);
  });
  for (std::size_t p = 1; p < found.size(); ++p)
    for (std::size_t i = 0; i < n_bins; ++i) found[0][i] += found[p][i];
  const double total = 6.0 * static_cast<double>(mesh.n_logical_cells());
  std::uint64_t below = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < n_bins; ++i) {
    below += found[0][i];
    while (next < kPercentiles.size() && static_cast<double>(below) >= kPercentiles[next] / 100.0 * total)
      d.percentiles[next++] = std::clamp(std::sqrt(end_of(low + i)), least, most);
  }
  return d;
}

}  // namespace hfr::detail
