// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/NonManifold.hh"

#include <algorithm>
#include <bit>
#include <compare>
#include <tuple>
#include <utility>

#include "HalfFace/CellOrder.hh"
#include "HalfFace/Writer.hh"
#include "Parallel/Atomic.hh"
#include "Parallel/DisjointSets.hh"

namespace hfr {
namespace {

/// Some bits a vertex, for its edges to vertices of larger number: what lies near in memory stays near.
class EdgeBits {
 public:
  EdgeBits(std::size_t n_vertices, bool alone) : words_(kWords * n_vertices), alone_(alone) {}

  /// True when the bit of the edge was set before.
  bool set(VertexHandle a, VertexHandle b) {
    std::uint64_t& word = words_[word_of(a, b)];
    const std::uint64_t bit = bit_of(b);
    if (alone_) {
      const bool was_set = (word & bit) != 0;
      word |= bit;
      return was_set;
    }
    return (par::atomic(word).fetch_or(bit, std::memory_order_relaxed) & bit) != 0;
  }
  bool has(VertexHandle a, VertexHandle b) const { return (words_[word_of(a, b)] & bit_of(b)) != 0; }

 private:
  static constexpr std::size_t kWords = 2;
  static std::uint64_t hash(VertexHandle b) { return b.idx() * 0x9e3779b97f4a7c15ULL; }
  static std::size_t word_of(VertexHandle a, VertexHandle b) { return kWords * a.idx() + (hash(b) >> 63); }
  static std::uint64_t bit_of(VertexHandle b) { return std::uint64_t{1} << (hash(b) >> 57 & 63); }

  std::vector<std::uint64_t> words_;
  bool alone_;
};

/// A cell at an edge, neither of whose neighbours round it comes before it: the first of each ring or fan is
/// one, and few others are.
struct Asking {
  std::array<VertexHandle, 2> edge;  // vertices ascending
  CellHandle cell;
  std::uint8_t edge_in_cell = 0;

  bool operator==(const Asking&) const = default;
  /// Written out: not every standard library compares arrays by <=>.
  std::strong_ordering operator<=>(const Asking& other) const {
    return std::tie(edge[0], edge[1], cell, edge_in_cell) <=>
           std::tie(other.edge[0], other.edge[1], other.cell, other.edge_in_cell);
  }
};

/// Per cell the edges at which it asks, a bit each: they are gone through twice, and to find them is to look
/// at four neighbours anywhere in memory.
class Askers {
 public:
  explicit Askers(const TetMesh& mesh) : mesh_(mesh), edges_(mesh.n_cells()) {}

  void find(const CellOrder& order, std::size_t i) {
    const CellHandle c(i);
    const Cell& cell = mesh_.cell(c);
    std::array<bool, 4> has_before;
    for (std::size_t k = 0; k < 4; ++k)
      has_before[k] = cell.mate[k].is_valid() && order.less(cell_of(cell.mate[k]), c);
    unsigned bits = 0;
    for (std::size_t e = 0; e < 6; ++e)
      bits |= has_before[kEdgeOpposite[e][0]] || has_before[kEdgeOpposite[e][1]] ? 0U : 1U << e;
    edges_[i] = static_cast<std::uint8_t>(bits);
  }
  /// visit(Asking) for each edge of the cell that was found.
  template <class Visit>
  void visit(std::size_t i, Visit&& visit) const {
    const auto& v = mesh_.cell(CellHandle(i)).v;
    for (unsigned left = edges_[i]; left != 0; left &= left - 1) {
      const auto e = static_cast<std::size_t>(std::countr_zero(left));
      const auto [a, b] = std::minmax(v[kEdgeCorners[e][0]], v[kEdgeCorners[e][1]]);
      visit(Asking{{a, b}, CellHandle(i), static_cast<std::uint8_t>(e)});
    }
  }

 private:
  const TetMesh& mesh_;
  std::vector<std::uint8_t> edges_;
};

/// A ring or fan round an edge: its cell of smallest index, and whether cells go all the way round.
struct RingOfEdge {
  CellHandle smallest;
  bool closed = false;

