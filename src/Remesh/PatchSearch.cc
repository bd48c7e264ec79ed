// SPDX-License-Identifier: BSD-3-Clause
// Insertion "followed by smoothing and topological improvement", kept or rolled back as one step (Klingner &
// Shewchuk 2007): here on a copy of the surroundings of each of the last few cells, and removal likewise.
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>

#include "Operators/Metrics.hh"
#include "Operators/Needle.hh"
#include "Operators/Replace.hh"
#include "Operators/VertexInsertion.hh"
#include "Operators/VertexRemoval.hh"
#include "Remesh/Patch.hh"
#include "Remesh/Pipeline.hh"
#include "Remesh/SurfaceRun.hh"

namespace hfr {
namespace {

constexpr double kLoss = 0.02;       // of sin² of the worst cell, that a new vertex may leave at first
constexpr double kAnyLoss = 1e-4;    // the same for vertices that count together only
constexpr double kRise = 1.002;      // times sin² of the worst cell of a patch: less is not worth its cells
constexpr double kFlat = 1e-5;       // sin² of a cell that is all but flat
constexpr double kAhead = 1.05;      // times the goal, which is worked for
constexpr double kLargestGoal = 60;  // degrees
constexpr int kIterations = 8;       // of the polish of one try: more found no more
constexpr double kPatchNanoseconds = 1e7;

struct Outcome {
  std::optional<TetMesh> mesh;
  double worst = 0;
  bool held_back = false;  // there was one that had too many cells, or too few
};

/// Cells that a patch may come to have.
struct Room {
  std::size_t least, most;

