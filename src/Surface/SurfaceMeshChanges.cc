// SPDX-License-Identifier: BSD-3-Clause
// What has happened to the surface, told one change at a time.
#include <limits>
#include <utility>

#include "Surface/SurfaceMeshImpl.hh"

namespace hfr {
using namespace surface;  // what SurfaceMesh is made of

namespace {

void take_samples(FaceRecord& face, std::array<std::vector<Vec3>, 2>& out) {
  for (std::size_t kind = 0; kind < 2; ++kind) {
    auto& points = face.samples[kind].points;
    out[kind].insert(out[kind].end(), points.begin(), points.end());
    points.clear();
  }
}

}  // namespace

void SurfaceMesh::Impl::account(const std::vector<OmFace>& some, double sign) {
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

void SurfaceMesh::Impl::share_samples(const std::vector<OmFace>& among,
                                      std::array<std::vector<Vec3>, 2> homeless) {
  /// Share of the distance allowed: a sample this near to its face stays with it.
  constexpr double kNearEnough = 0.25;
  const double enough = kNearEnough * hausdorff;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> beneath;
  for (OmFace f : among) {
    triangles.push_back(corners(f));
    beneath.push_back(record(f).beneath);
    const NearTriangle now(triangles.back());
    for (std::size_t kind = 0; kind < 2; ++kind) {
      Samples& of_f = record(f).samples[kind];
      std::erase_if(of_f.points, [&](Vec3 s) {
        const bool leaves = !now.is_within(s, enough);
        if (leaves) homeless[kind].push_back(s);
        return leaves;
      });
      of_f.reach = of_f.points.empty() ? 0.0 : enough;
    }
  }
  for (std::size_t kind = 0; kind < 2; ++kind) {
    for (Vec3 s : homeless[kind]) {
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < among.size() && least > 0; ++i) {
        const double d = norm2(nearest_point(triangles[i], s) - s);
        if (d < least) {
          least = d;
          nearest = i;
        }
      }
      if (!(least < std::numeric_limits<double>::infinity())) continue;
      Samples& home = record(among[nearest]).samples[kind];
      home.points.push_back(s);
      home.reach = std::max(home.reach, std::sqrt(least));
    }
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

void SurfaceMesh::on_move(const TetMesh& mesh, std::span<const VertexHandle> vertices) {
  for (VertexHandle v : vertices) on_move(v, mesh.point(v));
}

void SurfaceMesh::on_move(VertexHandle v, Vec3 x) {
  HFR_ASSERT(!numbers_);
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

void SurfaceMesh::on_swap(VertexHandle a, VertexHandle b) {
  HFR_ASSERT(!numbers_);
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

void SurfaceMesh::on_collapse(VertexHandle v, VertexHandle onto) {
  HFR_ASSERT(!numbers_);
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
  std::array<std::vector<Vec3>, 2> samples;
  std::vector<OmFace> old = impl_->faces_round(from);
  impl_->account(old, -1);
  for (OmFace f : old) {
    impl_->note_gone(f);
    take_samples(impl_->record(f), samples);
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
  impl_->motion_constraint[v.idx()] = {};
}

void SurfaceMesh::on_split(VertexHandle a, VertexHandle b, VertexHandle middle, Vec3 place) {
  HFR_ASSERT(!numbers_);
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
  MotionConstraint motion_constraint{SurfaceKind::kFacet, place,
                                     unit(scaled_normal(impl_->corners(halves[0])))};
  if (feature) motion_constraint = {SurfaceKind::kCurve, place, unit(place_of(ends[1]) - place_of(ends[0]))};
  // In flat mode the middle lies where both ends may go, or in the plane that one of them names.
  for (VertexHandle v : {a, b})
    if (impl_->flat() && impl_->motion_constraint[v.idx()].kind == motion_constraint.kind)
      motion_constraint = impl_->motion_constraint[v.idx()];

  for (OmFace f : halves) impl_->note_gone(f);
  impl_->account(halves, -1);
  std::vector<FaceRecord> was;
  std::array<std::vector<Vec3>, 2> samples;
  for (OmFace f : halves) {
    take_samples(impl_->record(f), samples);
    was.push_back(impl_->record(f));
  }
  const OmVertex m = impl_->add_vertex(middle, place);
  om.split_edge(e, m);
  impl_->faces.resize(om.n_faces());
  const std::vector<OmFace> round = impl_->faces_round(m);
  for (OmFace f : round) {
    const auto v = impl_->vertices(f);
    const bool first = v[0] == apex || v[1] == apex || v[2] == apex;
    impl_->record(f) = was[first ? 0 : 1];
    impl_->note_fresh(f);
  }
  impl_->account(round, 1);
  for (auto it = om.cvoh_iter(m); it.is_valid(); ++it) {
    const OmVertex to = om.to_vertex_handle(*it);
    om.status(om.edge_handle(*it)).set_feature(feature && (to == ends[0] || to == ends[1]));
  }
  impl_->motion_constraint.resize(std::max<std::size_t>(impl_->motion_constraint.size(), middle.idx() + 1));
  impl_->motion_constraint[middle.idx()] = motion_constraint;
  if (impl_->flat()) return;
  impl_->share_samples(round, std::move(samples));
}

auto SurfaceMesh::take_label_changes() -> LabelChanges {
  HFR_ASSERT(!numbers_);
  LabelChanges changes;
  changes.gone = std::exchange(impl_->gone, {});
  for (int i : std::exchange(impl_->fresh, {})) {
    const OmFace f(i);
    if (impl_->om.status(f).deleted()) continue;
    auto v = impl_->vertices(f);
    if (impl_->record(f).inward) std::swap(v[1], v[2]);
    changes.set.push_back({v, impl_->record(f).patch});
  }
  return changes;
}

void SurfaceMesh::write_labels(TetMesh& mesh) {
  const LabelChanges changes = take_label_changes();
  auto& labels = mesh.labels().faces;
  for (const auto& f : changes.gone) labels.erase_unordered(f);
  for (const LabelChanges::Set& one : changes.set) labels.set(one.vertices, one.label);
}

bool SurfaceMesh::in_step(const TetMesh& mesh) const {
  HFR_ASSERT(!numbers_);
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
