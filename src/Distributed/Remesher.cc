// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Remesher.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "Distributed/Order.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/PartCoordinates.hh"
#include "Distributed/PartFixes.hh"
#include "Distributed/PartTransfer.hh"
#include "Distributed/PartWatch.hh"
#include "HalfFace/Errors.hh"
#include "HalfFace/Geometry.hh"
#include "Remesh/FixedParts.hh"
#include "Remesh/MeanEdge.hh"
#include "Remesh/SafeFraction.hh"
#include "Remesh/Strategy.hh"

namespace hfr::mpi {
namespace {

std::vector<std::uint64_t> numbers_of_own(const RankArrays& arrays, int rank) {
  std::vector<std::uint64_t> numbers;
  for (std::size_t i = 0; i < arrays.points.size(); ++i)
    if (arrays.owner[i] == rank) numbers.push_back(arrays.vertex_number[i]);
  return numbers;
}

bool is_cut(Stop stop) { return stop == Stop::kTimeLimit || stop == Stop::kCancelled; }

}  // namespace

struct Remesher::Before {
  std::uint64_t n_inverted = 0;
  PartWatch::Excuses excuses;
  std::vector<double> travelled;
  double farthest = 0;
  int steps = 0;
  // From here on as the first repair has found it; the mesh has moved by then.
  std::shared_ptr<const DistributedMesh> mesh;
  std::vector<VertexHandle> points;
  std::vector<Vec3> was;
  std::vector<Field> fields;
  Kept kept;
  SurfaceOptions surface;
};

std::string reason_against(const RemesherOptions& options) {
  const RepairTriggers& triggers = options.triggers;
  if (triggers.indicator || !triggers.indicator_field.empty()) return "triggers by an indicator";
  if (options.motion != Motion::kGiven) return "vertices that follow others";
  for (const FieldTransfer& field : options.fields)
    if (field.how == Transfer::kCallback) return "fields by callback";
  return reason_against(options.improve);
}

Remesher::Remesher(Comm& comm, const RankArrays& arrays, RemesherOptions options)
    : comm_(comm), options_(std::move(options)) {
  validate(options_);
  const std::string reason = reason_against(options_);
  HFR_REQUIRE(reason.empty(), "a Remesher in parts does not have " + reason + " yet");
  for (const FieldTransfer& field : options_.fields) {
    for (const Field& other : fields_)
      HFR_REQUIRE(other.how.name != field.name,
                  "field '" + field.name + "' is named twice: in parts each name stands for one");
    fields_.push_back({field, 0, {}});
  }
  rebuild(arrays, Inverted::kTurn);
  kStepEffort.bound(options_.improve, static_cast<std::size_t>(mesh_->n_cells()));
  require_sound_coordinates(*mesh_, options_.improve.policy);
  watch_ = std::make_unique<PartWatch>(options_.triggers, options_.improve.policy);
  begin_to_keep();
  watch_->look(*mesh_);
  PartFixes(*mesh_, options_.improve.surface).release();  // are they all there?
  if (options_.triggers.motion > 0) mean_edge_ = mean_edge();
  const ImproveOptions& run = options_.improve;
  const bool mine = run.cancel || run.time_limit < std::numeric_limits<double>::infinity();
  may_be_cut_short_ = comm_.sum(mine ? 1 : 0) > 0;
}
Remesher::~Remesher() = default;

double Remesher::mean_edge() const {
  const TetMesh& part = mesh_->part();
  const std::vector<CellHandle> cells = own_cells(*mesh_);
  MeanEdge mean;
  for (CellHandle c : cells) mean.find_longest(part, c);
  const double longest = -comm_.min(-mean.longest());
  mean.begin_sum(longest);
  for (CellHandle c : cells) mean.add(part, c);
  FixedSum all(longest);
  for (const FixedSum& sum : comm_.all_gather(std::span<const FixedSum>(&mean.sum(), 1))) all.add(sum);
  return MeanEdge::of(all, static_cast<std::size_t>(mesh_->n_cells()));
}

void Remesher::rebuild(const RankArrays& arrays, Inverted inverted) {
  std::map<std::pair<int, int>, std::string> names;
  if (mesh_) names = std::move(mesh_->part().labels().names);
  mesh_.reset();
  mesh_ = std::make_unique<DistributedMesh>(comm_);
  from_arrays(*mesh_, arrays, Keep::kIfEven, inverted);
  mesh_->part().labels().names = std::move(names);
  points_.clear();
  for (std::uint64_t number : own_arrays(*mesh_).vertex_number) points_.push_back(mesh_->vertex_at(number));
  held_by_ = mesh_->held_by_others();
  travelled_.assign(options_.triggers.motion > 0 ? points_.size() : 0, 0.0);
}

/// Where own vertices that move are at that fraction of their way, and that to the ranks that hold them.
void Remesher::put_points(std::span<const Vec3> displacement, double fraction) {
  struct Moved {
    std::uint64_t number = 0;
    Vec3 point;
  };
  TetMesh& part = mesh_->part();
  std::vector<std::uint8_t> moves(part.n_vertices(), 0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const VertexHandle v = points_[i];
    if (!mesh_->is_own(v) || displacement[i] == Vec3{}) continue;
    moves[v.idx()] = 1;
    part.set_point(v, was_[v.idx()] + fraction * displacement[i]);
  }
  std::vector<Packer> to(comm_.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    for (VertexHandle v : held_by_[r])
      if (moves[v.idx()] != 0) to[r].put(Moved{mesh_->number(v), part.point(v)});
  for (const Comm::Message& message : comm_.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) {
      const auto moved = in.get<Moved>();
      if (const VertexHandle v = mesh_->vertex_at(moved.number); v.is_valid()) part.set_point(v, moved.point);
    }
}

void Remesher::put_points_back() {
  for (std::size_t v = 0; v < was_.size(); ++v) mesh_->part().set_point(VertexHandle(v), was_[v]);
}

// --- fields ---

auto Remesher::named(std::string_view name) const -> const Field& {
  const auto at = std::ranges::find_if(fields_, [&](const Field& f) { return f.how.name == name; });
  HFR_REQUIRE(at != fields_.end(), "field '" + std::string(name) + "' is not named by the options");
  return *at;
}

std::span<const double> Remesher::field(std::string_view name) const { return named(name).values; }

void Remesher::set_field(std::string_view name, std::span<const double> values, std::size_t n_components) {
  Field& field = fields_[static_cast<std::size_t>(&named(name) - fields_.data())];
  const bool of_vertices = is_of_vertices(field.how.how);
  const std::size_t n = of_vertices ? points_.size() : own_cells(*mesh_).size();
  HFR_REQUIRE(n_components > 0, "field '" + field.how.name + "' has no components");
  HFR_REQUIRE(values.size() == n * n_components,
              "field '" + field.how.name + "' has " + std::to_string(values.size()) + " values for " +
                  std::to_string(n) + (of_vertices ? " points" : " cells") + " of this rank, of " +
                  std::to_string(n_components) + " components each");
  const auto asked = static_cast<double>(n_components);
  const double least = comm_.min(asked), most = -comm_.min(-asked);
  HFR_REQUIRE(least == most, "field '" + field.how.name + "' has " + std::to_string(n_components) +
                                 " components on this rank, and another number of them elsewhere");
  field.n_components = n_components;
  field.values = std::vector<double>(values.begin(), values.end());  // which may be its own
  if (of_vertices) tell_values(field.values, n_components);
}

/// As hfr::validate_fields() has it, of a mesh with properties of these names.
void Remesher::require_fields() const {
  if (fields_.empty()) return;
  TetMesh named;
  std::vector<FieldTransfer> transfers;
  for (const Field& field : fields_) {
    HFR_REQUIRE(field.n_components > 0,
                "field '" + field.how.name + "' has no values yet: set_field() gives them");
    const std::vector<double> preset(field.n_components);
    if (is_of_vertices(field.how.how))
      named.request_vertex_property<std::vector<double>>(field.how.name, preset);
    else
      named.request_cell_property<std::vector<double>>(field.how.name, preset);
    transfers.push_back(field.how);
  }
  validate_fields(named, transfers);
}

/// Of own vertices, in the order of their numbers, of what there is of all points. `mesh`: with their
/// handles.
template <class T>
std::vector<T> Remesher::of_own_points(const DistributedMesh& mesh, const std::vector<T>& values,
                                       std::size_t width) const {
  std::vector<T> own;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (mesh.is_own(points_[i]))
      own.insert(own.end(), values.data() + width * i, values.data() + width * (i + 1));
  return own;
}

/// The way back.
template <class T>
std::vector<T> Remesher::to_points(const std::vector<T>& own, std::size_t width) {
  std::vector<T> values(width * points_.size());
  for (std::size_t i = 0, k = 0; i < points_.size(); ++i)
    if (mesh_->is_own(points_[i])) std::copy_n(own.data() + width * k++, width, values.data() + width * i);
  tell_values(values, width);
  return values;
}

/// Of own points, to the ranks that have them as well.
template <class T>
void Remesher::tell_values(std::vector<T>& values, std::size_t width) {
  const auto place = [&](VertexHandle v) { return std::ranges::lower_bound(points_, v) - points_.begin(); };
  std::vector<Packer> to(comm_.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    for (VertexHandle v : held_by_[r]) {
      to[r].put(mesh_->number(v));
      const T* const row = values.data() + width * static_cast<std::size_t>(place(v));
      for (std::size_t k = 0; k < width; ++k) to[r].put(row[k]);
    }
  for (const Comm::Message& message : comm_.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) {
      const VertexHandle v = mesh_->vertex_at(in.get<std::uint64_t>());
      const auto at = static_cast<std::size_t>(place(v));
      const bool is_here = at < points_.size() && points_[at] == v;
      for (std::size_t k = 0; k < width; ++k) {
        const auto value = in.get<T>();
        if (is_here) values[width * at + k] = value;
      }
    }
}

void Remesher::begin_to_keep() {
  const std::vector<CellHandle> cells = own_cells(*mesh_);
  if (options_.triggers.jacobian_ratio > 0)
    for (CellHandle c : cells) kept_.rest_volume.push_back(volume(mesh_->part(), c));
  watch_->set_rest_volumes(*mesh_, kept_.rest_volume);
  if (!options_.ids) return;
  for (VertexHandle v : points_) kept_.vertex_ids.push_back(mesh_->number(v));
  for (CellHandle c : cells) kept_.cell_ids.push_back(mesh_->number(c));
  next_vertex_id_ = mesh_->n_vertices();
  next_cell_id_ = mesh_->n_cells();
}

/// Over a repair; of own vertices and cells. `now`: the arrays of the mesh after it.
auto Remesher::kept_over(const DistributedMesh& old, Renumbered renumbered, const RankArrays& now) -> Kept {
  const OldPlaces from = old_places(old, *mesh_, renumbered);
  Kept kept;
  if (options_.triggers.jacobian_ratio > 0) {
    const std::vector<CellHandle> cells = own_cells(*mesh_);
    for (std::size_t i = 0; i < cells.size(); ++i)
      kept.rest_volume.push_back(from.cells[i] == OldPlaces::kCreated ? volume(mesh_->part(), cells[i])
                                                                      : kept_.rest_volume[from.cells[i]]);
  }
  if (!options_.ids) return kept;
  // What is created gets the next ones in the order of its numbers.
  const auto ids_over = [&](const std::vector<std::uint64_t>& had, const std::vector<std::size_t>& places,
                            const std::vector<std::uint64_t>& numbers, std::uint64_t& next) {
    std::vector<OrderKey> created;
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i] == OldPlaces::kCreated) created.push_back({numbers[i], 0, 0, 0});
    const std::vector<std::uint64_t> order = places_in_order(comm_, created);
    std::vector<std::uint64_t> ids;
    std::size_t k = 0;
    for (const std::size_t place : places)
      ids.push_back(place == OldPlaces::kCreated ? next + order[k++] : had[place]);
    next += comm_.sum(created.size());
    return ids;
  };
  kept.vertex_ids = ids_over(of_own_points(old, kept_.vertex_ids, 1), from.vertices,
                             numbers_of_own(now, comm_.rank()), next_vertex_id_);
  kept.cell_ids = ids_over(kept_.cell_ids, from.cells, now.cell_number, next_cell_id_);
  return kept;
}

/// Those of what a repair that is undone has created, which are not given again.
void Remesher::skip_ids(const DistributedMesh& old, Renumbered renumbered) {
  const OldPlaces from = old_places(old, *mesh_, renumbered);
  const auto n_created = [&](const std::vector<std::size_t>& places) {
    return comm_.sum(static_cast<std::uint64_t>(std::ranges::count(places, OldPlaces::kCreated)));
  };
  next_vertex_id_ += n_created(from.vertices);
  next_cell_id_ += n_created(from.cells);
}

/// Fields, and what is kept, after a repair that has changed something: over it, and to the ranks that have
/// the points and cells then. Makes the parts anew.
std::vector<FieldReport> Remesher::bring_along(std::shared_ptr<const DistributedMesh> old,
                                               Renumbered renumbered) {
  std::vector<PartField> fields;
  for (const Field& field : fields_)
    fields.push_back({field.how, field.n_components,
                      is_of_vertices(field.how.how) ? of_own_points(*old, field.values, field.n_components)
                                                    : field.values});
  std::vector<FieldReport> reports;
  if (!fields.empty()) reports = transfer_in_parts(*old, *mesh_, renumbered, fields, options_.improve.policy);
  const RankArrays arrays = renamed_arrays();
  Kept kept;
  if (keeps_values()) kept = kept_over(*old, renumbered, arrays);
  old.reset();
  const std::vector<std::uint64_t> vertices_had = numbers_of_own(arrays, comm_.rank());
  rebuild(arrays, Inverted::kLeave);
  std::vector<std::uint64_t> vertices_wanted, cells_wanted;
  for (VertexHandle v : points_)
    if (mesh_->is_own(v)) vertices_wanted.push_back(mesh_->number(v));
  for (CellHandle c : own_cells(*mesh_)) cells_wanted.push_back(mesh_->number(c));
  const auto of_vertices = [&]<class T>(const std::vector<T>& own, std::size_t width) {
    return to_points(rows_where_wanted(comm_, mesh_->n_vertices(), vertices_had, std::span<const T>(own),
                                       width, vertices_wanted),
                     width);
  };
  const auto of_cells = [&]<class T>(const std::vector<T>& own, std::size_t width) {
    return rows_where_wanted(comm_, mesh_->n_cells(), arrays.cell_number, std::span<const T>(own), width,
                             cells_wanted);
  };
  for (std::size_t f = 0; f < fields.size(); ++f)
    fields_[f].values = is_of_vertices(fields[f].how.how)
                            ? of_vertices(fields[f].values, fields[f].n_components)
                            : of_cells(fields[f].values, fields[f].n_components);
  if (options_.triggers.jacobian_ratio > 0) kept_.rest_volume = of_cells(kept.rest_volume, 1);
  if (options_.ids) {
    kept_.vertex_ids = of_vertices(kept.vertex_ids, 1);
    kept_.cell_ids = of_cells(kept.cell_ids, 1);
  }
  return reports;
}

/// The arrays of the mesh after a repair; what is fixed has their numbers from here on.
RankArrays Remesher::renamed_arrays() {
  const Numbering numbering(*mesh_);
  for_each_fixed(options_.improve.surface,
                 [&](VertexHandle& v) { v = VertexHandle(numbering.of_vertex(v.idx())); });
  return own_arrays(*mesh_);
}

// --- a step ---

RepairCause Remesher::needs_repair() const {
  if (watch_->cause() != RepairCause::kNone) return watch_->cause();
  if (options_.triggers.motion > 0 && farthest_ > options_.triggers.motion * mean_edge_)
    return RepairCause::kMotion;
  const int every = options_.triggers.every;
  return every > 0 && steps_ >= every ? RepairCause::kSteps : RepairCause::kNone;
}

/// False where the run was cut short; then the step may be undone. `is_last`: of the step.
bool Remesher::repair(PartsStep& result, bool is_last) {
  if (result.repairs.empty()) result.cause = needs_repair();
  PartsRepair& repair = result.repairs.emplace_back();
  std::vector<std::uint64_t> numbers;
  for (VertexHandle v : points_) numbers.push_back(mesh_->number(v));
  const bool brings_along = !fields_.empty() || keeps_values();
  const bool is_first = before_ && !before_->mesh;
  std::shared_ptr<const DistributedMesh> old;
  if (brings_along || is_first) old = mesh_->copy();
  if (is_first) {
    before_->mesh = old;
    before_->points = points_;
    before_->was = std::move(was_);
    before_->fields.assign(fields_.begin(), fields_.begin() + std::ssize(options_.fields));
    before_->kept = kept_;
    before_->surface = options_.improve.surface;
  }
  if (!brings_along) old.reset();
  std::vector<std::pair<std::uint64_t, std::uint64_t>> renumbered;
  repair.run = improve(*mesh_, options_.improve, &renumbered);
  result.stop = repair.run.stop;
  const bool is_cut_short = is_cut(result.stop);
  if (is_cut_short && PartWatch::count_inverted(*mesh_) > before_->n_inverted) {
    if (options_.ids) skip_ids(*old, renumbered);
    undo(result);
    return false;
  }
  if (is_cut_short || is_last) before_.reset();
  if (repair.run.changed && brings_along) {
    repair.fields = bring_along(std::move(old), renumbered);
  } else if (repair.run.changed) {
    rebuild(renamed_arrays(), Inverted::kLeave);
  } else {  // but vertices may have gone to other ranks and back
    std::ranges::transform(numbers, points_.begin(), [&](std::uint64_t n) { return mesh_->vertex_at(n); });
    held_by_ = mesh_->held_by_others();
  }
  result.changed = result.changed || repair.run.changed;
  watch_->set_rest_volumes(*mesh_, kept_.rest_volume);
  watch_->follow(*mesh_, is_cut_short);
  std::ranges::fill(travelled_, 0.0);
  farthest_ = 0;
  steps_ = 0;
  return !is_cut_short;
}

/// All is as it was before the step, but for ids, of which those that were given are not given again.
void Remesher::undo(PartsStep& result) {
  Before before = std::move(*before_);
  before_.reset();
  mesh_->put_back(*before.mesh);
  points_ = std::move(before.points);
  held_by_ = mesh_->held_by_others();
  was_ = std::move(before.was);
  put_points_back();
  fields_ = std::move(before.fields);
  kept_ = std::move(before.kept);
  options_.improve.surface = std::move(before.surface);
  travelled_ = std::move(before.travelled);
  farthest_ = before.farthest;
  steps_ = before.steps;
  watch_->set_rest_volumes(*mesh_, kept_.rest_volume);
  watch_->set_excuses(std::move(before.excuses));
  watch_->look(*mesh_);
  result.undone = true;
  result.changed = false;
  result.fraction = 0;
  result.repairs.clear();
}

/// As hfr::Remesher takes it.
auto Remesher::take(std::span<const Vec3> displacement, OnInversion on_inversion) -> Move {
  std::uint64_t n_moved = 0;
  for (std::size_t i = 0; i < points_.size(); ++i)
    n_moved += mesh_->is_own(points_[i]) && displacement[i] != Vec3{} ? 1 : 0;
  if (comm_.sum(n_moved) == 0) return {};
  const std::vector<std::uint64_t> inverted_before = watch_->inverted(*mesh_);
  // Cells of one move may come right and others go wrong, so that their number says nothing.
  const auto inverts_none = [&] {
    const std::vector<std::uint64_t> now = watch_->inverted(*mesh_);
    return comm_.sum(std::ranges::includes(inverted_before, now) ? 0 : 1) == 0;
  };
  const PartWatch::Excuses excuses = watch_->excuses();
  const auto put_at = [&](double fraction) {
    put_points(displacement, fraction);
    watch_->look(*mesh_);
  };
  was_.assign(mesh_->part().points().begin(), mesh_->part().points().end());
  put_at(1);
  if (on_inversion == OnInversion::kRepair || inverts_none()) {
    note_motion(displacement, 1);
    return {};
  }
  if (on_inversion == OnInversion::kRefuse) {
    const std::vector<std::uint64_t> mine = watch_->inverted(*mesh_);
    Move move{0, comm_.all_gather(std::span<const std::uint64_t>(mine))};
    std::ranges::sort(move.refused);
    put_points_back();
    watch_->set_excuses(excuses);
    watch_->look(*mesh_);
    return move;
  }
  const double safe = put_at_safe_fraction(kStepEffort.halvings, put_at, inverts_none);
  note_motion(displacement, safe);
  return {safe, {}};
}

void Remesher::note_motion(std::span<const Vec3> displacement, double fraction) {
  if (options_.triggers.motion <= 0) return;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!mesh_->is_own(points_[i]) || displacement[i] == Vec3{}) continue;
    travelled_[i] += fraction * norm(displacement[i]);
    farthest_ = std::max(farthest_, travelled_[i]);
  }
  farthest_ = -comm_.min(-farthest_);
}

