// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Statistics.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "Parallel/DisjointSets.hh"
#include "Quality/CellTotals.hh"
#include "Quality/FixedSum.hh"
#include "Quality/Metrics.hh"
#include "Quality/Ranks.hh"
#include "Quality/SurfaceStatistics.hh"

namespace hfr {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Coordinates that are no numbers are left out, whichever comes first.
struct Box {
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low = {kFar, kFar, kFar}, high = {-kFar, -kFar, -kFar};

  Box() = default;
  explicit Box(Vec3 p) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(kFar, p[d]);
      high[d] = std::max(-kFar, p[d]);
    }
  }
  friend Box united(Box a, const Box& b) {
    for (int d = 0; d < 3; ++d) {
      a.low[d] = std::min(a.low[d], b.low[d]);
      a.high[d] = std::max(a.high[d], b.high[d]);
    }
    return a;
  }
  /// Zeros where nothing is in it.
  Box or_zero() const {
    Box box = *this;
    for (int d = 0; d < 3; ++d)
      if (!(low[d] <= high[d])) box.low[d] = box.high[d] = 0;
    return box;
  }
};

/// Returns the box of those that cells have: what is measured goes by it, wherever others lie.
Box add_vertices(const TetMesh& mesh, par::Policy policy, Statistics& s) {
  const auto live = [&](std::size_t i) { return !mesh.is_deleted(VertexHandle(i)); };
  const auto sum = [](std::size_t a, std::size_t b) { return a + b; };
  s.vertices = mesh.n_logical_vertices();
  s.unused_vertices = par::reduce(
      policy, mesh.n_vertices(), std::size_t{0},
      [&](std::size_t i) {
        return static_cast<std::size_t>(live(i) && !mesh.incident_cell(VertexHandle(i)).is_valid());
      },
      sum);
  struct Boxes {
    Box all, used;
  };
  const Boxes boxes = par::reduce(
      policy, mesh.n_vertices(), Boxes{},
      [&](std::size_t i) {
        const Box here(mesh.point(VertexHandle(i)));
        return Boxes{live(i) ? here : Box(), mesh.incident_cell(VertexHandle(i)).is_valid() ? here : Box()};
      },
      [](const Boxes& a, const Boxes& b) {
        return Boxes{united(a.all, b.all), united(a.used, b.used)};
      });
  const Box all = boxes.all.or_zero();
  s.box_low = all.low;
  s.box_high = all.high;
  return boxes.used.or_zero();
}

// Of decision values; the mean is left to the caller.
Distribution distribution(Metric metric, const std::vector<double>& values, par::Policy policy) {
  Distribution d;
  if (values.empty()) return d;
  const std::size_t n = values.size();
  std::array<std::size_t, kPercentiles.size() + 1> ranks{};  // that of the smallest first
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    const auto rank = static_cast<std::size_t>(std::ceil(kPercentiles[i] / 100.0 * static_cast<double>(n)));
    ranks[i + 1] = std::clamp<std::size_t>(rank, 1, n) - 1;
  }
  const std::vector<double> found = detail::values_at(values, ranks, policy);
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) d.percentiles[i] = report_value(metric, found[i + 1]);
  d.min = report_value(metric, found[0]);
  d.max = d.percentiles.back();
  return d;
}

// Euler's formula; the characteristic of a solid is half that of its boundary.
std::size_t edge_count(const TetMesh& mesh, std::span<const HalfFaceHandle> constrained,
                       const Statistics& s) {
  std::vector<bool> on_boundary(mesh.n_vertices(), false);
  for (const HalfFaceHandle h : constrained) {
    if (mesh.opposite_halfface(h).is_valid()) continue;
    for (const VertexHandle v : mesh.halfface_vertices(h)) on_boundary[v.idx()] = true;
  }
  const auto boundary_vertices =
      static_cast<double>(std::count(on_boundary.begin(), on_boundary.end(), true));
  const double characteristic = 0.5 * (boundary_vertices - 0.5 * static_cast<double>(s.boundary_faces));
  const double edges = static_cast<double>(s.vertices - s.unused_vertices) + static_cast<double>(s.faces) -
                       static_cast<double>(s.cells) - characteristic;
  return static_cast<std::size_t>(std::llround(edges));
}

