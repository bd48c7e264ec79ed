// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_UNFOLDING_HH
#define HFR_DISTRIBUTED_PART_UNFOLDING_HH

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/PartSmoothing.hh"
#include "Distributed/Spread.hh"
#include "Remesh/Unfolding.hh"

namespace hfr::mpi {

/// A value of one vertex or cell, with its number in the whole.
struct Numbered {
  std::uint64_t number = 0;
  double value = 0;
};
/// The sum of the values of all ranks in the order of their numbers, which are below `n`; the same on all.
/// About so many values at a time come together on rank 0. All take part.
double sum_in_order(Comm& comm, std::span<const Numbered> values, std::uint64_t n,
                    std::uint64_t at_once = 1'000'000);

/// Each rank moves its own vertices, colour by colour, and tells those that hold them. What of the whole has
/// an order goes to rank 0 with its numbers: the volumes of invalid cells, the ways of a relaxation, and the
/// damage of patches.
class PartUnfolding : public Unfolding {
 public:
  PartUnfolding(DistributedMesh& parts, const UntangleEffort& effort, par::Policy policy)
      : parts_(parts), effort_(effort), policy_(policy) {}

  std::size_t look() override;
  std::size_t n_within(int layers) override;
  std::size_t take(int layers) override;
  Tangle tangle() override;
  double relax(double over) override;
  void put_back() override;
  void sweep() override;
  std::size_t keep_what_helps() override;

 private:
  std::vector<VertexHandle> own_within(int layers, Spread::Stars kind) const;
  std::vector<VertexHandle> with_others_near(std::span<const VertexHandle> own) const;
  void tell(std::span<const VertexHandle> moved);
  std::vector<std::uint64_t> patches_that_gain(std::span<const std::uint64_t> patch_of_cell);

  DistributedMesh& parts_;
  const UntangleEffort& effort_;
  par::Policy policy_;
  std::vector<CellHandle> invalid_;     // own ones
  std::vector<VertexHandle> vertices_;  // that are moved, as far as this part knows of them
  std::optional<PartSmoothing> colours_;
  std::vector<std::vector<VertexHandle>> groups_;  // own ones, by colour
  std::vector<Vec3> before_;                       // by vertices_
  std::vector<CellHandle> cells_;                  // own ones that a move may change
};

}  // namespace hfr::mpi

#endif
