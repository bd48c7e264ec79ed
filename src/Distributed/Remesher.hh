// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_REMESHER_HH
#define HFR_DISTRIBUTED_REMESHER_HH

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hfremesh/Distributed/InParts.hh"
#include "hfremesh/Distributed/RankArrays.hh"
#include "hfremesh/Remesh/Remesher.hh"

/// hfr::Remesher over a mesh in parts: a mesh inside of a simulation on several ranks.
namespace hfr::mpi {

class PartWatch;

/// What a repair has done.
struct PartsRepair {
  PartsResult run;
  std::vector<FieldReport> fields;  ///< one for each field; none where nothing has changed
};

/// What a step has done; the same on all ranks.
struct PartsStep {
  bool changed = false;                    ///< by a repair: connectivity, or points beyond the displacement
  RepairCause cause = RepairCause::kNone;  ///< of the first repair
  double fraction = 1;                     ///< of the displacement that was taken
  std::uint64_t n_moved = 0;               ///< vertices that were to move
  /// With OnInversion::kRefuse: numbers of the cells that would be inverted or flat, ascending.
  std::vector<std::uint64_t> refused;
  std::vector<PartsRepair> repairs;  ///< one, but for sub-steps; none where it was undone
  double min_dihedral = 0;           ///< after it, degrees
  std::uint64_t n_inverted = 0;      ///< after it: cells that are inverted or flat
  Stop stop = Stop::kNoProgress;     ///< of the last repair; kTimeLimit and kCancelled end the step
  /// The step was ended by a time limit or a caller while there were more inverted cells than before it, so
  /// mesh, parts, fields and ids are as they were then. Ids that it gave are not given again.
  bool undone = false;
};

/// What of these options is not there in parts, as in "a Remesher in parts does not have …"; empty where all
/// is.
std::string reason_against(const RemesherOptions& options);

/// Moves a mesh in parts, looks at what has become of it, and repairs it where a trigger calls for that: step
/// by step the mesh that hfr::Remesher makes, to the last bit, for each number of ranks and threads, unless a
/// clock ends one of them earlier. All ranks call each function at the same time; where one throws, the
/// others throw RankFailed with their next call, and the object is of no further use.
///
/// There are all triggers but those by an indicator. What options.improve.surface fixes is named by numbers
/// of vertices in the whole, and stays so when these change. Each rank may have a time limit and callbacks of
/// its own, or none (see mpi::improve()); where one has any, a step that repairs keeps a copy of part, fields
/// and ids to go back to. Throws InvalidInput for what reason_against() names: triggers by an indicator,
/// vertices that follow, fields by callback, and what mpi::improve() does not have. A step looks at all cells
/// of a rank.
///
/// Fields, of numbers of double precision, are not properties here: set_field() gives the values that a rank
/// has, and field() those that it has after a step: the ones of hfr::Remesher, to the last bit.
class Remesher {
 public:
  /// Of what from_arrays() takes, which says what it throws; `options` are the same on all ranks, but for
  /// time limits and callbacks. InvalidInput also for a field that is named twice, for what is named as fixed
  /// and not there, and for coordinates that nothing can be decided from, which hfr::improve() refuses. Here
  /// and after each repair that has changed something, cells stay where they are if parts are even
  /// (Keep::kIfEven).
  Remesher(Comm& comm, const RankArrays& arrays, RemesherOptions options = {});
  ~Remesher();
  Remesher(const Remesher&) = delete;
  Remesher& operator=(const Remesher&) = delete;

  /// `displacement`: of each point of arrays(), in its order and in the mesh's units; of a point that several
  /// ranks have, that which its owner gives counts. Throws InvalidInput, before anything is moved, for
  /// another number of them, for one that is not finite, and for fields that have no values or cannot be
  /// transferred (hfr::validate_fields()). A repair throws it for coordinates that a move has taken too far,
  /// and the object is of no further use then.
  PartsStep step(std::span<const Vec3> displacement);

