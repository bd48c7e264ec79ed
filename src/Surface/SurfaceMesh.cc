// SPDX-License-Identifier: BSD-3-Clause
// The one file that includes OpenMesh: a translation unit with it takes ten seconds to compile.
#include "Surface/SurfaceMesh.hh"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// After the mesh, whose traits it specialises.
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_set>

#include "Operators/Cavity.hh"
#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"
#include "Surface/Periodic.hh"

namespace hfr {
namespace {

using surface::Arrays;
using surface::scaled_normal;
using surface::unit;

struct Traits : OpenMesh::DefaultTraits {
  using Point = Eigen::Vector3d;
  using Normal = Eigen::Vector3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using Om = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using OmVertex = Om::VertexHandle;
using OmEdge = Om::EdgeHandle;
using OmHalfedge = Om::HalfedgeHandle;
using OmFace = Om::FaceHandle;

Eigen::Vector3d eigen(Vec3 p) { return {p.x, p.y, p.z}; }

constexpr double kDegree = std::numbers::pi / 180.0;
/// Of the mean edge length of the surface: normals of triangles no larger say little.
constexpr double kDetail = 0.1;
/// How far apart the points of a triangle are by which its distance is judged, of the mean edge; and into how
/// many pieces its edges are cut at least and at most.
constexpr double kSpacing = 0.3;
constexpr int kLeastCuts = 2;
constexpr int kMostCuts = 12;
/// The samples are judged by somewhat less than what is allowed, for what lies between them.
constexpr double kBetween = 0.7;
/// Cosine of the largest angle that the normal of a triangle as small as noise may have with the input's.
constexpr double kNotBack = 0.1;
/// Share of the volume beyond which a change in the same direction is refused.
constexpr double kVolume = 5e-4;
/// And of a region's, which no single change may pass, either.
constexpr double kRegionVolume = 9e-4;
constexpr std::uint32_t kNoOrbit = ~0U;

struct FaceRecord {
  int patch = 0;
  bool locked = false;
  bool interface = false;
  bool inward = false;                   // its label names it as seen from inside
  std::array<std::uint32_t, 2> sides{};  // places of its regions in Impl::regions; the second of interfaces
  HalfFaceHandle inside;                 // where it was when last asked for
  std::uint32_t facet = 0;               // flat mode
  std::vector<Vec3> samples;             // of the input, free mode: points that were nearest to this face
  std::uint32_t beneath = 0;             // free mode: a triangle of the input that lies about there
};

/// Calls f(u, v) for the points of a triangle, at t0 + u·(t1-t0) + v·(t2-t0), that cut its edges into so many
/// pieces.
template <class F>
void for_lattice(int cuts, F&& f) {
  for (int i = 0; i <= cuts; ++i)
    for (int j = 0; i + j <= cuts; ++j) f(i, j);
}

/// Disjoint sets of corners.
class Union {
 public:
  explicit Union(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::array<VertexHandle, 3> sorted(std::array<VertexHandle, 3> f) {
  std::sort(f.begin(), f.end());
  return f;
}

}  // namespace

struct SurfaceMesh::Impl {
  SurfaceOptions options;
  double hausdorff = 0;
  double detail = 0;   // what is no larger is noise
  double spacing = 0;  // of points by which distances are judged
  Om om;
  std::vector<VertexHandle> vertex;              // of the volume, per OpenMesh vertex
  std::vector<OmVertex> first;                   // OpenMesh's per vertex of the volume; invalid inside
  std::vector<std::pair<Index, OmVertex>> more;  // where there are several, ascending
  std::vector<FaceRecord> faces;
  std::vector<Freedom> freedom;
  std::optional<InputSurface> shape, curves;      // free mode
  std::vector<std::array<VertexHandle, 3>> gone;  // labelled faces that are no more
  std::set<int> fresh;                            // labelled faces with other vertices
  Vec3 origin;                                    // from which volumes are measured
  double six_volume = 0, area = 0;                // of the input
  double six_gain = 0;                            // of the volume since
  struct Region {
    double six_volume = 0, six_gain = 0;
  };
  std::vector<Region> regions;  // by ascending number
  bool has_interfaces = false;
  std::vector<std::vector<VertexHandle>> orbits;
  std::vector<std::uint32_t> orbit_of;  // per vertex; empty without orbits
  bool alone = false;                   // there are no cells
  bool is_open = false;                 // and the surface encloses nothing

  bool flat() const { return options.mode != SurfaceMode::kFree; }

