// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Statistics.hh"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "Parallel/DisjointSets.hh"
#include "Quality/CellTotals.hh"
#include "Quality/EdgeLengths.hh"
#include "Quality/FixedSum.hh"
#include "Quality/Metrics.hh"
#include "Quality/SurfaceStatistics.hh"

namespace hfr {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct Box {
  Vec3 low, high;
  bool empty = true;

  friend Box united(const Box& a, const Box& b) {
    if (a.empty) return b;
    if (b.empty) return a;
    return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
            {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)},
            false};
  }
};

void add_vertices(const TetMesh& mesh, par::Policy policy, Statistics& s) {
  const auto live = [&](std::size_t i) { return !mesh.is_deleted(VertexHandle(i)); };
  const auto sum = [](std::size_t a, std::size_t b) { return a + b; };
  s.vertices = mesh.n_logical_vertices();
  s.unused_vertices = par::reduce(
      policy, mesh.n_vertices(), std::size_t{0},
      [&](std::size_t i) {
        return static_cast<std::size_t>(live(i) && !mesh.incident_cell(VertexHandle(i)).is_valid());
      },
      sum);
  const Box box = par::reduce(
      policy, mesh.n_vertices(), Box{},
      [&](std::size_t i) {
        const Vec3 p = mesh.point(VertexHandle(i));
        return live(i) ? Box{p, p, false} : Box{};
      },
      [](const Box& a, const Box& b) { return united(a, b); });
  s.box_low = box.low;
  s.box_high = box.high;
}

// Puts the values of the given ranks, ascending, to their places in the sorted order: the middle rank first,
// so that each half of the ranks sees its half of the values only.
void select_ranks(std::span<double> values, std::span<const std::size_t> ranks, std::size_t offset = 0) {
  if (ranks.empty() || values.empty()) return;
  const std::size_t middle = ranks.size() / 2;
  const std::size_t at = ranks[middle] - offset;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  select_ranks(values.first(at), ranks.first(middle), offset);
  const auto above = ranks.subspan(middle + 1);
  const auto is_same = [&](std::size_t rank) { return rank == ranks[middle]; };
  const auto first_above = std::find_if_not(above.begin(), above.end(), is_same);
  select_ranks(values.subspan(at + 1), above.subspan(static_cast<std::size_t>(first_above - above.begin())),
               offset + at + 1);
}

// Of decision values; the mean is left to the caller. Reorders the values.
Distribution distribution(Metric metric, std::vector<double>& values) {
  Distribution d;
  if (values.empty()) return d;
  const std::size_t n = values.size();
  std::array<std::size_t, kPercentiles.size() + 1> ranks{};
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    const auto rank = static_cast<std::size_t>(std::ceil(kPercentiles[i] / 100.0 * static_cast<double>(n)));
    ranks[i + 1] = std::clamp<std::size_t>(rank, 1, n) - 1;
  }
  select_ranks(values, ranks);
  for (std::size_t i = 0; i < kPercentiles.size(); ++i)
    d.percentiles[i] = report_value(metric, values[ranks[i + 1]]);
  d.min = report_value(metric, values[0]);
  d.max = d.percentiles.back();
  return d;
}

// Euler's formula; the characteristic of a solid is half that of its boundary.
std::size_t edge_count(const TetMesh& mesh, const Statistics& s) {
  std::vector<bool> on_boundary(mesh.n_vertices(), false);
  for (std::size_t i = 0; i < 4 * mesh.n_cells(); ++i) {
    const HalfFaceHandle h(i);
    if (mesh.opposite_halfface(h).is_valid() || mesh.is_deleted(cell_of(h))) continue;
    for (const VertexHandle v : mesh.halfface_vertices(h)) on_boundary[v.idx()] = true;
  }
  const auto boundary_vertices =
      static_cast<double>(std::count(on_boundary.begin(), on_boundary.end(), true));
  const double characteristic = 0.5 * (boundary_vertices - 0.5 * static_cast<double>(s.boundary_faces));
  const double edges = static_cast<double>(s.vertices - s.unused_vertices) + static_cast<double>(s.faces) -
                       static_cast<double>(s.cells) - characteristic;
  return static_cast<std::size_t>(std::llround(edges));
}

