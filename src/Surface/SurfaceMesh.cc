// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceMesh.hh"

#include <limits>
#include <unordered_set>

#include "Parallel/DisjointSets.hh"
#include "Surface/Periodic.hh"
#include "Surface/SurfaceMeshImpl.hh"

namespace hfr {
namespace {

using namespace surface;  // what SurfaceMesh is made of

/// Share of the mean edge length of the surface: normals of triangles no larger say little.
constexpr double kDetail = 0.1;
/// How far apart the points of a triangle are by which its distance is judged, as a share of the mean edge.
constexpr double kSpacing = 0.3;
/// How far apart further points between these are, as a multiple of the distance allowed, and how many of
/// them there are on the input at most.
constexpr double kCloseSpacing = 2;
constexpr double kMostBetween = 1 << 20;
constexpr std::uint32_t kNoOrbit = ~0U;

std::array<VertexHandle, 3> sorted(std::array<VertexHandle, 3> f) {
  std::sort(f.begin(), f.end());
  return f;
}

}  // namespace

OmVertex SurfaceMesh::Impl::add_vertex(VertexHandle v, Vec3 p) {
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

namespace {

/// What face i of the arrays is to be known for. `numbers`: the regions, ascending.
void fill_record(FaceRecord& record, const Arrays& arrays, const surface::Features& features,
                 const std::vector<int>& numbers, std::size_t i) {
  record.patch = arrays.patch[i];
  record.locked = arrays.locked[i] != 0;
  record.interface = arrays.interface[i] != 0;
  for (std::size_t k = 0; k < 2; ++k)
    record.sides[k] = static_cast<std::uint32_t>(
        std::lower_bound(numbers.begin(), numbers.end(), arrays.regions[i][k]) - numbers.begin());
  record.inward = arrays.inward[i] != 0;
  record.inside = arrays.halffaces[i];
  if (!features.facet.empty()) record.facet = features.facet[i];
}

}  // namespace

void SurfaceMesh::Impl::build(const Arrays& arrays, const surface::Features& features) {
  const std::size_t n = arrays.faces.size();
  par::DisjointSets<std::uint32_t> corners_of(3 * n);
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
    fill_record(record(f), arrays, features, numbers, i);
    has_interfaces = has_interfaces || arrays.interface[i] != 0;
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

/// Length between further points: kCloseSpacing times the distance allowed, or more where that would make too
/// many.
double SurfaceMesh::Impl::spacing_between(std::span<const Triangle> input) const {
  const auto count = [&](double apart) {  // about
    double n = 0;
    for (const Triangle& t : input) {
      const double longest2 = surface::longest_edge2(t);
      if (longest2 > apart * apart)
        n += 2 * std::sqrt(longest2) / apart + 2 * norm(scaled_normal(t)) / (apart * apart);
    }
    return n;
  };
  double apart = std::max(kCloseSpacing * hausdorff, std::numeric_limits<double>::min());
  while (count(apart) > kMostBetween && std::isfinite(apart)) apart *= 2;
  return apart;
}

void SurfaceMesh::Impl::take_shape(const Arrays& arrays, const surface::Features& features) {
  std::vector<Triangle> triangles;
  std::vector<std::array<Vec3, 2>> segments;
  std::vector<std::uint8_t> is_sampled(arrays.points.size(), 0);
  if (!arrays.faces.empty()) origin = arrays.points[arrays.faces[0][0].idx()];
  for (const auto& f : arrays.faces) triangles.push_back(surface::corners(arrays.points, f));
  between = spacing_between(triangles);
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    const Triangle& t = triangles[i];
    faces[i].beneath = static_cast<std::uint32_t>(i);
    // Inner points alone: those of edges and corners would count for several faces.
    surface::all_inner_points(t, cuts_of(t), [&](Vec3 x) {
      faces[i].samples[0].points.push_back(x);
      return true;
    });
    if (has_between(t)) {
      samples_between = true;
      surface::bisect(t, between, [&](const Triangle&, Vec3 middle) {
        faces[i].samples[1].points.push_back(middle);
        return false;
      });
    }
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint8_t& done = is_sampled[arrays.faces[i][k].idx()];
      if (!done) faces[i].samples[0].points.push_back(t[k]);
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
      faces[e.f[0]].samples[0].points.push_back(ends[0] + (1.0 * i / cuts) * (ends[1] - ends[0]));
    if (e.feature) segments.push_back(ends);
  }
  if (!triangles.empty()) shape = std::make_shared<const InputSurface>(triangles);
  if (!segments.empty()) curves = std::make_shared<const InputSurface>(segments);
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
  motion_constraint = std::move(features.motion_constraint);
}

std::vector<std::array<Vec3, 2>> SurfaceMesh::Impl::feature_segments() const {
  std::vector<std::array<Vec3, 2>> segments;
  const auto place = [&](OmVertex v) {
    const auto& p = om.point(v);
    return Vec3{p[0], p[1], p[2]};
  };
  for (OmEdge e : om.all_edges()) {
    if (om.status(e).deleted() || !om.status(e).feature()) continue;
    const OmHalfedge h = om.halfedge_handle(e, 0);
    segments.push_back({place(om.from_vertex_handle(h)), place(om.to_vertex_handle(h))});
  }
  return segments;
}

std::vector<Vec3> SurfaceMesh::Impl::fixed_points() const {
  std::vector<Vec3> points;
  for (const MotionConstraint& one : motion_constraint)
    if (one.kind == SurfaceKind::kFixed) points.push_back(one.anchor);
  return points;
}

void SurfaceMesh::Impl::take_samples(const Impl& before) {
  const std::vector<OmFace> live = live_faces();
  std::vector<Triangle> triangles;
  for (OmFace f : live) triangles.push_back(corners(f));
  const InputSurface now(triangles);
  for (OmFace old : before.live_faces()) {
    const FaceRecord& of_old = before.record(old);
    for (std::size_t kind = 0; kind < 2; ++kind) {
      for (Vec3 x : of_old.samples[kind].points) {
        const InputSurface::Hit hit = now.nearest(x);
        Samples& home = record(live[hit.item]).samples[kind];
        home.points.push_back(x);
        home.reach = std::max(home.reach, hit.distance);
      }
    }
  }
  for (std::size_t i = 0; i < live.size(); ++i) {
    const Triangle& t = triangles[i];
    const Vec3 middle = (1.0 / 3) * (t[0] + t[1] + t[2]);
    record(live[i]).beneath = static_cast<std::uint32_t>(shape->nearest(middle).item);
  }
}

void SurfaceMesh::Impl::begin_again(const Arrays& arrays, const Impl& before) {
  options = before.options;
  if (flat()) return begin(arrays, options);
  hausdorff = before.hausdorff;
  detail = before.detail;
  spacing = before.spacing;
  between = before.between;
  samples_between = before.samples_between;
  shape = before.shape;
  curves = before.curves;
  origin = before.origin;
  six_volume = before.six_volume;
  area = before.area;
  surface::Features features =
      surface::find_features_again(arrays, options, before.feature_segments(), before.fixed_points());
  build(arrays, features);
  motion_constraint = std::move(features.motion_constraint);
  if (!shape) return;  // there are no faces
  take_samples(before);
  HFR_ASSERT(regions.size() == before.regions.size());
  six_gain = -six_volume;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    regions[i].six_volume = before.regions[i].six_volume;
    regions[i].six_gain = -regions[i].six_volume;
  }
  account(live_faces(), 1);
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

void SurfaceMesh::rebuild(const TetMesh& mesh, par::Policy policy) {
  HFR_ASSERT(!impl_->alone && impl_->gone.empty() && impl_->fresh.empty());
  HFR_ASSERT(impl_.use_count() == 1);  // nobody sees it from a part
  const Arrays arrays = surface::gather(mesh, impl_->options, policy);
  const auto again = std::make_shared<Impl>();
  again->begin_again(arrays, *impl_);
  again->bind(surface::periodic_orbits(arrays, again->options));
  impl_ = again;
}

void SurfaceMesh::rebuild(const surface::Arrays& arrays, std::vector<std::uint64_t> numbers) {
  HFR_ASSERT(!impl_->alone && impl_->gone.empty() && impl_->fresh.empty());
  HFR_ASSERT(numbers.size() == arrays.points.size() && impl_->orbits.empty());
  Impl again;
  again.in_whole = std::move(numbers);
  again.begin_again(arrays, *impl_);
  *impl_ = std::move(again);  // in its place: others see it from their parts
}

SurfaceMesh::SurfaceMesh(std::shared_ptr<Impl> impl, const VertexNumbers* numbers)
    : impl_(std::move(impl)), numbers_(numbers) {}

SurfaceMesh::SurfaceMesh(const surface::Arrays& arrays, std::vector<std::uint64_t> numbers,
                         const SurfaceOptions& options)
    : impl_(new Impl) {
  HFR_ASSERT(numbers.size() == arrays.points.size() && options.periodic.empty());
  impl_->options = checked(options);
  impl_->in_whole = std::move(numbers);
  impl_->begin(arrays, options);
}

std::unique_ptr<SurfaceMesh> SurfaceMesh::seen_from(const VertexNumbers& numbers) const {
  return std::unique_ptr<SurfaceMesh>(new SurfaceMesh(impl_, &numbers));
}

VertexHandle SurfaceMesh::handle_of(std::uint64_t number) const {
  const auto& numbers = impl_->in_whole;
  const auto at = std::lower_bound(numbers.begin(), numbers.end(), number);
  return at == numbers.end() || *at != number ? VertexHandle()
                                              : VertexHandle(static_cast<std::size_t>(at - numbers.begin()));
}

std::uint64_t SurfaceMesh::number_of(VertexHandle v) const { return impl_->in_whole[v.idx()]; }

VertexHandle SurfaceMesh::announce(std::uint64_t number) {
  auto& numbers = impl_->in_whole;
  HFR_ASSERT(numbers.empty() || numbers.back() < number);
  numbers.push_back(number);
  return VertexHandle(numbers.size() - 1);
}

std::unique_ptr<SurfaceMesh> SurfaceMesh::copy() const {
  return std::unique_ptr<SurfaceMesh>(new SurfaceMesh(std::make_shared<Impl>(*impl_)));
}

void SurfaceMesh::take_back(const SurfaceMesh& copied) { *impl_ = *copied.impl_; }

void SurfaceMesh::Impl::bind(std::vector<std::vector<VertexHandle>> found) {
  orbits = std::move(found);
  if (!orbits.empty()) orbit_of.assign(motion_constraint.size(), kNoOrbit);
  for (std::uint32_t i = 0; i < orbits.size(); ++i) {
    const SurfaceKind kind = motion_constraint[orbits[i][0].idx()].kind;
    const bool alike = std::all_of(orbits[i].begin(), orbits[i].end(),
                                   [&](VertexHandle v) { return motion_constraint[v.idx()].kind == kind; });
    for (VertexHandle v : orbits[i]) {
      orbit_of[v.idx()] = i;
      const auto& p = om.point(first[v.idx()]);
      if (!alike) motion_constraint[v.idx()] = {SurfaceKind::kFixed, {p[0], p[1], p[2]}, {}};
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
  return static_cast<std::size_t>(std::count_if(impl_->motion_constraint.begin(),
                                                impl_->motion_constraint.end(),
                                                [&](const MotionConstraint& f) { return f.kind == kind; }));
}

std::size_t SurfaceMesh::n_points() const { return impl_->motion_constraint.size(); }

const MotionConstraint& SurfaceMesh::motion_constraint(VertexHandle v) const {
  static const MotionConstraint kInner;
  const VertexHandle here = inner(v);
  return here.idx() < impl_->motion_constraint.size() ? impl_->motion_constraint[here.idx()] : kInner;
}

bool SurfaceMesh::has_interfaces() const { return impl_->has_interfaces; }

std::span<const VertexHandle> SurfaceMesh::orbit(VertexHandle v) const {
  if (impl_->orbits.empty()) return {};
  HFR_ASSERT(!numbers_);
  if (v.idx() >= impl_->orbit_of.size() || impl_->orbit_of[v.idx()] == kNoOrbit) return {};
  return impl_->orbits[impl_->orbit_of[v.idx()]];
}

bool SurfaceMesh::is_feature(VertexHandle a, VertexHandle b) const {
  const OmHalfedge h = impl_->find(inner(a), inner(b));
  return h.is_valid() && impl_->om.status(impl_->om.edge_handle(h)).feature();
}

HalfFaceHandle SurfaceMesh::halfface(const TetMesh& mesh, std::size_t f) {
  HFR_ASSERT(!numbers_);
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
  const auto v = mesh.halfface_vertices(h);
  const OmFace f = impl_->find({inner(v[0]), inner(v[1]), inner(v[2])});
  return f.is_valid() ? static_cast<std::size_t>(f.idx()) : kNoFace;
}

bool SurfaceMesh::is_deleted(std::size_t f) const {
  return impl_->om.status(OmFace(static_cast<int>(f))).deleted();
}

std::array<VertexHandle, 3> SurfaceMesh::face_vertices(std::size_t f) const {
  return outer(impl_->vertices(OmFace(static_cast<int>(f))));
}

int SurfaceMesh::patch(std::size_t f) const { return impl_->faces[f].patch; }

Vec3 SurfaceMesh::point(VertexHandle v) const { return impl_->point(inner(v)); }

void SurfaceMesh::star(VertexHandle v, std::vector<std::array<VertexHandle, 3>>& out) const {
  impl_->for_sheets(inner(v), [&](OmVertex w) {
    for (auto it = impl_->om.cvf_iter(w); it.is_valid(); ++it) out.push_back(outer(impl_->vertices(*it)));
  });
}

std::array<VertexHandle, 2> SurfaceMesh::across(VertexHandle a, VertexHandle b) const {
  const Om& om = impl_->om;
  std::array<VertexHandle, 2> apexes;
  const OmHalfedge h = impl_->find(inner(a), inner(b));
  if (!h.is_valid()) return apexes;
  const std::array<OmHalfedge, 2> sides = {h, om.opposite_halfedge_handle(h)};
  for (std::size_t i = 0; i < 2; ++i)
    if (!om.is_boundary(sides[i]))
      apexes[i] = outer(impl_->vertex_of(om.to_vertex_handle(om.next_halfedge_handle(sides[i]))));
  return apexes;
}

bool SurfaceMesh::Impl::is_inner(VertexHandle a, VertexHandle b) const {
  const OmHalfedge h = find_only(a, b);
  if (!h.is_valid()) return false;
  const OmEdge e = om.edge_handle(h);
  if (om.is_boundary(e) || om.status(e).feature()) return false;
  const FaceRecord& f = record(om.face_handle(h));
  const FaceRecord& g = record(om.face_handle(om.opposite_halfedge_handle(h)));
  return !f.locked && !g.locked && f.patch == g.patch && f.facet == g.facet;
}

bool SurfaceMesh::is_inner(VertexHandle a, VertexHandle b) const {
  return impl_->is_inner(inner(a), inner(b));
}

bool SurfaceMesh::may_swap(VertexHandle a, VertexHandle b) const {
  const VertexHandle p = inner(a), q = inner(b);
  return impl_->is_inner(p, q) && impl_->om.is_flip_ok(impl_->om.edge_handle(impl_->find(p, q)));
}

bool SurfaceMesh::may_split(VertexHandle first, VertexHandle last) const {
  const Om& om = impl_->om;
  const VertexHandle a = inner(first), b = inner(last);
  const OmHalfedge h = impl_->find_only(a, b);
  if (!h.is_valid() || om.status(om.edge_handle(h)).locked()) return false;
  if (om.is_boundary(om.edge_handle(h))) {
    // Edges of a rim are split where there are no cells, and on no other surface.
    if (!impl_->alone || !impl_->has_one_sheet(a) || !impl_->has_one_sheet(b)) return false;
  }
  for (OmHalfedge side : {h, om.opposite_halfedge_handle(h)})
    if (!om.is_boundary(side) &&
        (impl_->record(om.face_handle(side)).locked || impl_->record(om.face_handle(side)).interface))
      return false;
  return true;
}

void SurfaceMesh::collapse_targets(VertexHandle vertex, std::vector<VertexHandle>& out) {
  const SurfaceKind kind = motion_constraint(vertex).kind;
  const VertexHandle v = inner(vertex);
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
    const VertexHandle onto = impl_->vertex_of(om.to_vertex_handle(*it));
    if (om.is_collapse_ok(*it) && impl_->find_only(v, onto).is_valid() && !impl_->closes(*it))
      out.push_back(outer(onto));
  }
}

/// Would the collapse lay a face upon another one, as where a region is no more than one cell? The shape
/// would count it, and it would be gone with that region.
bool SurfaceMesh::Impl::closes(OmHalfedge h) const {
  const OmVertex from = om.from_vertex_handle(h), onto = om.to_vertex_handle(h);
  for (auto it = om.cvf_iter(from); it.is_valid(); ++it) {
    std::array<VertexHandle, 3> f = vertices(*it);
    if (std::find(f.begin(), f.end(), vertex_of(onto)) != f.end()) continue;
    std::replace(f.begin(), f.end(), vertex_of(from), vertex_of(onto));
    if (find(f).is_valid()) return true;
  }
  return false;
}

}  // namespace hfr
