// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Check.hh"

#include <algorithm>
#include <optional>
#include <ostream>
#include <unordered_set>

#include "HalfFace/TupleUse.hh"

namespace hfr {
namespace {

using Found = std::optional<CheckResult>;

template <class H>
std::string name(const char* kind, H h) {
  return std::string(kind) + " " + (h.is_valid() ? std::to_string(h.idx()) : "(invalid)");
}

/// Items of some kind listed by a vertex: those of vertex v are items[start[v]] … items[start[v + 1] - 1].
template <class Item>
struct ByVertex {
  std::vector<std::size_t> start;
  std::vector<Item> items;
  std::span<Item> of(std::size_t v) { return {items.data() + start[v], items.data() + start[v + 1]}; }
};

/// Counting sort; produce(visit) calls visit(vertex, item) for each item and is run twice.
template <class Item, class Produce>
ByVertex<Item> by_vertex(std::size_t n_vertices, Produce&& produce) {
  ByVertex<Item> lists;
  lists.start.assign(n_vertices + 2, 0);
  produce([&](VertexHandle v, const Item&) { ++lists.start[v.idx() + 2]; });
  for (std::size_t v = 2; v < lists.start.size(); ++v) lists.start[v] += lists.start[v - 1];
  lists.items.resize(lists.start.back());
  produce([&](VertexHandle v, const Item& item) { lists.items[lists.start[v.idx() + 1]++] = item; });
  lists.start.pop_back();
  return lists;
}

class Checker {
 public:
  Checker(const TetMesh& mesh, CheckOptions options) : mesh_(mesh), options_(options) {}

  CheckResult run() {
    using Test = Found (Checker::*)();
    constexpr Test kTests[] = {
        &Checker::index_range,    &Checker::repeated_vertex,   &Checker::free_list,
        &Checker::mate_symmetry,  &Checker::shared_vertices,   &Checker::orientation,
        &Checker::incident_cells, &Checker::duplicate_face,    &Checker::duplicate_edge,
        &Checker::manifold_edges, &Checker::manifold_vertices, &Checker::label_use};
    Rule rule = Rule::kNone;
    for (const Test test : kTests) {
      rule = static_cast<Rule>(static_cast<int>(rule) + 1);
      if (rule > options_.last) break;
      if (Found found = (this->*test)()) {
        found->rule = rule;
        return *std::move(found);
      }
    }
    return {};
  }

 private:
  /// An open or closed ring of cells round an edge, noted under the smaller of its vertices.
  struct Ring {
    VertexHandle other;
    CellHandle cell;  ///< the smallest of the ring
    bool closed;
  };

  std::size_t n_cells() const { return mesh_.n_cells(); }