  template <class Visit>
  void for_sheets(VertexHandle v, Visit&& visit) const {
    if (v.idx() >= first.size() || !first[v.idx()].is_valid()) return;
    visit(first[v.idx()]);
    auto at = std::lower_bound(more.begin(), more.end(), v.idx(),
                               [](const auto& entry, Index wanted) { return entry.first < wanted; });
    for (; at != more.end() && at->first == v.idx(); ++at) visit(at->second);
  }
  bool has_one_sheet(VertexHandle v) const {
    int n = 0;
    for_sheets(v, [&](OmVertex) { ++n; });
    return n == 1;
  }
  /// Invalid when the surface has no such edge; where it has several, one of them.
  OmHalfedge find(VertexHandle a, VertexHandle b) const {
    OmHalfedge found;
    for_sheets(a, [&](OmVertex from) {
      for (auto it = om.cvoh_iter(from); it.is_valid(); ++it)
        if (vertex[static_cast<std::size_t>(om.to_vertex_handle(*it).idx())] == b) found = *it;
    });
    return found;
  }
  OmFace find(const std::array<VertexHandle, 3>& f) const {
    OmFace found;
    for_sheets(f[0], [&](OmVertex from) {
      for (auto it = om.cvoh_iter(from); it.is_valid(); ++it) {
        if (om.is_boundary(*it)) continue;
        const VertexHandle to = vertex_of(om.to_vertex_handle(*it));
        const VertexHandle third = vertex_of(om.to_vertex_handle(om.next_halfedge_handle(*it)));
        if ((to == f[1] && third == f[2]) || (to == f[2] && third == f[1])) found = om.face_handle(*it);
      }
    });
    return found;
  }
  VertexHandle vertex_of(OmVertex v) const { return vertex[static_cast<std::size_t>(v.idx())]; }
  std::array<VertexHandle, 3> vertices(OmFace f) const {
    OmHalfedge h = om.halfedge_handle(f);
    std::array<VertexHandle, 3> v;
    for (VertexHandle& w : v) {
      w = vertex_of(om.to_vertex_handle(h));
      h = om.next_halfedge_handle(h);
    }
    return v;
  }
  FaceRecord& record(OmFace f) { return faces[static_cast<std::size_t>(f.idx())]; }
  const FaceRecord& record(OmFace f) const { return faces[static_cast<std::size_t>(f.idx())]; }

  void build(const Arrays& arrays, const surface::Features& features);
  void take_shape(const Arrays& arrays, const surface::Features& features);
  void begin(const Arrays& arrays, const SurfaceOptions& wanted);
  /// The vertices of each orbit move together; not at all where they are of several kinds.
  void bind(std::vector<std::vector<VertexHandle>> found);

  using Guesses = std::span<std::uint32_t>;
  bool are_near(std::span<const Triangle> born, std::span<const Triangle> dead, Guesses beneath,
                double distance) const;
  bool turn_little(std::span<const Triangle> born, std::span<const Triangle> dead, Guesses beneath,
                   double distance) const;

  OmVertex add_vertex(VertexHandle v, Vec3 p) {
    const OmVertex w = om.add_vertex(eigen(p));
    vertex.resize(static_cast<std::size_t>(w.idx()) + 1);
    vertex[static_cast<std::size_t>(w.idx())] = v;
    if (v.idx() >= first.size()) first.resize(v.idx() + 1);
    if (!first[v.idx()].is_valid())
      first[v.idx()] = w;
    else
      more.emplace_back(v.idx(), w);
    return w;
  }

