// SPDX-License-Identifier: BSD-3-Clause
// The stages of hfr::improve(), run by all ranks at the same time: each has its part as the mesh of the run,
// and what the run asks of the whole (counts, the worst cell, percentiles, bounds on cells) comes from
// reductions. So all ranks decide alike.
#include "Distributed/InParts.hh"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "Distributed/CellOrder.hh"
#include "Distributed/CommonBox.hh"
#include "Distributed/Order.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/PartCoordinates.hh"
#include "Distributed/PartFixes.hh"
#include "Distributed/PartPasses.hh"
#include "Distributed/PartPatchSearch.hh"
#include "Distributed/PartSurface.hh"
#include "Distributed/PartUnfolding.hh"
#include "Distributed/WorkBalance.hh"
#include "Quality/Coverage.hh"
#include "Quality/FoldedFaces.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Checkpoint.hh"
#include "Remesh/Polish.hh"
#include "Remesh/Run.hh"
#include "Remesh/Survey.hh"
#include "Remesh/WholeRun.hh"

namespace hfr::mpi {
namespace {

/// The ranks as the run of one of them sees them.
class Residents : public Ranks, public MeshInParts {
 public:
  Residents(DistributedMesh& mesh, par::Policy policy)
      : mesh_(mesh), policy_(policy), passes_(mesh, n_rounds_) {}
  std::uint64_t n_rounds() const { return n_rounds_; }

