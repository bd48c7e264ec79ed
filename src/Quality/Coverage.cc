// SPDX-License-Identifier: BSD-3-Clause
// One pass over the cells counts, at each vertex, those in which one direction leads, and the opposite one.
// At an inner vertex there is one of each, or as many as times that the cells cover all directions. At a
// vertex of the boundary, whose faces are one closed fan and do not cross, they cover the directions on one
// side of the faces once more than those on the other: where one of the two directions leads in no cell,
// nothing is covered twice. Where both lead in one, or one of them too near to a face to tell, the cells
// round each edge of the vertex are walked.
#include "Quality/Coverage.hh"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"
#include "Quality/Metrics.hh"

namespace hfr {
namespace {

constexpr double kCellNanoseconds = 20;
constexpr double kWalkNanoseconds = 300;
/// Along no axis or diagonal, so that it lies in no face of a grid.
constexpr Vec3 kDirection{0.8507350102, 0.4415211327, 0.2851530273};
/// An area below so many times the square of an edge may have either sign.
constexpr double kSure = 1e-13;

// What is known of a vertex, in one word: two numbers, and flags.
constexpr std::uint32_t kAhead = 1, kBehind = 1U << 14;
constexpr std::uint32_t kUnsure = 1U << 28, kNotPositive = 1U << 29, kOnBoundary = 1U << 30;
std::uint32_t n_ahead(std::uint32_t word) { return word % kBehind; }
std::uint32_t n_behind(std::uint32_t word) { return word % kUnsure / kBehind; }

/// Calls visit(corner, what) for what a cell says of its corners, but for the boundary.
template <class Visit>
void count_in(const TetMesh& mesh, CellHandle c, Visit&& visit) {
  const auto& v = mesh.cell(c).v;
  const Vec3 a = mesh.point(v[0]);
  const Vec3 b = mesh.point(v[1]) - a, d = mesh.point(v[2]) - a, e = mesh.point(v[3]) - a;
  // By the corner opposite a face: positive where the direction leads through it from outside.
  std::array<double, 4> inward = {0, dot(cross(d, e), kDirection), dot(cross(e, b), kDirection),
                                  dot(cross(b, d), kDirection)};
  inward[0] = -(inward[1] + inward[2] + inward[3]);
  if (!(dot(cross(b, d), e) > 0)) {
    for (std::size_t i = 0; i < 4; ++i) visit(i, kNotPositive);
    return;
  }
  const double least = kSure * std::max({dot(b, b), dot(d, d), dot(e, e)});
  unsigned enters = 0;
  bool is_sure = true;
  for (unsigned i = 0; i < 4; ++i) {
    enters |= static_cast<unsigned>(inward[i] > 0) << i;
    is_sure = is_sure && std::abs(inward[i]) > least;
  }
  if (!is_sure)
    for (std::size_t i = 0; i < 4; ++i) visit(i, kUnsure);
  else if (std::popcount(enters) == 3)
    visit(static_cast<std::size_t>(std::countr_one(enters)), kAhead);
  else if (std::popcount(enters) == 1)
    visit(static_cast<std::size_t>(std::countr_zero(enters)), kBehind);
}

/// How often the cells round the edge from a to b, counter-clockwise from `start` to the boundary or once all
/// the way round, come forward to where they began rather than back.
int n_turns(const TetMesh& mesh, VertexHandle a, VertexHandle b, RingPlace start) {
  const auto side = [&](VertexHandle x, VertexHandle y) {
    return x == y ? 0 : orientation(mesh.point(a), mesh.point(b), mesh.point(x), mesh.point(y));
  };
  const VertexHandle begin = mesh.cell(start.cell).v[start.p];
  int n = 0;
  int from = 0;  // negative: less than half a turn before the beginning
  RingPlace at = start;
  do {
    const auto& corners = mesh.cell(at.cell).v;
    const VertexHandle p = corners[at.p], q = corners[at.q];
    const int to = side(begin, q);
    // The way from p to q, of less than half a turn, may lead over the beginning or over what is opposite.
    if (from < 0 && to >= 0 && side(p, q) > 0) ++n;
    if (from >= 0 && to < 0 && side(p, q) < 0) --n;
    from = to;
    at = mesh.next_in_ring(at);
  } while (at.cell.is_valid() && at.cell != start.cell);
  return n;
}

bool is_wound(const TetMesh& mesh, EdgeHandle edge) {
  const HalfEdgeHandle e = TetMesh::halfedge_handle(edge, 0);
  RingPlace first = mesh.ring_place(e);
  const CellHandle any = first.cell;
  RingPlace before = mesh.previous_in_ring(first);
  while (before.cell.is_valid() && before.cell != any) {
    first = before;
    before = mesh.previous_in_ring(first);
  }
  const int n_allowed = before.cell.is_valid() ? 1 : 0;
  return n_turns(mesh, mesh.from_vertex(e), mesh.to_vertex(e), first) > n_allowed;
}

/// Whether the cells round an edge of a marked vertex go round it more than once.
bool has_wound_edge(const TetMesh& mesh, par::Policy policy, const std::vector<std::uint8_t>& is_marked) {
  const auto has_one = [&](CellHandle c) {
    const auto& corners = mesh.cell(c).v;
    std::array<bool, 4> marked{};
    for (std::size_t i = 0; i < 4; ++i) marked[i] = is_marked[corners[i].idx()] != 0;
    for (std::size_t k = 0; k < kEdgeCorners.size(); ++k) {
      if (!marked[kEdgeCorners[k][0]] && !marked[kEdgeCorners[k][1]]) continue;
      const EdgeHandle e(6 * c.idx() + static_cast<Index>(k));
      if (mesh.exists(e) && is_wound(mesh, e)) return true;
    }
    return false;
  };
  return !par::compact<Index>(policy.for_items_of(kWalkNanoseconds), mesh.n_cells(), [&](std::size_t i) {
            return mesh.exists(CellHandle(i)) && has_one(CellHandle(i));
          }).empty();
}

/// The same at the edges of the boundary at v, on the part of its cells that a walk sees.
bool is_wound_round(const TetMesh& mesh, VertexHandle v) {
  for (CellHandle c : mesh.vertex_cells(v))
    for (HalfFaceHandle h : mesh.cell_halffaces(c)) {
      const auto f = mesh.halfface_vertices(h);
      const auto at = static_cast<std::size_t>(std::find(f.begin(), f.end(), v) - f.begin());
      if (at == f.size() || !mesh.is_boundary(h)) continue;
      // Where the cells round the edge to the next vertex of the face begin.
      const RingPlace start{c, mesh.cell(c).own_corner(f[(at + 2) % 3]),
                            static_cast<std::uint8_t>(corner_of(h))};
      if (n_turns(mesh, v, f[(at + 1) % 3], start) > 0) return true;
    }
  return false;
}

}  // namespace

bool covers_twice(const TetMesh& mesh, par::Policy policy, const std::function<bool(VertexHandle)>& at) {
  std::vector<std::uint32_t> words(mesh.n_vertices(), 0);
  const auto note = [&](VertexHandle v, std::uint32_t what) {
    const auto word = par::atomic(words[v.idx()]);
    par::before_shared_access();
    if (what >= kUnsure)
      word.fetch_or(what, std::memory_order_relaxed);
    else
      word.fetch_add(what, std::memory_order_relaxed);
  };
  par::for_each(policy.for_items_of(kCellNanoseconds), mesh.n_cells(), [&](std::size_t i) {
    const CellHandle c(i);
    if (mesh.is_deleted(c)) return;
    const Cell& cell = mesh.cell(c);
    count_in(mesh, c, [&](std::size_t corner, std::uint32_t what) { note(cell.v[corner], what); });
    for (std::size_t k = 0; k < 4; ++k) {
      if (cell.mate[k].is_valid()) continue;
      for (VertexHandle v : mesh.halfface_vertices(halfface_of(c, static_cast<int>(k)))) note(v, kOnBoundary);
    }
  });
  enum Verdict : std::uint8_t { kOnce, kToWalk, kTwice };
  const auto verdict = [&](std::size_t v) {
    const std::uint32_t word = words[v];
    if (word == 0 || (at && !at(VertexHandle(v)))) return kOnce;
    if ((word & kNotPositive) != 0 || n_ahead(word) > 1 || n_behind(word) > 1) return kTwice;
    const bool both = n_ahead(word) > 0 && n_behind(word) > 0;
    return (word & kUnsure) != 0 || (both && (word & kOnBoundary) != 0) ? kToWalk : kOnce;
  };
  std::vector<std::uint8_t> to_walk(mesh.n_vertices(), 0);
  const Verdict worst = par::reduce(
      policy, words.size(), kOnce,
      [&](std::size_t v) {
        const Verdict here = verdict(v);
        to_walk[v] = here == kToWalk ? 1 : 0;
        return here;
      },
      [](Verdict a, Verdict b) { return std::max(a, b); });
  return worst == kTwice || (worst == kToWalk && has_wound_edge(mesh, policy, to_walk));
}

bool is_wound_at(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy) {
  return !par::compact<std::size_t>(policy.for_items_of(kWalkNanoseconds), vertices.size(),
                                    [&](std::size_t i) { return is_wound_round(mesh, vertices[i]); })
              .empty();
}

}  // namespace hfr