  /// Before the vertices of a face change.
  void note_gone(OmFace f) {
    if (record(f).patch != 0) gone.push_back(vertices(f));
  }
  void note_fresh(OmFace f) {
    if (record(f).patch != 0) fresh.insert(f.idx());
  }
  Triangle corners(OmFace f) const {
    OmHalfedge h = om.halfedge_handle(f);
    Triangle t;
    for (Vec3& p : t) {
      const auto& q = om.point(om.to_vertex_handle(h));
      p = {q[0], q[1], q[2]};
      h = om.next_halfedge_handle(h);
    }
    return t;
  }
  /// Adds what the faces bound to what has been gained, or takes it away: sign 1 or -1.
  void account(const std::vector<OmFace>& some, double sign) {
    double sum = 0;
    for (OmFace f : some) {
      const double volume = surface::six_volume(corners(f), origin);
      const FaceRecord& of_f = record(f);
      if (!of_f.interface) sum += volume;
      if (regions.size() == 1) continue;
      regions[of_f.sides[0]].six_gain += sign * volume;
      if (of_f.interface) regions[of_f.sides[1]].six_gain -= sign * volume;
    }
    six_gain += sign * sum;
  }
  /// True when a volume that has lost or gained much already would lose or gain more.
  static bool is_too_much(const Region& region, double six_more, double share = kVolume) {
    const double enough = share * std::abs(region.six_volume);
    return std::abs(region.six_gain) > enough && region.six_gain * six_more > 0 &&
           std::abs(six_more) > 1e-6 * enough;
  }
  bool keeps_regions(std::span<const std::array<VertexHandle, 3>> faces_dead, std::span<const Triangle> dead,
                     std::span<const Triangle> born) const;
  int cuts_of(const Triangle& t) const {
    const double longest2 = std::max({norm2(t[1] - t[0]), norm2(t[2] - t[1]), norm2(t[0] - t[2])});
    return std::clamp(static_cast<int>(std::ceil(std::sqrt(longest2) / spacing)), kLeastCuts, kMostCuts);
  }
  /// A sample stays where it is while that face is near enough, and goes to the nearest of these faces
  /// otherwise; so do those that have no face.
  void share_samples(const std::vector<OmFace>& among, std::vector<Vec3> homeless) {
    constexpr double kNearEnough = 0.25;  // of what is allowed
    const double enough2 = kNearEnough * kNearEnough * hausdorff * hausdorff;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> beneath;
    for (OmFace f : among) {
      triangles.push_back(corners(f));
      beneath.push_back(record(f).beneath);
      std::erase_if(record(f).samples, [&](Vec3 s) {
        const bool leaves = norm2(nearest_point(triangles.back(), s) - s) > enough2;
        if (leaves) homeless.push_back(s);
        return leaves;
      });
    }
    for (Vec3 s : homeless) {
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < among.size() && least > 0; ++i) {
        const double d = norm2(nearest_point(triangles[i], s) - s);
        if (d < least) {
          least = d;
          nearest = i;
        }
      }
      if (least < std::numeric_limits<double>::infinity()) record(among[nearest]).samples.push_back(s);
    }
    for (std::size_t i = 0; i < among.size(); ++i) {
      const Vec3 middle = (1.0 / 3) * (triangles[i][0] + triangles[i][1] + triangles[i][2]);
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t item : beneath) {
        const double d = shape->distance(middle, item);
        if (!(d < least)) continue;
        least = d;
        record(among[i]).beneath = item;
      }
    }
  }
  std::vector<OmFace> faces_round(OmVertex v) const {
    std::vector<OmFace> round;
    for (auto it = om.cvf_iter(v); it.is_valid(); ++it) round.push_back(*it);
    return round;
  }
};

void SurfaceMesh::Impl::build(const Arrays& arrays, const surface::Features& features) {
  const std::size_t n = arrays.faces.size();
  Union corners_of(3 * n);
  for (const surface::Edge& e : features.edges) {
    if (!e.manifold) continue;
    const auto corner = [&](std::size_t i, unsigned step) { return 3 * e.f[i] + (e.k[i] + step) % 3; };
    corners_of.join(corner(0, 0), corner(1, 1));  // the faces have the edge in opposite directions
    corners_of.join(corner(0, 1), corner(1, 0));
  }
  first.resize(arrays.points.size());
  std::set<int> all_regions;
  for (std::size_t i = 0; i < n; ++i) {
    all_regions.insert(arrays.regions[i][0]);
    if (arrays.interface[i]) all_regions.insert(arrays.regions[i][1]);
  }
  const std::vector<int> numbers(all_regions.begin(), all_regions.end());
  regions.resize(std::max<std::size_t>(numbers.size(), 1));
  std::vector<OmVertex> sheet(3 * n);
  // A pair of vertices may be joined by several edges that meet no face in common; OpenMesh would take them
  // for one.
  std::unordered_set<std::uint64_t> used;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<OmVertex, 3> w;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t root = corners_of.find(static_cast<std::uint32_t>(3 * i + k));
      if (!sheet[root].is_valid())
        sheet[root] = add_vertex(arrays.faces[i][k], arrays.points[arrays.faces[i][k].idx()]);
      w[k] = sheet[root];
    }
    const auto key = [&](std::size_t k) {
      return static_cast<std::uint64_t>(w[k].idx()) << 32 | static_cast<std::uint64_t>(w[(k + 1) % 3].idx());
    };
    if (used.contains(key(0)) || used.contains(key(1)) || used.contains(key(2)))
      for (std::size_t k = 0; k < 3; ++k)
        w[k] = add_vertex(arrays.faces[i][k], arrays.points[arrays.faces[i][k].idx()]);
    for (std::size_t k = 0; k < 3; ++k) used.insert(key(k));
    const OmFace f = om.add_face(w[0], w[1], w[2]);
    HFR_ASSERT(f.is_valid());
    faces.resize(om.n_faces());
    FaceRecord& record_of_f = record(f);
    record_of_f.patch = arrays.patch[i];
    record_of_f.locked = arrays.locked[i] != 0;
    record_of_f.interface = arrays.interface[i] != 0;
    has_interfaces = has_interfaces || record_of_f.interface;
    for (std::size_t k = 0; k < 2; ++k)
      record_of_f.sides[k] = static_cast<std::uint32_t>(
          std::lower_bound(numbers.begin(), numbers.end(), arrays.regions[i][k]) - numbers.begin());
    record_of_f.inward = arrays.inward[i] != 0;
    record_of_f.inside = arrays.halffaces[i];
    if (!features.facet.empty()) record_of_f.facet = features.facet[i];
  }
  std::sort(more.begin(), more.end());
  for (const surface::Edge& e : features.edges) {
    if (!e.feature) continue;
    for_sheets(e.a, [&](OmVertex from) {
      for (auto it = om.cvoh_iter(from); it.is_valid(); ++it)
        if (vertex_of(om.to_vertex_handle(*it)) == e.b) {
          om.status(om.edge_handle(*it)).set_feature(true);
          om.status(om.edge_handle(*it)).set_locked(e.locked);
        }
    });
  }
}

void SurfaceMesh::Impl::take_shape(const Arrays& arrays, const surface::Features& features) {
  std::vector<Triangle> triangles;
  std::vector<std::array<Vec3, 2>> segments;
  std::vector<std::uint8_t> is_sampled(arrays.points.size(), 0);
  if (!arrays.faces.empty()) origin = arrays.points[arrays.faces[0][0].idx()];
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    const Triangle t = surface::corners(arrays.points, arrays.faces[i]);
    triangles.push_back(t);
    faces[i].beneath = static_cast<std::uint32_t>(i);
    const int cuts = cuts_of(t);
    for_lattice(cuts, [&](int u, int v) {
      if (u == 0 || v == 0 || u + v == cuts) return;  // edges and corners are shared
      faces[i].samples.push_back(t[0] + (1.0 * u / cuts) * (t[1] - t[0]) + (1.0 * v / cuts) * (t[2] - t[0]));
    });
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint8_t& done = is_sampled[arrays.faces[i][k].idx()];
      if (!done) faces[i].samples.push_back(t[k]);
      done = 1;
    }
    const double volume = surface::six_volume(t, origin);
    regions[faces[i].sides[0]].six_volume += volume;
    if (arrays.interface[i]) regions[faces[i].sides[1]].six_volume -= volume;
    if (arrays.interface[i]) continue;
    six_volume += volume;
    area += 0.5 * norm(scaled_normal(t));
  }
  for (const surface::Edge& e : features.edges) {
    const std::array<Vec3, 2> ends = {arrays.points[e.a.idx()], arrays.points[e.b.idx()]};
    const int cuts = cuts_of({ends[0], ends[1], ends[1]});
    for (int i = 1; i < cuts; ++i)
      faces[e.f[0]].samples.push_back(ends[0] + (1.0 * i / cuts) * (ends[1] - ends[0]));
    if (e.feature) segments.push_back(ends);
  }
  if (!triangles.empty()) shape.emplace(triangles);
  if (!segments.empty()) curves.emplace(segments);
}

