// SPDX-License-Identifier: BSD-3-Clause
// The polish of hfr::improve(), run by all ranks at the same time: each has its part as the mesh of the run,
// and what the run asks of the whole (counts, the worst cell, bounds on cells) comes from reductions. So all
// ranks decide alike.
#include "Distributed/InParts.hh"

#include <algorithm>

#include "Distributed/PartPasses.hh"
#include "Quality/FoldedFaces.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Checkpoint.hh"
#include "Remesh/Polish.hh"
#include "Remesh/Run.hh"
#include "Remesh/Survey.hh"

namespace hfr::mpi {
namespace {

/// The ranks as the run of one of them sees them.
class Residents : public Ranks {
 public:
  explicit Residents(DistributedMesh& mesh) : mesh_(mesh), passes_(mesh, n_rounds_) {}

  bool keep_mesh() const override { return true; }
  bool can_do(PassKind kind, Metric metric) const override {
    const bool is_on_cutouts = kind == PassKind::kInsert || kind == PassKind::kCluster;
    return PartPasses::can_do(is_on_cutouts ? PassKind::kEdge : kind, metric);
  }
  bool can_take(const TetMesh&, const Workspace&) const override { return true; }
  std::size_t least_cells(std::size_t) const override { return 0; }
  void take(const TetMesh&, const Workspace&) override {}
  RoundCounts pass(const Look& look) override { return passes_.run(look); }
  RoundCounts dig(const Dig& dig, std::vector<std::uint64_t>& waiting) override {
    return passes_.dig(dig, waiting);
  }
  RoundCounts search(const Search& search) override { return passes_.search(search); }
  Tally tally(double below) override { return passes_.tally(below); }
  std::size_t n_cells() const override { return static_cast<std::size_t>(mesh_.n_cells()); }
  void bring_back(TetMesh&, Workspace&) override {}

 private:
  DistributedMesh& mesh_;
  std::uint64_t n_rounds_ = 0;
  PartPasses passes_;
};

/// What of the options is not there in parts; empty where all is.
std::string reason_against(const ImproveOptions& options) {
  if (!options.min_dihedral || !options.polish_only) return "runs other than the polish towards a goal";
  const SurfaceOptions& surface = options.surface;
  if (surface.mode != SurfaceMode::kFrozen) return "surfaces that may change";
  if (!surface.fixed_patches.empty() || !surface.fixed_vertices.empty() || !surface.fixed_edges.empty() ||
      !surface.fixed_faces.empty())
    return "fixed patches, faces, edges and vertices";
  if (options.compat != Compat::kNone) return "published pipelines";
  if (options.smoother != Smoother::kNewton) return "other smoothers than newton";
  if (options.coarsen) return "coarsening";
  if (options.device.kind == DeviceChoice::Kind::kOpenCl) return "devices";
  if (options.time_limit < std::numeric_limits<double>::infinity()) return "time limits";
  if (options.progress || options.cancel) return "callbacks";
  if (options.maps) return "maps";
  return {};
}

/// The boundary lies on itself at a vertex of this rank. What this part ends with is no boundary, and of
/// positive cells none of it is folded.
bool is_folded(DistributedMesh& mesh, par::Policy policy) {
  const std::vector<HalfFaceHandle> folded = folded_faces(mesh.part(), policy);
  return std::any_of(folded.begin(), folded.end(), [&](HalfFaceHandle h) {
    const auto v = mesh.part().halfface_vertices(h);
    return std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return mesh.is_own(u); });
  });
}

/// As before the first run.
void begin(DistributedMesh& mesh) {
  Workspace& work = mesh.work();
  work.begin();
  std::fill(work.changed.begin(), work.changed.end(), work.clock);
}

}  // namespace