std::size_t count_components(const TetMesh& mesh) {
  par::DisjointSets<Index> cells(mesh.n_cells());
  std::size_t components = mesh.n_logical_cells();
  for (std::size_t i = 0; i < 4 * mesh.n_cells(); ++i) {
    const HalfFaceHandle h(i);
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (!m.is_valid() || m < h || mesh.is_deleted(cell_of(h))) continue;
    if (cells.join(cell_of(h).idx(), cell_of(m).idx())) --components;
  }
  return components;
}

void add_cells(const detail::CellTotals& totals, double max_det, Statistics& s) {
  s.cells = totals.cells;
  s.boundary_faces = totals.boundary_faces;
  s.interface_faces = totals.interface_halffaces / 2;
  s.faces = (4 * totals.cells + totals.boundary_faces) / 2;
  s.inverted = totals.inverted;
  s.flat = totals.flat;
  s.worst_cell = totals.worst_cell;
  s.dihedral_histogram = totals.dihedral_histogram;
  s.volume_length_histogram = totals.volume_length_histogram;
  FixedSum det(max_det);
  for (const auto& [region, mine] : totals.regions) det.add(mine.det);
  s.volume = det.value() / 6.0;
  // |V| = V - 2 min(V, 0)
  s.absolute_volume = (det.value() - 2.0 * totals.negative_det.value()) / 6.0;
  for (const auto& [region, mine] : totals.regions)
    s.regions.push_back({region, mine.cells, mine.inverted, mine.flat, mine.det.value() / 6.0,
                         report_value(Metric::kMinDihedral, mine.min_decision)});
  if (totals.cells == 0) return;
  const auto n = static_cast<double>(totals.cells);
  s.mean_dihedral = kDegrees * totals.angles.value() / (6.0 * n);
  if (totals.inverted.size() < totals.cells)
    s.max_dihedral = report_value(Metric::kMaxDihedral, totals.max_decision);
  s.min_edge = std::sqrt(totals.min_length2);
  s.max_edge = std::sqrt(totals.max_length2);
  s.mean_edge = totals.lengths.value() / (6.0 * n);
}

}  // namespace

Statistics statistics(const TetMesh& mesh, par::Policy policy, const StatisticsOptions& options) {
  Statistics s;
  add_vertices(mesh, policy, s);
  const double diagonal = norm(s.box_high - s.box_low);
  const double max_det = 2.0 * diagonal * diagonal * diagonal;
  detail::CellValues values;
  const detail::CellTotals totals = detail::gather_cells(mesh, policy, max_det, diagonal, values);
  add_cells(totals, max_det, s);
  s.edge_length = detail::edge_length_percentiles(mesh, policy, s.min_edge, s.max_edge);
  s.edge_length.min = s.min_edge;
  s.edge_length.mean = s.mean_edge;
  s.edge_length.max = s.max_edge;
  constexpr int kTasks = 3;
  const int n_parts = std::min(kTasks, policy.threads);
  par::parts(n_parts, [&](int part) {
    for (int task = part; task < kTasks; task += n_parts) {
      if (task == 0) s.min_dihedral = distribution(Metric::kMinDihedral, values.min_dihedral);
      if (task == 1) s.volume_length = distribution(Metric::kVolumeLength, values.volume_length);
      if (task == 2 && options.components) s.components = count_components(mesh);
    }
  });
  if (s.cells > 0) {
    const auto n = static_cast<double>(s.cells);
    s.min_dihedral.mean = kDegrees * totals.min_angles.value() / n;
    s.volume_length.mean = totals.volume_length.value() / n;
  }
  const Vec3 centre = 0.5 * (s.box_low + s.box_high);
  s.enclosed_volume = detail::boundary_determinant(mesh, policy, centre, max_det) / 6.0;
  if (s.enclosed_volume != 0.0) s.overlap = s.absolute_volume / std::abs(s.enclosed_volume) - 1.0;
  s.edges = edge_count(mesh, s);
  if (options.surface) {
    detail::SurfaceTotals surface = detail::gather_surface(mesh, policy, diagonal * diagonal);
    s.patches = std::move(surface.patches);
    s.surface_ceiling = surface.surface_ceiling;
    s.interface_ceiling = surface.interface_ceiling;
  }
  return s;
}

}  // namespace hfr
