// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_WATCH_HH
#define HFR_DISTRIBUTED_PART_WATCH_HH

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Remesh/Remesher.hh"

namespace hfr::mpi {

/// What is known of the cells of a rank, and of all: as CellWatch, which has triggers by an indicator, too.
/// All ranks look at the same time.
class PartWatch {
 public:
  /// `triggers` have to stay.
  PartWatch(const RepairTriggers& triggers, par::Policy policy);

  /// Volumes at rest of own cells, in the order of numbers, where triggers.jacobian_ratio asks for them.
  /// Before the first look at a mesh, and at one whose cells have other handles.
  void set_rest_volumes(const DistributedMesh& mesh, std::span<const double> volumes);
  /// At own cells. What was excused stays so as long as it is bad for the same reason, and not much worse
  /// than it was left.
  void look(DistributedMesh& mesh);
  /// After a repair: looks at all. What is bad and not inverted was left by it, and is excused, unless it was
  /// cut short.
  /// The cells have handles of their own by now.
  void follow(DistributedMesh& mesh, bool was_cut_short);

  /// n_inverted() of a mesh that this object has not looked at, as one in the middle of a repair.
  static std::uint64_t count_inverted(const DistributedMesh& mesh);

  RepairCause cause() const { return cause_; }
  std::uint64_t n_inverted() const { return n_inverted_; }  ///< of all ranks
  double min_dihedral() const;                              ///< of all ranks, degrees
  /// Own ones, by number.
  std::vector<std::uint64_t> inverted(const DistributedMesh& mesh) const;

  struct Excuse {
    unsigned bits = 0;
    double left = 0;  ///< the value that the repair has left the cell with
  };
  using Excuses = std::map<CellHandle, Excuse>;
  const Excuses& excuses() const { return excused_; }
  void set_excuses(Excuses excuses) { excused_ = std::move(excuses); }

 private:
  /// Why a cell is bad, a bit each.
  enum Reason : unsigned { kIsInverted = 1, kIsBelow = 2, kHasMetric = 4, kIsSqueezed = 8 };
  struct Bad {
    CellHandle cell;
    double value = 0;
    unsigned bits = 0;
  };
  struct Found {
    std::vector<Bad> bad;
    double worst = std::numeric_limits<double>::infinity();
  };

  unsigned badness(const TetMesh& part, CellHandle c, double value) const;
  void narrow(CellHandle c, Excuse& excuse) const;

  const RepairTriggers& triggers_;
  par::Policy policy_;
  double trigger_;                   // decision value of triggers_.min_dihedral
  std::vector<Bad> bad_;             // ascending
  std::vector<double> rest_volume_;  // by cell of the part, where asked for
  Excuses excused_;                  // of cells that the last repair has left bad
  std::uint64_t n_inverted_ = 0;     // over all ranks
  double worst_ = 0;
  RepairCause cause_ = RepairCause::kNone;
};

}  // namespace hfr::mpi

#endif
