// SPDX-License-Identifier: BSD-3-Clause
// The boundary edge removal of Klingner & Shewchuk, Aggressive tetrahedral mesh improvement, 2007, for any
// part of a ring: the polygon of its outer vertices is triangulated as in edge removal (Klincsek 1980).
#include "Operators/FanMerge.hh"

#include <algorithm>
#include <limits>

#include "Operators/Klincsek.hh"
#include "Operators/Metrics.hh"

namespace hfr {
namespace {

/// Cells in a row round the edge a→b, counter-clockwise; cell i has the outer vertices i and i + 1.
template <std::size_t kMaxCells>
struct Row {
  VertexHandle a, b;
  std::size_t at = 0;  ///< of the seed's cell
  FixedVector<CellHandle, kMaxCells> cells;
  FixedVector<VertexHandle, kMaxCells + 1> vertices;
};

/// At most so many cells before and after the seed's, up to a face that may not change. Those of a small ring
/// are all of it: then the first outer vertex is the last one, too.
template <std::size_t kMaxCells>
Row<kMaxCells> gather_row(const TetMesh& mesh, CellHandle c, int edge, int n_before, int n_after) {
  const auto [a, b] = mesh.edge_vertices(EdgeHandle(6 * c.idx() + static_cast<Index>(edge)));
  const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(edge)];
  Row<kMaxCells> row;
  row.a = a;
  row.b = b;
  RingPlace first{c, opposite[0], opposite[1]};
  const RingPlace start = first;
  for (int i = 0; i < n_before && !mesh.is_constrained(halfface_of(first.cell, first.q)); ++i) {
    const RingPlace next = mesh.previous_in_ring(first);
    if (next.cell == c) break;
    first = next;
    ++row.at;
  }
  const auto push = [&](RingPlace place) {
    row.cells.push_back(place.cell);
    row.vertices.push_back(mesh.cell(place.cell).v[place.p]);
  };
  RingPlace last = first;
  for (push(last); last.cell != c; push(last)) last = mesh.next_in_ring(last);
  last = start;
  for (int i = 0; i < n_after && !mesh.is_constrained(halfface_of(last.cell, last.p)); ++i) {
    const RingPlace next = mesh.next_in_ring(last);
    if (next.cell == first.cell) break;
    last = next;
    push(last);
  }
  row.vertices.push_back(mesh.cell(last.cell).v[last.q]);
  return row;
}

}  // namespace

template <class Metric>
void FanMerge<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  out.clear();
  for (CellHandle c : gather_row<kMaxCells>(mesh, seed.cell, seed.edge, seed.n_before, seed.n_after).cells)
    out.push_back(c);
}

template <class Metric>
auto FanMerge<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  const auto row = gather_row<kMaxCells>(mesh, seed.cell, seed.edge, kReach, kReach);
  const auto n = static_cast<int>(row.vertices.size());
  if (n < 4) return std::nullopt;
  RawArray<Vec3, kMaxCells + 1> p;
  for (std::size_t i = 0; i < row.vertices.size(); ++i) p[i] = mesh.point(row.vertices[i]);
  const Vec3 a = mesh.point(row.a);
  const Vec3 b = mesh.point(row.b);
  const double floor = quality[seed.cell.idx()];
  RingTriangulation table(n);
  table.solve(floor, ring_value(metric, p, a, b));
  double best = floor;
  int first = 0, last = 0;  // outer vertices
  const auto at = static_cast<int>(row.at);
  for (int i = 0; i <= at; ++i) {
    for (int j = std::max(at + 1, i + 3); j < n; ++j) {
      double worst = table.best(i, j);
      if (!(worst > best) ||
          row.vertices[static_cast<std::size_t>(i)] == row.vertices[static_cast<std::size_t>(j)])
        continue;
      worst = std::min(worst, metric(a, b, p[static_cast<std::size_t>(i)], p[static_cast<std::size_t>(j)]));
      if (!(worst > best)) continue;
      best = worst;
      first = i;
      last = j;
    }
  }
  if (last == 0) return std::nullopt;
  Plan plan;
  plan.old_worst = std::numeric_limits<double>::infinity();
  for (int i = first; i < last; ++i)
    plan.old_worst = std::min(plan.old_worst, quality[row.cells[static_cast<std::size_t>(i)].idx()]);
  plan.new_worst = best;
  plan.n_removed = static_cast<std::uint32_t>(last - first);
  plan.n_created = 2 * plan.n_removed - 1;
  plan.seed = {seed.cell, seed.edge, static_cast<std::uint8_t>(at - first),
               static_cast<std::uint8_t>(last - 1 - at)};
  table.preorder(first, last, plan.apex.data());
  for (std::uint32_t t = 0; t + 1 < plan.n_removed; ++t)
    plan.apex[t] = static_cast<std::uint8_t>(plan.apex[t] - first);
  return plan;
}

template <class Metric>
void FanMerge<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  const Seed& seed = plan.seed;
  const auto row = gather_row<kMaxCells>(mesh, seed.cell, seed.edge, seed.n_before, seed.n_after);
  const int last = static_cast<int>(row.cells.size());
  out.clear();
  for (CellHandle c : row.cells) out.removed.push_back(c);
  out.created.push_back({row.a, row.b, row.vertices[0], row.vertices[row.cells.size()]});
  append_ring_cells(row.vertices, row.a, row.b, last, plan.apex.data(), out);
}

template <class Metric>
Tet FanMerge<Metric>::identity(const TetMesh& mesh, const Seed& seed) const {
  const auto row = gather_row<kMaxCells>(mesh, seed.cell, seed.edge, seed.n_before, seed.n_after);
  Tet names = {row.a, row.b, row.vertices[0], row.vertices[row.vertices.size() - 1]};
  std::sort(names.begin(), names.end());
  return names;
}

HFR_INSTANTIATE_FOR_METRICS(FanMerge)

}  // namespace hfr
