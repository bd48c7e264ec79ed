// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/Features.hh"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include "Parallel/DisjointSets.hh"
#include "Quality/CellQuality.hh"
#include "Surface/InputSurface.hh"
#include "Surface/PlaneFacets.hh"

namespace hfr::surface {
namespace {

/// Share of the diagonal: vertices no further from a plane or line count as in it. Moving them onto it
/// changes the volume by no more than that length times the area.
constexpr double kCoplanar = 1e-13;

/// Planar facets, over edges where the surface does not turn back, and their planes.
std::vector<std::uint32_t> find_facets(const Arrays& arrays, const std::vector<Edge>& edges, double tolerance,
                                       std::vector<MotionConstraint>& planes) {
  PlaneFacets facets = grow_facets(arrays, edges, tolerance, Look::kAlike, [](const Edge&) { return true; });
  for (std::uint32_t f : facets.largest)
    planes.push_back({SurfaceKind::kFacet, arrays.points[arrays.faces[f][0].idx()],
                      unit(scaled_normal(corners(arrays.points, arrays.faces[f])))});
  return std::move(facets.number);
}

/// Edges that are features by their angle alone, in connected sets that fit into a box of a few times the
/// distance that is allowed, are noise of the input: they are no features any more.
void drop_small(std::span<const Vec3> points, std::vector<Edge>& edges,
                const std::vector<std::uint8_t>& only_turns, double distance) {
  constexpr double kSmall = 3;
  struct Set {
    Vec3 low, high;
    bool keeps = false;  // the set has an edge that is a feature for another reason
  };
  par::DisjointSets<Index> connected(points.size());
  for (const Edge& e : edges)
    if (e.feature) connected.join(e.a.idx(), e.b.idx());
  std::map<Index, Set> sets;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    if (!e.feature) continue;
    const auto [at, is_new] = sets.try_emplace(connected.find(e.a.idx()));
    Set& set = at->second;
    if (is_new) set.low = set.high = points[e.a.idx()];
    for (VertexHandle v : {e.a, e.b}) {
      const Vec3 p = points[v.idx()];
      for (int d = 0; d < 3; ++d) {
        set.low[d] = std::min(set.low[d], p[d]);
        set.high[d] = std::max(set.high[d], p[d]);
      }
    }
    set.keeps = set.keeps || !only_turns[i];
  }
  for (Edge& e : edges) {
    if (!e.feature) continue;
    const Set& set = sets.at(connected.find(e.a.idx()));
    if (!set.keeps && norm(set.high - set.low) < kSmall * distance) e.feature = false;
  }
}

/// Edges that are features by their angle alone, and across which the surface turns by less when what lies
/// within `reach` is taken together, are noise as well: on each side the faces are followed as far as that,
/// across no other feature. A sharp edge keeps its two sides apart; one of a bumpy surface has the same
/// surface on both sides.
class Regions {
 public:
  Regions(const Arrays& arrays, std::vector<Edge>& edges, const std::vector<std::uint8_t>& only_turns,
          double reach, double cosine)
      : arrays_(arrays),
        edges_(edges),
        only_turns_(only_turns),
        reach_(reach),
        cosine_(cosine),
        edge_of_(arrays.faces.size(), {kNone, kNone, kNone}),
        seen_(arrays.faces.size(), 0) {
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
      if (!edges[i].manifold) continue;
      for (std::size_t k = 0; k < 2; ++k) edge_of_[edges[i].f[k]][edges[i].k[k]] = i;
    }
  }
  void drop_noise() {
    constexpr int kPasses = 4;  // across a feature that one pass drops, the next one follows the faces
    for (int pass = 0; pass < kPasses; ++pass) {
      std::vector<std::uint32_t> noise;
      for (std::uint32_t i = 0; i < edges_.size(); ++i)
        if (edges_[i].feature && only_turns_[i] && is_noise(edges_[i])) noise.push_back(i);
      for (std::uint32_t i : noise) edges_[i].feature = false;
      if (noise.empty()) return;
    }
  }

 private:
  static constexpr std::uint32_t kNone = ~0U;

