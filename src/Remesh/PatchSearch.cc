// SPDX-License-Identifier: BSD-3-Clause
// Insertion "followed by smoothing and topological improvement", kept or rolled back as one step (Klingner &
// Shewchuk 2007): here on a copy of the surroundings of each of the last few cells, and removal likewise.
#include "Remesh/PatchSearch.hh"

#include <algorithm>
#include <array>
#include <deque>
#include <limits>
#include <optional>
#include <span>

#include "Operators/Metrics.hh"
#include "Operators/Needle.hh"
#include "Operators/Replace.hh"
#include "Operators/VertexCollapse.hh"
#include "Operators/VertexInsertion.hh"
#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"
#include "Quality/Metrics.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Patch.hh"
#include "Remesh/PatchPlace.hh"
#include "Remesh/Polish.hh"
#include "Remesh/SurfaceRun.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

constexpr double kTryNanoseconds = 1e6;
/// Gain of a new vertex that may leave cells as poor as it likes, but valid: the polish of the try mends
/// them.
constexpr double kAnyLoss = 0;

struct Outcome {
  std::optional<TetMesh> mesh;
  bool held_back = false;  // see PatchVerdict
  bool is_folded = false;  // see Findings
};

/// Cells that a patch may come to have.
struct Room {
  std::size_t least, most;

  bool holds(const TetMesh& changed) const {
    return changed.n_logical_cells() >= least && changed.n_logical_cells() <= most;
  }
};

/// `n_cells`: of the whole.
Room room_of(const Patch& patch, std::size_t n_cells, const CellBounds& bounds) {
  const std::size_t others = n_cells - patch.cells().size();
  const auto above_others = [&](std::size_t n) { return std::max(n, others) - others; };
  return {above_others(bounds.min), bounds.max > 0 ? above_others(bounds.max) : kNoLimit};
}

/// What a try begins with on a copy of a patch, even at a loss.
struct Try {
  enum Kind {
    kNothing,  // improved as it is
    kRow,      // an apex over each needle; number: of PatchTrial::row_shares
    kVertex,   // a new vertex for the first cell; number: of the place, counted by promise
    kRemoval,  // one vertex less; number: of the vertex, which are in the order of discovery from that cell
    kOther,    // one vertex less, and a new one for what is the worst cell then, at a place of that number
  };
  Kind kind;
  std::size_t number;
  std::size_t place = 0;
};

std::vector<Try> tries_of(const PatchEffort& effort, std::size_t places_of_many) {
  std::vector<Try> tries = {{Try::kNothing, 0}};
  const auto add = [&](Try::Kind kind, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) tries.push_back({kind, i});
  };
  add(Try::kRow, std::min(effort.rows, kNeedleRows));
  add(Try::kVertex, effort.vertices);
  add(Try::kRemoval, effort.removals);
  for (std::size_t i = 0; effort.replaces && i < effort.removals; ++i)
    for (std::size_t k = 0; k < places_of_many; ++k) tries.push_back({Try::kOther, i, k});
  return tries;
}

/// An apex of its own over each needle whose cell is below the goal, among the faces that stay: those of the
/// surface, of interfaces, with labels, and towards the rest of the mesh. The short sides of a
/// band of needles lie alternately left and right: one apex near its short side spoils what lies over its
/// neighbours, but all of them together leave more than apexes that several needles share.
bool put_row(const Run& run, const PatchTrial& rules, double share, double goal) {
  TetMesh& mesh = run.mesh;
  Workspace& work = run.work;
  const double below = dihedral_decision(goal);
  std::vector<std::array<VertexHandle, 3>> needles;
  for (std::size_t h = 0; h < 4 * mesh.n_cells(); ++h) {
    const HalfFaceHandle face(h);
    if (!(work.quality[h / 4] < below) || !mesh.is_constrained(face)) continue;
    const detail::Needle needle(detail::points_of(mesh, face));
    if (needle.side < rules.slender * needle.length) needles.push_back(mesh.halfface_vertices(face));
  }
  bool changed = false;
  for (const auto& vertices : needles) {
    const HalfFaceHandle face = mesh.find_halfface(vertices);  // in whatever cell lies on it by now
    if (!face.is_valid()) continue;                            // where the patch is pinched at all three
    VertexInsertion<MinSine2> insertion{MinSine2{}, work.quality, kAnyLoss};
    insertion.only_place = detail::Needle(detail::points_of(mesh, face)).place(share, rules.row_height);
    if (!apply(insertion, mesh, VertexInsertion<MinSine2>::Seed(cell_of(face)))) continue;
    changed = true;
    work.quality.resize(mesh.n_cells());
    work.set_qualities(mesh, MinSine2{}, run.policy());
  }
  return changed;
}

