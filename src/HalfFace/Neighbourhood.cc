// SPDX-License-Identifier: BSD-3-Clause
// Queries of TetMesh that are more than a line.
#include <algorithm>
#include <bit>

#include "HalfFace/TetMesh.hh"

namespace hfr {

std::size_t TetMesh::n_edges() const {
  std::size_t n = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i)
    n += static_cast<std::size_t>(std::popcount(first_edges(CellHandle(i))));
  return n;
}
std::size_t TetMesh::n_faces() const { return faces().count(); }

int TetMesh::genus() const {
  const auto signed_size = [](std::size_t n) { return static_cast<std::ptrdiff_t>(n); };
  return static_cast<int>(1 - (signed_size(n_logical_vertices()) - signed_size(n_edges()) +
                               signed_size(n_faces()) - signed_size(n_logical_cells())));
}

std::size_t TetMesh::memory_bytes() const {
  const auto array = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  std::size_t sum = array(cells_) + array(regions_) + array(cell_status_) + array(free_cells_) +
                    array(points_) + array(incident_cell_) + array(vertex_status_) + array(labels_.vertices) +
                    array(hand_index_.n_cells);
  sum += labels_.faces.memory_bytes() + labels_.edges.memory_bytes() + locks_.faces.memory_bytes() +
         locks_.edges.memory_bytes() + properties_.memory_bytes();
  sum += hand_index_.face.bucket_count() * sizeof(void*) + hand_index_.face.size() * 5 * sizeof(void*);
  return sum;
}

// --- edges ---

bool TetMesh::gather_ring(RingPlace start, Ring& ring) const {
  int size = 0;
  ring.size = 0;
  ring.closed = false;
  for (RingPlace at = start; at.cell.is_valid(); at = next_in_ring(at)) {
    ring.closed = size > 0 && at.cell == start.cell;
    if (ring.closed) break;
    if (size == Ring::kCapacity) return false;
    ring.places[static_cast<std::size_t>(size++)] = at;
  }
  if (!ring.closed) {  // the boundary is met: what lies on the other side of the start belongs before it
    const int n_after = size;
    for (RingPlace at = previous_in_ring(start); at.cell.is_valid(); at = previous_in_ring(at)) {
      if (size == Ring::kCapacity) return false;
      ring.places[static_cast<std::size_t>(size++)] = at;
    }
    std::reverse(ring.places.begin() + n_after, ring.places.begin() + size);
    std::rotate(ring.places.begin(), ring.places.begin() + n_after, ring.places.begin() + size);
  }
  ring.size = size;
  return true;
}

int TetMesh::start_large_ring(RingPlace start, Ring& ring) const {
  RingPlace first = start;
  ring.size = 0;
  for (RingPlace at = previous_in_ring(start); at.cell.is_valid() && at.cell != start.cell;
       at = previous_in_ring(at))
    first = at;
  int n = 1;
  RingPlace at = next_in_ring(first);
  for (; at.cell.is_valid() && at.cell != first.cell; at = next_in_ring(at)) ++n;
  ring.closed = at.cell.is_valid();
  ring.places[0] = ring.closed ? start : first;
  return n;
}

bool TetMesh::is_boundary(HalfEdgeHandle e) const {
  const RingPlace start = ring_place(e);
  RingPlace at = next_in_ring(start);
  while (at.cell.is_valid() && at.cell != start.cell) at = next_in_ring(at);
  return !at.cell.is_valid();
}

/// True when no cell of the ring is smaller than the one that it is entered by.
static bool is_first_in_ring(const TetMesh& mesh, RingPlace start) {
  RingPlace at = mesh.next_in_ring(start);
  for (; at.cell.is_valid(); at = mesh.next_in_ring(at)) {
    if (at.cell < start.cell) return false;
    if (at.cell == start.cell) return true;
  }
  for (at = mesh.previous_in_ring(start); at.cell.is_valid(); at = mesh.previous_in_ring(at))
    if (at.cell < start.cell) return false;
  return true;
}

unsigned TetMesh::first_edges(CellHandle c) const {
  const Cell& k = cell(c);
  if (!k.v[0].is_valid()) return 0;
  unsigned smaller = 0;  // corners that a smaller cell lies across from; an invalid mate is larger than any
  for (unsigned i = 0; i < 4; ++i) smaller |= static_cast<unsigned>(k.mate[i].idx() / 4 < c.idx()) << i;
  unsigned found = 0;
  for (unsigned local = 0; local < 6; ++local) {
    const auto [p, q] = kEdgeOpposite[local];
    if ((smaller >> p & 1U) != 0 || (smaller >> q & 1U) != 0) continue;
    if (is_first_in_ring(*this, {c, p, q})) found |= 1U << local;
  }
  return found;
}