void SurfaceMesh::Impl::begin(const Arrays& arrays, const SurfaceOptions& wanted) {
  if (!flat()) {
    const double edge = surface::mean_edge(arrays);
    spacing = kSpacing * edge;
    hausdorff = surface::allowed_distance(arrays, wanted);
    detail = std::min(kDetail * edge, hausdorff);
  }
  surface::Features features = surface::find_features(arrays, options, hausdorff);
  build(arrays, features);
  if (!flat()) take_shape(arrays, features);
  freedom = std::move(features.freedom);
}

namespace {

/// The options as they are meant: a surface that may not go anywhere is flat.
SurfaceOptions checked(SurfaceOptions options) {
  HFR_REQUIRE(
      options.feature_angle >= 0 && options.feature_angle <= 180,
      "the feature angle must lie between 0 and 180 degrees, not " + std::to_string(options.feature_angle));
  HFR_REQUIRE(!options.hausdorff || *options.hausdorff >= 0,
              "the distance from the surface must not be negative");
  if (options.mode == SurfaceMode::kFree && options.hausdorff && *options.hausdorff == 0)
    options.mode = SurfaceMode::kFlat;
  return options;
}

}  // namespace

SurfaceMesh::SurfaceMesh(const TetMesh& mesh, const SurfaceOptions& options, par::Policy policy)
    : impl_(new Impl) {
  impl_->options = checked(options);
  const Arrays arrays = surface::gather(mesh, impl_->options, policy);
  impl_->begin(arrays, options);
  impl_->bind(surface::periodic_orbits(arrays, options));
}

void SurfaceMesh::Impl::bind(std::vector<std::vector<VertexHandle>> found) {
  orbits = std::move(found);
  if (!orbits.empty()) orbit_of.assign(freedom.size(), kNoOrbit);
  for (std::uint32_t i = 0; i < orbits.size(); ++i) {
    const SurfaceKind kind = freedom[orbits[i][0].idx()].kind;
    const bool alike = std::all_of(orbits[i].begin(), orbits[i].end(),
                                   [&](VertexHandle v) { return freedom[v.idx()].kind == kind; });
    for (VertexHandle v : orbits[i]) {
      orbit_of[v.idx()] = i;
      const auto& p = om.point(first[v.idx()]);
      if (!alike) freedom[v.idx()] = {SurfaceKind::kFixed, {p[0], p[1], p[2]}, {}};
    }
  }
}

SurfaceMesh::SurfaceMesh(const TriangleMesh& mesh, const SurfaceOptions& options) : impl_(new Impl) {
  impl_->options = checked(options);
  impl_->alone = true;
  impl_->begin(surface::gather(mesh, impl_->options), options);
  // What an open surface encloses is not defined.
  impl_->is_open = std::any_of(impl_->om.halfedges_begin(), impl_->om.halfedges_end(),
                               [&](OmHalfedge h) { return impl_->om.is_boundary(h); });
}

SurfaceMesh::~SurfaceMesh() = default;

double SurfaceMesh::allowed_distance(const TetMesh& mesh, const SurfaceOptions& options, par::Policy policy) {
  if (options.mode != SurfaceMode::kFree) return 0;
  return surface::allowed_distance(surface::gather(mesh, options, policy), options);
}

const SurfaceOptions& SurfaceMesh::options() const { return impl_->options; }
double SurfaceMesh::hausdorff() const { return impl_->hausdorff; }

std::size_t SurfaceMesh::n_faces() const { return impl_->om.n_faces(); }
std::size_t SurfaceMesh::n_edges() const { return impl_->om.n_edges(); }
std::size_t SurfaceMesh::n_feature_edges() const {
  return static_cast<std::size_t>(std::count_if(
      impl_->om.edges_begin(), impl_->om.edges_end(),
      [&](OmEdge e) { return !impl_->om.status(e).deleted() && impl_->om.status(e).feature(); }));
}
std::size_t SurfaceMesh::n_vertices(SurfaceKind kind) const {
  return static_cast<std::size_t>(std::count_if(impl_->freedom.begin(), impl_->freedom.end(),
                                                [&](const Freedom& f) { return f.kind == kind; }));
}

const Freedom& SurfaceMesh::freedom(VertexHandle v) const {
  static const Freedom kInner;
  return v.idx() < impl_->freedom.size() ? impl_->freedom[v.idx()] : kInner;
}

bool SurfaceMesh::has_interfaces() const { return impl_->has_interfaces; }

