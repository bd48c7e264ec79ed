// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Remesher.hh"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>

#include "HalfFace/Errors.hh"
#include "HalfFace/Geometry.hh"
#include "Quality/Coverage.hh"
#include "Quality/FoldedFaces.hh"
#include "Remesh/CellWatch.hh"
#include "Remesh/Coordinates.hh"
#include "Remesh/FixedParts.hh"
#include "Remesh/Improve.hh"
#include "Remesh/MeanEdge.hh"
#include "Remesh/MeshMotion.hh"
#include "Remesh/MovedVertices.hh"
#include "Remesh/RunMemory.hh"
#include "Remesh/SafeFraction.hh"
#include "Remesh/Strategy.hh"

namespace hfr {
namespace {

/// The property by which what is left of a displacement gets over a repair.
constexpr const char* kRest = "hfr: rest of the displacement";

double mean_edge(const TetMesh& mesh) {
  MeanEdge mean;
  for (CellHandle c : mesh.cells()) mean.find_longest(mesh, c);
  mean.begin_sum(mean.longest());
  for (CellHandle c : mesh.cells()) mean.add(mesh, c);
  return MeanEdge::of(mean.sum(), mean.n_cells());
}

}  // namespace

void validate(const RemesherOptions& options) {
  hfr::validate(options.improve);
  const RepairTriggers& triggers = options.triggers;
  const auto at_least_0 = [](double value, const char* name) {
    HFR_REQUIRE(value >= 0 && std::isfinite(value), std::string("trigger ") + name + ": must be 0 or more");
  };
  at_least_0(triggers.min_dihedral, "min_dihedral");
  at_least_0(triggers.jacobian_ratio, "jacobian_ratio");
  at_least_0(triggers.motion, "motion");
  HFR_REQUIRE(triggers.min_dihedral < kLargestGoal, "trigger min_dihedral: must be less than 70.5 degrees");
  HFR_REQUIRE(triggers.jacobian_ratio <= 1, "trigger jacobian_ratio: must be at most 1");
  HFR_REQUIRE(triggers.every >= 0, "trigger every: must be 0 or more");
  HFR_REQUIRE(options.max_substeps >= 1, "max_substeps: must be 1 or more");
  for (const auto& [metric, value] : triggers.metrics)
    HFR_REQUIRE(std::isfinite(value), "trigger of " + std::string(metric_name(metric)) + ": must be finite");
  if (options.improve.min_dihedral)
    HFR_REQUIRE(triggers.min_dihedral <= *options.improve.min_dihedral,
                "trigger min_dihedral: must not be above the goal, or every step would repair");
}

class Remesher::State {
 public:
  State(TetMesh& mesh, RemesherOptions options)
      : mesh_(mesh),
        options_(std::move(options)),
        policy_(options_.improve.policy),
        watch_(mesh, options_.triggers, policy_) {
    validate(options_);
    validate_fields(mesh, options_.fields);
    wants_parents_ = options_.parents ||
                     std::any_of(options_.fields.begin(), options_.fields.end(),
                                 [](const FieldTransfer& field) { return field.how == Transfer::kInherit; });
    options_.improve.maps = true;
    options_.improve.statistics = false;
    kStepEffort.bound(options_.improve, mesh.n_logical_cells());
    reset();
    prepare();
  }

  void reset();
  void require_displacement(std::span<const Vec3> displacement);
  StepResult step(std::span<const Vec3> displacement);
  MoveResult move(std::span<const Vec3> displacement);
  RepairCause needs_repair() const;
  RepairResult repair();
  std::vector<FieldReport> transfer();

  const CellWatch& watch() const { return watch_; }
  std::span<const std::uint64_t> vertex_ids() const { return vertex_ids_; }
  std::span<const std::uint64_t> cell_ids() const { return cell_ids_; }

 private:
  /// All that a step may have to take back, but for the points that its first move has changed.
  struct Before {
    std::shared_ptr<TetMesh> mesh;
    MovedVertices moved;
    CellWatch::Memory cells;
    std::vector<double> travelled, travelled_before;
    std::vector<std::uint64_t> vertex_ids, cell_ids;
    SurfaceOptions surface;
  };