bool TetMesh::exists(EdgeHandle e) const {
  const CellHandle c(e.idx() / 6);
  if (!exists(c)) return false;
  const auto [p, q] = kEdgeOpposite[e.idx() % 6];
  const auto& mate = cell(c).mate;
  if (mate[p].idx() / 4 < c.idx() || mate[q].idx() / 4 < c.idx()) return false;
  return is_first_in_ring(*this, {c, p, q});
}

EdgeHandle TetMesh::edge_in_cell(CellHandle c, int local_edge) const {
  const auto& corners = kEdgeCorners[static_cast<std::size_t>(local_edge)];
  return edge_handle(halfedge_in_cell(c, corners[0], corners[1]));
}

HalfEdgeHandle TetMesh::halfedge_in_cell(CellHandle c, int from_corner, int to_corner) const {
  const auto from = static_cast<std::size_t>(from_corner);
  const auto to = static_cast<std::size_t>(to_corner);
  const VertexHandle a = cell(c).v[from];
  const VertexHandle b = cell(c).v[to];
  CellHandle smallest = c;
  const auto note = [&](CellHandle d, VertexHandle, VertexHandle) {
    smallest = std::min(smallest, d);
    return true;
  };
  const int local = kEdgeOfCorners[from][to];
  if (!walk_ring(c, local, note)) walk_ring_back(c, local, note);
  return find_halfedge_in_cell(a, b, smallest);
}

/// The handle is canonical only when c is the smallest cell of the ring; callers see to that.
static HalfEdgeHandle halfedge_at(CellHandle c, std::size_t from, std::size_t to) {
  const Index local = kEdgeOfCorners[from][to];
  return HalfEdgeHandle(12 * c.idx() + 2 * local + (kEdgeCorners[local][0] == from ? 0 : 1));
}

HalfEdgeHandle TetMesh::find_halfedge_in_cell(VertexHandle from, VertexHandle to, CellHandle c) const {
  const int i = cell(c).corner(from);
  const int j = cell(c).corner(to);
  if (i == 4 || j == 4 || i == j) return {};
  return halfedge_at(c, static_cast<std::size_t>(i), static_cast<std::size_t>(j));
}

HalfEdgeHandle TetMesh::next_halfedge_in_halfface(HalfEdgeHandle e, HalfFaceHandle h) const {
  const auto v = halfface_vertices(h);
  const auto edges_of_h = halfface_halfedges(h);
  for (std::size_t i = 0; i < 3; ++i)
    if (v[i] == from_vertex(e) && v[(i + 1) % 3] == to_vertex(e)) return edges_of_h[(i + 1) % 3];
  return {};
}

HalfEdgeHandle TetMesh::prev_halfedge_in_halfface(HalfEdgeHandle e, HalfFaceHandle h) const {
  const HalfEdgeHandle next = next_halfedge_in_halfface(e, h);
  return next.is_valid() ? next_halfedge_in_halfface(next, h) : next;
}

std::size_t TetMesh::valence(EdgeHandle e) const { return edge_faces(e).count(); }
std::size_t TetMesh::valence(VertexHandle v) const { return vertex_vertices(v).count(); }

// --- faces ---

std::array<HalfEdgeHandle, 3> TetMesh::halfface_halfedges(HalfFaceHandle h) const {
  const auto& f = kFaceCorners[h.idx() % 4];
  const CellHandle c = cell_of(h);
  return {halfedge_in_cell(c, f[0], f[1]), halfedge_in_cell(c, f[1], f[2]), halfedge_in_cell(c, f[2], f[0])};
}

std::array<EdgeHandle, 3> TetMesh::halfface_edges(HalfFaceHandle h) const {
  const auto e = halfface_halfedges(h);
  return {edge_handle(e[0]), edge_handle(e[1]), edge_handle(e[2])};
}

HalfFaceHandle TetMesh::adjacent_halfface_in_cell(HalfFaceHandle h, HalfEdgeHandle e) const {
  const Cell& k = cell(cell_of(h));
  const int a = k.corner(from_vertex(e));
  const int b = k.corner(to_vertex(e));
  HFR_REQUIRE(a < 4 && b < 4 && a != corner_of(h) && b != corner_of(h),
              "adjacent_halfface_in_cell: the edge is none of the half-face's");
  return halfface_of(cell_of(h), 6 - a - b - corner_of(h));  // the corners of a cell add up to 6
}