std::span<const VertexHandle> SurfaceMesh::orbit(VertexHandle v) const {
  if (v.idx() >= impl_->orbit_of.size() || impl_->orbit_of[v.idx()] == kNoOrbit) return {};
  return impl_->orbits[impl_->orbit_of[v.idx()]];
}

bool SurfaceMesh::is_feature(VertexHandle a, VertexHandle b) const {
  const OmHalfedge h = impl_->find(a, b);
  return h.is_valid() && impl_->om.status(impl_->om.edge_handle(h)).feature();
}

HalfFaceHandle SurfaceMesh::halfface(const TetMesh& mesh, std::size_t f) {
  const OmFace face(static_cast<int>(f));
  if (impl_->om.status(face).deleted()) return {};
  const auto wanted = impl_->vertices(face);
  HalfFaceHandle& known = impl_->record(face).inside;
  const auto is_it = [&](HalfFaceHandle h) {
    return h.is_valid() && mesh.exists(h) && sorted(mesh.halfface_vertices(h)) == sorted(wanted);
  };
  if (!is_it(known)) known = mesh.find_halfface({wanted[0], wanted[2], wanted[1]});
  return known;
}

std::size_t SurfaceMesh::face(const TetMesh& mesh, HalfFaceHandle h) const {
  const OmFace f = impl_->find(mesh.halfface_vertices(h));
  return f.is_valid() ? static_cast<std::size_t>(f.idx()) : kNoFace;
}

bool SurfaceMesh::is_deleted(std::size_t f) const {
  return impl_->om.status(OmFace(static_cast<int>(f))).deleted();
}

std::array<VertexHandle, 3> SurfaceMesh::face_vertices(std::size_t f) const {
  return impl_->vertices(OmFace(static_cast<int>(f)));
}

int SurfaceMesh::patch(std::size_t f) const { return impl_->faces[f].patch; }

Vec3 SurfaceMesh::point(VertexHandle v) const {
  const auto& p = impl_->om.point(impl_->first[v.idx()]);
  return {p[0], p[1], p[2]};
}

void SurfaceMesh::star(VertexHandle v, std::vector<std::array<VertexHandle, 3>>& out) const {
  impl_->for_sheets(v, [&](OmVertex w) {
    for (auto it = impl_->om.cvf_iter(w); it.is_valid(); ++it) out.push_back(impl_->vertices(*it));
  });
}

std::array<VertexHandle, 2> SurfaceMesh::across(VertexHandle a, VertexHandle b) const {
  const Om& om = impl_->om;
  std::array<VertexHandle, 2> apexes;
  const OmHalfedge h = impl_->find(a, b);
  if (!h.is_valid()) return apexes;
  const std::array<OmHalfedge, 2> sides = {h, om.opposite_halfedge_handle(h)};
  for (std::size_t i = 0; i < 2; ++i)
    if (!om.is_boundary(sides[i]))
      apexes[i] = impl_->vertex_of(om.to_vertex_handle(om.next_halfedge_handle(sides[i])));
  return apexes;
}

bool SurfaceMesh::is_inner(VertexHandle a, VertexHandle b) const {
  const Om& om = impl_->om;
  const OmHalfedge h = impl_->find(a, b);
  if (!h.is_valid()) return false;
  const OmEdge e = om.edge_handle(h);
  if (om.is_boundary(e) || om.status(e).feature()) return false;
  const FaceRecord& f = impl_->record(om.face_handle(h));
  const FaceRecord& g = impl_->record(om.face_handle(om.opposite_halfedge_handle(h)));
  return !f.locked && !g.locked && f.patch == g.patch && f.facet == g.facet;
}

bool SurfaceMesh::may_swap(VertexHandle a, VertexHandle b) const {
  return is_inner(a, b) && impl_->om.is_flip_ok(impl_->om.edge_handle(impl_->find(a, b)));
}

bool SurfaceMesh::may_split(VertexHandle a, VertexHandle b) const {
  const Om& om = impl_->om;
  const OmHalfedge h = impl_->find(a, b);
  if (!h.is_valid() || om.status(om.edge_handle(h)).locked()) return false;
  if (om.is_boundary(om.edge_handle(h))) {
    // The rim of a surface without cells, and of no other.
    if (!impl_->alone || !impl_->has_one_sheet(a) || !impl_->has_one_sheet(b)) return false;
  }
  for (OmHalfedge side : {h, om.opposite_halfedge_handle(h)})
    if (!om.is_boundary(side) &&
        (impl_->record(om.face_handle(side)).locked || impl_->record(om.face_handle(side)).interface))
      return false;
  return true;
}

void SurfaceMesh::collapse_targets(VertexHandle v, std::vector<VertexHandle>& out) {
  const SurfaceKind kind = freedom(v).kind;
  if ((kind != SurfaceKind::kFacet && kind != SurfaceKind::kCurve) || !impl_->has_one_sheet(v)) return;
  Om& om = impl_->om;
  const OmVertex from = impl_->first[v.idx()];
  const bool on_rim = om.is_boundary(from);
  if (on_rim && !impl_->alone) return;
  for (auto it = om.cvf_iter(from); it.is_valid(); ++it)
    if (impl_->record(*it).locked) return;
  for (auto it = om.cvoh_iter(from); it.is_valid(); ++it) {
    if (kind == SurfaceKind::kCurve && !om.status(om.edge_handle(*it)).feature()) continue;
    if (on_rim && !om.is_boundary(om.edge_handle(*it))) continue;
    if (om.is_collapse_ok(*it)) out.push_back(impl_->vertex_of(om.to_vertex_handle(*it)));
  }
}

