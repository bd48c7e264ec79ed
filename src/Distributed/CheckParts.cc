// SPDX-License-Identifier: BSD-3-Clause
// The rules of HalfFace/Check.hh where the mesh is in parts. All cells of a rank's own vertices are held by
// it, so each looks at what is round its own ones; what cannot be seen from there is asked of others.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Distributed/InParts.hh"
#include "Distributed/Sources.hh"
#include "Parallel/DisjointSets.hh"

namespace hfr::mpi {
namespace {

using Fault = std::optional<std::string>;

/// The cells of each own vertex.
class Stars {
 public:
  explicit Stars(const DistributedMesh& mesh) : begin_(mesh.part().n_vertices() + 1, 0) {
    const TetMesh& part = mesh.part();
    const auto for_corners = [&](auto&& body) {
      for (std::size_t i = 0; i < part.n_cells(); ++i) {
        if (part.is_deleted(CellHandle(i))) continue;
        for (VertexHandle v : part.cell(CellHandle(i)).v)
          if (mesh.is_own(v)) body(v, CellHandle(i));
      }
    };
    for_corners([&](VertexHandle v, CellHandle) { ++begin_[v.idx() + 1]; });
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    cells_.resize(begin_.back());
    std::vector<std::size_t> at(begin_.begin(), begin_.end() - 1);
    for_corners([&](VertexHandle v, CellHandle c) { cells_[at[v.idx()]++] = c; });
  }
  std::span<const CellHandle> operator[](VertexHandle v) const {
    return {cells_.data() + begin_[v.idx()], begin_[v.idx() + 1] - begin_[v.idx()]};
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<CellHandle> cells_;  // ascending for each vertex
};

/// Looks at one rank's part.
class PartCheck {
 public:
  PartCheck(const DistributedMesh& mesh, const Pinches& known)
      : mesh_(mesh), part_(mesh.part()), known_(known) {}
  /// Of what has changed since: cells of three vertices or more that `asks` marks, and these vertices.
  PartCheck(const DistributedMesh& mesh, const Pinches& known, std::vector<std::uint8_t> asks)
      : mesh_(mesh), part_(mesh.part()), known_(known), asks_(std::move(asks)) {}

  Fault run() const {
    for (std::size_t i = 0; i < part_.n_cells(); ++i) {
      const CellHandle c(i);
      if (asks_.empty()) fetch_neighbours(i + kAhead);
      if (part_.is_deleted(c) || !is_asked(c)) continue;
      if (Fault fault = look_at(c)) return fault;
    }
    const std::vector<VertexHandle> suspects = suspect_vertices();
    if (suspects.empty()) return {};
    const Stars stars(mesh_);
    for (VertexHandle v : suspects)
      if (Fault fault = look_at(v, stars[v])) return fault;
    return {};
  }
  Pinches pinches() const {
    Pinches all;
    const std::vector<VertexHandle> suspects = suspect_vertices();
    if (suspects.empty()) return all;
    const Stars stars(mesh_);
    for (VertexHandle v : suspects) {
      if (part_.is_deleted(v)) continue;
      if (const std::size_t n = n_groups(stars[v]); n > 1) all.vertices[mesh_.number(v)] = n;
      for_edges(v, stars[v], [&](VertexHandle u, std::size_t n_fans) {
        if (n_fans > 1) all.edges[{mesh_.number(v), mesh_.number(u)}] = n_fans;
        return true;
      });
    }
    return all;
  }

 private:
  static constexpr std::size_t kAhead = 16;

  /// Of a cell whose turn comes soon.
  void fetch_neighbours(std::size_t i) const {
    if (i >= part_.n_cells()) return;
    for (HalfFaceHandle m : part_.cell(CellHandle(i)).mate)
      if (m.is_valid()) __builtin_prefetch(&part_.cell(cell_of(m)));
  }
  /// One that is not there asks, too.
  bool is_asked(VertexHandle v) const {
    return asks_.empty() || v.idx() >= asks_.size() || asks_[v.idx()] != 0;
  }
  bool is_asked(CellHandle c) const {
    return asks_.empty() ||
           std::ranges::count_if(part_.cell(c).v, [&](VertexHandle v) { return is_asked(v); }) >= 3;
  }