  bool is_noise(const Edge& e) {
    const Vec3 middle = 0.5 * (arrays_.points[e.a.idx()] + arrays_.points[e.b.idx()]);
    return dot(normal(e.f[0], middle), normal(e.f[1], middle)) >= cosine_;
  }
  /// Mean normal of the faces within reach of x that a walk from f comes to; a large face counts only for its
  /// part there.
  Vec3 normal(std::uint32_t f, Vec3 x) {
    ++mark_;
    Vec3 sum;
    front_.assign(1, f);
    seen_[f] = mark_;
    while (!front_.empty()) {
      const std::uint32_t g = front_.back();
      front_.pop_back();
      const Triangle t = corners(arrays_.points, arrays_.faces[g]);
      const Vec3 n = scaled_normal(t);
      const double twice_area = norm(n);
      const double most = reach_ * reach_;
      sum = sum + (twice_area > most ? most / twice_area : 1.0) * n;
      for (std::uint32_t i : edge_of_[g]) {
        if (i == kNone || edges_[i].feature) continue;
        const std::uint32_t next = edges_[i].f[0] == g ? edges_[i].f[1] : edges_[i].f[0];
        if (seen_[next] == mark_) continue;
        seen_[next] = mark_;
        const Triangle there = corners(arrays_.points, arrays_.faces[next]);
        if (norm2(nearest_point(there, x) - x) <= reach_ * reach_) front_.push_back(next);
      }
    }
    return unit(sum);
  }

  const Arrays& arrays_;
  std::vector<Edge>& edges_;
  const std::vector<std::uint8_t>& only_turns_;
  double reach_, cosine_;
  std::vector<std::array<std::uint32_t, 3>> edge_of_;
  std::vector<std::uint32_t> seen_, front_;
  std::uint32_t mark_ = 0;
};

struct Incidence {
  std::uint32_t n_features = 0;
  std::array<VertexHandle, 2> along;  // other ends of the first two features here
  std::uint32_t face = 0;             // some face of the vertex
  bool locked = false;
  bool crosses = false;                   // a feature here has other than two faces, or there are over two
  std::array<std::uint32_t, 4> beside{};  // flat mode: the facets beside the first two features
};

MotionConstraint motion_constraint_of(std::span<const Vec3> points, VertexHandle v, const Incidence& at,
                                      const SurfaceOptions& options, double tolerance,
                                      MotionConstraint plane) {
  const Vec3 p = points[v.idx()];
  const MotionConstraint fixed{SurfaceKind::kFixed, p, {}};
  if (at.locked || (at.n_features != 0 && at.n_features != 2)) return fixed;
  if (at.n_features == 0) return plane;
  const Vec3 back = points[at.along[0].idx()];
  const Vec3 ahead = points[at.along[1].idx()];
  const Vec3 axis = unit(ahead - back);
  if (options.mode == SurfaceMode::kFlat) {
    const Vec3 r = p - back;
    const bool straight = norm(r - dot(r, axis) * axis) <= tolerance && dot(p - back, ahead - p) > 0;
    return straight ? MotionConstraint{SurfaceKind::kCurve, back, axis} : fixed;
  }
  const double cosine = dot(unit(p - back), unit(ahead - p));
  return cosine >= std::cos(options.feature_angle * (std::numbers::pi / 180.0))
             ? MotionConstraint{SurfaceKind::kCurve, p, axis}
             : fixed;
}

}  // namespace

namespace {

std::array<VertexHandle, 3> sorted(std::array<VertexHandle, 3> f) {
  std::sort(f.begin(), f.end());
  return f;
}

/// The faces that the user wants as they are.
class FixedFaces {
 public:
  FixedFaces(const SurfaceOptions& options, const Locks& locks)
      : patches_(options.fixed_patches.begin(), options.fixed_patches.end()), locks_(locks) {
    for (const auto& f : options.fixed_faces) faces_.insert(sorted(f));
    for (const auto& pair : options.periodic) periodic_.insert(pair.begin(), pair.end());
  }
  bool has(const std::array<VertexHandle, 3>& f, const int* label) const {
    return faces_.contains(sorted(f)) || locks_.faces.find(f) ||
           (label && (patches_.contains(*label) || locks_.patches.contains(*label)));
  }
  bool is_periodic(const int* label) const { return label && periodic_.contains(*label); }