  bool holds(const TetMesh& changed) const {
    return changed.n_logical_cells() >= least && changed.n_logical_cells() <= most;
  }
};

Room room_of(const Patch& patch, const TetMesh& mesh, const ImproveOptions& options) {
  const std::size_t others = mesh.n_logical_cells() - patch.cells().size();
  const auto above_others = [&](std::size_t n) { return std::max(n, others) - others; };
  return {above_others(options.min_cells),
          options.max_cells > 0 ? above_others(options.max_cells) : std::numeric_limits<std::size_t>::max()};
}

/// Where over each needle an apex of its own is put, as shares of the way from the short side to the tip, and
/// how high, as a share of what would be best for a lone one; see detail::Needle.
constexpr std::array<double, kNeedleRows> kRowShares = {0.37, 1.0 / 3.0};
constexpr double kRowHeight = 0.8;
constexpr double kSlender = 0.35;  // short side over length of a needle

/// What a try begins with on a copy of a patch, even at a loss.
struct Try {
  enum Kind {
    kNothing,  // improved as it is
    kRow,      // an apex over each needle; number: of kRowShares
    kVertex,   // a new vertex for the first cell; number: of the place, counted by promise
    kRemoval,  // one vertex less; number: of the vertex, which are in the order of discovery from that cell
  };
  Kind kind;
  std::size_t number;
};

std::vector<Try> tries_of(const PatchEffort& effort) {
  std::vector<Try> tries = {{Try::kNothing, 0}};
  const auto add = [&](Try::Kind kind, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) tries.push_back({kind, i});
  };
  add(Try::kRow, std::min(effort.rows, kRowShares.size()));
  add(Try::kVertex, effort.vertices);
  add(Try::kRemoval, effort.removals);
  return tries;
}

/// An apex of its own over each needle whose cell is below the goal, among the faces that stay: those of the
/// surface, of interfaces, with labels, and towards the rest of the mesh. The short sides of a
/// band of needles lie alternately left and right: one apex near its short side spoils what lies over its
/// neighbours, but all of them together leave more than apexes that several needles share.
bool put_row(TetMesh& mesh, Workspace& work, const ImproveOptions& options, double share, double goal) {
  const double below = dihedral_decision(goal);
  std::vector<std::array<VertexHandle, 3>> needles;
  for (std::size_t h = 0; h < 4 * mesh.n_cells(); ++h) {
    const HalfFaceHandle face(h);
    if (!(work.quality[h / 4] < below) || !mesh.is_constrained(face)) continue;
    const detail::Needle needle(detail::points_of(mesh, face));
    if (needle.side < kSlender * needle.length) needles.push_back(mesh.halfface_vertices(face));
  }
  bool changed = false;
  for (const auto& vertices : needles) {
    const HalfFaceHandle face = mesh.find_halfface(vertices);  // in whatever cell lies on it by now
    if (!face.is_valid()) continue;                            // where the patch is pinched at all three
    VertexInsertion<MinSine2> insertion{MinSine2{}, work.quality, kAnyLoss};
    insertion.only_place = detail::Needle(detail::points_of(mesh, face)).place(share, kRowHeight);
    if (!apply(insertion, mesh, VertexInsertion<MinSine2>::Seed(cell_of(face)))) continue;
    changed = true;
    work.quality.resize(mesh.n_cells());
    work.set_qualities(mesh, MinSine2{}, options.policy);
  }
  return changed;
}

/// False where the try cannot be begun.
bool begin(const Try& attempt, TetMesh& mesh, Workspace& work, const ImproveOptions& options, double goal) {
  if (attempt.kind == Try::kRow || attempt.kind == Try::kVertex)
    work.set_qualities(mesh, MinSine2{}, options.policy);
  switch (attempt.kind) {
    case Try::kNothing:
      return true;
    case Try::kRow: {
      if (!put_row(mesh, work, options, kRowShares[attempt.number], goal)) return false;
      // Vertices that came all at once have to be well connected before any is judged by itself.
      ImproveOptions connecting = options;
      connecting.ops = without(without(options.ops, Ops::kNode), Ops::kInsert);
      RunControl control(connecting);
      work.attach(mesh, options.policy);
      polish(mesh, work, connecting, control, goal);
      return true;
    }
    case Try::kVertex: {
      VertexInsertion<MinSine2> insertion{MinSine2{}, work.quality, kLoss};
      insertion.only_site = static_cast<int>(attempt.number);
      return apply(insertion, mesh, VertexInsertion<MinSine2>::Seed(CellHandle(0)));
    }
    case Try::kRemoval: {
      const VertexHandle v(attempt.number);
      if (!has(options.ops, Ops::kNode) || v.idx() >= mesh.n_vertices() || work.frozen[v.idx()] != 0)
        return false;
      const std::vector<double> nothing_to_lose(mesh.n_cells(), kFlat);
      return apply(VertexRemoval<MinSine2>{MinSine2{}, nothing_to_lose, work.frozen}, mesh, v);
    }
  }
  return false;
}

/// The best of several tries at the patch: none unless its worst cell gets better. Vertices are taken out
/// only where none that was put in has helped.
/// `surface`: of the whole, whose part of the patch may change as well; null where it may not.
Outcome search(const Patch& patch, const SurfaceMesh* surface, Room room, const ImproveOptions& options,
               double seconds, double goal, const PatchEffort& effort) {
  ImproveOptions whole;
  whole.time_limit = seconds;
  RunControl clock(whole);
  ImproveOptions here;
  here.ops = options.ops;
  here.seed = options.seed;
  if (surface) here.surface.mode = SurfaceMode::kFlat;
  here.raise_min_dihedral = true;  // as many vertices as it takes
  here.iterations = kIterations;
  here.policy = {};  // patches are searched side by side
  Outcome best;
  best.worst = survey(patch.mesh(), here.policy).worst;
  const double least = kRise * best.worst;
  const double worked_for = std::min(kAhead * goal, kLargestGoal);
  if (n_below(patch.mesh(), worked_for, here.policy) > effort.few) return best;
  const double enough = dihedral_decision(goal);
  for (const Try& attempt : tries_of(effort)) {
    if (best.worst >= enough || (attempt.kind == Try::kRemoval && best.mesh) || clock.stopped()) break;
    here.time_limit = seconds - clock.seconds();
    TetMesh mesh = patch.mesh();
    Workspace work;
    work.attach(mesh, here.policy);
    if (!begin(attempt, mesh, work, here, worked_for)) continue;
    work.attach(mesh, here.policy);
    RunControl control(here);
    const PartOfSurface part(mesh, surface, patch.vertices());
    control.set_surface(part.get());
    polish(mesh, work, here, control, worked_for);
    const double worst = survey(mesh, here.policy).worst;
    if (!(worst > std::max(best.worst, least))) continue;
    if (!room.holds(mesh)) {
      best.held_back = true;
      continue;
    }
    best.worst = worst;
    best.mesh = std::move(mesh);
  }
  return best;
}

}  // namespace