  std::string name(CellHandle c) const { return "cell " + std::to_string(mesh_.number(c)); }
  std::string name(VertexHandle v) const { return "vertex " + std::to_string(mesh_.number(v)); }

  /// Own vertices that a first look does not clear; see is_plain().
  std::vector<VertexHandle> suspect_vertices() const {
    std::vector<std::uint32_t> n_cells_of(part_.n_vertices(), 0);
    for (std::size_t i = 0; i < part_.n_cells(); ++i)
      if (!part_.is_deleted(CellHandle(i)))
        for (VertexHandle v : part_.cell(CellHandle(i)).v) ++n_cells_of[v.idx()];
    std::vector<VertexHandle> suspects;
    std::vector<std::uint8_t> place(part_.n_vertices(), 0);
    for (std::size_t i = 0; i < part_.n_vertices(); ++i)
      if (const VertexHandle v(i); mesh_.is_own(v) && is_asked(v) && !is_plain(v, n_cells_of[i], place))
        suspects.push_back(v);
    return suspects;
  }

  /// True only where all is well round v, which has so many cells: they connect, no face has more than two of
  /// them, each edge one fan. Expects cells that look_at() has cleared. `place`: by vertex, all 0 between
  /// calls. That a face has two cells without a mate is for compare_boundaries() to see.
  ///
  /// The faces opposite v in its cells make up a connected surface. Faces of v are its edges: where each is
  /// met once in each direction at most, none has more than two cells. Were a vertex of it counted once that
  /// has several fans, its Euler characteristic would come out too small: a disk or a sphere has one fan
  /// everywhere. All other surfaces are left for a closer look.
  bool is_plain(VertexHandle v, std::size_t n_cells, std::vector<std::uint8_t>& place) const {
    const CellHandle incident = part_.incident_cell(v);
    if (part_.is_deleted(v)) return n_cells == 0;
    if (n_cells == 0) return !incident.is_valid();
    if (!incident.is_valid() || incident.idx() >= part_.n_cells() || part_.is_deleted(incident) ||
        !part_.cell(incident).has(v) || mesh_.work().star_size[v.idx()] != n_cells)
      return false;
    Star star;
    if (!part_.gather_star(v, star) || static_cast<std::size_t>(star.size) != n_cells) return false;
    constexpr std::size_t kMost = 64;                // neighbours, each a bit
    std::array<std::uint64_t, kMost + 1> follows{};  // of each: those that come after it round a face
    std::array<VertexHandle, kMost> neighbours;
    std::size_t n_neighbours = 0, n_open = 0;
    const auto place_of = [&](VertexHandle u) {
      std::uint8_t& at = place[u.idx()];
      if (at == 0 && n_neighbours < kMost) {
        neighbours[n_neighbours++] = u;
        at = static_cast<std::uint8_t>(n_neighbours);
      }
      return at;
    };
    const auto look = [&] {
      for (std::size_t i = 0; i < n_cells; ++i) {
        const Cell& cell = part_.cell(star.cells[i]);
        const auto& f = kFaceCorners[star.corners[i]];
        std::array<std::uint8_t, 3> at{};
        for (std::size_t k = 0; k < 3; ++k)
          if ((at[k] = place_of(cell.v[f[k]])) == 0) return false;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint8_t a = at[k], b = at[(k + 1) % 3];
          const std::uint64_t bit = std::uint64_t{1} << (b - 1);
          if ((follows[a] & bit) != 0) return false;
          follows[a] |= bit;
          if (!cell.mate[f[(k + 2) % 3]].is_valid()) ++n_open;
        }
      }
      // V - (3 F + O) / 2 + F, twice: each face has three edges, of which O are open.
      return 2 * n_neighbours == n_cells + n_open + (n_open > 0 ? 2 : 4);
    };
    const bool is_plain = look();
    for (std::size_t i = 0; i < n_neighbours; ++i) place[neighbours[i].idx()] = 0;
    return is_plain;
  }