/// A vertex at a place of that number, counted by promise, for a cell.
bool put_vertex(const Run& run, CellHandle c, std::size_t place) {
  VertexInsertion<MinSine2> insertion{MinSine2{}, run.work.quality, kAnyLoss};
  insertion.only_site = static_cast<int>(place);
  return apply(insertion, run.mesh, VertexInsertion<MinSine2>::Seed(c));
}

bool remove_vertex(const Run& run, VertexHandle v) {
  TetMesh& mesh = run.mesh;
  const auto& frozen = run.work.frozen;
  if (!has(run.strategy.pass.ops, Ops::kNode) || v.idx() >= mesh.n_vertices() || frozen[v.idx()] != 0)
    return false;
  const std::vector<double> nothing_to_lose(mesh.n_cells(), 0);
  return apply(VertexCollapse<MinSine2>{MinSine2{}, nothing_to_lose, frozen}, mesh, v);
}

/// False where the try cannot be begun.
bool begin(const Try& attempt, const Run& run, const PatchTrial& rules, double goal) {
  TetMesh& mesh = run.mesh;
  Workspace& work = run.work;
  if (attempt.kind == Try::kRow || attempt.kind == Try::kVertex)
    work.set_qualities(mesh, MinSine2{}, run.policy());
  switch (attempt.kind) {
    case Try::kNothing:
      return true;
    case Try::kRow: {
      if (!put_row(run, rules, rules.row_shares[attempt.number], goal)) return false;
      // Vertices that came all at once have to be well connected before any is judged by itself.
      const Strategy connecting = strategy_to_connect(run.strategy);
      work.attach(mesh, run.policy());
      polish({mesh, work, connecting, run.control, run.findings, run.device}, connecting.polish, goal);
      return true;
    }
    case Try::kVertex:
      return put_vertex(run, CellHandle(0), attempt.number);
    case Try::kRemoval:
      return remove_vertex(run, VertexHandle(attempt.number));
    case Try::kOther: {
      if (!remove_vertex(run, VertexHandle(attempt.number))) return false;
      work.set_qualities(mesh, MinSine2{}, run.policy());
      const std::vector<CellHandle> worst = worst_cells_below(mesh, goal, 1, run.policy());
      return !worst.empty() && put_vertex(run, worst[0], attempt.place);
    }
  }
  return false;
}

/// What a try has left of the worst cell of a patch, and the patch where that is better than it was.
struct Attempt {
  double worst = 0;
  bool has_room = true;
  bool is_folded = false;
  std::optional<TetMesh> mesh;
};

/// The tries at one patch. Those of one kind are compared, the first kind of which one helps: none unless the
/// worst cell gets better. What a dearer kind would add to that is left to the next turn, which sees the
/// patch as it is by then. Tries may be made in any order and at the same time; which of them count does not
/// depend on that.
class PatchTries {
 public:
  /// `surface`: that of `whole`, which may change in the patch as well, if patches have one.
  PatchTries(const Patch& patch, const Run& whole, const SurfaceMesh* surface, Room room, double goal,
             std::span<const Try> tries)
      : patch_(patch),
        whole_(whole),
        surface_(whole.strategy.patch.has_surface ? surface : nullptr),
        room_(room),
        strategy_(strategy_of_patch(whole.strategy)),
        tries_(tries),
        attempts_(tries.size()),
        worst_(survey(patch.mesh(), strategy_.pass.policy).worst),
        least_(rules().rise * worst_),
        enough_(dihedral_decision(goal)),
        worked_for_(std::min(rules().ahead * goal, kLargestGoal)) {}