HalfFaceHandle TetMesh::adjacent_halfface_on_surface(HalfFaceHandle h, HalfEdgeHandle e) const {
  HFR_REQUIRE(is_boundary(h), "adjacent_halfface_on_surface: the half-face is not on the boundary");
  HalfFaceHandle g = adjacent_halfface_in_cell(h, e);
  while (opposite_halfface(g).is_valid()) g = adjacent_halfface_in_cell(opposite_halfface(g), e);
  return g;
}

std::array<HalfFaceHandle, 3> TetMesh::boundary_halfface_halffaces(HalfFaceHandle h) const {
  const auto e = halfface_halfedges(h);
  return {adjacent_halfface_on_surface(h, e[0]), adjacent_halfface_on_surface(h, e[1]),
          adjacent_halfface_on_surface(h, e[2])};
}

bool TetMesh::is_incident(FaceHandle f, EdgeHandle e) const {
  const auto v = face_vertices(f);
  const auto ends = edge_vertices(e);
  const auto is_end = [&](VertexHandle w) { return w == ends[0] || w == ends[1]; };
  if (std::count_if(v.begin(), v.end(), is_end) != 2) return false;
  const auto edges = face_edges(f);  // another fan has another edge of the same ends
  return std::find(edges.begin(), edges.end(), e) != edges.end();
}

std::array<VertexHandle, 3> TetMesh::halfface_vertices(HalfFaceHandle h, VertexHandle from) const {
  const auto v = halfface_vertices(h);
  for (std::size_t i = 0; i < 3; ++i)
    if (v[i] == from) return {v[i], v[(i + 1) % 3], v[(i + 2) % 3]};
  throw InvalidInput("halfface_vertices: vertex " + std::to_string(from.idx()) +
                     " is none of the half-face's");
}

// --- cells ---

std::array<VertexHandle, 4> TetMesh::cell_vertices(CellHandle c, VertexHandle v) const {
  const auto corner = static_cast<std::size_t>(cell(c).corner(v));
  HFR_REQUIRE(corner < 4, "cell_vertices: the vertex is none of the cell's");
  const auto f = halfface_vertices(halfface_of(c, static_cast<int>(corner)));
  return {v, f[0], f[2], f[1]};  // (f0, f1, f2, v) is positive; this is an even permutation of it
}

std::array<FaceHandle, 4> TetMesh::cell_faces(CellHandle c) const {
  std::array<FaceHandle, 4> faces_of_c;
  for (int k = 0; k < 4; ++k) faces_of_c[static_cast<std::size_t>(k)] = face_handle(halfface_of(c, k));
  return faces_of_c;
}

std::array<EdgeHandle, 6> TetMesh::cell_edges(CellHandle c) const {
  std::array<EdgeHandle, 6> edges_of_c;
  for (int k = 0; k < 6; ++k) edges_of_c[static_cast<std::size_t>(k)] = edge_in_cell(c, k);
  return edges_of_c;
}

std::array<HalfEdgeHandle, 12> TetMesh::cell_halfedges(CellHandle c) const {
  std::array<HalfEdgeHandle, 12> halfedges_of_c;
  for (std::size_t k = 0; k < 6; ++k) {
    halfedges_of_c[2 * k] = halfedge_in_cell(c, kEdgeCorners[k][0], kEdgeCorners[k][1]);
    halfedges_of_c[2 * k + 1] = opposite_halfedge(halfedges_of_c[2 * k]);
  }
  return halfedges_of_c;
}

bool TetMesh::is_boundary(CellHandle c) const {
  const auto& mate = cell(c).mate;
  return std::any_of(mate.begin(), mate.end(), [](HalfFaceHandle m) { return !m.is_valid(); });
}

bool TetMesh::is_boundary(VertexHandle v) const {
  const auto halffaces_of_v = vertex_halffaces(v);
  return std::any_of(halffaces_of_v.begin(), halffaces_of_v.end(),
                     [&](HalfFaceHandle h) { return is_boundary(h); });
}

// --- by vertices ---