  Fault look_at(CellHandle c) const {
    const Cell& cell = part_.cell(c);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!cell.v[k].is_valid() || cell.v[k].idx() >= part_.n_vertices() || part_.is_deleted(cell.v[k]))
        return name(c) + ": a vertex of it is not there";
      for (std::size_t j = 0; j < k; ++j)
        if (cell.v[j] == cell.v[k]) return name(c) + ": a vertex of it appears twice";
    }
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k), m = part_.opposite_halfface(h);
      if (!m.is_valid()) continue;
      if (m.idx() / 4 >= part_.n_cells() || part_.is_deleted(cell_of(m)) || cell_of(m) == c ||
          part_.opposite_halfface(m) != h)
        return name(c) + ": a face of it and its mate do not name each other";
      const auto a = part_.halfface_vertices(h), b = part_.halfface_vertices(m);
      const auto at = std::find(b.begin(), b.end(), a[0]) - b.begin();
      if (at == 3 || a[1] != b[static_cast<std::size_t>(at + 2) % 3] ||
          a[2] != b[static_cast<std::size_t>(at + 1) % 3])
        return name(c) + ": it and a neighbour see their face in the same order, or other vertices of it";
    }
    return {};
  }

  Fault look_at(VertexHandle v, std::span<const CellHandle> star) const {
    const CellHandle incident = part_.incident_cell(v);
    if (part_.is_deleted(v)) return star.empty() ? Fault{} : name(v) + ": it is deleted, and has cells";
    if (star.empty()) return incident.is_valid() ? name(v) + ": its incident cell is none of it" : Fault{};
    if (!std::binary_search(star.begin(), star.end(), incident))
      return name(v) + ": its incident cell is none of it";
    if (mesh_.work().star_size[v.idx()] != star.size()) return name(v) + ": it has another number of cells";
    if (Fault fault = look_at_faces(v, star)) return fault;
    return look_at_links(v, star);
  }

  /// No face of v has two cells that are not mates.
  Fault look_at_faces(VertexHandle v, std::span<const CellHandle> star) const {
    std::vector<std::pair<std::array<VertexHandle, 2>, HalfFaceHandle>> faces;
    for (CellHandle c : star)
      for (int k = 0; k < 4; ++k) {
        const HalfFaceHandle h = halfface_of(c, k);
        std::array<VertexHandle, 2> others;
        std::size_t n = 0;
        for (VertexHandle u : part_.halfface_vertices(h))
          if (u != v && n < 2) others[n++] = u;
        if (part_.cell(c).v[static_cast<std::size_t>(k)] == v) continue;
        std::sort(others.begin(), others.end());
        faces.emplace_back(others, h);
      }
    std::sort(faces.begin(), faces.end());
    for (std::size_t i = 1; i < faces.size(); ++i)
      if (faces[i].first == faces[i - 1].first &&
          part_.opposite_halfface(faces[i].second) != faces[i - 1].second)
        return name(v) + ": a face of it has two cells that are not each other's neighbours";
    return {};
  }

  /// Groups of the cells of a vertex that connect through faces, all of which have the vertex.
  std::size_t n_groups(std::span<const CellHandle> star) const {
    par::DisjointSets<std::uint32_t> groups(star.size());
    std::size_t n = star.size();
    for (std::size_t i = 0; i < star.size(); ++i)
      for (HalfFaceHandle m : part_.cell(star[i]).mate) {
        if (!m.is_valid()) continue;
        const auto at = std::lower_bound(star.begin(), star.end(), cell_of(m));
        if (at == star.end() || *at != cell_of(m)) continue;
        if (groups.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(at - star.begin()))) --n;
      }
    return n;
  }

  /// The cells of v connect through faces, and so do those of each edge of it, but for what is known.
  Fault look_at_links(VertexHandle v, std::span<const CellHandle> star) const {
    const auto known_groups = known_.vertices.find(mesh_.number(v));
    if (n_groups(star) > (known_groups == known_.vertices.end() ? 1 : known_groups->second))
      return name(v) + ": its cells do not connect through faces";
    Fault fault;
    for_edges(v, star, [&](VertexHandle u, std::size_t n_fans) {
      if (n_fans == 1 || n_fans <= n_known(v, u)) return true;
      fault = "the edge of " + name(v) + " and " + name(u) + " has more than one fan of cells";
      return false;
    });
    return fault;
  }
  std::size_t n_known(VertexHandle v, VertexHandle u) const {
    const auto at = known_.edges.find({mesh_.number(v), mesh_.number(u)});
    return at == known_.edges.end() ? 1 : at->second;
  }

  /// body(other end, fans of cells round it) for the edges of v, while it returns true.
  template <class Body>
  void for_edges(VertexHandle v, std::span<const CellHandle> star, Body&& body) const {
    std::vector<std::pair<VertexHandle, CellHandle>> edges;
    for (CellHandle c : star)
      for (VertexHandle u : part_.cell(c).v)
        if (u != v) edges.emplace_back(u, c);
    std::sort(edges.begin(), edges.end());
    std::vector<CellHandle> cells;  // of one edge
    for (std::size_t i = 0, n = 1; i < edges.size(); i += n) {
      for (n = 1; i + n < edges.size() && edges[i + n].first == edges[i].first;) ++n;
      cells.clear();
      for (std::size_t k = i; k < i + n; ++k) cells.push_back(edges[k].second);
      if (!body(edges[i].first, n_fans(v, edges[i].first, cells))) return;
    }
  }
  /// `cells`: all of the edge; none of them is left there.
  std::size_t n_fans(VertexHandle a, VertexHandle b, std::vector<CellHandle>& cells) const {
    std::size_t n = 0;
    for (; !cells.empty(); ++n) {
      const CellHandle first = cells.back();
      cells.pop_back();
      leave_out_fan(a, b, first, cells);
    }
    return n;
  }
  /// Those of `cells`, all round the edge, that connect to c.
  void leave_out_fan(VertexHandle a, VertexHandle b, CellHandle c, std::vector<CellHandle>& cells) const {
    const Cell& cell = part_.cell(c);
    std::array<std::size_t, 2> off{};  // the corners that are not on the edge
    std::size_t n_off = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if (cell.v[k] != a && cell.v[k] != b && n_off < 2) off[n_off++] = k;
    for (std::size_t side = 0; side < 2; ++side) {
      VertexHandle ahead = cell.v[off[1 - side]];  // goes on through the face that has it
      for (HalfFaceHandle h = halfface_of(c, static_cast<int>(off[side]));;) {
        const HalfFaceHandle m = part_.opposite_halfface(h);
        if (!m.is_valid()) break;
        const CellHandle at = cell_of(m);
        // Each is met once, and none twice where mates do not go round.
        const auto found = std::find(cells.begin(), cells.end(), at);
        if (found == cells.end()) break;
        cells.erase(found);
        const VertexHandle next = part_.cell(at).v[static_cast<std::size_t>(corner_of(m))];
        h = halfface_of(at, part_.cell(at).corner(ahead));
        ahead = next;
      }
    }
  }

  const DistributedMesh& mesh_;
  const TetMesh& part_;
  const Pinches& known_;
  std::vector<std::uint8_t> asks_;  // by vertex; empty where all ask
};