  /// Whether there is something to be done, for few cells.
  bool is_worth_trying(std::size_t few) const {
    return worst_ < enough_ && n_below(patch_.mesh(), worked_for_, strategy_.pass.policy) <= few;
  }

  /// Makes try number t, unless one before it that has ended by now makes it idle.
  void make(std::size_t t) {
    if (!is_idle(t)) attempts_[t] = attempt(tries_[t]);
    note(t);
  }

  /// What the tries come to in their order.
  PatchVerdict verdict() const {
    PatchVerdict found;
    double worst = worst_;
    Try::Kind helped = Try::kNothing;
    for (std::size_t t = 0; t < tries_.size(); ++t) {
      const Attempt& one = attempts_[t];
      const bool has_helped = found.best != PatchVerdict::kNone;
      if (worst >= enough_ || (has_helped && tries_[t].kind != helped)) break;
      if (!one.mesh || !(one.worst > std::max(worst, least_))) continue;
      if (!one.has_room) {
        found.held_back = true;
        continue;
      }
      helped = tries_[t].kind;
      worst = one.worst;
      found.best = static_cast<std::uint32_t>(t);
    }
    return found;
  }
  /// Of a verdict on this patch, of this process or another, for which the try is made once more.
  Outcome outcome(const PatchVerdict& verdict) {
    Outcome best;
    best.held_back = verdict.held_back;
    if (verdict.best == PatchVerdict::kNone) return best;
    Attempt& one = attempts_[verdict.best];
    if (!one.mesh) one = attempt(tries_[verdict.best]);
    best.is_folded = one.is_folded;
    best.mesh = std::move(one.mesh);
    return best;
  }

 private:
  const PatchTrial& rules() const { return whole_.strategy.patch; }

  /// Whether a try that helps, of an earlier kind or to all that is asked for, comes before it: then
  /// verdict() does not come to it.
  bool is_idle(std::size_t t) {
    const auto value = [](auto& shared) {
      par::before_shared_access();
      return par::atomic(shared).load(std::memory_order_relaxed);
    };
    return t > value(enough_from_) || tries_[t].kind > value(helps_);
  }
  void note(std::size_t t) {
    const Attempt& one = attempts_[t];
    if (!one.mesh || !one.has_room) return;
    const auto lower = [](auto& shared, auto value) {
      const auto least = par::atomic(shared);
      par::before_shared_access();
      auto now = least.load(std::memory_order_relaxed);
      while (value < now) {
        par::before_shared_access();
        if (least.compare_exchange_weak(now, value, std::memory_order_relaxed)) return;
      }
    };
    lower(helps_, static_cast<int>(tries_[t].kind));
    if (one.worst >= enough_) lower(enough_from_, t);
  }

  Attempt attempt(const Try& how) const {
    Attempt one;
    RunControl clock(whole_.control.seconds_left());
    if (clock.stopped()) return one;
    TetMesh mesh = patch_.mesh();
    LoneRun lone(mesh, strategy_, clock.seconds_left());
    lone.findings().is_folded = whole_.findings.is_folded;
    lone.findings().may_cover_twice = whole_.findings.may_cover_twice;
    if (!begin(how, lone.run(), rules(), worked_for_)) return one;
    lone.work().attach(mesh, strategy_.pass.policy);
    const PartOfSurface part(mesh, surface_, patch_.vertices());
    polish(lone.run(part.get()), strategy_.polish, worked_for_);
    one.worst = survey(mesh, strategy_.pass.policy).worst;
    one.has_room = room_.holds(mesh);
    one.is_folded = lone.findings().is_folded;
    if (one.worst > std::max(worst_, least_)) one.mesh = std::move(mesh);
    return one;
  }

