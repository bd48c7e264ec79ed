// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Remesher.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "Distributed/OwnItems.hh"
#include "HalfFace/Errors.hh"
#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Strategy.hh"

namespace hfr::mpi {

/// What is known of own cells; as CellWatch, which has more triggers.
class Remesher::Watch {
 public:
  Watch(const RepairTriggers& triggers, par::Policy policy)
      : triggers_(triggers),
        policy_(policy),
        trigger_(triggers.min_dihedral > 0 ? dihedral_decision(triggers.min_dihedral)
                                           : -std::numeric_limits<double>::infinity()) {}

  /// What was excused stays so as long as it is bad, and no worse than it was left.
  void look(DistributedMesh& mesh) {
    const TetMesh& part = mesh.part();
    bad_.clear();
    double worst = std::numeric_limits<double>::infinity();
    const int n_parts = par::thread_count(policy_, part.n_cells());
    std::vector<Found> found(static_cast<std::size_t>(n_parts));
    par::parts(n_parts, [&](int p) {
      Found mine;
      for_decisions(part, MinDihedral{}, par::part_begin(part.n_cells(), n_parts, p),
                    par::part_begin(part.n_cells(), n_parts, p + 1), [&](std::size_t i, double value) {
                      const CellHandle c(i);
                      if (part.is_deleted(c) || !mesh.is_own(c)) return;
                      mine.worst = std::min(mine.worst, value);
                      if (!(value > 0) || value < trigger_) mine.bad.push_back({c, value});
                    });
      found[static_cast<std::size_t>(p)] = std::move(mine);
    });
    for (Found& one : found) {
      worst = std::min(worst, one.worst);
      bad_.insert(bad_.end(), one.bad.begin(), one.bad.end());
    }
    std::erase_if(excused_, [&](const auto& one) { return !is_still_excused(one.first, one.second); });
    std::array<std::uint64_t, 3> sums{};  // inverted; bad by an inversion, and by the angle, and not excused
    for (const Bad& one : bad_) {
      const bool is_inverted = !(one.value > 0);
      sums[0] += is_inverted ? 1 : 0;
      sums[1] += is_inverted && triggers_.inverted ? 1 : 0;
      sums[2] += one.value < trigger_ && !excused_.contains(one.cell) ? 1 : 0;
    }
    worst_ = mesh.comm().sum_and_min(sums, worst);
    n_inverted_ = sums[0];
    cause_ = sums[1] > 0 ? RepairCause::kInverted : sums[2] > 0 ? RepairCause::kAngle : RepairCause::kNone;
  }

  /// After a repair: what it had to leave. The cells have handles of their own by now.
  void excuse(DistributedMesh& mesh) {
    excused_.clear();
    look(mesh);
    if (cause_ == RepairCause::kNone) return;
    for (const Bad& one : bad_)
      if (one.value < trigger_) excused_[one.cell] = one.value;
    look(mesh);
  }

  RepairCause cause() const { return cause_; }
  std::uint64_t n_inverted() const { return n_inverted_; }
  double min_dihedral() const {
    return report_value(Metric::kMinDihedral, std::min(kRegularDihedral, worst_));
  }
  /// Own ones, by number.
  std::vector<std::uint64_t> inverted(const DistributedMesh& mesh) const {
    std::vector<std::uint64_t> numbers;
    for (const Bad& one : bad_)
      if (!(one.value > 0)) numbers.push_back(mesh.number(one.cell));
    std::sort(numbers.begin(), numbers.end());
    return numbers;
  }
  using Excuses = std::map<CellHandle, double>;
  const Excuses& excuses() const { return excused_; }
  void set_excuses(Excuses excuses) { excused_ = std::move(excuses); }

 private:
  struct Bad {
    CellHandle cell;
    double value = 0;
  };
  struct Found {
    std::vector<Bad> bad;
    double worst = std::numeric_limits<double>::infinity();
  };

  bool is_still_excused(CellHandle c, double left) const {
    const auto at = std::ranges::lower_bound(bad_, c, {}, &Bad::cell);
    return at != bad_.end() && at->cell == c && at->value < trigger_ &&
           !kStepEffort.is_much_worse(at->value, left);
  }

