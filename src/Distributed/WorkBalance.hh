// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_WORK_BALANCE_HH
#define HFR_DISTRIBUTED_WORK_BALANCE_HH

#include <cstdint>
#include <span>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr::mpi {

/// How many of `counts` each rank is to give to each other, so that none has more than all have on average:
/// what rank `from` gives, by rank.
std::vector<std::uint64_t> gifts(std::span<const std::uint64_t> counts, int from);

/// While a run goes on towards a goal, ranks that have few of the cells below it own some vertices of ranks
/// that have many, and so do part of their work. Once they are given back, whose they were is as before, but
/// of those that were deleted meanwhile. The mesh that comes out does not depend on it.
class WorkBalance {
 public:
  /// Counts the cells below `goal` degrees, and hands vertices over where that takes less than it saves. All
  /// take part, here and in give_back().
  WorkBalance(DistributedMesh& parts, double goal, par::Policy policy);
  WorkBalance(const WorkBalance&) = delete;
  WorkBalance& operator=(const WorkBalance&) = delete;

  /// Vertices that have come since go along with their neighbours.
  void give_back();
  std::uint64_t n_borrowed() const { return borrowed_.size(); }

 private:
  struct Borrowed {
    std::uint64_t number = 0;
    int from = 0;
  };

  void hand_over(std::span<const int> to);

  DistributedMesh& parts_;
  bool is_lent_ = false;  // something, by any rank
  std::uint64_t n_vertices_before_ = 0;
  std::vector<Borrowed> borrowed_;  // by number
};

}  // namespace hfr::mpi

#endif
