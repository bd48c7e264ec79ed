// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_SMOOTH_PASS_HH
#define HFR_SCHEDULER_SMOOTH_PASS_HH

#include <algorithm>
#include <chrono>
#include <span>

#include "Operators/Smooth.hh"
#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"
#include "Quality/Damage.hh"
#include "Scheduler/StarTable.hh"
#include "Scheduler/VertexColours.hh"
#include "Scheduler/Workspace.hh"
#ifdef HFR_PARANOID
#include "Scheduler/Paranoid.hh"
#endif

namespace hfr {

/// About how long a search takes at one vertex, so that few dear ones are shared among threads as well as
/// many cheap ones. Searches that take much longer than the default say so in kVertexNanoseconds.
template <class Search>
constexpr double vertex_nanoseconds() {
  if constexpr (requires { Search::kVertexNanoseconds; })
    return Search::kVertexNanoseconds;
  else
    return 2'000;
}

/// True when with v at x more cells of the star would be invalid by the metric than are now, or the star
/// would be more damaged.
template <class Metric>
bool worsens_damage(const TetMesh& mesh, const Workspace& work, const Metric& metric, VertexHandle v,
                    std::span<const HalfFaceHandle> link, Vec3 x) {
  std::ptrdiff_t more = 0;
  Damage before, after;
  for (HalfFaceHandle h : link) {
    const CellHandle c = cell_of(h);
    if (!(quality_with(mesh, c, v, x, metric) > 0)) ++more;
    if (!(work.quality[c.idx()] > 0)) --more;
    before.add(mesh, c);
    after.add(mesh, c, v, x);
  }
  return more > 0 || (work.holds_damage && !before.may_become(after, work.floor));
}

/// Puts v at x, and notes what that changes in the cells of its link.
template <class Metric>
void move_vertex(TetMesh& mesh, Workspace& work, const Metric& metric, VertexHandle v,
                 std::span<const HalfFaceHandle> link, Vec3 x) {
  mesh.set_point(v, x);
  for (HalfFaceHandle h : link) {
    const CellHandle c = cell_of(h);
    work.quality[c.idx()] = quality_with(mesh, c, v, x, metric);
    work.pending[c.idx()] = 0xff;
    for (VertexHandle u : mesh.cell(c).v) {  // neighbours may share u: all write the same value
      par::before_shared_access();
      par::atomic(work.changed[u.idx()]).store(work.clock, std::memory_order_relaxed);
    }
  }
}

/// Smooths the vertices once, colour by colour. Vertices of one colour share no cell, so each evaluates and
/// moves by itself; a later colour sees the moves of the earlier ones.
template <class Search, class Metric>
RoundCounts smooth_pass(TetMesh& mesh, Workspace& work, const Search& search, const Metric& metric,
                        std::span<const VertexHandle> vertices, par::Policy policy) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
#ifdef HFR_PARANOID
  const detail::Paranoid paranoid(mesh, work, "pass", typeid(Search), metric);
#endif
  RoundCounts counts;
  counts.rounds = 1;
  counts.seeds = vertices.size();
  ++work.clock;
  auto start = Clock::now();
  const StarTable stars(mesh, vertices, work.star_size, policy);
  const auto groups = colour_vertices(mesh, vertices, stars, policy);
  counts.seconds_select = since(start);
  start = Clock::now();
  const par::Policy by_cost = policy.for_items_of(vertex_nanoseconds<Search>());
  std::vector<std::uint8_t> moved(vertices.size(), 0);
  for (const auto& group : groups) {
    // Stars differ much in cost, so threads take blocks as they come.
    const std::size_t block =
        std::clamp<std::size_t>(group.size() / 16 / static_cast<std::size_t>(policy.threads), 1, 64);
    par::for_each_dynamic(by_cost, group.size(), block, [&](std::size_t k) {
      const std::uint32_t i = group[k];
      const auto link = stars.link(i);
      if (link.empty()) return;
      const VertexHandle v = vertices[i];
      const std::optional<Move> move = search(mesh, v, link, metric, std::span<const double>(work.quality));
      if (!move) return;
      if (!(move->old_worst > 0) && worsens_damage(mesh, work, metric, v, link, move->target)) return;
      move_vertex(mesh, work, metric, v, link, move->target);
      moved[i] = 1;
    });
  }
  counts.winners = static_cast<std::size_t>(std::count(moved.begin(), moved.end(), std::uint8_t{1}));
  std::vector<CellHandle> cells;
  for (std::size_t i = 0; i < vertices.size() && !work.all_touched; ++i) {
    if (!moved[i]) continue;
    cells.clear();
    for (HalfFaceHandle h : stars.link(i)) cells.push_back(cell_of(h));
    work.touch(cells);
  }
  counts.candidates = counts.winners;
  counts.seconds_evaluate = since(start);
#ifdef HFR_PARANOID
  paranoid.look_again();
#endif
  return counts;
}

}  // namespace hfr

#endif