  /// The smallest cell that is not deleted and breaks(cell).
  template <class Breaks>
  CellHandle first_cell(Breaks&& breaks) const {
    const std::size_t n = n_cells();
    const std::size_t first = par::reduce(
        options_.policy, n, n,
        [&](std::size_t i) { return !mesh_.is_deleted(CellHandle(i)) && breaks(CellHandle(i)) ? i : n; },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
    return first == n ? CellHandle() : CellHandle(first);
  }

  /// The same for half-faces that have a mate: breaks(half-face, mate).
  template <class Breaks>
  HalfFaceHandle first_mated(Breaks&& breaks) const {
    const auto of_cell = [&](CellHandle c) {
      for (int k = 0; k < 4; ++k) {
        const HalfFaceHandle m = mesh_.cell(c).mate[static_cast<std::size_t>(k)];
        if (m.is_valid() && breaks(halfface_of(c, k), m)) return halfface_of(c, k);
      }
      return HalfFaceHandle();
    };
    const CellHandle c = first_cell([&](CellHandle cell) { return of_cell(cell).is_valid(); });
    return c.is_valid() ? of_cell(c) : HalfFaceHandle();
  }

  static CheckResult of_cells(std::vector<CellHandle> cells, std::string message) {
    CheckResult result;
    result.cells = std::move(cells);
    result.message = std::move(message);
    return result;
  }
  static CheckResult of_vertices(std::vector<VertexHandle> vertices, std::string message) {
    CheckResult result;
    result.vertices = std::move(vertices);
    result.message = std::move(message);
    return result;
  }
  CheckResult of_mates(HalfFaceHandle h, const std::string& complaint) const {
    const HalfFaceHandle m = mesh_.opposite_halfface(h);
    CheckResult result;
    result.halffaces = {h, m};
    result.cells = {cell_of(h), cell_of(m)};
    result.message = name("half-face", h) + " and its mate " + std::to_string(m.idx()) + " " + complaint;
    return result;
  }

  Found index_range() {
    const Labels& labels = mesh_.labels();
    if (!labels.vertices.empty() && labels.vertices.size() != mesh_.n_vertices())
      return of_vertices({}, "there are " + std::to_string(labels.vertices.size()) + " vertex labels for " +
                                 std::to_string(mesh_.n_vertices()) + " vertices");
    const auto bad_vertex = [&](VertexHandle v) {
      return v.idx() >= mesh_.n_vertices() || mesh_.is_deleted(v);
    };
    const auto bad_mate = [&](HalfFaceHandle m) {
      return m.is_valid() && (cell_of(m).idx() >= n_cells() || mesh_.is_deleted(cell_of(m)));
    };
    const CellHandle c = first_cell([&](CellHandle cell) {
      const Cell& k = mesh_.cell(cell);
      return std::any_of(k.v.begin(), k.v.end(), bad_vertex) ||
             std::any_of(k.mate.begin(), k.mate.end(), bad_mate);
    });
    if (!c.is_valid()) return {};
    for (VertexHandle v : mesh_.cell(c).v) {
      if (!bad_vertex(v)) continue;
      CheckResult result =
          of_cells({c}, name("cell", c) + " has " + name("vertex", v) + ", which does not exist");
      result.vertices = {v};
      return result;
    }
    for (HalfFaceHandle m : mesh_.cell(c).mate) {
      if (!bad_mate(m)) continue;
      CheckResult result = of_cells(
          {c}, name("cell", c) + " has a mate in " + name("cell", cell_of(m)) + ", which does not exist");
      result.halffaces = {m};
      return result;
    }
    return {};
  }

  Found repeated_vertex() {
    const CellHandle c = first_cell([&](CellHandle cell) {
      const auto& v = mesh_.cell(cell).v;
      return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3];
    });
    if (!c.is_valid()) return {};
    return of_cells({c}, name("cell", c) + " has a vertex twice");
  }

  Found free_list() {
    std::vector<std::uint8_t> listed(n_cells(), 0);
    for (CellHandle c : mesh_.free_cells()) {
      if (c.idx() >= n_cells() || !mesh_.is_deleted(c))
        return of_cells({c}, name("cell", c) + " is on the free list and not deleted");
      if (listed[c.idx()]++ != 0) return of_cells({c}, name("cell", c) + " is on the free list twice");
    }
    for (std::size_t i = 0; i < n_cells(); ++i)
      if (mesh_.is_deleted(CellHandle(i)) && listed[i] == 0)
        return of_cells({CellHandle(i)},
                        name("cell", CellHandle(i)) + " is deleted and not on the free list");
    return {};
  }

  Found mate_symmetry() {
    const HalfFaceHandle h = first_mated([&](HalfFaceHandle a, HalfFaceHandle b) {
      return mesh_.opposite_halfface(b) != a || cell_of(a) == cell_of(b);
    });
    if (!h.is_valid()) return {};
    return of_mates(h, "do not name each other");
  }

  Found shared_vertices() {
    const HalfFaceHandle h = first_mated([&](HalfFaceHandle a, HalfFaceHandle b) {
      return AnyOrder::key(mesh_.halfface_vertices(a)) != AnyOrder::key(mesh_.halfface_vertices(b));
    });
    if (!h.is_valid()) return {};
    return of_mates(h, "have different vertices");
  }

  Found orientation() {
    const HalfFaceHandle h = first_mated([&](HalfFaceHandle a, HalfFaceHandle b) {
      return CyclicOrder::key(mesh_.halfface_vertices(a)) == CyclicOrder::key(mesh_.halfface_vertices(b));
    });
    if (!h.is_valid()) return {};
    return of_mates(h, "see their vertices in the same order: one of the cells lies the wrong way round");
  }