  const Patch& patch_;
  const Run& whole_;
  const SurfaceMesh* const surface_;
  const Room room_;
  const Strategy strategy_;
  std::span<const Try> tries_;
  std::vector<Attempt> attempts_;
  double worst_, least_, enough_, worked_for_;  // decision values but for the last, which is an angle
  // Lowered by tries at the same time:
  int helps_ = Try::kOther + 1;         // the first kind of which one helps
  std::size_t enough_from_ = kNoLimit;  // the first try that leaves enough
};

/// What the tries bring to each patch; nothing where another process goes on. Tries and patches share
/// nothing, so all of them may run at once: the first try of each patch, then the second of each …, because
/// one that helps saves those after it.
std::vector<Outcome> search(const Run& run, PatchPlace& place, std::span<const Patch> patches, double goal,
                            const PatchEffort& effort) {
  const std::vector<Try> tries = tries_of(effort, run.strategy.pass.sites_of_many);
  std::deque<PatchTries> all;
  const SurfaceMesh* const surface = run.surface ? place.surface(run.surface) : nullptr;
  std::vector<std::size_t> open;  // numbers of those that are tried on here
  for (std::size_t i = 0; i < patches.size(); ++i) {
    all.emplace_back(patches[i], run, surface, room_of(patches[i], place.n_cells(), run.bounds), goal, tries);
    if (place.tries_on(i) && all.back().is_worth_trying(effort.few)) open.push_back(i);
  }
  par::for_each_dynamic(run.policy().for_items_of(kTryNanoseconds), open.size() * tries.size(), 1,
                        [&](std::size_t i) { all[open[i % open.size()]].make(i / open.size()); });
  std::vector<PatchVerdict> verdicts;
  for (const PatchTries& one : all) verdicts.push_back(one.verdict());
  if (!place.share(verdicts)) return {};
  std::vector<Outcome> outcomes(all.size());
  par::for_each_dynamic(run.policy().for_items_of(kTryNanoseconds), all.size(), 1,
                        [&](std::size_t i) { outcomes[i] = all[i].outcome(verdicts[i]); });
  return outcomes;
}

/// Patches round the worst of the cells that share none.
std::vector<Patch> disjoint_patches(PatchPlace& place, const PatchEffort& effort) {
  const TetMesh& mesh = place.mesh();
  std::vector<Patch> patches;
  std::vector<std::uint8_t> taken(mesh.n_cells(), 0);
  for (CellHandle c : place.worst()) {
    if (patches.size() == effort.patches) break;
    if (taken[c.idx()]) continue;
    Patch patch(mesh, c, effort.layers, place.pinched());
    const auto& cells = patch.cells();
    if (std::any_of(cells.begin(), cells.end(), [&](CellHandle d) { return taken[d.idx()] != 0; })) continue;
    for (CellHandle d : cells) taken[d.idx()] = 1;
    patches.push_back(std::move(patch));
  }
  return patches;
}

/// Puts back what has got better, as far as the bounds on cells let it and no edge or face comes twice.
void put_back(const Run& run, PatchPlace& place, std::span<const Patch> patches,
              std::span<const Outcome> outcomes, PatchesDone& done) {
  const bool may_overlap =
      run.findings.is_folded || run.findings.may_cover_twice || !run.work.pinched.empty() || run.surface;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    done.met_bound = done.met_bound || outcomes[i].held_back;
    if (!outcomes[i].mesh) continue;
    ++done.n_candidates;
    if (!room_of(patches[i], place.n_cells(), run.bounds)
             .holds(*outcomes[i].mesh)) {  // the others have had theirs
      done.met_bound = true;
      continue;
    }
    if (may_overlap && !patches[i].fits(place.mesh(), *outcomes[i].mesh)) continue;
    place.put_back(patches[i], *outcomes[i].mesh);
    done.is_folded = done.is_folded || outcomes[i].is_folded;
    ++done.n_changed;
    done.worst_rose = done.worst_rose || i == 0;
  }
}