 private:
  std::set<std::array<VertexHandle, 3>> faces_;
  std::set<int> patches_, periodic_;
  const Locks& locks_;
};

void add_fixed(Arrays& arrays, const SurfaceOptions& options) {
  arrays.locked_edges.insert(arrays.locked_edges.end(), options.fixed_edges.begin(),
                             options.fixed_edges.end());
  for (auto& e : arrays.locked_edges)
    if (e[1] < e[0]) std::swap(e[0], e[1]);
  std::sort(arrays.locked_edges.begin(), arrays.locked_edges.end());
  for (VertexHandle v : options.fixed_vertices)
    if (v.idx() < arrays.points.size()) arrays.locked_vertices.push_back(v);
}

/// A labelled face inside a region is no part of the surface, but the vertices and edges it shares with it
/// are locked.
bool is_inside(const TetMesh& mesh, const std::array<VertexHandle, 3>& f) {
  const HalfFaceHandle h = mesh.find_halfface(f);
  return h.is_valid() && !mesh.is_boundary(h) &&
         mesh.region(cell_of(h)) == mesh.region(cell_of(mesh.opposite_halfface(h)));
}

void lock_labelled_inside(const TetMesh& mesh, Arrays& arrays) {
  std::vector<std::uint8_t> on_surface(mesh.n_vertices(), 0);
  for (const auto& f : arrays.faces)
    for (VertexHandle v : f) on_surface[v.idx()] = 1;
  for (const auto& entry : mesh.labels().faces.entries()) {
    const auto& v = entry.vertices;
    const bool known =
        std::all_of(v.begin(), v.end(), [&](VertexHandle u) { return on_surface[u.idx()] != 0; });
    if (known && !is_inside(mesh, v)) continue;
    arrays.locked_vertices.insert(arrays.locked_vertices.end(), v.begin(), v.end());
  }
}

/// Is the half-face a face of the surface? Interfaces count from the smaller region.
bool is_surface(const TetMesh& mesh, HalfFaceHandle h) {
  const HalfFaceHandle m = mesh.opposite_halfface(h);
  return !m.is_valid() || mesh.region(cell_of(h)) < mesh.region(cell_of(m));
}

void add_face(const TetMesh& mesh, HalfFaceHandle h, const FixedFaces& fixed, Arrays& arrays) {
  const auto& labels = mesh.labels().faces;
  const auto f = mesh.halfface_vertices(h);
  const std::size_t entry = labels.position(f);
  const int* label = entry < labels.size() ? &labels.entries()[entry].value : nullptr;
  arrays.faces.push_back({f[0], f[2], f[1]});
  arrays.halffaces.push_back(h);
  arrays.at_invalid.push_back(orientation(mesh, cell_of(h)) > 0 ? 0 : 1);
  arrays.patch.push_back(label ? *label : 0);
  const bool inward = label && CyclicOrder::key(labels.entries()[entry].vertices) == CyclicOrder::key(f);
  arrays.inward.push_back(inward ? 1 : 0);
  const HalfFaceHandle m = mesh.opposite_halfface(h);
  arrays.interface.push_back(m.is_valid() ? 1 : 0);
  arrays.regions.push_back({mesh.region(cell_of(h)), m.is_valid() ? mesh.region(cell_of(m)) : 0});
  arrays.fixed.push_back(fixed.has(f, label) ? 1 : 0);
  arrays.locked.push_back(arrays.fixed.back() || fixed.is_periodic(label) ? 1 : 0);
}

/// What labels of edges, and what is fixed, hold.
void add_locks(const TetMesh& mesh, Arrays& arrays) {
  for (const auto& entry : mesh.labels().edges.entries()) {  // edges inside the volume, too
    arrays.locked_edges.push_back(entry.vertices);
    arrays.locked_vertices.insert(arrays.locked_vertices.end(), entry.vertices.begin(), entry.vertices.end());
  }
  for (const auto& entry : mesh.locks().edges.entries()) {
    arrays.locked_edges.push_back(entry.vertices);
    arrays.locked_vertices.insert(arrays.locked_vertices.end(), entry.vertices.begin(), entry.vertices.end());
  }
  for (const auto& entry : mesh.locks().faces.entries())  // faces inside the volume, too
    arrays.locked_vertices.insert(arrays.locked_vertices.end(), entry.vertices.begin(), entry.vertices.end());
  for (VertexHandle v : mesh.vertices())
    if (mesh.is_fixed(v)) arrays.locked_vertices.push_back(v);
}

}  // namespace