  Found incident_cells() {
    for (std::size_t i = 0; i < mesh_.n_vertices(); ++i) {
      const VertexHandle v(i);
      const CellHandle c = mesh_.incident_cell(v);
      if (!c.is_valid()) continue;
      if (mesh_.is_deleted(v))
        return of_vertices({v}, name("vertex", v) + " is deleted and has an incident cell");
      if (c.idx() < n_cells() && mesh_.cell(c).has(v)) continue;
      CheckResult result = of_vertices(
          {v}, "the incident cell of " + name("vertex", v) + ", " + name("cell", c) + ", is no cell of it");
      result.cells = {c};
      return result;
    }
    const auto has_no_cell = [&](VertexHandle v) { return !mesh_.incident_cell(v).is_valid(); };
    const CellHandle c = first_cell([&](CellHandle cell) {
      const auto& v = mesh_.cell(cell).v;
      return std::any_of(v.begin(), v.end(), has_no_cell);
    });
    if (!c.is_valid()) return {};
    const auto& v = mesh_.cell(c).v;
    const VertexHandle lost = *std::find_if(v.begin(), v.end(), has_no_cell);
    CheckResult result =
        of_vertices({lost}, name("vertex", lost) + " is in " + name("cell", c) + " and has no incident cell");
    result.cells = {c};
    return result;
  }

  Found duplicate_face() {
    struct Face {
      std::array<VertexHandle, 2> larger;
      HalfFaceHandle h;
    };
    ByVertex<Face> faces = by_vertex<Face>(mesh_.n_vertices(), [&](auto&& visit) {
      for (Index h = 0; h < 4 * n_cells(); ++h) {
        if (mesh_.is_deleted(cell_of(HalfFaceHandle(h)))) continue;
        const auto v = AnyOrder::key(mesh_.halfface_vertices(HalfFaceHandle(h)));
        visit(v[0], Face{{v[1], v[2]}, HalfFaceHandle(h)});
      }
    });
    for (std::size_t v = 0; v < mesh_.n_vertices(); ++v) {
      const std::span<Face> mine = faces.of(v);
      std::sort(mine.begin(), mine.end(), [](const Face& a, const Face& b) {
        return a.larger != b.larger ? a.larger < b.larger : a.h < b.h;
      });
      for (std::size_t i = 1; i < mine.size(); ++i) {
        if (mine[i].larger != mine[i - 1].larger || mesh_.opposite_halfface(mine[i].h) == mine[i - 1].h)
          continue;
        CheckResult result;
        result.halffaces = {mine[i - 1].h, mine[i].h};
        result.cells = {cell_of(mine[i - 1].h), cell_of(mine[i].h)};
        result.vertices = {VertexHandle(v), mine[i].larger[0], mine[i].larger[1]};
        result.message = name("cell", result.cells[0]) + " and " + name("cell", result.cells[1]) +
                         " have a face of the same vertices and are not neighbours across it";
        return result;
      }
    }
    return {};
  }

  /// Emits every ring once, with its smallest cell.
  void gather_rings() {
    rings_ = by_vertex<Ring>(mesh_.n_vertices(), [&](auto&& visit) {
      for (std::size_t i = 0; i < n_cells(); ++i) {
        const CellHandle c(i);
        if (mesh_.is_deleted(c)) continue;
        for (int e = 0; e < 6; ++e) {
          const auto& corners = kEdgeCorners[static_cast<std::size_t>(e)];
          const VertexHandle a = mesh_.cell(c).v[corners[0]];
          const VertexHandle b = mesh_.cell(c).v[corners[1]];
          bool smallest = true;
          const auto keep_on = [&](CellHandle d, VertexHandle, VertexHandle) { return smallest = !(d < c); };
          const bool closed = mesh_.walk_ring(c, e, keep_on);
          if (!closed && smallest) mesh_.walk_ring_back(c, e, keep_on);
          if (smallest) visit(std::min(a, b), Ring{std::max(a, b), c, closed});
        }
      }
    });
    for (std::size_t v = 0; v < mesh_.n_vertices(); ++v) {
      const std::span<Ring> mine = rings_.of(v);
      std::sort(mine.begin(), mine.end(), [](const Ring& a, const Ring& b) {
        return a.other != b.other ? a.other < b.other : a.cell < b.cell;
      });
    }
  }

  template <class Offends>
  Found repeated_ring(const char* complaint, Offends&& offends) {
    for (std::size_t v = 0; v < mesh_.n_vertices(); ++v) {
      const std::span<Ring> mine = rings_.of(v);
      for (std::size_t i = 1; i < mine.size(); ++i) {
        if (mine[i].other != mine[i - 1].other || !offends(mine[i - 1], mine[i])) continue;
        CheckResult result = of_vertices({VertexHandle(v), mine[i].other}, "");
        result.cells = {mine[i - 1].cell, mine[i].cell};
        result.message = "the edge of vertices " + std::to_string(v) + " and " +
                         std::to_string(mine[i].other.idx()) + " " + complaint + ", one with " +
                         name("cell", mine[i - 1].cell) + ", one with " + name("cell", mine[i].cell);
        return result;
      }
    }
    return {};
  }

