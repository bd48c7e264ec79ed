// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_REMESHER_HH
#define HFR_REMESH_REMESHER_HH

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Remesh/Options.hh"
#include "hfremesh/Remesh/Result.hh"
#include "hfremesh/Transfer/Edits.hh"
#include "hfremesh/Transfer/Fields.hh"

/// A mesh inside of a simulation: its vertices move step by step, and what has become bad is repaired.
namespace hfr {

/// What makes a step repair: any of these. A trigger lies below the goal, so that a repaired mesh stands some
/// steps. What a repair had to leave as it is calls for another one only when it has become worse.
struct RepairTriggers {
  double min_dihedral = 10;  ///< a cell has a smaller dihedral, degrees; 0: not looked at
  bool inverted = true;      ///< a cell is inverted or flat
  /// A cell has a report value that is worse than this: lower, for kMaxDihedral higher.
  std::vector<std::pair<Metric, double>> metrics;
  /// Volume of a cell as a share of what it was when the cell was made, or the Remesher. 0: not looked at.
  double jacobian_ratio = 0;
  /// A vertex has come this far since the last repair, in mean edge lengths of the mesh that the Remesher was
  /// made with. 0: not looked at.
  double motion = 0;
  int every = 0;  ///< steps since the last repair. 0: not counted
  /// A cell is as bad as the caller says. Asked about cells with a vertex that has moved, from several
  /// threads at once.
  std::function<bool(const TetMesh&, CellHandle)> indicator;
  /// The same by a field of cells, of numbers: a cell is bad where it is not 0. What a repair leaves bad
  /// calls for no other one before the field has been 0 there.
  std::string indicator_field;
};

/// What a move does that would invert cells.
enum class OnInversion {
  kRepair,    ///< the whole of it, and the repair has to mend what it can
  kSubsteps,  ///< as much of it as inverts nothing, a repair, and again; see RemesherOptions::max_substeps
  kRefuse,    ///< nothing: the mesh stays, and the cells are named
};

/// Whose motion a displacement is.
enum class Motion {
  kGiven,    ///< of every vertex
  kLaplace,  ///< of the boundary and of fixed vertices; others follow by Laplace's equation
  kElastic,  ///< the same, as an elastic body whose small cells are stiff
};

/// The strongest that holds.
enum class RepairCause { kNone, kInverted, kAngle, kMetric, kJacobian, kIndicator, kMotion, kSteps, kAsked };

struct MoveResult {
  /// Of the displacement that was taken: 1, or less with kSubsteps, or 0 where it was refused.
  double fraction = 1;
  std::size_t n_moved = 0;          ///< vertices
  std::size_t n_looked_at = 0;      ///< cells with such a vertex
  std::vector<CellHandle> refused;  ///< with kRefuse: the cells that would be inverted or flat, ascending
};

/// One repair of a step.
struct RepairResult {
  Edits edits;
  std::vector<FieldReport> fields;
  Stop stop = Stop::kNoProgress;  ///< why it ended
  bool goal_reached = false;
};

struct StepResult {
  bool changed = false;                    ///< by a repair: connectivity, or points beyond the displacement
  RepairCause cause = RepairCause::kNone;  ///< of the first repair
  double fraction = 1;                     ///< of the displacement that was taken
  std::size_t n_looked_at = 0;             ///< cells with a vertex that was moved
  std::vector<CellHandle> refused;         ///< see MoveResult
  /// What the repairs did, each to the mesh that the one before it has left: one, but for sub-steps. Handles
  /// of created things are those after that repair.
  std::vector<RepairResult> repairs;
  double min_dihedral = 0;        ///< after it, degrees
  std::size_t n_inverted = 0;     ///< after it: cells that are inverted or flat
  Stop stop = Stop::kNoProgress;  ///< of the last repair; kTimeLimit and kCancelled end the step
  /// The step was ended by its time limit or the caller while cells were inverted that were not before, so
  /// the mesh and its fields were put back as they were before it.
  bool undone = false;
};

struct RemesherOptions {
  /// Of each repair. min_dihedral is the goal; time_limit holds for each repair alone. Without a goal a
  /// repair is a default run. `maps` and `statistics` are set by the Remesher. What `surface` fixes is named
  /// by the handles that the mesh has then, and stays so when they change.
  ImproveOptions improve;
  RepairTriggers triggers;
  OnInversion on_inversion = OnInversion::kRepair;
  /// With kSubsteps: moves of a step; what is left of the displacement then is taken as a whole.
  int max_substeps = 16;
  Motion motion = Motion::kGiven;
  /// The fields that are carried over a repair. Others come out of it as operators leave them: those of
  /// vertices attached, those of cells with what stood in the slot.
  std::vector<FieldTransfer> fields;
  /// Edits can be asked for the parents of created cells (Edits::parents()); they keep the mesh as it was
  /// until then. Without, they can only where a field is inherited.
  bool parents = true;
  /// Keep numbers for vertices and cells that never change and are never given twice.
  bool ids = false;

  RemesherOptions() { improve.min_dihedral = 15; }
};

/// Throws InvalidInput, with a line, for options out of range.
void validate(const RemesherOptions& options);

/// Moves a mesh, looks at what has moved, repairs what is bad, and carries fields over. The mesh belongs to
/// the caller and outlives this object. Between calls its points may be read, its fields written; whoever
/// changes its points, connectivity or regions himself calls reset() after that.
///
/// A step that throws (a callback, memory) leaves mesh and fields as they were before it. The results are the
/// same bits for any number of threads.
class Remesher {
 public:
  /// Deleted things of the mesh are collected. Looks at every cell once. Throws InvalidInput for options out
  /// of range, and for fields that do not exist.
  explicit Remesher(TetMesh& mesh, RemesherOptions options = {});
  ~Remesher();
  Remesher(const Remesher&) = delete;
  Remesher& operator=(const Remesher&) = delete;

  /// move(), and where a trigger calls for it repair() and transfer(). `displacement`: of each vertex, in the
  /// mesh's units; with kLaplace and kElastic what it has for other vertices than those of the boundary and
  /// fixed ones is not read. Throws InvalidInput, before anything is moved, for another number of them, and
  /// for one that is not finite. Where nothing triggers, nothing of the mesh is
  /// written but points, and nothing allocated but what starting threads takes.
  StepResult step(std::span<const Vec3> displacement);

  /// Moves the vertices and looks at their cells.
  MoveResult move(std::span<const Vec3> displacement);
  /// Whether, and why, the mesh is to be repaired.
  RepairCause needs_repair() const;
  /// Repairs the mesh whatever the triggers say. Fields are those of the mesh as it was until transfer().
  RepairResult repair();
  /// Carries the fields over the last repair; done by the next move() or repair() where it was not called.
  std::vector<FieldReport> transfer();
  /// Looks at everything anew.
  void reset();

  const TetMesh& mesh() const { return mesh_; }
  double min_dihedral() const;     ///< degrees
  std::size_t n_inverted() const;  ///< inverted and flat cells
  /// With RemesherOptions::ids, by handle.
  std::span<const std::uint64_t> vertex_ids() const;
  std::span<const std::uint64_t> cell_ids() const;

 private:
  class State;
  TetMesh& mesh_;
  std::unique_ptr<State> state_;
};

}  // namespace hfr

#endif