/// A cell of both vertices, sought from the incident cell of a by crossing the face at a that b lies farthest
/// behind. Takes a few steps where a's cells are positive. An invalid handle says no more than that it was
/// not found that way.
static CellHandle walk_towards(const TetMesh& mesh, VertexHandle a, VertexHandle b) {
  constexpr int kSteps = 16;
  const Vec3 from = mesh.point(a);
  const Vec3 direction = mesh.point(b) - from;
  CellHandle c = mesh.incident_cell(a);
  for (int step = 0; step < kSteps; ++step) {
    const Cell& k = mesh.cell(c);
    if (k.has(b)) return c;
    const auto& corners = kFaceCorners[k.own_corner(a)];
    std::array<Vec3, 3> side;
    for (std::size_t i = 0; i < 3; ++i) side[i] = mesh.point(k.v[corners[i]]) - from;
    double farthest = 0;
    HalfFaceHandle exit;
    for (std::size_t i = 0; i < 3; ++i) {
      const double behind = dot(direction, cross(side[(i + 1) % 3], side[(i + 2) % 3]));
      if (!(behind > farthest) || !k.mate[corners[i]].is_valid()) continue;
      farthest = behind;
      exit = k.mate[corners[i]];
    }
    if (!exit.is_valid()) return {};
    c = cell_of(exit);
  }
  return {};
}

/// The same for two to four vertices: on from the edge of the first two round its ring.
template <std::size_t N>
static CellHandle walk_to_cell(const TetMesh& mesh, const std::array<VertexHandle, N>& wanted) {
  CellHandle c = walk_towards(mesh, wanted[0], wanted[1]);
  if (!c.is_valid()) c = walk_towards(mesh, wanted[1], wanted[0]);
  if (N == 2 || !c.is_valid()) return c;
  const auto corner = [&](VertexHandle v) { return static_cast<std::size_t>(mesh.cell(c).corner(v)); };
  const int local = kEdgeOfCorners[corner(wanted[0])][corner(wanted[1])];
  if (local == 6) return {};
  CellHandle found;
  const auto seek = [&](CellHandle d, VertexHandle, VertexHandle) {
    const Cell& k = mesh.cell(d);
    if (std::all_of(wanted.begin(), wanted.end(), [&](VertexHandle w) { return k.has(w); })) found = d;
    return !found.is_valid();
  };
  if (!mesh.walk_ring(c, local, seek) && !found.is_valid()) mesh.walk_ring_back(c, local, seek);
  return found;
}

template <std::size_t N>
CellHandle TetMesh::find_cell_with(const std::array<VertexHandle, N>& wanted) const {
  const auto exists_here = [&](VertexHandle v) { return exists(v) && incident_cell(v).is_valid(); };
  if (!std::all_of(wanted.begin(), wanted.end(), exists_here)) return {};
  if (const CellHandle near = walk_to_cell(*this, wanted); near.is_valid()) return near;
  for (VertexHandle v : wanted) {  // should v pinch the mesh, the thing may hang on the others alone
    const StarRange<policy::StarCells> star = vertex_cells(v);
    for (CellHandle c : star) {
      const Cell& k = cell(c);
      if (std::all_of(wanted.begin(), wanted.end(), [&](VertexHandle w) { return k.has(w); })) return c;
    }
  }
  return {};
}

HalfEdgeHandle TetMesh::find_halfedge(VertexHandle from, VertexHandle to) const {
  if (from == to) return {};
  const CellHandle c = find_cell_with<2>({from, to});
  return c.is_valid() ? halfedge_in_cell(c, cell(c).corner(from), cell(c).corner(to)) : HalfEdgeHandle();
}

EdgeHandle TetMesh::find_edge(VertexHandle a, VertexHandle b) const {
  const HalfEdgeHandle e = find_halfedge(a, b);
  return e.is_valid() ? edge_handle(e) : EdgeHandle();
}

HalfFaceHandle TetMesh::find_halfface_in_cell(const std::array<VertexHandle, 3>& wanted, CellHandle c) const {
  for (HalfFaceHandle h : cell_halffaces(c))
    if (CyclicOrder::key(halfface_vertices(h)) == CyclicOrder::key(wanted)) return h;
  return {};
}

HalfFaceHandle TetMesh::find_halfface(const std::array<VertexHandle, 3>& wanted) const {
  const CellHandle c = find_cell_with<3>(wanted);
  if (!c.is_valid()) return {};
  const HalfFaceHandle h = find_halfface_in_cell(wanted, c);
  if (h.is_valid()) return h;
  const HalfFaceHandle other = find_halfface_in_cell({wanted[0], wanted[2], wanted[1]}, c);
  return other.is_valid() ? opposite_halfface(other) : other;
}