  void prepare();
  void forget_mesh();
  void forget_coverage();
  std::span<const Vec3> followed(std::span<const Vec3> displacement);
  void remember_mesh();
  std::size_t look_at_moved();
  std::vector<CellHandle> inverted_now() const;
  void move_points(std::span<const Vec3> displacement);
  void put_points_back();
  MoveResult take(std::span<const Vec3> displacement, OnInversion on_inversion);
  void note_motion(std::span<const Vec3> displacement, double fraction);

  void copy_mesh();
  void take_back(std::shared_ptr<TetMesh> mesh);
  RepairResult repair_mesh();
  void follow_edits(const Edits& edits, bool was_cut_short);
  Before before_now() const;
  bool repair_in_step(std::span<const FieldTransfer> fields, StepResult& result);
  void run_step(std::span<const Vec3> displacement, StepResult& result);
  void undo();

  TetMesh& mesh_;
  RemesherOptions options_;
  par::Policy policy_;

  CellWatch watch_;
  std::vector<double> travelled_;  // by vertex, where asked for
  std::vector<std::uint64_t> vertex_ids_, cell_ids_;
  std::uint64_t next_vertex_id_ = 0, next_cell_id_ = 0;
  bool wants_parents_ = false;
  double mean_edge_ = 0;
  double farthest_ = 0;  // of travelled_
  int steps_ = 0;        // since the last repair

  // Of the move that was done last; kept for their memory.
  MovedVertices moved_;
  std::vector<double> travelled_before_;  // of moved_, where asked for
  std::vector<std::uint8_t> known_;
  std::vector<Vec3> follow_;

