// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/VertexCollapse.hh"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "Operators/Metrics.hh"

namespace hfr {
namespace {

/// Vertices of a link, each once, although its faces name it three times and more.
class LinkVertices {
 public:
  void add(VertexHandle v) {
    std::uint64_t& marks = marks_[v.idx() % kMarks / 64];
    const std::uint64_t mark = std::uint64_t{1} << (v.idx() % 64);
    // Those whose marks differ are not the same.
    if ((marks & mark) != 0 && std::find(vertices_.begin(), vertices_.end(), v) != vertices_.end()) return;
    marks |= mark;
    vertices_.push_back(v);
  }
  std::span<const VertexHandle> ascending() {
    std::sort(vertices_.begin(), vertices_.end());
    return {vertices_.begin(), vertices_.end()};
  }

 private:
  static constexpr std::size_t kMarks = 256;

  FixedVector<VertexHandle, 3 * Star::kCapacity> vertices_;
  std::array<std::uint64_t, kMarks / 64> marks_{};
};

}  // namespace

template <class Metric>
void VertexCollapse<Metric>::scope(const TetMesh& mesh, Seed seed, Scope& out) const {
  Star star;
  out.clear();
  mesh.gather_star(seed, star);
  for (int i = 0; i < star.size; ++i) out.push_back(star.cells[static_cast<std::size_t>(i)]);
}

template <class Metric>
std::optional<typename VertexCollapse<Metric>::Plan> VertexCollapse<Metric>::evaluate(const TetMesh& mesh,
                                                                                      Seed seed) const {
  if (frozen[seed.idx()] || mesh.labels().vertex(seed) != 0) return std::nullopt;
  Star star;
  if (!mesh.gather_star(seed, star)) return std::nullopt;
  const auto n = static_cast<std::size_t>(star.size);
  FixedVector<std::array<VertexHandle, 3>, Star::kCapacity> faces;  // of the link
  FixedVector<std::array<Vec3, 3>, Star::kCapacity> corners;        // and their points
  LinkVertices link;
  double old_worst = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    old_worst = std::min(old_worst, quality[star.cells[i].idx()]);
    const auto f = mesh.halfface_vertices(halfface_of(star.cells[i], star.corners[i]));
    faces.push_back(f);
    corners.push_back({mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2])});
    for (VertexHandle v : f) link.add(v);
  }

  Plan plan;
  plan.new_worst = old_worst;
  std::size_t killer = 0;  // the face that refused the last apex is likely to refuse the next
  for (VertexHandle apex : link.ascending()) {
    const Vec3 p = mesh.point(apex);
    double worst = std::numeric_limits<double>::infinity();
    std::uint32_t n_created = 0;
    for (std::size_t k = 0; k < n && worst > plan.new_worst; ++k) {
      const std::size_t i = k == 0 ? killer : k <= killer ? k - 1 : k;
      const auto& f = faces[i];
      if (f[0] == apex || f[1] == apex || f[2] == apex) continue;
      ++n_created;
      worst = std::min(worst, metric(corners[i][0], corners[i][1], corners[i][2], p));
      if (!(worst > plan.new_worst)) killer = i;
    }
    if (!(worst > plan.new_worst) || n_created == 0) continue;
    plan.new_worst = worst;
    plan.apex = apex;
    plan.n_created = n_created;
  }
  if (!plan.apex.is_valid()) return std::nullopt;
  plan.old_worst = old_worst;
  plan.n_removed = static_cast<std::uint32_t>(n);
  plan.removes_vertex = true;
  plan.seed = seed;
  return plan;
}

template <class Metric>
void VertexCollapse<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  Star star;
  mesh.gather_star(plan.seed, star);
  out.clear();
  out.removed_vertex = plan.seed;
  for (std::size_t i = 0; i < static_cast<std::size_t>(star.size); ++i) {
    out.removed.push_back(star.cells[i]);
    const auto f = mesh.halfface_vertices(halfface_of(star.cells[i], star.corners[i]));
    if (f[0] != plan.apex && f[1] != plan.apex && f[2] != plan.apex)
      out.created.push_back({f[0], f[1], f[2], plan.apex});
  }
}

HFR_INSTANTIATE_FOR_METRICS(VertexCollapse)

}  // namespace hfr
