// SPDX-License-Identifier: BSD-3-Clause
// An operator of one's own: cuts every cell above a size into four at its middle, all of them in one round.
#include <algorithm>
#include <cstdio>

#include <hfremesh/HalfFace/Check.hh>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/Scheduler/Round.hh>

using namespace hfr;

struct SplitLargeCell {
  using Seed = CellHandle;
  struct Plan : PlanBase {  // a small value: what was found out, enough for cavity() to say it again in full
    CellHandle seed;
    Vec3 middle;
  };
  Volume metric;  // keeps the workspace's qualities up to date
  double limit;   // six times the volume above which a cell is cut

  void scope(const TetMesh&, Seed c, Scope& out) const {
    out.clear();
    out.push_back(c);
  }
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed c) const {
    const Tet& v = mesh.cell(c).v;
    const double size = metric(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
    if (size <= limit) return std::nullopt;  // refusal is no error
    Plan plan{{.old_worst = 0, .new_worst = 1, .n_removed = 1, .n_created = 4, .adds_vertex = true}, c, {}};
    for (VertexHandle u : v) plan.middle = plan.middle + 0.25 * mesh.point(u);
    return plan;
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    out.clear();
    out.removed.push_back(plan.seed);
    for (HalfFaceHandle h : mesh.cell_halffaces(plan.seed)) {
      const auto f = mesh.halfface_vertices(h);
      out.created.push_back({f[0], f[1], f[2], Cavity::kNewVertex});
    }
    out.new_vertex = plan.middle;
  }
  Tet identity(const TetMesh& mesh, Seed c) const {
    Tet names = mesh.cell(c).v;
    return std::sort(names.begin(), names.end()), names;
  }
};
static_assert(LocalOperator<SplitLargeCell>);

int main() {
  const generate::Arrays box = generate::jittered_box({8, 8, 8}, 0.2, 1);
  TetMesh mesh = build(box.points, box.cells);
  Workspace work;
  work.attach(mesh, {});
  const std::vector<CellHandle> seeds(mesh.cells().begin(), mesh.cells().end());
  const RoundCounts counts = Round<SplitLargeCell>(mesh, work, {}).run({{}, 0.002}, seeds);
  std::printf("%zu of %zu cells cut, %zu now\n", counts.winners, counts.seeds, mesh.n_logical_cells());
  return check(mesh) && mesh.n_logical_cells() == counts.seeds + 3 * counts.winners ? 0 : 1;
}
