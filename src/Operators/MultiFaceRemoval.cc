// SPDX-License-Identifier: BSD-3-Clause
// Shewchuk, Two discrete optimization algorithms for the topological improvement of tetrahedral meshes, 2002,
// section 3: the tree of sandwiched faces and its programme.
#include "Operators/MultiFaceRemoval.hh"

#include <algorithm>
#include <limits>

#include "Operators/Metrics.hh"

namespace hfr {
namespace {

/// Faces looked at for one seed. A tree has each once, but where the faces close round a vertex they are met
/// again on every way that leads there.
constexpr int kMaxVisits = 64;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// The half-face behind edge i of a sandwiched face, in the cell of a and between the same apexes; invalid
/// when there is none. Edge i leads from vertex i of the half-face to the next.
HalfFaceHandle across(const TetMesh& mesh, HalfFaceHandle h, std::size_t i) {
  const HalfFaceHandle below = mesh.opposite_halfface(h);
  const auto f = mesh.halfface_vertices(h);
  const VertexHandle lost = f[(i + 2) % 3];
  const VertexHandle a = mesh.halfface_opposite_vertex(h);
  const VertexHandle b = mesh.halfface_opposite_vertex(below);
  const HalfFaceHandle over = mesh.opposite_halfface(mesh.vertex_opposite_halfface(cell_of(h), lost));
  const HalfFaceHandle under = mesh.opposite_halfface(mesh.vertex_opposite_halfface(cell_of(below), lost));
  if (!over.is_valid() || !under.is_valid()) return {};
  // The cell behind (edge, a) must see the one behind (edge, b) through the face opposite a.
  const HalfFaceHandle next = mesh.vertex_opposite_halfface(cell_of(over), a);
  const HalfFaceHandle m = mesh.opposite_halfface(next);
  if (!m.is_valid() || cell_of(m) != cell_of(under) || mesh.halfface_opposite_vertex(m) != b) return {};
  return next;
}

/// The faces of a tree as the cells of apex a see them, in the order of the steps.
using Faces = FixedVector<HalfFaceHandle, FaceTree::kMaxFaces>;
Faces faces_of(const TetMesh& mesh, const FaceTree& tree) {
  Faces faces;
  faces.push_back(tree.first);
  for (std::size_t i = 0; i < tree.n_steps; ++i)
    faces.push_back(across(mesh, faces[tree.steps[i] / 3U], tree.steps[i] % 3U));
  return faces;
}

/// Searches the tree for the faces that are best removed with the first one.
template <class Metric>
class Programme {
 public:
  Programme(const TetMesh& mesh, const Metric& metric, std::span<const double> quality, HalfFaceHandle first)
      : mesh_(mesh), metric_(metric), quality_(quality) {
    tree_.first = first;
    a_ = mesh.halfface_opposite_vertex(first);
    b_ = mesh.halfface_opposite_vertex(mesh.opposite_halfface(first));
    faces_.push_back(first);
  }

  const FaceTree& tree() const { return tree_; }

  /// What goes and what comes: the worst of each.
  struct Worst {
    double old_one = kNone;
    double new_one = kNone;
  };
  Worst solve() {
    Worst worst{cells_worst(tree_.first), kNone};
    for (std::size_t i = 0; i < 3; ++i) worst = both(worst, beyond(0, i));
    return worst;
  }

 private:
  static Worst both(Worst x, Worst y) {
    return {std::min(x.old_one, y.old_one), std::min(x.new_one, y.new_one)};
  }
  double cells_worst(HalfFaceHandle h) const {
    return std::min(quality_[cell_of(h).idx()], quality_[cell_of(mesh_.opposite_halfface(h)).idx()]);
  }
  bool has(HalfFaceHandle h) const {
    return std::any_of(faces_.begin(), faces_.end(),
                       [&](HalfFaceHandle f) { return cell_of(f) == cell_of(h); });
  }

