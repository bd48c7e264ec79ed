// SPDX-License-Identifier: BSD-3-Clause
// The surface of some cells of a mesh, with what is known of the whole's.
#include "Surface/SurfaceMeshImpl.hh"

namespace hfr {

SurfaceMesh::SurfaceMesh(const TetMesh& part, const SurfaceMesh& whole,
                         std::span<const VertexHandle> vertices)
    : impl_(new Impl) {
  const Impl& there = *whole.impl_;
  HFR_ASSERT(there.flat() && !there.alone);
  impl_->options = there.options;
  surface::Arrays arrays = surface::gather(part, SurfaceOptions{}, {});
  const auto known_as = [&](VertexHandle v) { return vertices[v.idx()]; };
  const auto whole_of = [&](VertexHandle v) { return whole.inner(known_as(v)); };

  surface::Features features;
  features.edges = surface::find_edges(arrays);
  features.facet.resize(arrays.faces.size());
  features.motion_constraint.resize(part.n_vertices());
  const auto n_facets = static_cast<std::uint32_t>(there.om.n_faces());  // at most
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    const auto& [a, b, c] = arrays.faces[i];
    const surface::OmFace f = there.find({whole_of(a), whole_of(b), whole_of(c)});
    const bool shared = !f.is_valid() || there.record(f).interface;
    arrays.fixed[i] = shared ? 1 : 0;
    arrays.locked[i] = shared || there.record(f).locked ? 1 : 0;
    // What faces other cells is a facet of its own.
    features.facet[i] = shared ? n_facets + static_cast<std::uint32_t>(i) : there.record(f).facet;
    arrays.patch[i] = shared ? 0 : there.record(f).patch;
    arrays.inward[i] = !shared && there.record(f).inward ? 1 : 0;
  }
  for (surface::Edge& e : features.edges) {
    const surface::OmHalfedge h = there.find(whole_of(e.a), whole_of(e.b));
    const bool shared = arrays.fixed[e.f[0]] || arrays.fixed[e.f[1]];
    const auto differ = [&](const auto& of) { return of[e.f[0]] != of[e.f[1]]; };
    e.locked = shared || (h.is_valid() && there.om.status(there.om.edge_handle(h)).locked());
    e.feature = e.locked || !e.manifold || differ(features.facet) || differ(arrays.patch) ||
                (h.is_valid() && there.om.status(there.om.edge_handle(h)).feature());
  }
  for (std::size_t i = 0; i < arrays.faces.size(); ++i)
    for (VertexHandle v : arrays.faces[i])
      if (features.motion_constraint[v.idx()].kind == SurfaceKind::kInside)
        features.motion_constraint[v.idx()] = whole.motion_constraint(known_as(v));
  for (std::size_t i = 0; i < arrays.faces.size(); ++i)
    for (VertexHandle v : arrays.faces[i])
      if (arrays.fixed[i] || !there.has_one_sheet(whole_of(v)) || !whole.orbit(known_as(v)).empty())
        features.motion_constraint[v.idx()] = {SurfaceKind::kFixed, part.point(v), {}};
  impl_->build(arrays, features);
  impl_->motion_constraint = std::move(features.motion_constraint);
}

}  // namespace hfr