Arrays gather(const TetMesh& mesh, const SurfaceOptions& options, par::Policy policy) {
  const auto halffaces = par::compact<Index>(policy, 4 * mesh.n_cells(), [&](std::size_t i) {
    return !mesh.is_deleted(cell_of(HalfFaceHandle(i))) && is_surface(mesh, HalfFaceHandle(i));
  });
  const FixedFaces fixed(options, mesh.locks());
  Arrays arrays;
  arrays.points = mesh.points();
  for (Index i : halffaces) add_face(mesh, HalfFaceHandle(i), fixed, arrays);
  lock_labelled_inside(mesh, arrays);
  add_locks(mesh, arrays);
  add_fixed(arrays, options);
  return arrays;
}

Arrays gather_own(const TetMesh& part, const SurfaceOptions& options,
                  const std::function<bool(CellHandle)>& is_own_cell,
                  const std::function<bool(VertexHandle)>& is_own_vertex) {
  const FixedFaces fixed(options, part.locks());
  Arrays arrays;
  arrays.points = part.points();
  for (std::size_t c = 0; c < part.n_cells(); ++c) {
    if (part.is_deleted(CellHandle(c)) || !is_own_cell(CellHandle(c))) continue;
    for (HalfFaceHandle h : part.cell_halffaces(CellHandle(c)))
      if (is_surface(part, h)) add_face(part, h, fixed, arrays);
  }
  for (const auto& entry : part.labels().faces.entries()) {
    const auto& v = entry.vertices;
    if (is_own_vertex(*std::min_element(v.begin(), v.end())) && is_inside(part, v))
      arrays.locked_vertices.insert(arrays.locked_vertices.end(), v.begin(), v.end());
  }
  add_locks(part, arrays);
  return arrays;
}

Arrays gather(const TriangleMesh& mesh, const SurfaceOptions& options) {
  const Locks none;
  const FixedFaces fixed(options, none);
  Arrays arrays;
  arrays.points = mesh.points;
  arrays.faces = mesh.triangles;
  arrays.halffaces.resize(arrays.faces.size());
  arrays.at_invalid.resize(arrays.faces.size());
  arrays.patch = mesh.patches;
  arrays.patch.resize(arrays.faces.size());
  arrays.inward.resize(arrays.faces.size());
  arrays.interface.resize(arrays.faces.size());
  arrays.regions.resize(arrays.faces.size());
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    const int* label = &arrays.patch[i];
    arrays.locked.push_back(fixed.has(arrays.faces[i], label) || fixed.is_periodic(label) ? 1 : 0);
  }
  arrays.fixed = arrays.locked;
  add_fixed(arrays, options);
  return arrays;
}

std::vector<Edge> find_edges(const Arrays& arrays) {
  struct Use {
    VertexHandle a, b;
    std::uint32_t f;
    std::uint8_t k;
    bool forth;  // the face has the edge from a to b
  };
  std::vector<Use> uses;
  uses.reserve(3 * arrays.faces.size());
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      const VertexHandle a = arrays.faces[i][k];
      const VertexHandle b = arrays.faces[i][(k + 1U) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(i), k, a < b});
    }
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& x, const Use& y) { return std::tie(x.a, x.b, x.f) < std::tie(y.a, y.b, y.f); });
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b) ++end;
    Edge edge{uses[i].a, uses[i].b, {uses[i].f, uses[end - 1].f}, {uses[i].k, uses[end - 1].k}};
    edge.manifold = end - i == 2 && uses[i].forth != uses[i + 1].forth;
    edges.push_back(edge);
    i = end;
  }
  return edges;
}

double diagonal(const Arrays& arrays) {
  if (arrays.faces.empty()) return 0;
  Vec3 low = arrays.points[arrays.faces[0][0].idx()];
  Vec3 high = low;
  for (const auto& f : arrays.faces) {
    for (VertexHandle v : f) {
      const Vec3 p = arrays.points[v.idx()];
      for (int d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], p[d]);
        high[d] = std::max(high[d], p[d]);
      }
    }
  }
  return norm(high - low);
}