bool search_patches(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
                    double goal, const PatchEffort& effort) {
  if (!has(options.ops, Ops::kInsert) || options.iterations > 0) return false;
  if (!(survey(mesh, options.policy).worst > 0)) return false;
  PassReport pass;
  pass.stage = "patches";
  pass.op = "insert";
  const double start = control.seconds();
  // A curved one cannot: its shape is that of the input, which a patch does not know.
  SurfaceMesh* const surface = options.surface.mode == SurfaceMode::kFlat ? control.surface() : nullptr;
  for (int turn = 0; turn < effort.turns && !control.stopped(); ++turn) {
    const double next = std::min(goal, smallest_dihedral(mesh, options.policy) + effort.degrees);
    const std::size_t n_centres = 4 * effort.patches;  // most patches hold several of the worst cells
    const auto worst = worst_cells_below(mesh, next, std::max(effort.few + 1, n_centres), options.policy);
    if (worst.size() > effort.few) break;
    std::vector<Patch> patches;
    std::vector<std::uint8_t> taken(mesh.n_cells(), 0);
    for (CellHandle c : std::span(worst).first(std::min(n_centres, worst.size()))) {
      if (patches.size() == effort.patches) break;
      if (taken[c.idx()]) continue;
      Patch patch(mesh, c, effort.layers);
      const auto& cells = patch.cells();
      if (std::any_of(cells.begin(), cells.end(), [&](CellHandle d) { return taken[d.idx()] != 0; }))
        continue;
      for (CellHandle d : cells) taken[d.idx()] = 1;
      patches.push_back(std::move(patch));
    }
    if (patches.empty()) break;
    std::vector<Outcome> outcomes(patches.size());
    const double seconds = options.time_limit - control.seconds();
    par::for_each_dynamic(options.policy.for_items_of(kPatchNanoseconds), patches.size(), 1,
                          [&](std::size_t i) {
                            const Room room = room_of(patches[i], mesh, options);
                            outcomes[i] = search(patches[i], surface, room, options, seconds, next, effort);
                          });
    ++pass.rounds;
    pass.seeds += patches.size();
    std::size_t n_changed = 0;
    bool worst_rose = false;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      if (outcomes[i].held_back) control.note_cell_bound(options.max_cells);
      if (!outcomes[i].mesh) continue;
      ++pass.candidates;
      if (!room_of(patches[i], mesh, options).holds(*outcomes[i].mesh)) {  // the others have had theirs
        control.note_cell_bound(options.max_cells);
        continue;
      }
      patches[i].put_back(mesh, *outcomes[i].mesh);
      ++n_changed;
      worst_rose = worst_rose || i == 0;
    }
    pass.winners += n_changed;
    if (n_changed > 0) {
      work.attach(mesh, options.policy);
      take_again(surface, mesh, options.policy);
    }
    if (!worst_rose) break;
  }
  pass.worst = survey(mesh, options.policy).worst;
  pass.seconds = control.seconds() - start;
  const bool changed = pass.winners > 0;
  control.add(std::move(pass));
  return changed;
}

}  // namespace hfr