  auto operator<=>(const RingOfEdge&) const = default;
};

RingOfEdge ring_of(const TetMesh& mesh, const Asking& asking) {
  RingOfEdge ring{asking.cell};
  const auto see = [&](CellHandle d, VertexHandle, VertexHandle) {
    ring.smallest = std::min(ring.smallest, d);
    return true;
  };
  ring.closed = mesh.walk_ring(asking.cell, asking.edge_in_cell, see);
  if (!ring.closed) mesh.walk_ring_back(asking.cell, asking.edge_in_cell, see);
  return ring;
}

/// Lists by part of the cells, in one.
template <class Item, class Fill>
std::vector<Item> gathered(int n_parts, Fill&& fill) {
  std::vector<std::vector<Item>> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) { fill(part, found[static_cast<std::size_t>(part)]); });
  std::vector<Item> all = std::move(found[0]);
  for (std::size_t i = 1; i < found.size(); ++i) all.insert(all.end(), found[i].begin(), found[i].end());
  return all;
}

}  // namespace

std::vector<VertexHandle> split_pinched(TetMesh& mesh) {
  par::DisjointSets<Index> corners(4 * mesh.n_cells());  // of cells, joined where they are one vertex
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    const CellHandle c(i);
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle m = mesh.opposite_halfface(halfface_of(c, k));
      if (!m.is_valid() || c < cell_of(m)) continue;
      for (VertexHandle v : mesh.halfface_vertices(m))
        corners.join(halfface_of(c, mesh.cell(c).corner(v)).idx(),
                     halfface_of(cell_of(m), mesh.cell(cell_of(m)).corner(v)).idx());
    }
  }
  TetMesh::Writer writer(mesh);
  std::vector<VertexHandle> copied;
  std::vector<std::uint8_t> taken(mesh.n_vertices(), 0);  // a part has the vertex
  std::vector<VertexHandle> of_root(4 * mesh.n_cells());  // where that is not the vertex itself
  for (Index corner = 0; corner < 4 * mesh.n_cells(); ++corner) {
    const Index root = corners.find(corner);
    const CellHandle c(corner / 4);
    VertexHandle& v = writer.cell(c).v[corner % 4];
    if (root == corner && taken[v.idx()] != 0) {
      copied.push_back(v);
      of_root[root] = mesh.add_vertex(mesh.point(v));
      writer.set_incident_cell(of_root[root], c);
    }
    taken[v.idx()] = 1;
    if (of_root[root].is_valid()) v = of_root[root];
  }
  return copied;
}

std::optional<DoubleEdge> find_double_edge(const TetMesh& mesh, par::Policy policy) {
  // Of two rings on one edge, the first cell of one comes upon the bit that the other has set. So do a few
  // edges by chance, and cells that are not the first of their ring: those that ask for the same edge tell,
  // by a walk.
  const int n_parts = par::thread_count(policy, mesh.n_cells());
  const CellOrder order(mesh, policy);
  EdgeBits seen(mesh.n_vertices(), n_parts == 1), some(mesh.n_vertices(), n_parts == 1);
  Askers askers(mesh);
  const auto for_cells = [&](int part, auto&& body) {
    const std::size_t end = par::part_begin(mesh.n_cells(), n_parts, part + 1);
    for (std::size_t i = par::part_begin(mesh.n_cells(), n_parts, part); i < end; ++i) body(i);
  };
  par::parts(n_parts, [&](int part) {
    for_cells(part, [&](std::size_t i) {
      askers.find(order, i);
      askers.visit(i, [&](const Asking& one) {
        if (seen.set(one.edge[0], one.edge[1])) some.set(one.edge[0], one.edge[1]);
      });
    });
  });
  auto asking = gathered<Asking>(n_parts, [&](int part, std::vector<Asking>& out) {
    for_cells(part, [&](std::size_t i) {
      askers.visit(i, [&](const Asking& one) {
        if (some.has(one.edge[0], one.edge[1])) out.push_back(one);
      });
    });
  });
  std::sort(asking.begin(), asking.end());
  std::vector<RingOfEdge> rings;
  for (std::size_t begin = 0, end = 0; begin < asking.size(); begin = end) {
    while (end < asking.size() && asking[end].edge == asking[begin].edge) ++end;
    if (end - begin == 1) continue;
    rings.clear();
    for (std::size_t i = begin; i < end; ++i) rings.push_back(ring_of(mesh, asking[i]));
    std::sort(rings.begin(), rings.end());
    rings.erase(std::unique(rings.begin(), rings.end()), rings.end());
    for (std::size_t i = 1; i < rings.size(); ++i)
      if (rings[i].closed || rings[i - 1].closed)
        return DoubleEdge{asking[begin].edge, {rings[i - 1].smallest, rings[i].smallest}};
  }
  return std::nullopt;
}

}  // namespace hfr