std::vector<std::uint8_t> held_vertices(const Arrays& arrays) {
  std::vector<std::uint8_t> held(arrays.points.size(), 0);
  const auto hold = [&](const auto& vertices) {
    for (VertexHandle v : vertices) held[v.idx()] = 1;
  };
  hold(arrays.locked_vertices);
  for (const auto& e : arrays.locked_edges) hold(e);
  for (std::size_t i = 0; i < arrays.faces.size(); ++i)
    if (arrays.locked[i] || arrays.interface[i]) hold(arrays.faces[i]);
  return held;
}

double flat_tolerance(const Arrays& arrays) { return kCoplanar * diagonal(arrays); }

double mean_edge(const Arrays& arrays) {
  double sum = 0;
  for (const auto& f : arrays.faces) {
    const Triangle t = corners(arrays.points, f);
    for (std::size_t k = 0; k < 3; ++k) sum += norm(t[(k + 1) % 3] - t[k]);
  }
  return arrays.faces.empty() ? 0 : sum / (3.0 * static_cast<double>(arrays.faces.size()));
}

double allowed_distance(const Arrays& arrays, const SurfaceOptions& options) {
  constexpr double kOfEdge = 0.3, kOfDiagonal = 0.005;
  if (options.mode != SurfaceMode::kFree) return 0;
  if (options.hausdorff) return *options.hausdorff;
  return std::min(kOfEdge * mean_edge(arrays), kOfDiagonal * diagonal(arrays));
}

namespace {

/// What the faces at each vertex say of it, before edges do; `on_surface` is set where there is one.
std::vector<Incidence> incidences(const Arrays& arrays, std::vector<std::uint8_t>& on_surface) {
  std::vector<Incidence> at(arrays.points.size());
  on_surface.assign(arrays.points.size(), 0);
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    for (VertexHandle v : arrays.faces[i]) {
      on_surface[v.idx()] = 1;
      at[v.idx()].face = static_cast<std::uint32_t>(i);
      if (arrays.fixed[i]) at[v.idx()].locked = true;
    }
  }
  return at;
}

/// Sets `locked` and `feature` of the edges; `turns` says of an edge with two faces whether their angle makes
/// it one. Returns 1 for edges that are features, if at all, by their angle alone.
template <class Turns>
std::vector<std::uint8_t> mark_edges(const Arrays& arrays, std::vector<Edge>& edges, Turns&& turns) {
  std::vector<std::uint8_t> only_turns;
  for (Edge& e : edges) {
    e.locked = std::binary_search(arrays.locked_edges.begin(), arrays.locked_edges.end(),
                                  std::array<VertexHandle, 2>{e.a, e.b});
    const bool other = !e.manifold || arrays.patch[e.f[0]] != arrays.patch[e.f[1]] || e.locked;
    e.feature = other || turns(e);
    only_turns.push_back(other ? 0 : 1);
  }
  return only_turns;
}

/// Counts the features at each vertex; in flat mode notes the facets beside them as well.
void count_features(const Features& found, std::span<Incidence> at) {
  for (const Edge& e : found.edges) {
    if (!e.feature) continue;
    const std::array<VertexHandle, 2> ends = {e.a, e.b};
    for (std::size_t i = 0; i < 2; ++i) {
      Incidence& here = at[ends[i].idx()];
      here.crosses = here.crosses || !e.manifold || here.n_features >= 2;
      if (!found.facet.empty() && !here.crosses)
        for (std::size_t side = 0; side < 2; ++side)
          here.beside[2 * here.n_features + side] = found.facet[e.f[side]];
      if (here.n_features < 2) here.along[here.n_features] = ends[1 - i];
      ++here.n_features;
      here.locked = here.locked || e.locked;
    }
  }
}

/// Locks vertices in which sheets of several facets meet without an edge in common: to move such a vertex in
/// the facet of one would take it out of that of another.
void lock_meeting_sheets(const Arrays& arrays, std::span<const std::uint32_t> facet,
                         std::span<Incidence> at) {
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    for (VertexHandle v : arrays.faces[i]) {
      Incidence& here = at[v.idx()];
      if (here.n_features == 0) {
        here.locked = here.locked || facet[i] != facet[here.face];
      } else if (!here.crosses) {
        const auto end = here.beside.begin() + 2 * here.n_features;
        here.locked = here.locked || std::find(here.beside.begin(), end, facet[i]) == end;
      }
    }
  }
}