/// Marks the vertices of cells that were others in the copy, or not in it, as they are and as they were, and
/// those that were otherwise themselves.
std::vector<std::uint8_t> vertices_of_changed(const DistributedMesh& mesh, const DistributedMesh& before) {
  std::vector<std::uint8_t> marks(mesh.part().n_vertices(), 0);
  const auto mark = [&](VertexHandle v) {
    if (v.idx() < marks.size()) marks[v.idx()] = 1;
  };
  const auto number_of = [](const DistributedMesh& of, VertexHandle v) {
    return v.idx() < of.part().n_vertices() ? of.number(v) : kNoNumber;
  };
  // A cell of the same number stands at the same index, but where the part has been cut anew.
  const auto same_in = [](const DistributedMesh& other, std::uint64_t number, std::size_t i) {
    const CellHandle c(i);
    return i < other.part().n_cells() && other.number(c) == number ? c : other.cell_at(number);
  };
  const auto is_same = [&](const DistributedMesh& a, CellHandle x, const DistributedMesh& b, CellHandle y) {
    if (a.part().is_deleted(x) || b.part().is_deleted(y))
      return a.part().is_deleted(x) && b.part().is_deleted(y);
    for (std::size_t k = 0; k < 4; ++k)
      if (number_of(a, a.part().cell(x).v[k]) != number_of(b, b.part().cell(y).v[k])) return false;
    return true;
  };
  const auto for_changed = [&](const DistributedMesh& of, const DistributedMesh& other, auto&& body) {
    for (std::size_t i = 0; i < of.part().n_cells(); ++i) {
      const CellHandle c(i), same = same_in(other, of.number(c), i);
      if (same.is_valid() && is_same(of, c, other, same)) continue;
      if (of.part().is_deleted(c)) continue;
      for (VertexHandle v : of.part().cell(c).v) body(v);
    }
  };
  const auto incident = [](const DistributedMesh& of, VertexHandle v) {
    const CellHandle c = of.part().incident_cell(v);
    return c.idx() < of.part().n_cells() ? of.number(c) : kNoNumber;
  };
  for (std::size_t i = 0; i < mesh.part().n_vertices(); ++i) {
    const VertexHandle v(i);
    const bool same_place = i < before.part().n_vertices() && before.number(v) == mesh.number(v);
    const VertexHandle was = same_place ? v : before.vertex_at(mesh.number(v));
    if (!was.is_valid() || mesh.part().is_deleted(v) != before.part().is_deleted(was) ||
        mesh.work().star_size[v.idx()] != before.work().star_size[was.idx()] ||
        incident(mesh, v) != incident(before, was))
      mark(v);
  }
  for_changed(mesh, before, mark);
  for_changed(before, mesh, [&](VertexHandle v) { mark(mesh.vertex_at(number_of(before, v))); });
  return marks;
}