  bool keep_mesh() const override { return true; }
  MeshInParts* parts() override { return this; }
  bool can_do(PassKind kind, const RankMetric& metric) const override {
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
  /// For as long as this lives.
  void add_surface(PartSurface& surface) { surfaces_[surface.get()] = &surface; }
  std::optional<RoundCounts> surface_pass(SurfaceMesh& surface, const SurfaceLook& look) override {
    const auto counts = surfaces_.at(&surface)->pass(look, [&] { return passes_.listed(look.look); });
    if (counts) n_rounds_ += counts->rounds;
    return counts;
  }
  std::shared_ptr<SurfaceMesh> surface(const SurfaceOptions& options) override;
  void rebuild(SurfaceMesh& surface) override { surfaces_.at(&surface)->rebuild(); }
  std::vector<FeatureCeiling> feature_ceilings(std::span<const CellHandle> cells,
                                               const SurfaceOptions& options) override {
    return PartSurface::ceilings(mesh_, cells, options);
  }
  bool is_folded_since(std::uint32_t clock, bool are_positive) override;
  bool covers_twice() override;
  Tally tally(double below) override { return passes_.tally(below); }
  std::size_t n_cells() const override { return static_cast<std::size_t>(mesh_.n_cells()); }
  void bring_back(TetMesh&, Workspace&) override {}

  Survey survey() override {
    const Survey mine = hfr::survey(mesh_.part(), policy_, known_values(mesh_.work()), is_mine());
    std::array<std::uint64_t, 1> n_invalid = {mine.n_invalid};
    const double worst = mesh_.comm().sum_and_min(n_invalid, mine.worst);
    return {worst, static_cast<std::size_t>(n_invalid[0])};
  }
  AngleTally tally_below(std::span<const double> degrees) override;
  VertexTally vertices() override;
  bool is_own(CellHandle c) const override { return mesh_.is_own(c); }
  std::size_t sum(std::size_t mine) override { return static_cast<std::size_t>(mesh_.comm().sum(mine)); }
  double min(double mine) override { return mesh_.comm().min(mine); }
  double smallest(std::span<const double> mine, std::size_t rank) override;
  void mark_round(std::span<const CellHandle> cells, int layers) override {
    passes_.mark_round(cells, layers);
  }
  std::vector<std::uint64_t> worst_cells_below(double degrees, std::size_t n,
                                               std::span<const CellHandle> but) override;
  PatchesDone search_patches(std::span<const std::uint64_t> cells, int layers, const SurfaceMesh* surface,
                             const std::function<PatchesDone(PatchPlace&)>& search) override {
    return search_patches_in_parts(mesh_, cells, layers, surface ? surfaces_.at(surface) : nullptr, search);
  }
  Standing standing() override;
  Box box() override;
  std::unique_ptr<Unfolding> unfolding(const UntangleEffort& effort) override {
    return std::make_unique<PartUnfolding>(mesh_, effort, policy_);
  }
  std::shared_ptr<const void> copy() const override { return mesh_.copy(); }
  void put_back(const std::shared_ptr<const void>& copy) override {
    mesh_.put_back(*std::static_pointer_cast<const DistributedMesh>(copy));
  }
  std::string fault(const std::shared_ptr<const void>& copy) override {
    const PartsCheck checked = check_changes(mesh_, *std::static_pointer_cast<const DistributedMesh>(copy));
    return checked.is_good ? std::string() : checked.message;
  }

 private:
  std::function<bool(CellHandle)> is_mine() const {
    return [this](CellHandle c) { return mesh_.is_own(c); };
  }

  DistributedMesh& mesh_;
  par::Policy policy_;
  std::uint64_t n_rounds_ = 0;
  PartPasses passes_;
  std::map<const SurfaceMesh*, PartSurface*> surfaces_;  // by what the run knows of them
};

std::shared_ptr<SurfaceMesh> Residents::surface(const SurfaceOptions& options) {
  const auto made = std::make_shared<PartSurface>(mesh_, options, policy_);
  add_surface(*made);
  return {made->get(), [this, made](SurfaceMesh* surface) { surfaces_.erase(surface); }};
}

/// As SurfacePasses has it, each rank at its own vertices.
bool Residents::is_folded_since(std::uint32_t clock, bool are_positive) {
  const TetMesh& part = mesh_.part();
  const Workspace& work = mesh_.work();
  std::vector<VertexHandle> changed;
  for (VertexHandle v : own_vertices(mesh_))
    if (work.frozen[v.idx()] && work.changed[v.idx()] > clock) changed.push_back(v);
  bool is_folded =
      is_folded_at(part, changed, policy_) || (are_positive && is_wound_at(part, changed, policy_));
  const auto is_pinched = [&](VertexHandle v) { return !work.pinched.empty() && work.pinched[v.idx()] != 0; };
  const auto has_changed_pinched = [&](VertexHandle v) {
    return is_pinched(v) && std::binary_search(changed.begin(), changed.end(), v);
  };
  if (!is_folded && std::any_of(changed.begin(), changed.end(), is_pinched))
    is_folded = !folded_faces(part, policy_, has_changed_pinched).empty() ||
                (are_positive && hfr::covers_twice(part, policy_, has_changed_pinched));
  return mesh_.comm().sum(is_folded ? 1 : 0) > 0;
}

bool Residents::covers_twice() {
  const auto at = [&](VertexHandle v) { return mesh_.is_own(v); };
  return mesh_.comm().sum(hfr::covers_twice(mesh_.part(), policy_, at) ? 1 : 0) > 0;
}

/// Of whose inverted cells the volumes come together on all ranks.
Standing Residents::standing() {
  const Survey found = survey();
  if (found.n_invalid == 0) return standing_of(found.worst, {});
  std::vector<CellHandle> invalid = invalid_cells(mesh_.part(), policy_, known_values(mesh_.work()));
  std::erase_if(invalid, [&](CellHandle c) { return !mesh_.is_own(c); });
  InvalidVolumes volumes = volumes_of(mesh_.part(), invalid);
  volumes.n_flat = static_cast<std::size_t>(mesh_.comm().sum(volumes.n_flat));
  volumes.inverted = mesh_.comm().all_gather(std::span<const double>(volumes.inverted));
  return standing_of(found.worst, std::move(volumes));
}

Box Residents::box() {
  const TetMesh& part = mesh_.part();
  std::vector<VertexHandle> vertices = own_vertices(mesh_);
  std::erase_if(vertices, [&](VertexHandle v) { return !part.incident_cell(v).is_valid(); });
  return common_box(mesh_.comm(), vertices.size(), [&](std::size_t i) { return part.point(vertices[i]); });
}

AngleTally Residents::tally_below(std::span<const double> degrees) {
  AngleTally all = hfr::tally_below(mesh_.part(), degrees, policy_, known_values(mesh_.work()), is_mine());
  all.n_cells = n_cells();
  for (std::size_t& n : all.n_below) n = sum(n);
  all.worst = min(all.worst);
  all.smallest = report_value(Metric::kMinDihedral, all.worst);
  return all;
}

VertexTally Residents::vertices() {
  std::array<std::uint64_t, 2> n = {0, 0};
  for (VertexHandle v : own_vertices(mesh_)) {
    ++n[0];
    n[1] += mesh_.work().frozen[v.idx()] == 0 ? 1 : 0;
  }
  mesh_.comm().sum(n);
  return {static_cast<std::size_t>(n[0]), static_cast<std::size_t>(n[1])};
}

/// Each rank's own n worst ones come together on all ranks.
std::vector<std::uint64_t> Residents::worst_cells_below(double degrees, std::size_t n,
                                                        std::span<const CellHandle> but) {
  const TetMesh& part = mesh_.part();
  std::vector<Numbered> worst;
  const auto keep_worst = [&] {
    const auto order = [](const Numbered& a) { return std::pair(a.value, a.number); };
    std::ranges::sort(worst, {}, order);
    worst.resize(std::min(n, worst.size()));
  };
  for (CellHandle c : cells_below(part, degrees, policy_, known_values(mesh_.work()))) {
    if (!mesh_.is_own(c) || std::binary_search(but.begin(), but.end(), c)) continue;
    const auto& v = part.cell(c).v;
    worst.push_back({mesh_.number(c),
                     MinDihedral{}(part.point(v[0]), part.point(v[1]), part.point(v[2]), part.point(v[3]))});
  }
  keep_worst();
  worst = mesh_.comm().all_gather(std::span<const Numbered>(worst));
  keep_worst();
  std::vector<std::uint64_t> numbers;
  for (const Numbered& one : worst) numbers.push_back(one.number);
  return numbers;
}

/// From the first bits to the last: by the next four, of the values that begin as the one that is looked for,
/// all ranks count how many there are of each.
double Residents::smallest(std::span<const double> mine, std::size_t rank) {
  std::vector<std::uint64_t> keys(mine.size());
  par::for_each(policy_, mine.size(), [&](std::size_t i) { keys[i] = ordered_bits(mine[i]); });
  std::uint64_t found = 0, left = rank;
  for (int shift = 60; shift >= 0; shift -= 4) {
    std::array<std::uint64_t, Comm::kMostSums> counts{};
    for (std::uint64_t key : keys) ++counts[key >> shift & 15];
    mesh_.comm().sum(counts);
    std::uint64_t digit = 0;
    for (; digit < 15 && left > counts[digit]; ++digit) left -= counts[digit];
    found |= digit << shift;
    std::erase_if(keys, [&](std::uint64_t key) { return (key >> shift & 15) != digit; });
  }
  return value_of_ordered(found);
}

/// Whether the boundary lies on itself at a vertex of any rank, which has all faces of the boundary there.
/// What a part ends with elsewhere is no boundary.
bool is_folded(DistributedMesh& mesh, par::Policy policy) {
  const auto at = [&](VertexHandle v) { return mesh.is_own(v); };
  return mesh.comm().sum(folded_faces(mesh.part(), policy, at).empty() ? 0 : 1) > 0;
}

/// The run over a mesh of positive cells, without a copy to come back to. True where the smallest angle has
/// fallen below that of the input.
bool polish_valid(const Run& run, double degrees, double worst_before) {
  const auto has_fallen = [&] {
    Standing now, before;
    now.worst = run.survey().worst;
    before.worst = worst_before;
    return !is_no_worse(now, before);
  };
  polish(run, run.strategy.polish, degrees);
  if (!has_fallen()) return false;
  polish_to(run.within(run.strategy.bounds_asked), run.strategy.mending(), worst_before);
  return has_fallen();
}

/// A clock and callbacks of which any rank may have its own.
RunControl control_of(Comm& comm, const ImproveOptions& options) {
  const bool may_stop = options.cancel || options.time_limit < std::numeric_limits<double>::infinity();
  std::array<std::uint64_t, 2> n = {may_stop ? 1U : 0U, options.progress ? 1U : 0U};
  comm.sum(n);
  std::function<void(const Progress&)> progress = options.progress;
  if (n[1] > 0 && !progress) progress = [](const Progress&) {};  // what is told all have to find out together
  if (n[0] == 0) return RunControl(options.time_limit, options.cancel, std::move(progress));
  RunControl control(comm.min(options.time_limit), options.cancel, std::move(progress));
  control.agree_by([&comm](std::optional<Stop> mine) -> std::optional<Stop> {
    constexpr std::array kInOrder = {Stop::kCancelled, Stop::kTimeLimit};  // as stopped() asks
    const auto at = mine ? std::ranges::find(kInOrder, *mine) - kInOrder.begin() : std::ssize(kInOrder);
    const auto first = static_cast<std::size_t>(comm.min(static_cast<double>(at)));
    return first < kInOrder.size() ? std::optional(kInOrder[first]) : std::nullopt;
  });
  return control;
}

/// As before the first run.
void begin(DistributedMesh& mesh) {
  Workspace& work = mesh.work();
  work.begin();
  std::fill(work.changed.begin(), work.changed.end(), work.clock);
}

}  // namespace

std::string reason_against(const ImproveOptions& options) {
  if (!options.polish_only && options.metric != Metric::kVolumeLength)
    return "bulk passes in another metric than volume-length";
  const SurfaceOptions& surface = options.surface;
  if (!surface.periodic.empty()) return "periodic patches";
  if (surface.mode != SurfaceMode::kFrozen && !PartSurface::is_there())
    return "surfaces that may change in a build without OpenMesh";
  if (options.compat != Compat::kNone) return "published pipelines";
  if (options.smoother != Smoother::kNewton) return "other smoothers than newton";
  if (options.device.kind == DeviceChoice::Kind::kOpenCl) return "devices";
  if (options.maps) return "maps";
  return {};
}

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

PartsResult improve(DistributedMesh& mesh, const ImproveOptions& options,
                    std::vector<std::pair<std::uint64_t, std::uint64_t>>* renumbered) {
  validate(options);
  const std::string reason = reason_against(options);
  HFR_REQUIRE(reason.empty(), "meshes in parts do not have " + reason + " yet");
  const par::Policy policy = options.policy;
  require_sound_coordinates(mesh, policy);
  const double goal = options.min_dihedral.value_or(0);
  PartFixes fixes(mesh, options.surface);
  PartsResult result;
  result.before = result.after = survey(mesh, goal, policy);
  if (options.min_dihedral && result.before.n_below_goal == 0 && result.before.n_invalid == 0) {
    result.goal_reached = true;
    result.stop = Stop::kGoal;
    fixes.release();
    return result;
  }
  // As in shared memory: where the run goes over everything.
  std::optional<std::vector<std::uint64_t>> order;
  if (!options.min_dihedral && is_dense(mesh) && is_scattered(mesh)) {
    mesh.drop_dead_slots();
    order = mesh.renumber(numbers_along_curve(mesh));
    if (renumbered) {
      renumbered->clear();
      for (std::size_t i = 0; i < order->size(); ++i)
        renumbered->emplace_back((*order)[i], mesh.number(CellHandle(i)));
      std::ranges::sort(*renumbered);
    }
  }
  RunControl control = control_of(mesh.comm(), options);
  std::optional<WorkBalance> balance;
  if (options.min_dihedral) balance.emplace(mesh, goal, policy);
  begin(mesh);
  const Survey found{result.before.worst, static_cast<std::size_t>(result.before.n_invalid)};
  const Strategy strategy = resolve(options, found, static_cast<std::size_t>(result.before.n_cells));
  Findings findings;
  DeviceSession device;
  Residents residents(mesh, policy);
  Run run{mesh.part(), mesh.work(), strategy,        control, findings,  device,
          nullptr,     nullptr,     strategy.bounds, false,   &residents};
  std::optional<Checkpoint> checkpoint;
  const auto keep_checkpoint = [&] {
    run.checkpoint = &checkpoint.emplace(residents, policy);
    checkpoint->may_trust(strategy.course == Course::kGoal);
  };
  std::optional<PartSurfaceRun> surface;
  if (options.surface.mode != SurfaceMode::kFrozen) {
    const bool is_valid = found.n_invalid == 0;
    mesh.follow_face_labels();
    keep_checkpoint();
    if (!is_valid) run.keep(is_valid);  // before folds are spread
    std::vector<PassReport> unfolding;
    surface.emplace(mesh, options.surface, options.statistics, !is_valid, policy, unfolding,
                    [&] { return control.stopped(); });
    for (PassReport& pass : unfolding) control.add(std::move(pass));
    residents.add_surface(surface->surface());
    run.surface = surface->surface().get();
  }
  mesh.work().set_qualities(mesh.part(), MinSine2{}, policy);
  findings.is_folded = is_folded(mesh, policy);
  if (options.polish_only && !surface && found.n_invalid == 0 && !findings.is_folded &&
      mesh.work().pinched.empty()) {
    result.has_fallen = polish_valid(run, goal, result.before.worst);
  } else {
    if (!checkpoint) keep_checkpoint();
    run_to_the_end(run);
  }
  result.changed = control.n_changes() > 0;
  if (surface) {
    mesh.leave_face_labels();
    result.surface = surface->report();
  }
  if (balance) {
    balance->give_back();
    result.mine.n_borrowed = balance->n_borrowed();
  }
  if (order && !result.changed) mesh.renumber(*order);
  result.after = survey(mesh, goal, policy);
  result.goal_reached = result.after.n_below_goal == 0 && result.after.n_invalid == 0;
  result.stop = control.reason_to_end(options, result.goal_reached);
  result.passes = std::move(control.passes());
  result.seconds = control.seconds();
  result.mine.n_rounds = residents.n_rounds();
  look_at_part(mesh, result.mine);
  fixes.release();
  return result;
}

}  // namespace hfr::mpi