  Found duplicate_edge() {
    gather_rings();
    return repeated_ring("exists twice", [](const Ring& a, const Ring& b) { return a.closed || b.closed; });
  }

  Found manifold_edges() {
    return repeated_ring("has more than one fan of cells", [](const Ring&, const Ring&) { return true; });
  }

  Found manifold_vertices() {
    std::vector<std::uint32_t> n_cells_of(mesh_.n_vertices(), 0);
    for (std::size_t i = 0; i < n_cells(); ++i)
      if (!mesh_.is_deleted(CellHandle(i)))
        for (VertexHandle v : mesh_.cell(CellHandle(i)).v) ++n_cells_of[v.idx()];
    Star star;
    for (std::size_t i = 0; i < mesh_.n_vertices(); ++i) {
      const VertexHandle v(i);
      if (n_cells_of[i] == 0) continue;
      const std::size_t size =
          mesh_.gather_star(v, star) ? static_cast<std::size_t>(star.size) : large_star(v);
      if (size == n_cells_of[i]) continue;
      CheckResult result = of_vertices({v}, "the cells of " + name("vertex", v) +
                                                " do not connect through faces: " + std::to_string(size) +
                                                " of " + std::to_string(n_cells_of[i]) + " do with " +
                                                name("cell", mesh_.incident_cell(v)));
      result.cells = {mesh_.incident_cell(v)};
      return result;
    }
    return {};
  }

  /// Number of cells that connect to the incident cell round v, however many.
  std::size_t large_star(VertexHandle v) const {
    std::unordered_set<CellHandle> seen{mesh_.incident_cell(v)};
    std::vector<CellHandle> todo{mesh_.incident_cell(v)};
    while (!todo.empty()) {
      const Cell& k = mesh_.cell(todo.back());
      todo.pop_back();
      for (std::size_t f = 0; f < 4; ++f)
        if (k.v[f] != v && k.mate[f].is_valid() && seen.insert(cell_of(k.mate[f])).second)
          todo.push_back(cell_of(k.mate[f]));
    }
    return seen.size();
  }

  template <std::size_t N>
  Found label_use(const TupleMap<N, int>& map, const char* kind) {
    if (map.empty()) return {};
    const std::vector<std::uint8_t> used = used_entries(mesh_, map);
    const auto unused = std::find(used.begin(), used.end(), 0);
    if (unused == used.end()) return {};
    const auto& entry = map.entries()[static_cast<std::size_t>(unused - used.begin())];
    std::string message =
        std::string("label ") + std::to_string(entry.value) + " is on the " + kind + " of vertices";
    for (VertexHandle v : entry.vertices) message += " " + std::to_string(v.idx());
    return of_vertices({entry.vertices.begin(), entry.vertices.end()}, message + ", which no cell has");
  }
  Found label_use() {
    Found found = label_use(mesh_.labels().faces, "face");
    return found ? found : label_use(mesh_.labels().edges, "edge");
  }

  const TetMesh& mesh_;
  CheckOptions options_;
  ByVertex<Ring> rings_;
};

}  // namespace

std::string_view rule_name(Rule rule) {
  constexpr std::string_view kNames[] = {"kNone",          "kIndexRange",      "kRepeatedVertex",
                                         "kFreeList",      "kMateSymmetry",    "kSharedVertices",
                                         "kOrientation",   "kIncidentCell",    "kDuplicateFace",
                                         "kDuplicateEdge", "kNonManifoldEdge", "kNonManifoldVertex",
                                         "kLabel"};
  return kNames[static_cast<std::size_t>(rule)];
}

std::ostream& operator<<(std::ostream& out, const CheckResult& result) {
  out << rule_name(result.rule);
  if (!result.message.empty()) out << ": " << result.message;
  return out;
}

CheckResult check(const TetMesh& mesh, CheckOptions options) { return Checker(mesh, options).run(); }

std::vector<VertexHandle> unused_vertices(const TetMesh& mesh) {
  std::vector<VertexHandle> unused;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i)
    if (!mesh.is_deleted(VertexHandle(i)) && !mesh.incident_cell(VertexHandle(i)).is_valid())
      unused.emplace_back(i);
  return unused;
}

}  // namespace hfr