InParts survey(DistributedMesh& mesh, double goal, par::Policy policy) {
  struct Found {
    std::array<std::uint64_t, 4 + kCountedBelow.size()>
        sums{};  // cells, boundary faces, invalid, below the goal
    double worst = std::numeric_limits<double>::infinity();
  };
  std::array<double, kCountedBelow.size()> below{};
  for (std::size_t k = 0; k < below.size(); ++k) below[k] = dihedral_decision(kCountedBelow[k]);
  const double goal_decision = goal > 0 ? dihedral_decision(goal) : 0.0;
  const TetMesh& part = mesh.part();
  const int n_parts = par::thread_count(policy, part.n_cells());
  std::vector<Found> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int p) {
    Found mine;
    const std::size_t end = par::part_begin(part.n_cells(), n_parts, p + 1);
    for_decisions(part, MinDihedral{}, par::part_begin(part.n_cells(), n_parts, p), end,
                  [&](std::size_t i, double value) {
                    const CellHandle c(i);
                    if (part.is_deleted(c) || !mesh.is_own(c)) return;
                    const Cell& cell = part.cell(c);
                    ++mine.sums[0];
                    for (HalfFaceHandle m : cell.mate) mine.sums[1] += m.is_valid() ? 0 : 1;
                    if (!(value > 0) && orientation(part.point(cell.v[0]), part.point(cell.v[1]),
                                                    part.point(cell.v[2]), part.point(cell.v[3])) <= 0)
                      ++mine.sums[2];
                    mine.sums[3] += value < goal_decision ? 1 : 0;
                    for (std::size_t k = 0; k < below.size(); ++k)
                      mine.sums[4 + k] += value < below[k] ? 1 : 0;
                    mine.worst = std::min(mine.worst, value);
                  });
    found[static_cast<std::size_t>(p)] = mine;
  });
  std::array<std::uint64_t, 5 + kCountedBelow.size()> sums{};
  double worst = std::numeric_limits<double>::infinity();
  for (const Found& one : found) {
    for (std::size_t k = 0; k < one.sums.size(); ++k) sums[k] += one.sums[k];
    worst = std::min(worst, one.worst);
  }
  for (std::size_t v = 0; v < part.n_vertices(); ++v)
    if (mesh.is_own(VertexHandle(v)) && !part.is_deleted(VertexHandle(v))) ++sums.back();
  InParts all;
  all.worst = mesh.comm().sum_and_min(sums, worst);
  all.n_cells = sums[0];
  all.n_boundary_faces = sums[1];
  all.n_invalid = sums[2];
  all.n_below_goal = sums[3];
  std::copy_n(sums.begin() + 4, all.n_below.size(), all.n_below.begin());
  all.n_vertices = sums.back();
  all.min_dihedral = report_value(Metric::kMinDihedral, std::min(all.worst, kRegularDihedral));
  all.most_held = static_cast<std::uint64_t>(-mesh.comm().min(-static_cast<double>(part.n_cells())));
  return all;
}

PartsResult improve(DistributedMesh& mesh, const ImproveOptions& options) {
  validate(options);
  const std::string reason = reason_against(options);
  HFR_REQUIRE(reason.empty(), "meshes in parts do not have " + reason + " yet");
  const par::Policy policy = options.policy;
  PartsResult result;
  result.before = result.after = survey(mesh, *options.min_dihedral, policy);
  HFR_REQUIRE(result.before.n_invalid == 0, "meshes in parts do not have untangling yet, and this one has " +
                                                std::to_string(result.before.n_invalid) +
                                                " inverted or flat cells");
  HFR_REQUIRE(mesh.comm().sum(is_folded(mesh, policy) ? 1 : 0) == 0,
              "meshes in parts cannot have a boundary that lies on itself or goes through itself yet");
  if (result.before.n_below_goal == 0) {
    result.goal_reached = true;
    return result;
  }
  begin(mesh);
  const Strategy strategy = resolve(options, {result.before.worst, 0}, result.before.n_cells);
  RunControl control;
  Findings findings;
  DeviceSession device;
  Residents residents(mesh);
  const Run run{mesh.part(), mesh.work(), strategy,        control, findings,  device,
                nullptr,     nullptr,     strategy.bounds, false,   &residents};
  polish(run, strategy.polish, *options.min_dihedral);
  result.after = survey(mesh, *options.min_dihedral, policy);
  const auto has_fallen = [&] {
    Standing now, before;
    now.worst = result.after.worst;
    before.worst = result.before.worst;
    return !is_no_worse(now, before);
  };
  if (has_fallen()) {
    polish_to(run.within(strategy.bounds_asked), strategy.mending(), result.before.worst);
    result.after = survey(mesh, *options.min_dihedral, policy);
  }
  result.has_fallen = has_fallen();
  result.changed = control.n_changes() > 0;
  result.goal_reached = result.after.n_below_goal == 0 && result.after.n_invalid == 0;
  result.passes = std::move(control.passes());
  result.seconds = control.seconds();
  return result;
}

}  // namespace hfr::mpi
