// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_CUTOUT_ROUND_HH
#define HFR_DISTRIBUTED_CUTOUT_ROUND_HH

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "Distributed/Buffer.hh"
#include "Distributed/Cutout.hh"
#include "Distributed/DistributedMesh.hh"
#include "Distributed/LookOptions.hh"
#include "Remesh/Ranks.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/RoundPlace.hh"

namespace hfr::mpi {

/// The place of a round on a cutout, on rank 0. Slots are those of the whole.
class CutoutRound : public RoundPlace {
 public:
  /// What a round does to the slots and vertices of the whole.
  struct SlotChange {
    std::uint64_t n_taken = 0;     ///< from the back of the free list
    std::uint64_t n_fresh = 0;     ///< beyond it, at the end of all slots
    std::uint64_t n_vertices = 0;  ///< that come
  };

  CutoutRound(Cutout& cutout, const DistributedMesh& parts) : cutout_(cutout), parts_(parts) {}

  std::uint64_t number(VertexHandle v) const override { return cutout_.number(v); }
  std::uint64_t number(CellHandle c) const override { return cutout_.number(c); }
  CellHandle slot(std::uint64_t number) override { return cutout_.add_slot(number); }
  Selected select(std::span<const Candidate> candidates, std::size_t may_lose, std::size_t may_gain,
                  bool check_links) override;
  void finish(std::span<const Commit> commits) override;
  RoundCounts total(RoundCounts mine) override { return mine; }

  /// What all ranks have to know after the round: the cells from which an evaluation has come to the rim, and
  /// where there are none of these, what the round has done.
  Packer said(const RoundCounts& counts) const;

 private:
  /// What of one winner the other ranks need.
  struct Change {
    std::vector<std::uint64_t> removed;
    std::vector<DistributedMesh::VertexRecord> vertices;
    std::vector<DistributedMesh::CellRecord> cells;
    std::vector<LabelRecord> labels;
  };

  std::vector<std::size_t> independent(std::span<const Candidate> candidates, bool check_links) const;

  Cutout& cutout_;
  const DistributedMesh& parts_;
  std::vector<std::uint64_t> met_;  // cells from which an evaluation has come to the rim
  SlotChange slots_;
  std::vector<std::uint64_t> freed_;  // in the order in which they go to the free list
  std::vector<Change> changes_;
};

/// What CutoutRound has said of the round, into this part: each rank takes what lies near its own vertices; a
/// new vertex belongs to the owner of the vertex with the smallest number among its neighbours. Nothing where
/// an evaluation has come to the rim: then the depth of these cells rises. `cells`: ascending. All take part.
std::optional<RoundCounts> follow(DistributedMesh& parts, std::span<const std::byte> said,
                                  std::span<const std::uint64_t> cells, std::span<std::uint8_t> depth);

/// A round of an operator whose clusters grow from cells, over a mesh in parts, with the bits that it has in
/// shared memory. What these cells have round them comes together on rank 0 (see Cutout), which evaluates,
/// selects and commits; where an evaluation comes to the rim, again with more layers. What has changed goes
/// to all ranks.
///
/// `make_op(cutout)`: the operator, with the qualities and the rim of the cutout; called on rank 0. `cells`:
/// numbers, ascending, the same on all ranks. `first_depth`: layers that are tried first, at least 1; the
/// result does not depend on it. All take part.
template <class MakeOp>
RoundCounts round_on_cutout(DistributedMesh& parts, const Ranks::Look& look,
                            std::span<const std::uint64_t> cells, std::uint8_t first_depth,
                            MakeOp&& make_op) {
  std::vector<std::uint8_t> depth(cells.size(), first_depth);
  for (;;) {
    Packer said;
    {
      Cutout cutout(parts, cells, depth);
      if (parts.comm().rank() == 0) {
        const auto op = make_op(cutout);
        using Op = std::remove_const_t<decltype(op)>;
        std::vector<typename Op::Seed> seeds;
        for (std::uint64_t number : cells) seeds.emplace_back(cutout.cell_at(number));
        CutoutRound place(cutout, parts);
        Round<Op> round(cutout.mesh(), cutout.work(), options_of(look, place));
        const RoundCounts counts = round.run(op, seeds);
        said = place.said(counts);
      }
    }
    if (const auto counts = follow(parts, told_by_first(parts.comm(), said), cells, depth)) return *counts;
  }
}

}  // namespace hfr::mpi

#endif
