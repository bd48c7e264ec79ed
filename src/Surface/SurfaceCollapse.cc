// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceCollapse.hh"

#include <algorithm>
#include <limits>
#include <span>

#include "Operators/Metrics.hh"

namespace hfr {
namespace {

/// The cells that a collapse may write. In two regions those of the smaller number come first; within a
/// region, the cells behind the star.
struct Cluster {
  Star star;
  Scope cells;
  RawArray<std::uint8_t, Star::kCapacity> corner;  // of the vertex in each; 4 behind the star
  std::size_t n_first = 0;                         // of the smaller region, where there are two
};

/// The cells behind link faces at vertices with at most two cells in the star, which are not of the star.
Scope cells_behind(const TetMesh& mesh, const Star& star) {
  struct Count {
    VertexHandle v;
    int n = 0;
  };
  FixedVector<Count, 3 * Star::kCapacity> counts;
  const std::span cells(star.cells.begin(), static_cast<std::size_t>(star.size));
  const auto count_of = [&](VertexHandle v) {
    return std::find_if(counts.begin(), counts.end(), [&](const Count& c) { return c.v == v; });
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (VertexHandle w : mesh.halfface_vertices(halfface_of(cells[i], star.corners[i]))) {
      const auto at = count_of(w);
      if (at != counts.end())
        ++at->n;
      else
        counts.push_back({w, 1});
    }
  }
  Scope behind;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const HalfFaceHandle h = halfface_of(cells[i], star.corners[i]);
    const auto f = mesh.halfface_vertices(h);
    const bool rare = std::any_of(f.begin(), f.end(), [&](VertexHandle w) { return count_of(w)->n <= 2; });
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (!rare || !m.is_valid() || std::find(cells.begin(), cells.end(), cell_of(m)) != cells.end()) continue;
    if (std::find(behind.begin(), behind.end(), cell_of(m)) == behind.end()) behind.push_back(cell_of(m));
  }
  return behind;
}

/// Gathers the cells that a collapse of v may write; none where they are too many, or of more than two
/// regions. Besides the star: another vertex with only one or two cells in it may have none left that is
/// created anew, and its incident cell would point nowhere, so the cells behind those come along. Which these
/// are must not depend on the target: cells_behind().
void gather_cluster(const TetMesh& mesh, VertexHandle v, Cluster& out) {
  out.cells.clear();
  out.n_first = 0;
  Star& star = out.star;
  if (!mesh.gather_star(v, star)) return;
  const auto n = static_cast<std::size_t>(star.size);
  const Scope behind = cells_behind(mesh, star);
  if (behind.size() + n > Star::kCapacity) return;
  int low = mesh.region(star.cells[0]);
  int high = low;
  const auto look = [&](CellHandle c) {
    low = std::min(low, mesh.region(c));
    high = std::max(high, mesh.region(c));
  };
  if (mesh.has_regions()) {
    for (CellHandle c : behind) look(c);
    for (std::size_t i = 0; i < n; ++i) look(star.cells[i]);
  }
  const auto put = [&](int region) {
    const auto take = [&](CellHandle c, std::uint8_t corner) {
      if (mesh.region(c) != region) return;
      out.corner[out.cells.size()] = corner;
      out.cells.push_back(c);
    };
    for (CellHandle c : behind) take(c, 4);
    for (std::size_t i = 0; i < n; ++i) take(star.cells[i], star.corners[i]);
  };
  put(low);
  if (low == high) return;
  out.n_first = out.cells.size();
  put(high);
  if (out.cells.size() != behind.size() + n) out.cells.clear();
}

bool has(const std::array<VertexHandle, 3>& f, VertexHandle v) { return f[0] == v || f[1] == v || f[2] == v; }

/// Faces of the surface in the star at v, as seen from outside or from the larger region.
template <class Faces>
bool gather_faces(const TetMesh& mesh, VertexHandle v, const Star& star, Faces& out) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(star.size); ++i) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(star.cells[i], k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (k == star.corners[i] || (m.is_valid() && !(mesh.region(cell_of(h)) < mesh.region(cell_of(m)))))
        continue;
      const auto f = mesh.halfface_vertices(h);
      if (out.full()) return false;
      if (has(f, v)) out.push_back({f[0], f[2], f[1]});
    }
  }
  return true;
}

/// True where the star has an inner face (v, onto, x) whose edge (v, x) is on the surface: then two edges of
/// it would become one.
template <class Faces>
bool meets_twice(const TetMesh& mesh, const Star& star, const Faces& faces, VertexHandle onto) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(star.size); ++k) {
    const auto f = mesh.halfface_vertices(halfface_of(star.cells[k], star.corners[k]));
    if (!has(f, onto)) continue;
    for (VertexHandle x : f) {
      if (x == onto) continue;
      bool is_with_x = false;
      bool is_with_both = false;
      for (const auto& g : faces) {
        is_with_x = is_with_x || has(g, x);
        is_with_both = is_with_both || (has(g, x) && has(g, onto));
      }
      if (is_with_x && !is_with_both) return true;
    }
  }
  return false;
}

}  // namespace