PatchesDone search_at(const Run& run, PatchPlace& place, double goal, const PatchEffort& effort) {
  const std::vector<Patch> patches = disjoint_patches(place, effort);
  PatchesDone done;
  done.n_patches = patches.size();
  if (!patches.empty()) put_back(run, place, patches, search(run, place, patches, goal, effort), done);
  return done;
}

/// The mesh itself.
class WholeMesh : public PatchPlace {
 public:
  WholeMesh(const Run& run, std::span<const CellHandle> worst)
      : mesh_(run.mesh), work_(run.work), worst_(worst) {}
  TetMesh& mesh() override { return mesh_; }
  std::span<const CellHandle> worst() const override { return worst_; }
  std::span<const std::uint8_t> pinched() const override { return work_.pinched; }
  std::size_t n_cells() const override { return mesh_.n_logical_cells(); }
  void put_back(const Patch& patch, const TetMesh& changed) override {
    patch.put_back(mesh_, changed, work_);
  }

 private:
  TetMesh& mesh_;
  Workspace& work_;
  std::span<const CellHandle> worst_;
};

/// A turn round the worst cells below `degrees`; nothing where these are too many.
std::optional<PatchesDone> take_turn(const Run& run, double degrees, const PatchEffort& effort) {
  const std::size_t n_centres = 4 * effort.patches;  // most patches hold several of the worst cells
  const std::size_t n = std::max(effort.few + 1, n_centres);
  const std::vector<CellHandle> held = cells_at_ceiling(run, degrees);
  if (run.is_part()) {
    std::vector<std::uint64_t> worst = run.parts()->worst_cells_below(degrees, n, held);
    if (worst.size() > effort.few) return std::nullopt;
    worst.resize(std::min(n_centres, worst.size()));
    return run.parts()->search_patches(
        worst, effort.layers, run.strategy.patch.has_surface ? run.surface : nullptr,
        [&](PatchPlace& place) { return search_at(run, place, degrees, effort); });
  }
  std::vector<CellHandle> worst = worst_cells_below(run.mesh, degrees, n, run.policy(), held, run.known());
  if (worst.size() > effort.few) return std::nullopt;
  worst.resize(std::min(n_centres, worst.size()));
  WholeMesh place(run, worst);
  return search_at(run, place, degrees, effort);
}

}  // namespace

bool search_patches(const Run& run, double degrees, const PatchEffort& effort) {
  if (!run.strategy.patch.enabled || !(run.survey().worst > 0)) return false;
  PassReport pass;
  pass.stage = "patches";
  pass.op = "insert";
  const double start = run.control.seconds();
  for (int turn = 0; turn < effort.turns && !run.control.stopped(); ++turn) {
    const double next = std::min(degrees, smallest_that_may_rise(run, degrees) + effort.degrees);
    const std::optional<PatchesDone> done = take_turn(run, next, effort);
    if (!done || done->n_patches == 0) break;
    ++pass.rounds;
    pass.seeds += done->n_patches;
    pass.candidates += done->n_candidates;
    pass.winners += done->n_changed;
    if (done->met_bound) run.findings.note_cell_bound(run.bounds);
    run.findings.is_folded = run.findings.is_folded || done->is_folded;
    if (done->n_changed > 0) {
      if (run.is_part())
        run.work.forget_qualities();
      else if (run.surface)  // of which vertices may have come or gone, also before
        run.work.attach(run.mesh, run.policy());
      else
        run.work.look_again_for_pinched(run.mesh, run.policy());
      if (run.strategy.patch.has_surface) rebuild_surface(run);
    }
    if (!done->worst_rose) break;
  }
  pass.worst = run.survey().worst;
  pass.seconds = run.control.seconds() - start;
  const bool changed = pass.winners > 0;
  run.control.add(std::move(pass));
  return changed;
}

}  // namespace hfr
