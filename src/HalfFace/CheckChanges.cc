// SPDX-License-Identifier: BSD-3-Clause
// Quick tests that a sound place passes, and for the few places that do not, slow ones that name what is
// wrong. The quick one of a vertex goes by Euler's formula: cells that connect through faces round a vertex
// make a connected surface of triangles, its link. Of a closed one with T triangles V - T/2 is at most 2, of
// one with B edges on its boundary V - (T + B)/2 at most 1. Where the different vertices alone make up that
// number, the link has each of them once: every edge of the vertex has one ring of cells.
#include "HalfFace/Check.hh"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "HalfFace/RawArray.hh"
#include "Parallel/Atomic.hh"
#include "Parallel/DisjointSets.hh"
#include "Parallel/Interleave.hh"

namespace hfr {
namespace {

constexpr double kVertexNanoseconds = 500;

/// The vertices of cell c that are not v, in the order that makes (v, x, y, z) positive.
std::array<VertexHandle, 3> seen_from(const Cell& cell, VertexHandle v) {
  const auto& f = kFaceCorners[static_cast<std::size_t>(cell.corner(v))];
  return {cell.v[f[0]], cell.v[f[1]], cell.v[f[2]]};
}

/// The link of a vertex: its vertices, numbered as they come, and from which of them an edge of a triangle
/// leads to which. Room for kMost vertices; a larger link takes another way.
class SmallLink {
 public:
  static constexpr unsigned kMost = 64;

  /// Number of the vertex; kMost where there are more.
  unsigned number(VertexHandle v) {
    std::size_t at = static_cast<std::uint32_t>(v.idx()) * 0x9e3779b1U >> 24;
    for (; number_[at] != 0; at = (at + 1) % kSlots)
      if (vertices_[number_[at] - 1U] == v) return number_[at] - 1U;
    if (size_ == kMost) return kMost;
    vertices_[size_] = v;
    after_[size_] = 0;
    number_[at] = static_cast<std::uint8_t>(++size_);
    return size_ - 1;
  }
  unsigned size() const { return size_; }
  /// False when the edge was there.
  bool add_edge(unsigned a, unsigned b) {
    const std::uint64_t bit = std::uint64_t{1} << b;
    const bool is_new = (after_[a] & bit) == 0;
    after_[a] |= bit;
    return is_new;
  }
  bool has_edge(unsigned a, unsigned b) const { return (after_[a] >> b & 1) != 0; }

 private:
  static constexpr std::size_t kSlots = 256;
  unsigned size_ = 0;
  std::array<std::uint8_t, kSlots> number_{};  // by hash: 1 + number; 0: none
  RawArray<VertexHandle, kMost> vertices_;
  RawArray<std::uint64_t, kMost> after_;  // by number: a bit for each vertex that an edge leads to
};

/// The same for a link of any size.
class LargeLink {
 public:
  static constexpr unsigned kMost = 0xffffffffU;

  unsigned number(VertexHandle v) {
    return numbers_.try_emplace(v.idx(), static_cast<unsigned>(numbers_.size())).first->second;
  }
  unsigned size() const { return static_cast<unsigned>(numbers_.size()); }
  bool add_edge(unsigned a, unsigned b) { return edges_.insert(key(a, b)).second; }
  bool has_edge(unsigned a, unsigned b) const { return edges_.count(key(a, b)) != 0; }

 private:
  static std::uint64_t key(unsigned a, unsigned b) { return std::uint64_t{a} << 32 | b; }
  std::unordered_map<Index, unsigned> numbers_;
  std::unordered_set<std::uint64_t> edges_;
};

/// How far the cells of a vertex are from a manifold, by their vertices alone.
struct Defects {
  std::size_t components = 0;  ///< sets of cells that connect through faces of the vertex, beyond the first
  std::size_t fans = 0;        ///< the same at its edges, summed up
  std::size_t crowds = 0;      ///< faces with more than two cells
};

class ChangeChecker {
 public:
  ChangeChecker(const TetMesh& mesh, const TetMesh& before, par::Policy policy)
      : mesh_(mesh), before_(before), policy_(policy) {}

  CheckResult run() {
    mark();
    if (!cells_fit()) return named(Rule::kDuplicateFace);
    const std::vector<VertexHandle> doubtful = vertices_in_doubt();
    if (doubtful.empty()) return {};
    const auto now = defects_of(mesh_, doubtful);
    const auto once = defects_of(before_, doubtful);
    for (std::size_t i = 0; i < doubtful.size(); ++i) {
      const VertexHandle v = doubtful[i];
      if (now[i].crowds > 0) return named(Rule::kDuplicateFace);
      if (now[i].fans > once[i].fans)
        return offence(Rule::kDuplicateEdge, v, "an edge has more fans or rings of cells than it had");
      if (now[i].components > once[i].components)
        return offence(Rule::kNonManifoldVertex, v, "fewer of its cells connect through faces than did");
    }
    return {};
  }