FaceHandle TetMesh::find_face(const std::array<VertexHandle, 3>& wanted) const {
  const CellHandle c = find_cell_with<3>(wanted);
  if (!c.is_valid()) return {};
  for (HalfFaceHandle h : cell_halffaces(c))
    if (AnyOrder::key(halfface_vertices(h)) == AnyOrder::key(wanted)) return face_handle(h);
  return {};
}

CellHandle TetMesh::find_cell(const std::array<VertexHandle, 4>& wanted) const {
  const auto key = AnyOrder::key(wanted);
  if (std::adjacent_find(key.begin(), key.end()) != key.end()) return {};
  return find_cell_with<4>(wanted);
}

// --- vertices round a vertex ---

/// Fewer handles than there are slots.
template <class H, std::size_t kSlots>
class SmallSet {
 public:
  SmallSet() { std::fill(slot_.begin(), slot_.end(), H()); }
  /// 1 when it was not there. Without a branch that depends on the answer, which nobody can foretell.
  unsigned enter(H h) {
    std::size_t at = (static_cast<std::uint32_t>(h.idx()) * 0x9e3779b1U >> 16) % kSlots;
    while (slot_[at].is_valid() && slot_[at] != h) at = (at + 1) % kSlots;
    const unsigned is_new = slot_[at].is_valid() ? 0 : 1;
    slot_[at] = h;
    return is_new;
  }

 private:
  RawArray<H, kSlots> slot_;
};

/// The neighbours of v into `out`, where the star has at most `most_cells` cells; 0 where it has more. A cell
/// has one vertex that the cell which it was entered from has not: the one opposite the face between them.
template <std::size_t kSlots>
static std::size_t gather_neighbours(const TetMesh& mesh, VertexHandle v, std::size_t most_cells,
                                     HalfFaceHandle* entry, VertexHandle* out) {
  SmallSet<CellHandle, kSlots> cells;
  SmallSet<VertexHandle, kSlots> neighbours;
  const CellHandle first = mesh.incident_cell(v);
  entry[0] = halfface_of(first, mesh.cell(first).own_corner(v));
  cells.enter(first);
  std::size_t n_cells = 1;
  for (std::size_t i = 0; i < n_cells; ++i) {
    const Cell& k = mesh.cell(cell_of(entry[i]));
    const unsigned corner = k.own_corner(v);
    for (unsigned turn = 1; turn < 4; ++turn) {
      const HalfFaceHandle m = k.mate[(corner + turn) & 3];
      if (!m.is_valid()) continue;
      __builtin_prefetch(&mesh.cell(cell_of(m)));  // its turn comes in a few rounds
      entry[n_cells] = m;                          // kept if its cell is new
      n_cells += cells.enter(cell_of(m));
      if (n_cells > most_cells) return 0;
    }
  }
  std::size_t n = 0;
  for (VertexHandle w : mesh.cell(first).v) {
    if (w == v) continue;
    neighbours.enter(w);
    out[n++] = w;
  }
  for (std::size_t i = 1; i < n_cells; ++i) {
    out[n] = mesh.halfface_opposite_vertex(entry[i]);
    n += neighbours.enter(out[n]);
  }
  return n;
}

VertexVertices::VertexVertices(const TetMesh& mesh, VertexHandle v) : mesh_(&mesh), v_(v) {
  if (!mesh.incident_cell(v).is_valid()) return;
  constexpr std::size_t kMostInSmall = 64;  // cells; few stars have more, and small tables are soon cleared
  RawArray<HalfFaceHandle, Star::kCapacity + 1> entry;
  limit_ = gather_neighbours<128>(mesh, v, kMostInSmall, entry.data(), neighbours_.data());
  if (limit_ > 0) return;
  limit_ = gather_neighbours<1024>(mesh, v, Star::kCapacity, entry.data(), neighbours_.data());
  if (limit_ > 0) return;
  scan_ = true;
  limit_ = 4 * mesh.n_cells();
}

bool VertexVertices::scan_has(std::size_t place) const {
  const CellHandle c(place / 4);
  const int corner = mesh_->cell(c).corner(v_);
  const auto other = place % 4;
  if (corner == 4 || static_cast<std::size_t>(corner) == other) return false;
  const EdgeHandle e(6 * c.idx() + kEdgeOfCorners[static_cast<std::size_t>(corner)][other]);
  if (!mesh_->exists(e)) return false;
  // Of several fans of an edge, the one with the smallest cell names the neighbour.
  const auto around = mesh_->vertex_cells(mesh_->cell(c).v[other]);
  return std::none_of(around.begin(), around.end(),
                      [&](CellHandle d) { return d < c && mesh_->cell(d).has(v_); });
}

}  // namespace hfr