template <class Metric>
bool SurfaceCollapse<Metric>::may_gain(const TetMesh& mesh, VertexHandle v) const {
  Star star;
  FixedVector<std::array<VertexHandle, 3>, kMaxFacesOfVertex> faces;
  if (!mesh.gather_star(v, star) || !gather_faces(mesh, v, star, faces)) return false;
  const auto n = static_cast<std::size_t>(star.size);
  RawArray<std::array<VertexHandle, 3>, Star::kCapacity> link;
  double old_worst = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < n; ++k) {
    link[k] = mesh.halfface_vertices(halfface_of(star.cells[k], star.corners[k]));
    old_worst = std::min(old_worst, quality[star.cells[k].idx()]);
  }
  FixedVector<VertexHandle, 3 * kMaxFacesOfVertex> asked;
  const auto gains = [&](VertexHandle onto) {
    const Vec3 p = mesh.point(onto);
    bool has_created = false;
    for (std::size_t k = 0; k < n; ++k) {
      const auto& f = link[k];
      if (has(f, onto)) continue;
      has_created = true;
      if (metric(mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2]), p) > old_worst) continue;
      std::swap(link[0], link[k]);  // a face that has ended one search is likely to end the next
      return false;
    }
    return has_created;
  };
  for (const auto& f : faces) {
    for (VertexHandle w : f) {
      if (w == v || std::find(asked.begin(), asked.end(), w) != asked.end()) continue;
      asked.push_back(w);
      if (gains(w)) return true;
    }
  }
  return false;
}

template <class Metric>
void SurfaceCollapse<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  Cluster cluster;
  gather_cluster(mesh, seed.vertex, cluster);
  out = cluster.cells;
}

template <class Metric>
auto SurfaceCollapse<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  const VertexHandle v = seed.vertex;
  if (mesh.labels().vertex(v) != 0) return std::nullopt;
  Cluster cluster;
  gather_cluster(mesh, v, cluster);
  const Star& star = cluster.star;
  const Scope& cells = cluster.cells;
  if (cells.empty()) return std::nullopt;
  const auto n = static_cast<std::size_t>(star.size);
  const std::size_t n_behind = cells.size() - n;
  FixedVector<std::array<VertexHandle, 3>, kMaxFacesOfVertex> faces;
  if (!gather_faces(mesh, v, star, faces)) return std::nullopt;

  double old_worst = std::numeric_limits<double>::infinity();
  // The cells behind the star stay as they are: no target does better than the worst of them.
  double floor = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    old_worst = std::min(old_worst, quality[cells[i].idx()]);
    if (cluster.corner[i] == 4) floor = std::min(floor, quality[cells[i].idx()]);
  }
  Plan plan;
  plan.old_worst = old_worst;
  plan.new_worst = old_worst;
  for (std::uint32_t i = seed.first; i < seed.first + seed.n; ++i) {
    const VertexHandle onto = targets[i];
    const Vec3 p = mesh.point(onto);
    double worst = floor;
    std::uint32_t n_created = 0;
    for (std::size_t k = 0; k < n && worst > plan.new_worst; ++k) {
      const auto f = mesh.halfface_vertices(halfface_of(star.cells[k], star.corners[k]));
      if (has(f, onto)) continue;
      ++n_created;
      worst = std::min(worst, metric(mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2]), p));
    }
    if (!(worst > plan.new_worst) || n_created == 0) continue;
    FixedVector<Triangle, kMaxFacesOfVertex> removed, created;
    for (const auto& f : faces) {
      Triangle t = {mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2])};
      removed.push_back(t);
      if (has(f, onto)) continue;
      for (std::size_t k = 0; k < 3; ++k)
        if (f[k] == v) t[k] = p;
      created.push_back(t);
    }
    if (meets_twice(mesh, star, faces, onto) || !surface->keeps_shape(faces, removed, created)) continue;
    plan.new_worst = worst;
    plan.onto = onto;
    plan.n_created = n_created + static_cast<std::uint32_t>(n_behind);
  }
  if (!plan.onto.is_valid()) return std::nullopt;
  plan.n_removed = static_cast<std::uint32_t>(cells.size());
  plan.n_removed_first = static_cast<std::uint16_t>(cluster.n_first);
  for (std::size_t i = 0; i < cluster.n_first; ++i)
    if (cluster.corner[i] == 4 ||
        !has(mesh.halfface_vertices(halfface_of(cells[i], cluster.corner[i])), plan.onto))
      ++plan.n_created_first;
  plan.removes_vertex = true;
  plan.seed = seed;
  return plan;
}

template <class Metric>
void SurfaceCollapse<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  Cluster cluster;
  gather_cluster(mesh, plan.seed.vertex, cluster);
  out.clear();
  out.surface_is_held = true;
  out.removed_vertex = plan.seed.vertex;
  out.n_removed_first = plan.n_removed_first;
  out.n_created_first = plan.n_created_first;
  for (std::size_t i = 0; i < cluster.cells.size(); ++i) {
    const CellHandle c = cluster.cells[i];
    out.removed.push_back(c);
    if (cluster.corner[i] == 4) {
      out.created.push_back(mesh.cell(c).v);
      continue;
    }
    const auto f = mesh.halfface_vertices(halfface_of(c, cluster.corner[i]));
    if (!has(f, plan.onto)) out.created.push_back({f[0], f[1], f[2], plan.onto});
  }
}

HFR_INSTANTIATE_FOR_METRICS(SurfaceCollapse)

}  // namespace hfr