 private:
  /// What check() has to say, which a quick test has found to be wrong.
  CheckResult named(Rule last) const {
    CheckResult result = check(mesh_, {last, policy_});
    if (result) result = offence(Rule::kFreeList, VertexHandle(), "cells do not fit those that were changed");
    return result;
  }
  static CheckResult offence(Rule rule, VertexHandle v, const char* what) {
    CheckResult result;
    result.rule = rule;
    if (v.is_valid()) result.vertices = {v};
    result.message = (v.is_valid() ? "at vertex " + std::to_string(v.idx()) + " " : std::string()) + what;
    return result;
  }

  bool is_changed(std::size_t c) const {
    return c >= before_.n_cells() || mesh_.cell(CellHandle(c)).v != before_.cell(CellHandle(c)).v;
  }

  /// Marks the vertices of changed cells, as they are and as they were.
  void mark() {
    near_.assign(mesh_.n_vertices(), 0);
    const auto changed =
        par::compact<Index>(policy_, mesh_.n_cells(), [&](std::size_t i) { return is_changed(i); });
    const auto see = [&](const TetMesh& of, CellHandle c) {
      for (VertexHandle v : of.cell(c).v)
        if (v.idx() < near_.size()) near_[v.idx()] = 1;
    };
    for (Index c : changed) {
      see(mesh_, CellHandle(c));
      if (c < before_.n_cells()) see(before_, CellHandle(c));
    }
  }

  /// Handles were not renumbered, the free list holds the deleted cells, and cells that are new, or share a
  /// face with one that is or was there, fit their vertices and mates. One look at all cells; counts those of
  /// marked vertices on the way.
  bool cells_fit() {
    if (mesh_.n_cells() < before_.n_cells() || mesh_.n_vertices() < before_.n_vertices()) return false;
    n_cells_of_.assign(mesh_.n_vertices(), 0);
    struct Seen {
      std::size_t n_deleted = 0;
      bool fit = true;
    };
    const Seen seen = par::reduce(
        policy_, mesh_.n_cells(), Seen{},
        [&](std::size_t i) -> Seen {
          const CellHandle c(i);
          if (mesh_.is_deleted(c)) return {1, true};
          int n_near = 0;
          for (VertexHandle v : mesh_.cell(c).v) {
            if (v.idx() >= near_.size()) return {0, false};
            if (near_[v.idx()] == 0) continue;
            ++n_near;
            par::before_shared_access();
            par::atomic(n_cells_of_[v.idx()]).fetch_add(1, std::memory_order_relaxed);
          }
          return {0, n_near < 3 || cell_fits(c)};
        },
        [](Seen a, Seen b) {
          return Seen{a.n_deleted + b.n_deleted, a.fit && b.fit};
        });
    return seen.fit && free_list_fits(seen.n_deleted);
  }
  bool free_list_fits(std::size_t n_deleted) const {
    std::vector<CellHandle> free = mesh_.free_cells();
    std::sort(free.begin(), free.end());
    if (free.size() != n_deleted || std::adjacent_find(free.begin(), free.end()) != free.end()) return false;
    return std::all_of(free.begin(), free.end(),
                       [&](CellHandle c) { return c.idx() < mesh_.n_cells() && mesh_.is_deleted(c); });
  }

  bool cell_fits(CellHandle c) const {
    const Cell& k = mesh_.cell(c);
    for (std::size_t i = 0; i < 4; ++i) {
      if (mesh_.is_deleted(k.v[i]) || !mesh_.incident_cell(k.v[i]).is_valid()) return false;
      for (std::size_t j = 0; j < i; ++j)
        if (k.v[i] == k.v[j]) return false;
      const HalfFaceHandle m = k.mate[i];
      if (!m.is_valid()) continue;
      const CellHandle other = cell_of(m);
      if (other.idx() >= mesh_.n_cells() || mesh_.is_deleted(other) || other == c) return false;
      const HalfFaceHandle h = halfface_of(c, static_cast<int>(i));
      if (mesh_.opposite_halfface(m) != h) return false;
      auto mine = CyclicOrder::key(mesh_.halfface_vertices(h));
      const auto theirs = CyclicOrder::key(mesh_.halfface_vertices(m));
      std::swap(mine[1], mine[2]);
      if (mine != theirs) return false;
    }
    return true;
  }

  /// Of the marked ones, those that the quick test does not prove sound, ascending.
  std::vector<VertexHandle> vertices_in_doubt() const {
    std::vector<VertexHandle> doubtful;
    for (Index v : par::compact<Index>(
             policy_.for_items_of(kVertexNanoseconds), near_.size(),
             [&](std::size_t i) { return near_[i] != 0 && !is_sound(VertexHandle(i), n_cells_of_[i]); }))
      doubtful.push_back(VertexHandle(v));
    return doubtful;
  }