/// What is held of a cell or vertex of another rank.
struct HeldCell {
  std::uint64_t number = 0;
  std::array<std::uint64_t, 4> v{};
  std::uint64_t source = 0;
  double quality = 0;
  std::int64_t region = 0;
  std::uint64_t labels = 0;  ///< of what hangs on its vertices, edges and faces: a hash
};
struct HeldVertex {
  std::uint64_t number = 0, source = 0;
  Vec3 point;
  /// Where it is near enough that this rank holds all its cells.
  bool is_near = false, is_pinched = false;
  std::uint32_t star_size = 0;
  std::uint64_t incident = kNoNumber;
};

std::uint64_t hash_of_labels(const DistributedMesh& mesh, CellHandle c) {
  std::uint64_t sum = 0;
  const auto number = [&](VertexHandle v) { return mesh.number(v); };
  for (const LabelRecord& r :
       mesh.label_numbers().of(mesh.part(), {}, {&c, 1}, mesh.part().cell(c).v, number)) {
    std::uint64_t h = mix64(r.number ^ static_cast<std::uint64_t>(r.kind) << 56);
    // Of what is fixed, the order of vertices says nothing.
    const bool is_lock = r.kind == LabelRecord::Kind::kFixedEdge || r.kind == LabelRecord::Kind::kFixedFace;
    for (std::uint64_t v : is_lock ? r.key() : r.v) h = mix64(h ^ v);
    sum += mix64(h ^ static_cast<std::uint32_t>(r.value));
  }
  return sum;
}