  /// What this rank has now: own_arrays(). Other cells and points only after a step that has `changed`.
  RankArrays arrays();
  /// What this rank has of a field of options.fields: of each point of arrays() or of each of its cells,
  /// `n_components` values, one after the other. Of a point that several ranks have, those that its owner
  /// gives count. Before the first step, and whenever the values have changed otherwise than by a step.
  /// Throws InvalidInput for a field that the options do not name, another number of values, and other
  /// components than other ranks give.
  void set_field(std::string_view name, std::span<const double> values, std::size_t n_components = 1);
  /// The same as it is now, also of points of others; none before set_field(). Good until that is called
  /// again or a step has `changed` or was `undone`. Throws InvalidInput for a field that the options do not
  /// name. Each rank may call it by itself.
  std::span<const double> field(std::string_view name) const;
  /// With RemesherOptions::ids: of each point of arrays(), and of each of its cells, the ids that
  /// hfr::Remesher gives. In the beginning they are the numbers. Good until a step has `changed` or was
  /// `undone`.
  std::span<const std::uint64_t> vertex_ids() const { return kept_.vertex_ids; }
  std::span<const std::uint64_t> cell_ids() const { return kept_.cell_ids; }
  /// The parts as they are, to be written or checked. Good until a step has `changed` or was `undone`.
  DistributedMesh& mesh() { return *mesh_; }

 private:
  void rebuild(const RankArrays& arrays, Inverted inverted);
  struct Move {
    double fraction = 1;
    std::vector<std::uint64_t> refused;
  };
  Move take(std::span<const Vec3> displacement, OnInversion on_inversion);
  void put_points(std::span<const Vec3> displacement, double fraction);
  void put_points_back();
  void run_step(std::span<const Vec3> displacement, PartsStep& result);
  RepairCause needs_repair() const;
  double mean_edge() const;
  void note_motion(std::span<const Vec3> displacement, double fraction);
  struct Field {
    FieldTransfer how;
    std::size_t n_components = 0;  ///< 0: has no values yet
    std::vector<double> values;    ///< as arrays() has points, or cells
  };
  /// What is kept of each thing over repairs, where asked for.
  struct Kept {
    std::vector<double> rest_volume;        ///< by own cell
    std::vector<std::uint64_t> vertex_ids;  ///< by point of arrays()
    std::vector<std::uint64_t> cell_ids;    ///< by own cell
  };
  /// All that a step may have to take back.
  struct Before;
  using Renumbered = std::span<const std::pair<std::uint64_t, std::uint64_t>>;

  const Field& named(std::string_view name) const;
  void require_fields() const;
  template <class T>
  void tell_values(std::vector<T>& values, std::size_t width);
  template <class T>
  std::vector<T> of_own_points(const DistributedMesh& mesh, const std::vector<T>& values,
                               std::size_t width) const;
  template <class T>
  std::vector<T> to_points(const std::vector<T>& own, std::size_t width);
  bool keeps_values() const { return options_.triggers.jacobian_ratio > 0 || options_.ids; }
  void begin_to_keep();
  Kept kept_over(const DistributedMesh& old, Renumbered renumbered, const RankArrays& now);
  void skip_ids(const DistributedMesh& old, Renumbered renumbered);
  RankArrays renamed_arrays();
  bool repair(PartsStep& result, bool is_last);
  std::vector<FieldReport> bring_along(std::shared_ptr<const DistributedMesh> old, Renumbered renumbered);
  void undo(PartsStep& result);

  Comm& comm_;
  RemesherOptions options_;
  std::unique_ptr<DistributedMesh> mesh_;
  std::unique_ptr<PartWatch> watch_;
  std::vector<Field> fields_;
  Kept kept_;
  std::uint64_t next_vertex_id_ = 0, next_cell_id_ = 0;
  bool may_be_cut_short_ = false;     // on any rank
  std::unique_ptr<Before> before_;    // the step in progress, where it may be
  std::vector<VertexHandle> points_;  // those of arrays()
  /// Own vertices that other ranks hold, by rank.
  std::vector<std::vector<VertexHandle>> held_by_;
  std::vector<Vec3> was_;          // points before the last move, by vertex; none before one
  std::vector<double> travelled_;  // by own point since the last repair, where asked for
  double mean_edge_ = 0, farthest_ = 0;
  int steps_ = 0;  // since the last repair
};

}  // namespace hfr::mpi

#endif