/// Unit normals of the faces.
std::vector<Vec3> normals(const Arrays& arrays) {
  std::vector<Vec3> normal;
  for (const auto& face : arrays.faces) normal.push_back(unit(scaled_normal(corners(arrays.points, face))));
  return normal;
}

/// What the vertices may do, once the features are known. `planes`: of the facets; only in flat mode.
void find_motion_constraints(const Arrays& arrays, const SurfaceOptions& options,
                             std::span<const Vec3> normal, std::span<const MotionConstraint> planes,
                             Features& found) {
  const bool flat = options.mode != SurfaceMode::kFree;
  const double tolerance = flat_tolerance(arrays);
  std::vector<std::uint8_t> on_surface;
  std::vector<Incidence> at = incidences(arrays, on_surface);
  count_features(found, at);
  if (flat) lock_meeting_sheets(arrays, found.facet, at);
  for (VertexHandle v : arrays.locked_vertices) at[v.idx()].locked = true;
  found.motion_constraint.resize(arrays.points.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!on_surface[i]) continue;
    const std::uint32_t f = at[i].face;
    const MotionConstraint plane =
        flat ? planes[found.facet[f]] : MotionConstraint{SurfaceKind::kFacet, arrays.points[i], normal[f]};
    found.motion_constraint[i] =
        motion_constraint_of(arrays.points, VertexHandle(i), at[i], options, tolerance, plane);
  }
}

}  // namespace

Features find_features(const Arrays& arrays, const SurfaceOptions& options, double distance) {
  const bool flat = options.mode != SurfaceMode::kFree;
  const double cosine = std::cos(options.feature_angle * (std::numbers::pi / 180.0));
  Features found;
  found.edges = find_edges(arrays);
  std::vector<MotionConstraint> planes;
  if (flat) found.facet = find_facets(arrays, found.edges, flat_tolerance(arrays), planes);
  const std::vector<Vec3> normal = normals(arrays);
  const std::vector<std::uint8_t> only_turns = mark_edges(arrays, found.edges, [&](const Edge& e) {
    return flat ? found.facet[e.f[0]] != found.facet[e.f[1]] : dot(normal[e.f[0]], normal[e.f[1]]) < cosine;
  });
  if (!flat && distance > 0) {
    constexpr double kReach = 3;
    Regions(arrays, found.edges, only_turns, kReach * distance, cosine).drop_noise();
    drop_small(arrays.points, found.edges, only_turns, distance);
  }
  find_motion_constraints(arrays, options, normal, planes, found);
  return found;
}

Features find_features_again(const Arrays& arrays, const SurfaceOptions& options,
                             std::span<const std::array<Vec3, 2>> segments, std::vector<Vec3> corners) {
  /// Share of the diagonal: what is no further from a segment lies on it but for rounding.
  constexpr double kOnSegment = 1e-9;
  const double tolerance = kOnSegment * diagonal(arrays);
  std::optional<InputSurface> before;
  if (!segments.empty()) before.emplace(segments);
  const auto lies_there = [&](Vec3 x) { return before && before->any_within(x, tolerance).has_value(); };
  Features found;
  found.edges = find_edges(arrays);
  mark_edges(arrays, found.edges, [&](const Edge& e) {
    const Vec3 a = arrays.points[e.a.idx()];
    const Vec3 b = arrays.points[e.b.idx()];
    return lies_there(a) && lies_there(b) && lies_there(0.5 * (a + b));
  });
  find_motion_constraints(arrays, options, normals(arrays), {}, found);
  const auto less = [](Vec3 a, Vec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  std::sort(corners.begin(), corners.end(), less);
  for (std::size_t i = 0; i < found.motion_constraint.size(); ++i) {
    MotionConstraint& here = found.motion_constraint[i];
    if (here.kind != SurfaceKind::kInside &&
        std::binary_search(corners.begin(), corners.end(), arrays.points[i], less))
      here = {SurfaceKind::kFixed, arrays.points[i], {}};
  }
  return found;
}

}  // namespace hfr::surface