/// As hfr::Remesher has it: what is left of a displacement gets over a repair as a field does.
void Remesher::run_step(std::span<const Vec3> displacement, PartsStep& result) {
  std::vector<Vec3> rest;  // of the displacement, once a part of it was taken
  double taken = 0;
  for (int i = 0; taken < 1; ++i) {
    const std::span<const Vec3> whole = i == 0 ? displacement : std::span<const Vec3>(rest);
    const bool as_a_whole = options_.on_inversion == OnInversion::kSubsteps && i >= options_.max_substeps;
    Move move = take(whole, as_a_whole ? OnInversion::kRepair : options_.on_inversion);
    result.refused = std::move(move.refused);
    result.fraction = taken += (1 - taken) * move.fraction;
    if (!result.refused.empty()) return;
    if (move.fraction == 1) break;
    Field left{{.name = "hfr: rest of the displacement", .how = Transfer::kLinear}, 3, {}};
    for (const Vec3& d : whole) {
      const Vec3 one = (1 - move.fraction) * d;
      left.values.insert(left.values.end(), {one.x, one.y, one.z});
    }
    fields_.push_back(std::move(left));
    const bool finished = repair(result, false);
    // The part that was taken inverts nothing; what is left of it would.
    if (result.cause == RepairCause::kNone) result.cause = RepairCause::kInverted;
    if (result.undone) return;
    const std::vector<double> values = std::move(fields_.back().values);
    fields_.pop_back();
    std::vector<FieldReport>& reports = result.repairs.back().fields;
    const bool has_changed = !reports.empty();  // in the end; there was a field at least
    if (has_changed) reports.pop_back();
    rest.clear();
    for (std::size_t k = 0; k < values.size(); k += 3)
      rest.push_back({values[k], values[k + 1], values[k + 2]});
    if (!finished) return;
    if (move.fraction == 0 && !has_changed) i = options_.max_substeps - 1;
  }
  ++steps_;
  if (needs_repair() != RepairCause::kNone) repair(result, true);
}

PartsStep Remesher::step(std::span<const Vec3> displacement) {
  HFR_REQUIRE(displacement.size() == points_.size(),
              "displacement: has " + std::to_string(displacement.size()) + " entries for " +
                  std::to_string(points_.size()) + " points of this rank");
  require_fields();
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
  was_.clear();
  if (may_be_cut_short_) {
    before_ = std::make_unique<Before>();
    before_->n_inverted = watch_->n_inverted();
    before_->excuses = watch_->excuses();
    before_->travelled = travelled_;
    before_->farthest = farthest_;
    before_->steps = steps_;
  }
  run_step(displacement, result);
  before_.reset();
  result.min_dihedral = watch_->min_dihedral();
  result.n_inverted = watch_->n_inverted();
  return result;
}

RankArrays Remesher::arrays() { return own_arrays(*mesh_); }

}  // namespace hfr::mpi