  const RepairTriggers& triggers_;
  par::Policy policy_;
  double trigger_;        // decision value of triggers_.min_dihedral
  std::vector<Bad> bad_;  // ascending
  Excuses excused_;       // cells below the trigger that the last repair has left, and their values then
  std::uint64_t n_inverted_ = 0;  // over all ranks
  double worst_ = 0;
  RepairCause cause_ = RepairCause::kNone;
};

std::string reason_against(const RemesherOptions& options) {
  const RepairTriggers& triggers = options.triggers;
  if (!triggers.metrics.empty()) return "triggers by metrics";
  if (triggers.jacobian_ratio > 0) return "a trigger by the volume of cells";
  if (triggers.motion > 0) return "a trigger by motion";
  if (triggers.indicator || !triggers.indicator_field.empty()) return "triggers by an indicator";
  if (options.on_inversion == OnInversion::kSubsteps) return "sub-steps";
  if (options.motion != Motion::kGiven) return "vertices that follow others";
  if (!options.fields.empty()) return "fields";
  if (options.ids) return "ids that never change";
  const SurfaceOptions& surface = options.improve.surface;
  if (!surface.fixed_vertices.empty() || !surface.fixed_edges.empty() || !surface.fixed_faces.empty() ||
      !surface.fixed_patches.empty())
    return "fixed patches, faces, edges and vertices";  // whose numbers change with a repair
  // A repair that is cut short would have to be undone.
  if (options.improve.time_limit < std::numeric_limits<double>::infinity()) return "time limits";
  if (options.improve.cancel) return "repairs that may be cancelled";
  return reason_against(options.improve);
}

Remesher::Remesher(Comm& comm, const RankArrays& arrays, RemesherOptions options)
    : comm_(comm), options_(std::move(options)) {
  validate(options_);
  const std::string reason = reason_against(options_);
  HFR_REQUIRE(reason.empty(), "a Remesher in parts does not have " + reason + " yet");
  rebuild(arrays);
  kStepEffort.bound(options_.improve, static_cast<std::size_t>(mesh_->n_cells()));
  watch_ = std::make_unique<Watch>(options_.triggers, options_.improve.policy);
  watch_->look(*mesh_);
}
Remesher::~Remesher() = default;

void Remesher::rebuild(const RankArrays& arrays) {
  std::map<std::pair<int, int>, std::string> names;
  if (mesh_) names = std::move(mesh_->part().labels().names);
  mesh_.reset();
  mesh_ = std::make_unique<DistributedMesh>(comm_);
  from_arrays(*mesh_, arrays, Keep::kIfEven);
  mesh_->part().labels().names = std::move(names);
  points_.clear();
  for (std::uint64_t number : own_arrays(*mesh_).vertex_number) points_.push_back(mesh_->vertex_at(number));
  held_by_ = mesh_->held_by_others();
}

/// Where own vertices are, to the ranks that hold them.
void Remesher::tell_points() {
  struct Moved {
    std::uint64_t number = 0;
    Vec3 point;
  };
  TetMesh& part = mesh_->part();
  std::vector<Packer> to(comm_.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    for (VertexHandle v : held_by_[r])
      if (part.point(v) != was_[v.idx()]) to[r].put(Moved{mesh_->number(v), part.point(v)});
  for (const Comm::Message& message : comm_.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) {
      const auto moved = in.get<Moved>();
      if (const VertexHandle v = mesh_->vertex_at(moved.number); v.is_valid()) part.set_point(v, moved.point);
    }
}

void Remesher::move_points(std::span<const Vec3> displacement) {
  TetMesh& part = mesh_->part();
  was_.assign(part.points().begin(), part.points().end());
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (mesh_->is_own(points_[i])) part.set_point(points_[i], part.point(points_[i]) + displacement[i]);
  tell_points();
}

void Remesher::put_points_back() {
  for (std::size_t v = 0; v < was_.size(); ++v) mesh_->part().set_point(VertexHandle(v), was_[v]);
}

PartsStep Remesher::step(std::span<const Vec3> displacement) {
  HFR_REQUIRE(displacement.size() == points_.size(),
              "displacement: has " + std::to_string(displacement.size()) + " entries for " +
                  std::to_string(points_.size()) + " points of this rank");
  PartsStep result;
  std::uint64_t n_moved = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3& d = displacement[i];
    HFR_REQUIRE(
        std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z),
        "displacement: that of vertex " + std::to_string(mesh_->number(points_[i])) + " is not finite");
    n_moved += mesh_->is_own(points_[i]) && d != Vec3{} ? 1 : 0;
  }
  result.n_moved = comm_.sum(n_moved);
  const std::vector<std::uint64_t> inverted_before = watch_->inverted(*mesh_);
  const Watch::Excuses excuses = watch_->excuses();
  if (result.n_moved > 0) {
    move_points(displacement);
    watch_->look(*mesh_);
  }
  if (options_.on_inversion == OnInversion::kRefuse) {
    const std::vector<std::uint64_t> now = watch_->inverted(*mesh_);
    const bool inverts_none = std::ranges::includes(inverted_before, now);
    if (comm_.sum(inverts_none ? 0 : 1) > 0) {
      result.refused = comm_.all_gather(std::span<const std::uint64_t>(now));
      std::ranges::sort(result.refused);
      result.fraction = 0;
      put_points_back();
      watch_->set_excuses(excuses);
      watch_->look(*mesh_);
    }
  }
  if (result.refused.empty()) {
    ++steps_;
    result.cause = watch_->cause();
    const int every = options_.triggers.every;
    if (result.cause == RepairCause::kNone && every > 0 && steps_ >= every)
      result.cause = RepairCause::kSteps;
  }
  if (result.cause != RepairCause::kNone) {
    std::vector<std::uint64_t> numbers;
    for (VertexHandle v : points_) numbers.push_back(mesh_->number(v));
    result.repair = improve(*mesh_, options_.improve);
    result.changed = result.repair->changed;
    if (result.changed) {
      rebuild(own_arrays(*mesh_));
    } else {  // but vertices may have gone to other ranks and back
      std::ranges::transform(numbers, points_.begin(), [&](std::uint64_t n) { return mesh_->vertex_at(n); });
      held_by_ = mesh_->held_by_others();
    }
    watch_->excuse(*mesh_);
    steps_ = 0;
  }
  result.min_dihedral = watch_->min_dihedral();
  result.n_inverted = watch_->n_inverted();
  return result;
}

RankArrays Remesher::arrays() { return own_arrays(*mesh_); }

}  // namespace hfr::mpi