// A cell belongs to the root of its smallest neighbour, if that is smaller than itself: one look for most
// cells, and few roots are left to be joined. Threads find the roots of pieces of the mesh.
std::size_t count_components(const TetMesh& mesh, par::Policy policy) {
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  struct Part {
    std::size_t n_roots = 0;
    std::vector<std::array<Index, 2>> touching;  // roots
    std::vector<Index> at_others;                // cells with a neighbour in a part before

    void touch(Index one, Index other) {
      const std::array<Index, 2> both = {one, other};
      if (one != other && (touching.empty() || both != touching.back())) touching.push_back(both);
    }
  };
  std::vector<Part> parts(static_cast<std::size_t>(n_parts));
  std::vector<Index> number(n);  // of the root that a cell belongs to; within its part at first
  par::parts(n_parts, [&](int p) {
    Part& mine = parts[static_cast<std::size_t>(p)];
    const std::size_t begin = par::part_begin(n, n_parts, p);
    par::for_part(n, n_parts, p, [&](std::size_t i) {
      if (mesh.is_deleted(CellHandle(i))) return;
      const auto& mates = mesh.cell(CellHandle(i)).mate;
      std::size_t least = i;
      bool is_at_others = false;
      for (const HalfFaceHandle m : mates) {
        if (!m.is_valid()) continue;
        if (cell_of(m).idx() < begin)
          is_at_others = true;
        else
          least = std::min<std::size_t>(least, cell_of(m).idx());
      }
      if (is_at_others) mine.at_others.push_back(static_cast<Index>(i));
      number[i] = least == i ? static_cast<Index>(mine.n_roots++) : number[least];
      for (const HalfFaceHandle m : mates)
        if (m.is_valid() && cell_of(m).idx() >= begin && cell_of(m).idx() < i)
          mine.touch(number[cell_of(m).idx()], number[i]);
    });
  });
  std::size_t n_roots = 0;
  for (Part& part : parts) n_roots += std::exchange(part.n_roots, n_roots);  // those before it
  par::parts(n_parts, [&](int p) {
    Part& mine = parts[static_cast<std::size_t>(p)];
    const auto before = static_cast<Index>(mine.n_roots);
    par::for_part(n, n_parts, p, [&](std::size_t i) { number[i] += before; });
    for (auto& [one, other] : mine.touching) one += before, other += before;
  });
  par::parts(n_parts, [&](int p) {
    Part& mine = parts[static_cast<std::size_t>(p)];
    const std::size_t begin = par::part_begin(n, n_parts, p);
    for (const Index i : mine.at_others)
      for (const HalfFaceHandle m : mesh.cell(CellHandle(i)).mate)
        if (m.is_valid() && cell_of(m).idx() < begin) mine.touch(number[cell_of(m).idx()], number[i]);
  });
  par::DisjointSets<Index> sets(n_roots);
  std::size_t components = n_roots;
  for (const Part& part : parts)
    for (const auto& [one, other] : part.touching)
      if (sets.join(one, other)) --components;
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
  s.min_dihedral_histogram = totals.min_dihedral_histogram;
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

std::size_t n_cells_below(const Statistics& statistics, std::size_t degrees) {
  const auto& bins = statistics.min_dihedral_histogram;
  const auto first = bins.begin() + static_cast<std::ptrdiff_t>(std::min(degrees, bins.size()));
  return statistics.cells - static_cast<std::size_t>(std::accumulate(first, bins.end(), std::uint64_t{0}));
}

Statistics statistics(const TetMesh& mesh, par::Policy policy, const StatisticsOptions& options) {
  Statistics s;
  const Box box = add_vertices(mesh, policy, s);
  const double diagonal = norm(box.high - box.low);
  const double max_det = 2.0 * diagonal * diagonal * diagonal;
  detail::CellValues values;
  const detail::CellTotals totals = detail::gather_cells(mesh, policy, max_det, diagonal, values);
  add_cells(totals, max_det, s);
  s.edge_length = totals.length_bins.percentiles(s.min_edge, s.max_edge);
  s.edge_length.min = s.min_edge;
  s.edge_length.mean = s.mean_edge;
  s.edge_length.max = s.max_edge;
  s.min_dihedral = distribution(Metric::kMinDihedral, values.min_dihedral, policy);
  s.volume_length = distribution(Metric::kVolumeLength, values.volume_length, policy);
  if (options.components) s.components = count_components(mesh, policy);
  if (s.cells > 0) {
    const auto n = static_cast<double>(s.cells);
    s.min_dihedral.mean = kDegrees * totals.min_angles.value() / n;
    s.volume_length.mean = totals.volume_length.value() / n;
  }
  const Vec3 centre = 0.5 * (box.low + box.high);
  s.enclosed_volume = detail::boundary_determinant(mesh, totals.constrained, centre, max_det) / 6.0;
  if (s.enclosed_volume != 0.0) s.overlap = s.absolute_volume / std::abs(s.enclosed_volume) - 1.0;
  s.edges = edge_count(mesh, totals.constrained, s);
  if (options.surface) {
    detail::SurfaceTotals surface =
        detail::gather_surface(mesh, policy, totals.constrained, diagonal * diagonal);
    s.patches = std::move(surface.patches);
    s.surface_ceiling = surface.surface_ceiling;
    s.interface_ceiling = surface.interface_ceiling;
    s.angle_ceiling = surface.angle_ceiling;
  }
  return s;
}

}  // namespace hfr