  RunMemory memory_;                                 // of repairs
  std::optional<CellWatch::Memory> excuses_before_;  // of the step, where there were any
  std::shared_ptr<TetMesh> before_;                  // the mesh before the last repair
  std::shared_ptr<TetMesh> spare_;                   // where edits keep, or have kept, such a copy
  std::optional<Edits> pending_;                     // of the last repair, whose fields wait
  std::optional<Before> undo_;                       // of the step in progress, once it has repaired
  bool has_moved_ = false;                           // points, in the step in progress
  int steps_before_ = 0;                             // steps_ before the step in progress
  bool is_stale_ = false;  // the cells could not be looked at after a step was taken back
};

void Remesher::State::reset() {
  pending_.reset();
  if (mesh_.needs_garbage_collection())
    rename_fixed(options_.improve.surface, mesh_.collect_garbage().vertices);
  require_sound_coordinates(mesh_, policy_);
  require_fixed_parts(mesh_, options_.improve.surface);
  steps_ = 0;
  if (options_.triggers.motion > 0) {
    travelled_.assign(mesh_.n_vertices(), 0.0);
    mean_edge_ = mean_edge(mesh_);
  }
  farthest_ = 0;
  if (options_.ids) {
    const auto number = [](std::vector<std::uint64_t>& ids, std::size_t size, std::uint64_t& next) {
      ids.resize(size);
      for (std::uint64_t& id : ids) id = next++;
    };
    number(vertex_ids_, mesh_.n_vertices(), next_vertex_id_);
    number(cell_ids_, mesh_.n_cells(), next_cell_id_);
  }
  is_stale_ = false;
  forget_mesh();
  watch_.reset();
}

/// What the first repair would else have to allocate and to find out.
void Remesher::State::prepare() {
  constexpr std::size_t kRoom = 16;  // cells for each that a repair may add
  mesh_.reserve_cells(mesh_.n_cells() + mesh_.n_cells() / kRoom);
  before_ = std::make_shared<TetMesh>(mesh_);
  remember_mesh();
  memory_.is_folded = !folded_faces(mesh_, policy_).empty();
  memory_.covers_once = !*memory_.is_folded && !covers_twice(mesh_, policy_);
}

void Remesher::State::remember_mesh() {
  memory_.work.attach(mesh_, policy_);
  memory_.knows_stars = true;
}

/// The mesh is another one than repairs remember.
void Remesher::State::forget_mesh() {
  memory_.knows_stars = false;
  forget_coverage();
}

/// Whether the boundary lies on itself, or cells over one another.
void Remesher::State::forget_coverage() {
  memory_.is_folded.reset();
  memory_.covers_once = false;
}

RepairCause Remesher::State::needs_repair() const {
  if (watch_.cause() != RepairCause::kNone) return watch_.cause();
  const RepairTriggers& triggers = options_.triggers;
  if (triggers.motion > 0 && farthest_ > triggers.motion * mean_edge_) return RepairCause::kMotion;
  if (triggers.every > 0 && steps_ >= triggers.every) return RepairCause::kSteps;
  return RepairCause::kNone;
}

// --- moving ---

void Remesher::State::require_displacement(std::span<const Vec3> displacement) {
  if (is_stale_) watch_.look_at_all();
  is_stale_ = false;
  HFR_REQUIRE(displacement.size() == mesh_.n_vertices(),
              "displacement: has " + std::to_string(displacement.size()) + " entries for " +
                  std::to_string(mesh_.n_vertices()) + " vertices");
  const std::size_t first = moved_.find(displacement, policy_);
  HFR_REQUIRE(first == displacement.size(),
              "displacement: that of vertex " + std::to_string(first) + " is not finite");
}

/// The displacement of all vertices, which moved_ knows: as it is given, or with inner ones made to follow.
std::span<const Vec3> Remesher::State::followed(std::span<const Vec3> displacement) {
  if (options_.motion == Motion::kGiven) return displacement;
  known_.assign(mesh_.n_vertices(), 0);
  for (HalfFaceHandle h : mesh_.boundary_halffaces())
    for (VertexHandle v : mesh_.halfface_vertices(h)) known_[v.idx()] = 1;
  for (VertexHandle v : mesh_.vertices())
    if (mesh_.is_fixed(v)) known_[v.idx()] = 1;
  for_each_fixed(options_.improve.surface, [&](VertexHandle v) { known_[v.idx()] = 1; });
  follow_.assign(displacement.begin(), displacement.end());
  follow(mesh_, known_, options_.motion == Motion::kElastic, follow_);
  const std::size_t first = moved_.find(follow_, policy_);
  HFR_REQUIRE(first == follow_.size(), "motion: that of vertex " + std::to_string(first) +
                                           " could not be solved for: cells are too nearly flat; move it "
                                           "by hand (motion given)");
  return follow_;
}

void Remesher::State::move_points(std::span<const Vec3> displacement) {
  travelled_before_.clear();
  const auto is_frozen = [&](VertexHandle v) { return !memory_.knows_stars || memory_.work.frozen[v.idx()]; };
  if ((memory_.is_folded || memory_.covers_once) && moved_.find_if(is_frozen)) forget_coverage();
  if (!travelled_.empty())
    moved_.find_if([&](VertexHandle v) {
      travelled_before_.push_back(travelled_[v.idx()]);
      return false;
    });
  moved_.move(mesh_, displacement, policy_);
  has_moved_ = true;
}

void Remesher::State::put_points_back() {
  moved_.put_back(mesh_, policy_);
  if (travelled_.empty()) return;
  moved_.find_if([&, i = std::size_t{0}](VertexHandle v) mutable {
    travelled_[v.idx()] = travelled_before_[i++];
    return false;
  });
}

std::size_t Remesher::State::look_at_moved() {
  if (moved_.are_many()) return watch_.look_at_all();
  if (!memory_.knows_stars) remember_mesh();
  const std::vector<std::uint8_t>& pinched = memory_.work.pinched;
  // A walk round such a vertex does not come to all its cells.
  if (!pinched.empty() && moved_.find_if([&](VertexHandle v) { return pinched[v.idx()] != 0; }))
    return watch_.look_at_all();
  return watch_.look_at_cells_of(moved_);
}

/// Ascending; nobody looks for them where there are none.
std::vector<CellHandle> Remesher::State::inverted_now() const {
  return watch_.n_inverted() > 0 ? watch_.inverted() : std::vector<CellHandle>();
}

/// Of the displacement that moved_ knows.
MoveResult Remesher::State::take(std::span<const Vec3> displacement, OnInversion on_inversion) {
  MoveResult result;
  result.n_moved = moved_.size();
  if (moved_.size() == 0) return result;
  const std::vector<CellHandle> inverted_before = inverted_now();
  // Cells of one move may come right and others go wrong, so that their number says nothing.
  const auto inverts_none = [&] {
    const std::vector<CellHandle> now = inverted_now();
    return std::includes(inverted_before.begin(), inverted_before.end(), now.begin(), now.end());
  };
  std::optional<CellWatch::Memory> excuses;
  if (on_inversion == OnInversion::kRefuse && watch_.has_excuses()) excuses = watch_.memory();
  move_points(displacement);
  result.n_looked_at = look_at_moved();
  if (on_inversion == OnInversion::kRepair || inverts_none()) {
    note_motion(displacement, 1);
    return result;
  }
  if (on_inversion == OnInversion::kRefuse) {
    result.refused = watch_.inverted();
    put_points_back();
    if (excuses) {
      watch_.restore(std::move(*excuses));
      watch_.look_at_all();
    } else {
      look_at_moved();
    }
    result.fraction = 0;
    return result;
  }
  const auto put_at = [&](double fraction) {
    moved_.put(mesh_, displacement, fraction, policy_);
    look_at_moved();
  };
  const double safe = put_at_safe_fraction(kStepEffort.halvings, put_at, inverts_none);
  result.fraction = safe;
  note_motion(displacement, safe);
  return result;
}

void Remesher::State::note_motion(std::span<const Vec3> displacement, double fraction) {
  if (travelled_.empty()) return;
  moved_.find_if([&](VertexHandle v) {
    travelled_[v.idx()] += fraction * norm(displacement[v.idx()]);
    farthest_ = std::max(farthest_, travelled_[v.idx()]);
    return false;
  });
}

MoveResult Remesher::State::move(std::span<const Vec3> displacement) {
  require_displacement(displacement);
  transfer();
  const MoveResult result = take(followed(displacement), options_.on_inversion);
  if (result.refused.empty()) ++steps_;
  return result;
}

// --- repairing ---

/// Into before_. Edits whose parents may still be asked for keep the copy that was there; another one, whose
/// edits are gone, serves again.
void Remesher::State::copy_mesh() {
  if (before_ && before_.use_count() > 1) std::swap(before_, spare_);
  if (before_ && before_.use_count() == 1) {
    std::atomic_thread_fence(std::memory_order_acquire);  // edits may have gone in another thread
    *before_ = mesh_;
  } else {
    before_ = std::make_shared<TetMesh>(mesh_);
  }
}

/// The mesh is that one again: without a copy, which there may be no memory for, unless somebody else has it.
void Remesher::State::take_back(std::shared_ptr<TetMesh> mesh) {
  if (mesh.use_count() == 1) {
    std::atomic_thread_fence(std::memory_order_acquire);
    mesh_.restore(std::move(*mesh));
  } else {
    mesh_.restore(*mesh);
  }
}

/// Leaves the mesh as it was where it throws; what is kept for its cells and vertices is for undo().
RepairResult Remesher::State::repair_mesh() {
  copy_mesh();
  memory_.before = before_.get();
  memory_.found = watch_.survey();
  try {
    Result run = improve(mesh_, options_.improve, memory_);
    RepairResult result;
    result.stop = run.stop;
    result.goal_reached = run.goal_reached;
    result.edits = wants_parents_ ? make_edits(before_, mesh_, std::move(run.maps), policy_)
                                  : make_edits(*before_, mesh_, std::move(run.maps), policy_);
    follow_edits(result.edits, run.stop == Stop::kTimeLimit || run.stop == Stop::kCancelled);
    return result;
  } catch (...) {
    forget_mesh();
    take_back(std::move(before_));
    throw;
  }
}

/// Brings what is kept for each cell and vertex over a repair.
void Remesher::State::follow_edits(const Edits& edits, bool was_cut_short) {
  const MeshMaps& maps = edits.maps;
  if (!travelled_.empty()) travelled_.assign(mesh_.n_vertices(), 0.0);
  farthest_ = 0;
  steps_ = 0;
  rename_fixed(options_.improve.surface, maps.vertices);
  carry(cell_ids_, maps.old_cells, std::uint64_t{0});
  carry(vertex_ids_, maps.old_vertices, std::uint64_t{0});
  if (options_.ids) {
    for (const CreatedCell& c : edits.created_cells) cell_ids_[c.cell.idx()] = next_cell_id_++;
    for (const PlacedVertex& v : edits.created_vertices) vertex_ids_[v.vertex.idx()] = next_vertex_id_++;
  }
  watch_.follow(edits, was_cut_short);
}

RepairResult Remesher::State::repair() {
  transfer();
  has_moved_ = false;
  steps_before_ = steps_;
  undo_ = before_now();
  try {
    RepairResult result = repair_mesh();
    undo_.reset();
    pending_ = result.edits;
    return result;
  } catch (...) {
    undo();
    throw;
  }
}

std::vector<FieldReport> Remesher::State::transfer() {
  if (!pending_) return {};
  std::vector<FieldReport> reports = transfer_fields(*before_, mesh_, *pending_, options_.fields, policy_);
  pending_.reset();  // not where one was thrown: it is done again then, from the old mesh
  return reports;
}

// --- a step ---

/// But for the mesh, which the first repair copies.
Remesher::State::Before Remesher::State::before_now() const {
  return {.mesh = nullptr,
          .moved = moved_,
          .cells = watch_.memory(),
          .travelled = travelled_,
          .travelled_before = travelled_before_,
          .vertex_ids = vertex_ids_,
          .cell_ids = cell_ids_,
          .surface = options_.improve.surface};
}

/// Repairs, and carries `fields` over. False where the run was cut short.
bool Remesher::State::repair_in_step(std::span<const FieldTransfer> fields, StepResult& result) {
  if (result.repairs.empty()) result.cause = needs_repair();
  if (!undo_) undo_ = before_now();
  RepairResult repair = repair_mesh();
  if (!undo_->mesh) undo_->mesh = before_;
  if (!repair.edits.empty()) {
    result.changed = true;
    repair.fields = transfer_fields(*before_, mesh_, repair.edits, fields, policy_);
    repair.fields.resize(options_.fields.size());  // without that of what is left of the displacement
  }
  result.stop = repair.stop;
  result.repairs.push_back(std::move(repair));
  return result.stop != Stop::kTimeLimit && result.stop != Stop::kCancelled;
}

void Remesher::State::run_step(std::span<const Vec3> displacement, StepResult& result) {
  std::vector<Vec3> rest;  // of the displacement, once a part of it was taken
  double taken = 0;
  for (int i = 0; taken < 1; ++i) {
    const bool as_a_whole = options_.on_inversion == OnInversion::kSubsteps && i >= options_.max_substeps;
    const MoveResult move =
        take(i == 0 ? displacement : rest, as_a_whole ? OnInversion::kRepair : options_.on_inversion);
    result.n_looked_at += move.n_looked_at;
    result.refused = move.refused;
    result.fraction = taken += (1 - taken) * move.fraction;
    if (!move.refused.empty()) return;
    if (move.fraction == 1) break;
    auto left = mesh_.request_vertex_property<Vec3>(kRest);
    for (std::size_t v = 0; v < mesh_.n_vertices(); ++v)
      left[VertexHandle(v)] = (1 - move.fraction) * (i == 0 ? displacement[v] : rest[v]);
    std::vector<FieldTransfer> fields = options_.fields;
    fields.push_back({.name = kRest, .how = Transfer::kLinear});
    const bool finished = repair_in_step(fields, result);
    // The part that was taken inverts nothing; what is left of it would.
    if (result.cause == RepairCause::kNone) result.cause = RepairCause::kInverted;
    rest.assign(left.values().begin(), left.values().end());
    mesh_.properties().vertices.remove(kRest);
    if (!finished) return;
    moved_.find(rest, policy_);
    if (move.fraction == 0 && result.repairs.back().edits.empty()) i = options_.max_substeps - 1;
  }
  ++steps_;
  if (needs_repair() != RepairCause::kNone) repair_in_step(options_.fields, result);
}

void Remesher::State::undo() {
  if (undo_ && undo_->mesh) {
    forget_mesh();
    if (before_ == undo_->mesh) before_.reset();
    take_back(std::move(undo_->mesh));
  }
  if (undo_) {
    mesh_.properties().vertices.remove(kRest);
    moved_ = std::move(undo_->moved);
    watch_.restore(std::move(undo_->cells));
    travelled_ = std::move(undo_->travelled);
    travelled_before_ = std::move(undo_->travelled_before);
    vertex_ids_ = std::move(undo_->vertex_ids);
    cell_ids_ = std::move(undo_->cell_ids);
    options_.improve.surface = std::move(undo_->surface);
  }
  if (has_moved_) {
    forget_coverage();
    put_points_back();
  }
  steps_ = steps_before_;
  farthest_ = travelled_.empty() ? 0.0 : *std::max_element(travelled_.begin(), travelled_.end());
  undo_.reset();
  has_moved_ = false;
  is_stale_ = true;
  // The move before the repair has taken excuses away by then.
  if (excuses_before_) watch_.restore(std::move(*excuses_before_));
  excuses_before_.reset();
  watch_.look_at_all();
  is_stale_ = false;
}

StepResult Remesher::State::step(std::span<const Vec3> displacement) {
  require_displacement(displacement);
  transfer();
  undo_.reset();
  has_moved_ = false;
  steps_before_ = steps_;
  const std::size_t inverted_before = watch_.n_inverted();
  excuses_before_.reset();
  if (watch_.has_excuses()) excuses_before_ = watch_.memory();
  StepResult result;
  try {
    run_step(followed(displacement), result);
  } catch (...) {
    result.repairs.clear();  // whose edits hold the mesh as it was
    undo();
    throw;
  }
  const bool cut_short = result.stop == Stop::kTimeLimit || result.stop == Stop::kCancelled;
  if (cut_short && watch_.n_inverted() > inverted_before) {
    undo();
    result.undone = true;
    result.changed = false;
    result.fraction = 0;
    result.repairs.clear();
  }
  undo_.reset();
  result.n_inverted = watch_.n_inverted();
  result.min_dihedral = watch_.min_dihedral();
  return result;
}

// --- the class ---

Remesher::Remesher(TetMesh& mesh, RemesherOptions options)
    : mesh_(mesh), state_(std::make_unique<State>(mesh, std::move(options))) {}
Remesher::~Remesher() = default;
StepResult Remesher::step(std::span<const Vec3> displacement) { return state_->step(displacement); }
MoveResult Remesher::move(std::span<const Vec3> displacement) { return state_->move(displacement); }
RepairCause Remesher::needs_repair() const { return state_->needs_repair(); }
RepairResult Remesher::repair() { return state_->repair(); }
std::vector<FieldReport> Remesher::transfer() { return state_->transfer(); }
void Remesher::reset() { state_->reset(); }
double Remesher::min_dihedral() const { return state_->watch().min_dihedral(); }
std::size_t Remesher::n_inverted() const { return state_->watch().n_inverted(); }
std::span<const std::uint64_t> Remesher::vertex_ids() const { return state_->vertex_ids(); }
std::span<const std::uint64_t> Remesher::cell_ids() const { return state_->cell_ids(); }

}  // namespace hfr