  /// The best beyond edge `edge` of face number `parent`: either the new cell at this edge, or what removing
  /// the next face, and with it the best part of the tree behind, makes of it.
  Worst beyond(std::size_t parent, std::size_t edge) {
    const auto f = mesh_.halfface_vertices(faces_[parent]);
    const VertexHandle u = f[edge];
    const VertexHandle w = f[(edge + 1) % 3];
    const double stop = metric_(mesh_.point(u), mesh_.point(w), mesh_.point(b_), mesh_.point(a_));
    const HalfFaceHandle next = across(mesh_, faces_[parent], edge);
    if (!next.is_valid()) return {kNone, stop};
    // Two ways round a vertex meet: it would be left without a cell.
    if (has(next)) return {kNone, -kNone};
    if (faces_.full() || n_visits_ == kMaxVisits || mesh_.is_constrained(next)) return {kNone, stop};
    ++n_visits_;
    const std::size_t mark = faces_.size();
    const std::uint8_t n_steps = tree_.n_steps;
    tree_.steps[tree_.n_steps++] = static_cast<std::uint8_t>(3 * parent + edge);
    faces_.push_back(next);
    const auto g = mesh_.halfface_vertices(next);
    Worst worst{cells_worst(next), kNone};
    for (std::size_t i = 0; i < 3; ++i) {
      const bool is_back = (g[i] == w && g[(i + 1) % 3] == u);
      if (!is_back) worst = both(worst, beyond(mark, i));
    }
    if (worst.new_one > worst.old_one || worst.new_one > stop) return worst;
    faces_.resize(mark);
    tree_.n_steps = n_steps;
    return {kNone, stop};
  }

  const TetMesh& mesh_;
  const Metric& metric_;
  std::span<const double> quality_;
  VertexHandle a_, b_;
  FaceTree tree_;
  Faces faces_;
  int n_visits_ = 0;
};

}  // namespace

template <class Metric>
void MultiFaceRemoval<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  out.clear();
  for (HalfFaceHandle h : faces_of(mesh, seed.tree)) {
    out.push_back(cell_of(h));
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (m.is_valid()) out.push_back(cell_of(m));
  }
}

template <class Metric>
auto MultiFaceRemoval<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  if (mesh.is_constrained(seed.halfface)) return std::nullopt;
  Programme<Metric> programme(mesh, metric, quality, seed.halfface);
  const auto worst = programme.solve();
  if (!(worst.new_one > worst.old_one)) return std::nullopt;
  Plan plan;
  plan.seed = seed;
  plan.seed.tree = programme.tree();
  plan.old_worst = worst.old_one;
  plan.new_worst = worst.new_one;
  plan.n_removed = 2 * (1U + plan.seed.tree.n_steps);
  plan.n_created = 3U + plan.seed.tree.n_steps;
  return plan;
}

template <class Metric>
void MultiFaceRemoval<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  out.clear();
  const Faces faces = faces_of(mesh, plan.seed.tree);
  const VertexHandle a = mesh.halfface_opposite_vertex(faces[0]);
  const VertexHandle b = mesh.halfface_opposite_vertex(mesh.opposite_halfface(faces[0]));
  for (HalfFaceHandle h : faces) {
    out.removed.push_back(cell_of(h));
    out.removed.push_back(cell_of(mesh.opposite_halfface(h)));
  }
  for (HalfFaceHandle h : faces) {
    const auto f = mesh.halfface_vertices(h);
    for (std::size_t i = 0; i < 3; ++i) {
      // Edges between two faces of the tree have no new cell.
      const HalfFaceHandle side = mesh.vertex_opposite_halfface(cell_of(h), f[(i + 2) % 3]);
      const HalfFaceHandle over = mesh.opposite_halfface(side);
      const bool inside = over.is_valid() && std::any_of(faces.begin(), faces.end(), [&](HalfFaceHandle g) {
                            return cell_of(g) == cell_of(over);
                          });
      if (!inside) out.created.push_back({f[i], f[(i + 1) % 3], b, a});
    }
  }
}

template <class Metric>
Tet MultiFaceRemoval<Metric>::identity(const TetMesh& mesh, const Seed& seed) const {
  const auto f = mesh.halfface_vertices(seed.halfface);
  Tet names{f[0], f[1], f[2], VertexHandle()};
  std::sort(names.begin(), names.begin() + 3);
  return names;
}

HFR_INSTANTIATE_FOR_METRICS(MultiFaceRemoval)

}  // namespace hfr