Vec3 SurfaceMesh::project(VertexHandle v, Vec3 x) const {
  const Freedom& f = freedom(v);
  const bool on_curve = f.kind == SurfaceKind::kCurve;
  if (f.kind == SurfaceKind::kInside) return x;
  if (f.kind == SurfaceKind::kFixed) return f.anchor;
  if (!impl_->flat()) return on_curve ? impl_->curves->nearest(x).point : x;
  const Vec3 r = x - f.anchor;
  return on_curve ? f.anchor + dot(r, f.axis) * f.axis : x - dot(r, f.axis) * f.axis;
}

/// Are points spread over the new triangles no further than `distance` from the input? What the new triangles
/// have in common with the old ones has been looked at before.
bool SurfaceMesh::Impl::are_near(std::span<const Triangle> born, std::span<const Triangle> dead,
                                 Guesses beneath, double distance) const {
  const auto is_near = [&](Vec3 x) {
    for (std::size_t i = 0; i < beneath.size(); ++i) {
      if (!(shape->distance(x, beneath[i]) <= distance)) continue;
      std::swap(beneath[i], beneath[i / 2]);  // the next point is likely to be there, too
      return true;
    }
    return shape->is_within(x, distance, {});
  };
  const auto has_edge = [](const Triangle& t, Vec3 p, Vec3 q) {
    return (t[0] == p && t[1] == q) || (t[1] == p && t[2] == q) || (t[2] == p && t[0] == q);
  };
  const auto is_old = [&](Vec3 x) {
    return std::any_of(dead.begin(), dead.end(),
                       [&](const Triangle& d) { return d[0] == x || d[1] == x || d[2] == x; });
  };
  for (std::size_t i = 0; i < born.size(); ++i) {
    const Triangle& t = born[i];
    const int cuts = cuts_of(t);
    const auto at = [&](int u, int v) {
      return t[0] + (1.0 * u / cuts) * (t[1] - t[0]) + (1.0 * v / cuts) * (t[2] - t[0]);
    };
    for (int u = 1; u < cuts; ++u)
      for (int v = 1; u + v < cuts; ++v)
        if (!is_near(at(u, v))) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = t[k];
      const Vec3 q = t[(k + 1) % 3];
      if (!is_old(p) && !is_near(p)) return false;
      const bool seen =
          std::any_of(born.begin(), born.begin() + static_cast<std::ptrdiff_t>(i),
                      [&](const Triangle& other) { return has_edge(other, q, p); }) ||
          std::any_of(dead.begin(), dead.end(), [&](const Triangle& old) { return has_edge(old, p, q); });
      for (int j = 1; j < cuts && !seen; ++j)
        if (!is_near(p + (1.0 * j / cuts) * (q - p))) return false;
    }
  }
  return true;
}

/// Are the normals of the new triangles near those of the input no further than `distance` beneath them? The
/// normals of triangles no larger than noise say little, but they must not turn back. What is worse already
/// must not get worse still: a surface that folds over has to be mended somehow.
bool SurfaceMesh::Impl::turn_little(std::span<const Triangle> born, std::span<const Triangle> dead,
                                    Guesses beneath, double distance) const {
  const auto turned = [&](const Triangle& t) {  // cosine of the angle with the input beneath
    const Vec3 n = unit(scaled_normal(t));
    const Vec3 middle = t[0] + (1.0 / 3) * (t[1] - t[0]) + (1.0 / 3) * (t[2] - t[0]);
    const InputSurface::Hit hit = shape->nearest_within(middle, distance, n, beneath);
    return hit.distance <= distance ? dot(n, shape->normal(hit.item)) : -1.0;
  };
  const double bound = std::cos(options.normal_angle * kDegree);
  double worst_dead = 2;  // not known yet
  for (const Triangle& t : born) {
    const double size2 = std::max({norm2(t[1] - t[0]), norm2(t[2] - t[1]), norm2(t[0] - t[2])});
    const bool small = size2 < 4 * detail * detail;
    const double now = turned(t);
    if (now >= (small ? kNotBack : bound)) continue;
    if (worst_dead == 2)
      for (const Triangle& d : dead) worst_dead = std::min(worst_dead, turned(d));
    if (now < worst_dead) return false;
  }
  return true;
}

bool SurfaceMesh::keeps_shape(std::span<const std::array<VertexHandle, 3>> faces_dead,
                              std::span<const Triangle> dead, std::span<const Triangle> born) const {
  constexpr double kSameSide = 0.5;
  for (const Triangle& t : born) {
    const Vec3 n = unit(scaled_normal(t));
    if (n == Vec3{}) return false;
    if (!impl_->flat()) continue;
    const bool found = std::any_of(dead.begin(), dead.end(), [&](const Triangle& d) {
      return dot(n, unit(scaled_normal(d))) > kSameSide;
    });
    if (!found) return false;
  }
  if (impl_->flat()) return true;

  if (!impl_->keeps_regions(faces_dead, dead, born)) return false;

  // What was beneath the old triangles is likely to be beneath the new ones.
  FixedVector<std::uint32_t, 64> beneath;
  const double h = kBetween * impl_->hausdorff;
  std::size_t last = 0;  // the triangle that was near
  for (std::size_t i = 0; i < faces_dead.size(); ++i) {
    const OmFace face = impl_->find(faces_dead[i]);
    if (!face.is_valid()) return false;
    const FaceRecord& record = impl_->record(face);
    if (!beneath.full() && std::find(beneath.begin(), beneath.end(), record.beneath) == beneath.end())
      beneath.push_back(record.beneath);
    if (born.size() == faces_dead.size()) last = i;
    for (Vec3 s : record.samples) {
      const auto is_near = [&](const Triangle& t) { return norm2(nearest_point(t, s) - s) <= h * h; };
      if (is_near(born[last])) continue;
      const auto at = std::find_if(born.begin(), born.end(), is_near);
      if (at == born.end()) return false;
      last = static_cast<std::size_t>(at - born.begin());
    }
  }
  return impl_->are_near(born, dead, beneath, h) && impl_->turn_little(born, dead, beneath, 2 * h);
}