HeldCell held(const DistributedMesh& mesh, CellHandle c) {
  HeldCell one{mesh.number(c),
               {},
               sources::of(mesh.part(), c),
               mesh.work().quality[c.idx()],
               mesh.part().region(c),
               hash_of_labels(mesh, c)};
  for (std::size_t k = 0; k < 4; ++k) one.v[k] = mesh.number(mesh.part().cell(c).v[k]);
  return one;
}

HeldVertex held(const DistributedMesh& mesh, VertexHandle v, bool is_near) {
  HeldVertex one{mesh.number(v), sources::of(mesh.part(), v), mesh.part().point(v), is_near, false, 0,
                 kNoNumber};
  if (!is_near) return one;
  const Workspace& work = mesh.work();
  one.is_pinched = !work.pinched.empty() && work.pinched[v.idx()] != 0;
  one.star_size = work.star_size[v.idx()];
  if (const CellHandle c = mesh.part().incident_cell(v); c.is_valid()) one.incident = mesh.number(c);
  return one;
}

int owner_of(const DistributedMesh& mesh, CellHandle c) {
  const auto& v = mesh.part().cell(c).v;
  return mesh.owner(std::min(std::min(v[0], v[1]), std::min(v[2], v[3])));
}

/// False where a vertex of it is not there.
bool has_vertices(const TetMesh& part, CellHandle c) {
  return std::ranges::all_of(part.cell(c).v, [&](VertexHandle v) { return v.idx() < part.n_vertices(); });
}

/// What this rank holds for others is what they have.
Fault compare_with_owners(DistributedMesh& mesh) {
  const TetMesh& part = mesh.part();
  const auto n_ranks = mesh.comm().n_ranks();
  std::vector<std::vector<HeldCell>> cells(n_ranks);
  std::vector<std::vector<HeldVertex>> vertices(n_ranks);
  std::vector<std::uint8_t> has_cell(part.n_vertices(), 0);
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c) || !has_vertices(part, c)) continue;  // which look_at() has named
    for (VertexHandle v : part.cell(c).v) has_cell[v.idx()] = 1;
    if (!mesh.is_own(c)) cells[static_cast<std::size_t>(owner_of(mesh, c))].push_back(held(mesh, c));
  }
  for (std::size_t i = 0; i < part.n_vertices(); ++i)
    if (const VertexHandle v(i); has_cell[i] && !mesh.is_own(v))
      vertices[static_cast<std::size_t>(mesh.owner(v))].push_back(
          held(mesh, v, mesh.within_two().has(i, mesh.comm().rank())));
  std::vector<Packer> to(n_ranks);
  for (std::size_t r = 0; r < n_ranks; ++r) {
    if (cells[r].empty() && vertices[r].empty()) continue;
    to[r].put_all(std::exchange(cells[r], {}));
    to[r].put_all(std::exchange(vertices[r], {}));
  }
  Fault fault;
  for (const Comm::Message& message : mesh.comm().exchange(to)) {
    Unpacker in(message.bytes);
    const auto say = [&](const std::string& what) {
      if (!fault) fault = what + ", as rank " + std::to_string(message.from) + " holds it, is another here";
    };
    for (const HeldCell& theirs : in.get_all<HeldCell>()) {
      const CellHandle c = mesh.cell_at(theirs.number);
      if (!c.is_valid() || part.is_deleted(c) || !has_vertices(part, c) || !mesh.is_own(c)) {
        say("cell " + std::to_string(theirs.number));
        continue;
      }
      const HeldCell mine = held(mesh, c);
      if (mine.v != theirs.v || mine.quality != theirs.quality || mine.region != theirs.region)
        say("cell " + std::to_string(theirs.number));
      if (mine.source != theirs.source) say("whose values cell " + std::to_string(theirs.number) + " has");
      if (mine.labels != theirs.labels) say("what is labelled of cell " + std::to_string(theirs.number));
    }
    for (const HeldVertex& theirs : in.get_all<HeldVertex>()) {
      const VertexHandle v = mesh.vertex_at(theirs.number);
      const bool is_same = v.is_valid() && mesh.is_own(v) && !part.is_deleted(v) && [&] {
        const HeldVertex mine = held(mesh, v, theirs.is_near);
        return mine.point == theirs.point && mine.source == theirs.source &&
               mine.is_pinched == theirs.is_pinched && mine.star_size == theirs.star_size &&
               mine.incident == theirs.incident;
      }();
      if (!is_same) say("vertex " + std::to_string(theirs.number));
    }
  }
  return fault;
}