  bool is_sound(VertexHandle v, std::uint32_t n_cells) const {
    const CellHandle incident_cell = mesh_.incident_cell(v);
    if (n_cells == 0) return !incident_cell.is_valid();
    if (incident_cell.idx() >= mesh_.n_cells() || !mesh_.cell(incident_cell).has(v)) return false;
    Star star;
    if (!mesh_.gather_star(v, star) || static_cast<std::uint32_t>(star.size) != n_cells) return false;
    SmallLink small;
    if (const auto sound = is_disc_or_sphere(star, v, small)) return *sound;
    LargeLink large;
    return is_disc_or_sphere(star, v, large).value_or(false);
  }

  /// Whether the link is one, each vertex and edge of it there once; nothing where it does not fit in.
  template <class Link>
  std::optional<bool> is_disc_or_sphere(const Star& star, VertexHandle v, Link& link) const {
    RawArray<std::array<unsigned, 3>, Star::kCapacity> triangles;
    const auto n_cells = static_cast<unsigned>(star.size);
    for (unsigned i = 0; i < n_cells; ++i) {
      auto& t = triangles[i];
      const auto corners = seen_from(mesh_.cell(star.cells[i]), v);
      for (std::size_t k = 0; k < 3; ++k) {
        t[k] = link.number(corners[k]);
        if (t[k] == Link::kMost) return std::nullopt;
      }
      for (std::size_t k = 0; k < 3; ++k)
        if (!link.add_edge(t[k], t[(k + 1) % 3])) return false;
    }
    unsigned n_open = 0;
    for (unsigned i = 0; i < n_cells; ++i) {
      const Cell& cell = mesh_.cell(star.cells[i]);
      const auto& corners = kFaceCorners[static_cast<std::size_t>(cell.corner(v))];
      const auto& t = triangles[i];
      for (std::size_t k = 0; k < 3; ++k) {
        if (cell.mate[corners[(k + 2) % 3]].is_valid()) continue;
        ++n_open;
        if (link.has_edge(t[(k + 1) % 3], t[k])) return false;
      }
    }
    if (n_open > 0) return 2 * link.size() == 2 + n_cells + n_open;
    return n_cells >= 4 && 2 * link.size() == 4 + n_cells;
  }

  /// Of the cells round each of the vertices, which are ascending.
  static std::vector<Defects> defects_of(const TetMesh& mesh, const std::vector<VertexHandle>& vertices) {
    std::vector<std::vector<std::array<VertexHandle, 3>>> links(vertices.size());
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
      const Cell& cell = mesh.cell(CellHandle(i));
      if (!cell.v[0].is_valid()) continue;
      for (VertexHandle v : cell.v) {
        const auto at = std::lower_bound(vertices.begin(), vertices.end(), v);
        if (at != vertices.end() && *at == v)
          links[static_cast<std::size_t>(at - vertices.begin())].push_back(seen_from(cell, v));
      }
    }
    std::vector<Defects> all;
    for (const auto& link : links) all.push_back(defects(link));
    return all;
  }

  static Defects defects(const std::vector<std::array<VertexHandle, 3>>& link) {
    // Triangles joined across edges, and corners joined across the edges at their vertex.
    par::DisjointSets<std::size_t> triangles(link.size()), corners(3 * link.size());
    Defects found;
    std::size_t n_triangles = link.size(), n_corners = corners.size();
    std::map<std::array<VertexHandle, 2>, std::vector<std::size_t>> at_edge;  // 3 · triangle + side
    std::set<VertexHandle> vertices;
    for (std::size_t i = 0; i < link.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        vertices.insert(link[i][k]);
        at_edge[AnyOrder::key(std::array<VertexHandle, 2>{link[i][k], link[i][(k + 1) % 3]})].push_back(
            3 * i + k);
      }
    }
    for (const auto& [ends, sides] : at_edge) {
      if (sides.size() > 2) ++found.crowds;
      for (std::size_t s = 1; s < sides.size(); ++s) {
        n_triangles -= triangles.join(sides[0] / 3, sides[s] / 3) ? 1 : 0;
        for (std::size_t a = 0; a < 2; ++a) {
          const auto corner_at = [&](std::size_t side) { return side / 3 * 3 + (side % 3 + a) % 3; };
          const VertexHandle w = link[sides[0] / 3][(sides[0] % 3 + a) % 3];
          const auto there = [&](std::size_t side) {
            const std::size_t first = corner_at(side);
            if (link[first / 3][first % 3] == w) return first;
            return side / 3 * 3 + (side % 3 + 1 - a) % 3;
          };
          n_corners -= corners.join(there(sides[0]), there(sides[s])) ? 1 : 0;
        }
      }
    }
    found.components = n_triangles > 0 ? n_triangles - 1 : 0;
    found.fans = n_corners - vertices.size();
    return found;
  }

  const TetMesh& mesh_;
  const TetMesh& before_;
  par::Policy policy_;
  std::vector<std::uint8_t> near_;         // per vertex: 1 where marked
  std::vector<std::uint32_t> n_cells_of_;  // of marked vertices
};

}  // namespace

CheckResult check_changes(const TetMesh& mesh, const TetMesh& before, par::Policy policy) {
  return ChangeChecker(mesh, before, policy).run();
}

}  // namespace hfr
