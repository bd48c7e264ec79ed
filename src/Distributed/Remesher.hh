// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_REMESHER_HH
#define HFR_DISTRIBUTED_REMESHER_HH

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hfremesh/Distributed/InParts.hh"
#include "hfremesh/Distributed/RankArrays.hh"
#include "hfremesh/Remesh/Remesher.hh"

/// hfr::Remesher over a mesh in parts: a mesh inside of a simulation on several ranks.
namespace hfr::mpi {

/// What a step has done; the same on all ranks.
struct PartsStep {
  bool changed = false;                    ///< by a repair: connectivity, or points beyond the displacement
  RepairCause cause = RepairCause::kNone;  ///< of the repair
  double fraction = 1;        ///< of the displacement that was taken: 1, or 0 where it was refused
  std::uint64_t n_moved = 0;  ///< vertices
  /// With OnInversion::kRefuse: numbers of the cells that would be inverted or flat, ascending.
  std::vector<std::uint64_t> refused;
  std::optional<PartsResult> repair;
  double min_dihedral = 0;       ///< after it, degrees
  std::uint64_t n_inverted = 0;  ///< after it: cells that are inverted or flat
};

/// What of these options is not there in parts, as in "a Remesher in parts does not have …"; empty where all
/// is.
std::string reason_against(const RemesherOptions& options);

/// Moves a mesh in parts, looks at what has become of it, and repairs it where a trigger calls for that: step
/// by step the mesh that hfr::Remesher makes, to the last bit, for each number of ranks and threads. All
/// ranks call each function at the same time; where one throws, the others throw RankFailed with their next
/// call, and the object is of no further use.
///
/// There are the triggers min_dihedral, inverted and every, and OnInversion::kRepair and kRefuse. Throws
/// InvalidInput for what reason_against() names: other triggers, sub-steps, vertices that follow, fields,
/// ids, what is fixed, time limits, cancelling, and what mpi::improve() does not have. A step looks at all
/// cells of a rank.
class Remesher {
 public:
  /// Of what from_arrays() takes, which says what it throws. Here and after each repair that has changed
  /// something, cells stay where they are if parts are even (Keep::kIfEven).
  Remesher(Comm& comm, const RankArrays& arrays, RemesherOptions options = {});
  ~Remesher();
  Remesher(const Remesher&) = delete;
  Remesher& operator=(const Remesher&) = delete;

  /// `displacement`: of each point of arrays(), in its order and in the mesh's units; of a point that several
  /// ranks have, that which its owner gives counts. Throws InvalidInput, before anything is moved, for
  /// another number of them, and for one that is not finite.
  PartsStep step(std::span<const Vec3> displacement);

  /// What this rank has now: own_arrays(). Other cells and points only after a step that has `changed`.
  RankArrays arrays();
  /// The parts as they are, to be written or checked.
  DistributedMesh& mesh() { return *mesh_; }

 private:
  class Watch;

  void rebuild(const RankArrays& arrays);
  void move_points(std::span<const Vec3> displacement);
  void put_points_back();
  void tell_points();

  Comm& comm_;
  RemesherOptions options_;
  std::unique_ptr<DistributedMesh> mesh_;
  std::unique_ptr<Watch> watch_;
  std::vector<VertexHandle> points_;  // those of arrays()
  /// Own vertices that other ranks hold, by rank.
  std::vector<std::vector<VertexHandle>> held_by_;
  std::vector<Vec3> was_;  // own points before the move, by vertex; others too
  int steps_ = 0;          // since the last repair
};

}  // namespace hfr::mpi

#endif