/// Faces without a mate, each looked at by some rank: a face that comes from two cells is no boundary.
Fault compare_boundaries(DistributedMesh& mesh) {
  using Face = std::array<std::uint64_t, 3>;
  const TetMesh& part = mesh.part();
  std::vector<Packer> to(mesh.comm().n_ranks());
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c) || !has_vertices(part, c) || !mesh.is_own(c)) continue;
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      if (part.opposite_halfface(h).is_valid()) continue;
      Face face{};
      const auto v = part.halfface_vertices(h);
      for (std::size_t j = 0; j < 3; ++j) face[j] = mesh.number(v[j]);
      std::sort(face.begin(), face.end());
      to[(face[0] + face[1] + face[2]) % to.size()].put(face);
    }
  }
  std::vector<Face> faces;
  for (const Comm::Message& message : mesh.comm().exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) faces.push_back(in.get<Face>());
  std::sort(faces.begin(), faces.end());
  const auto twice = std::adjacent_find(faces.begin(), faces.end());
  if (twice == faces.end()) return {};
  return "the face of vertices " + std::to_string((*twice)[0]) + ", " + std::to_string((*twice)[1]) +
         " and " + std::to_string((*twice)[2]) + " has two cells that are not each other's neighbours";
}

}  // namespace

Pinches pinches(const DistributedMesh& mesh) { return PartCheck(mesh, {}).pinches(); }

namespace {

/// Collective.
PartsCheck checked(DistributedMesh& mesh, const PartCheck& part) {
  Comm& comm = mesh.comm();
  Fault fault = part.run();
  // What one rank finds is no reason for others to stop where all have to be asked.
  for (const auto& compare : {compare_with_owners, compare_boundaries})
    if (Fault another = compare(mesh); another && !fault) fault = std::move(another);
  PartsCheck result;
  const double first = comm.min(fault ? comm.rank() : comm.size());
  result.rank = static_cast<int>(first);
  result.is_good = result.rank == comm.size();
  std::string mine = fault && result.rank == comm.rank() ? *fault : std::string();
  const std::vector<char> said = comm.all_gather(std::span<const char>(mine.data(), mine.size()));
  result.message.assign(said.begin(), said.end());
  if (result.is_good) result.rank = 0;
  return result;
}

}  // namespace

PartsCheck check(DistributedMesh& mesh, const Pinches& known) {
  const Comm::InPhase phase(mesh.comm(), Phase::kTally);
  return checked(mesh, PartCheck(mesh, known));
}

PartsCheck check_changes(DistributedMesh& mesh, const DistributedMesh& before) {
  const Comm::InPhase phase(mesh.comm(), Phase::kTally);
  const std::vector<std::uint8_t> marks = vertices_of_changed(mesh, before);
  const PartsCheck found = checked(mesh, PartCheck(mesh, {}, marks));
  if (found.is_good) return found;
  const Pinches known = pinches(before);
  return checked(mesh, PartCheck(mesh, known, marks));
}

}  // namespace hfr::mpi