/// Dead and born triangles correspond one to one where they bound different regions.
bool SurfaceMesh::Impl::keeps_regions(std::span<const std::array<VertexHandle, 3>> faces_dead,
                                      std::span<const Triangle> dead, std::span<const Triangle> born) const {
  if (is_open || dead.empty()) return true;
  if (regions.size() == 1) {
    double change = 0;
    for (const Triangle& t : born) change += surface::six_volume(t, dead[0][0]);
    for (const Triangle& t : dead) change -= surface::six_volume(t, dead[0][0]);
    return !is_too_much({six_volume, six_gain}, change);
  }
  double outer = 0;
  std::vector<std::pair<std::uint32_t, double>> of_region;
  const auto add = [&](const Triangle& t, const std::array<VertexHandle, 3>& like, double sign) {
    const OmFace f = find(like);
    if (!f.is_valid()) return;
    const FaceRecord& of_f = record(f);
    const double volume = sign * surface::six_volume(t, dead[0][0]);
    of_region.emplace_back(of_f.sides[0], volume);
    if (of_f.interface)
      of_region.emplace_back(of_f.sides[1], -volume);
    else
      outer += volume;
  };
  for (std::size_t i = 0; i < dead.size(); ++i) add(dead[i], faces_dead[i], -1);
  for (std::size_t i = 0; i < born.size(); ++i)
    add(born[i], faces_dead[born.size() == dead.size() ? i : 0], 1);
  if (is_too_much({six_volume, six_gain}, outer)) return false;
  std::sort(of_region.begin(), of_region.end());
  for (std::size_t i = 0; i < of_region.size();) {
    const std::uint32_t region = of_region[i].first;
    double change = 0;
    for (; i < of_region.size() && of_region[i].first == region; ++i) change += of_region[i].second;
    // Of a small region a single change may be a large share.
    const Region after{regions[region].six_volume, regions[region].six_gain + change};
    if (is_too_much(regions[region], change) || is_too_much(after, change, kRegionVolume)) return false;
  }
  return true;
}

double SurfaceMesh::volume_gain() const {
  return impl_->six_volume != 0 && !impl_->is_open ? impl_->six_gain / impl_->six_volume : 0.0;
}

double SurfaceMesh::outward() const {
  if (!(impl_->area > 0) || impl_->is_open) return 0;
  const double limit = 0.1 * impl_->hausdorff;
  return std::clamp(-impl_->six_gain / (6.0 * impl_->area), -limit, limit);
}

void SurfaceMesh::moved(const TetMesh& mesh, std::span<const VertexHandle> vertices) {
  for (VertexHandle v : vertices) moved(v, mesh.point(v));
}

void SurfaceMesh::moved(VertexHandle v, Vec3 x) {
  const Eigen::Vector3d place = eigen(x);
  impl_->for_sheets(v, [&](OmVertex w) {
    if (impl_->om.point(w) == place) return;
    const std::vector<OmFace> round = impl_->faces_round(w);
    impl_->account(round, -1);
    impl_->om.set_point(w, place);
    impl_->account(round, 1);
    if (!impl_->flat()) impl_->share_samples(round, {});
  });
}

void SurfaceMesh::swapped(VertexHandle a, VertexHandle b) {
  Om& om = impl_->om;
  const OmHalfedge h = impl_->find(a, b);
  HFR_ASSERT(h.is_valid() && om.is_flip_ok(om.edge_handle(h)));
  const std::vector<OmFace> both = {om.face_handle(h), om.face_handle(om.opposite_halfedge_handle(h))};
  for (OmFace f : both) impl_->note_gone(f);
  impl_->account(both, -1);
  om.flip(om.edge_handle(h));
  impl_->account(both, 1);
  for (OmFace f : both) impl_->note_fresh(f);
  if (!impl_->flat()) impl_->share_samples(both, {});
}

