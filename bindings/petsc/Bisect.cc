// SPDX-License-Identifier: BSD-3-Clause
// An edge is halved once it has to be, on all ranks that know its ends. A cell with such an edge is halved by
// its longest one: then that has to be, too. These are the edges of the smallest set in which each cell with
// an edge of it has its longest one in it, whatever the order in which they are found.
#include "Bisect.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr::petsc {
namespace {

/// Halves of halves are exact but for rounding: three of them are an eighth.
constexpr double kRounding = 1 + 1e-9;

using IdPair = std::array<VertexId, 2>;

class Bisection {
 public:
  Bisection(mpi::Comm& comm, Simplices& mine) : comm_(comm), mine_(mine) {
    for (Index v = 0; v < mine_.points.size(); ++v) vertex_of_.emplace(mine_.ids[v], v);
    stamp_.assign(mine_.points.size(), 0);
    seen_.assign(mine_.cells.size(), 0);
  }

  void run() {
    do halve_cells();
    while (hear_of_others());
    halve_labelled(mine_.faces);
    halve_labelled(mine_.edges);
  }

 private:
  using Edge = std::array<Index, 2>;
  /// No two edges are alike.
  using Length = std::tuple<double, VertexId, VertexId>;

  static std::uint64_t key(Edge e) {
    return static_cast<std::uint64_t>(std::min(e[0], e[1])) << 32 | std::max(e[0], e[1]);
  }
  IdPair ids(Edge e) const {
    const auto& [a, b] = std::minmax(mine_.ids[e[0]], mine_.ids[e[1]]);
    return {a, b};
  }
  Length length(Edge e) const {
    const Vec3 d = mine_.points[e[1]] - mine_.points[e[0]];
    const IdPair id = ids(e);
    return {dot(d, d), id[1], id[0]};
  }
  template <std::size_t N>
  Edge longest_edge(const std::array<Index, N>& v) const {
    Edge longest = {v[0], v[1]};
    Length most = length(longest);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = i + 1; j < N; ++j) {
        const Length other = length({v[i], v[j]});
        if (!(other > most)) continue;
        most = other;
        longest = {v[i], v[j]};
      }
    return longest;
  }
  template <std::size_t N>
  bool has_halved_edge(const std::array<Index, N>& v) const {
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = i + 1; j < N; ++j)
        if (middle_.contains(key({v[i], v[j]}))) return true;
    return false;
  }

  /// The vertex in the middle of an edge that is halved from now on. True where it was not before.
  std::pair<Index, bool> halve(Edge e) {
    const auto [at, is_new] = middle_.emplace(key(e), static_cast<Index>(mine_.points.size()));
    if (!is_new) return {at->second, false};
    if (mine_.points.size() >= std::numeric_limits<Index>::max())
      throw ResourceLimit("halving makes more vertices than an index can count on one rank");
    const IdPair id = ids(e);
    const VertexId middle = {mix64(id[0].a ^ mix64(id[1].a)), mix64(~id[0].b ^ mix64(~id[1].b))};
    mine_.points.push_back((mine_.points[e[0]] + mine_.points[e[1]]) * 0.5);
    mine_.ids.push_back(middle);
    if (!mine_.sizes.empty()) mine_.sizes.push_back(size_between(e));
    mine_.is_shared.push_back(mine_.is_shared[e[0]] != 0 && mine_.is_shared[e[1]] != 0 ? 1 : 0);
    vertex_of_.emplace(middle, at->second);
    ++clock_;
    stamp_.push_back(clock_);
    stamp_[e[0]] = stamp_[e[1]] = clock_;
    return {at->second, true};
  }

  bool is_too_large(const Simplices::Cell& c) const {
    if (c.largest > 0 && volume_of(mine_, c) > kRounding * c.largest) return true;
    for (std::size_t i = 0; i < 4 && !mine_.sizes.empty(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (is_too_long({c.v[i], c.v[j]})) return true;
    return false;
  }
  bool is_too_long(Edge e) const {
    const Vec3 d = mine_.points[e[1]] - mine_.points[e[0]];
    const double size = size_between(e);
    return dot(d, d) > 2 * size * size;
  }
  double size_between(Edge e) const { return 0.5 * (mine_.sizes[e[0]] + mine_.sizes[e[1]]); }
  bool has_to_be_halved(std::size_t c) {
    if (is_too_large(mine_.cells[c])) return true;
    // Without an edge that was halved since it was looked at: those make both of its ends newer.
    const auto is_newer = [&](Index v) { return stamp_[v] > seen_[c]; };
    if (std::ranges::count_if(mine_.cells[c].v, is_newer) < 2) return false;
    if (has_halved_edge(mine_.cells[c].v)) return true;
    seen_[c] = clock_;
    return false;
  }

  void halve_cells() {
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (std::size_t c = 0; c < mine_.cells.size(); ++c)  // which grow
        while (has_to_be_halved(c)) {
          halve_cell(c);
          goes_on = true;
        }
    }
  }

  void halve_cell(std::size_t c) {
    const Edge e = longest_edge(mine_.cells[c].v);
    const auto [middle, is_new] = halve(e);
    if (is_new && mine_.is_shared[middle] != 0) told_.push_back(ids(e));
    Simplices::Cell other = mine_.cells[c];
    std::ranges::replace(mine_.cells[c].v, e[1], middle);
    std::ranges::replace(other.v, e[0], middle);
    mine_.cells.push_back(other);
    seen_[c] = 0;
    seen_.push_back(0);
  }

  /// False where nobody has halved anything that another may have.
  bool hear_of_others() {
    const std::vector<IdPair> all = comm_.all_gather(std::span<const IdPair>(told_));
    told_.clear();
    for (const IdPair& id : all) {
      const auto a = vertex_of_.find(id[0]), b = vertex_of_.find(id[1]);
      if (a != vertex_of_.end() && b != vertex_of_.end()) halve({a->second, b->second});
    }
    return !all.empty();
  }

  /// Faces as the cells at them, edges until no half has a middle.
  template <std::size_t N>
  void halve_labelled(std::vector<Simplices::Labelled<N>>& items) {
    for (std::size_t i = 0; i < items.size(); ++i)  // which grow
      while (has_halved_edge(items[i].v)) {
        const Edge e = longest_edge(items[i].v);
        const auto [middle, is_new] = halve(e);
        if (is_new) throw InternalError("a labelled face has a longest edge that no cell has halved");
        auto other = items[i];
        std::ranges::replace(items[i].v, e[1], middle);
        std::ranges::replace(other.v, e[0], middle);
        items.push_back(other);
      }
  }

  mpi::Comm& comm_;
  Simplices& mine_;
  std::map<VertexId, Index> vertex_of_;
  std::unordered_map<std::uint64_t, Index> middle_;  // by edge
  std::uint64_t clock_ = 0;
  std::vector<std::uint64_t> stamp_;  // by vertex: when an edge at it was halved last
  std::vector<std::uint64_t> seen_;   // by cell: when it had none that was
  std::vector<IdPair> told_;          // halved since the last exchange
};

}  // namespace

double volume_of(const Simplices& mine, const Simplices::Cell& c) {
  const auto p = [&](std::size_t i) { return mine.points[c.v[i]]; };
  return std::abs(dot(cross(p(1) - p(0), p(2) - p(0)), p(3) - p(0))) / 6;
}

void bisect(mpi::Comm& comm, Simplices& mine) {
  const bool asks = !mine.sizes.empty() ||
                    std::ranges::any_of(mine.cells, [](const Simplices::Cell& c) { return c.largest > 0; });
  if (comm.sum(asks ? 1 : 0) > 0) Bisection(comm, mine).run();
}

}  // namespace hfr::petsc