void SurfaceMesh::collapsed(VertexHandle v, VertexHandle onto) {
  Om& om = impl_->om;
  const OmHalfedge h = impl_->find(v, onto);
  HFR_ASSERT(h.is_valid() && om.is_collapse_ok(h));
  const OmVertex from = om.from_vertex_handle(h);
  const OmVertex to = om.to_vertex_handle(h);
  // The two edges on either side of h become one each, which is a feature when one of them was.
  std::vector<OmVertex> sides;
  std::vector<std::uint8_t> is_feature;
  for (OmHalfedge side : {h, om.opposite_halfedge_handle(h)}) {
    if (om.is_boundary(side)) continue;
    const OmHalfedge next = om.next_halfedge_handle(side);
    const OmHalfedge last = om.next_halfedge_handle(next);
    sides.push_back(om.to_vertex_handle(next));
    is_feature.push_back(om.status(om.edge_handle(next)).feature() ||
                         om.status(om.edge_handle(last)).feature());
  }
  std::vector<Vec3> samples;
  std::vector<OmFace> old = impl_->faces_round(from);
  impl_->account(old, -1);
  for (OmFace f : old) {
    impl_->note_gone(f);
    auto& of_f = impl_->record(f).samples;
    samples.insert(samples.end(), of_f.begin(), of_f.end());
    of_f.clear();
  }
  om.collapse(h);
  std::erase_if(old, [&](OmFace f) { return om.status(f).deleted(); });
  impl_->account(old, 1);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const OmHalfedge side = om.find_halfedge(to, sides[i]);
    om.status(om.edge_handle(side)).set_feature(is_feature[i] != 0);
  }
  const std::vector<OmFace> round = impl_->faces_round(to);
  for (OmFace f : round) impl_->note_fresh(f);
  if (!impl_->flat()) impl_->share_samples(round, std::move(samples));
  impl_->first[v.idx()] = OmVertex();
  impl_->freedom[v.idx()] = {};
}

void SurfaceMesh::was_split(VertexHandle a, VertexHandle b, VertexHandle middle, Vec3 place) {
  Om& om = impl_->om;
  OmHalfedge h = impl_->find(a, b);
  HFR_ASSERT(h.is_valid());
  if (om.is_boundary(h)) h = om.opposite_halfedge_handle(h);
  const OmEdge e = om.edge_handle(h);
  std::vector<OmFace> halves = {om.face_handle(h)};
  if (!om.is_boundary(e)) halves.push_back(om.face_handle(om.opposite_halfedge_handle(h)));
  const std::array<OmVertex, 2> ends = {om.from_vertex_handle(h), om.to_vertex_handle(h)};
  const VertexHandle apex = impl_->vertex_of(om.to_vertex_handle(om.next_halfedge_handle(h)));
  const bool feature = om.status(e).feature();
  const auto place_of = [&](OmVertex v) {
    const auto& p = om.point(v);
    return Vec3{p[0], p[1], p[2]};
  };
  Freedom freedom{SurfaceKind::kFacet, place, unit(scaled_normal(impl_->corners(halves[0])))};
  if (feature) freedom = {SurfaceKind::kCurve, place, unit(place_of(ends[1]) - place_of(ends[0]))};
  // In flat mode the middle lies where both ends may go, or in the plane that one of them names.
  for (VertexHandle v : {a, b})
    if (impl_->flat() && impl_->freedom[v.idx()].kind == freedom.kind) freedom = impl_->freedom[v.idx()];

  for (OmFace f : halves) impl_->note_gone(f);
  impl_->account(halves, -1);
  std::vector<FaceRecord> was;
  std::vector<Vec3> samples;
  for (OmFace f : halves) {
    was.push_back(impl_->record(f));
    samples.insert(samples.end(), was.back().samples.begin(), was.back().samples.end());
  }
  const OmVertex m = impl_->add_vertex(middle, place);
  om.split_edge(e, m);
  impl_->faces.resize(om.n_faces());
  const std::vector<OmFace> round = impl_->faces_round(m);
  for (OmFace f : round) {
    const auto v = impl_->vertices(f);
    const bool first = v[0] == apex || v[1] == apex || v[2] == apex;
    impl_->record(f) = was[first ? 0 : 1];
    impl_->record(f).samples.clear();
    impl_->note_fresh(f);
  }
  impl_->account(round, 1);
  for (auto it = om.cvoh_iter(m); it.is_valid(); ++it) {
    const OmVertex to = om.to_vertex_handle(*it);
    om.status(om.edge_handle(*it)).set_feature(feature && (to == ends[0] || to == ends[1]));
  }
  impl_->freedom.resize(std::max<std::size_t>(impl_->freedom.size(), middle.idx() + 1));
  impl_->freedom[middle.idx()] = freedom;
  if (impl_->flat()) return;
  impl_->share_samples(round, std::move(samples));
}

void SurfaceMesh::write_labels(TetMesh& mesh) {
  if (impl_->gone.empty() && impl_->fresh.empty()) return;
  auto& labels = mesh.labels().faces;
  for (const auto& f : impl_->gone) labels.erase_unordered(f);
  for (int i : impl_->fresh) {
    const OmFace f(i);
    if (impl_->om.status(f).deleted()) continue;
    auto v = impl_->vertices(f);
    if (impl_->record(f).inward) std::swap(v[1], v[2]);
    labels.set(v, impl_->record(f).patch);
  }
  impl_->gone.clear();
  impl_->fresh.clear();
}

bool SurfaceMesh::in_step(const TetMesh& mesh) const {
  const Arrays arrays = surface::gather(mesh, impl_->options, {});
  std::size_t n_live = 0;
  for (OmFace f : impl_->om.all_faces())
    if (!impl_->om.status(f).deleted()) ++n_live;
  if (n_live != arrays.faces.size()) return false;
  for (const auto& face : arrays.faces) {
    const OmFace f = impl_->find(face);
    if (!f.is_valid() || impl_->om.status(f).deleted()) return false;
    const auto v = impl_->vertices(f);
    if (CyclicOrder::key(v) != CyclicOrder::key(face)) return false;
    const Triangle t = impl_->corners(f);
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] != mesh.point(v[k])) return false;
  }
  return true;
}

}  // namespace hfr
