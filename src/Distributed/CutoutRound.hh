// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_CUTOUT_ROUND_HH
#define HFR_DISTRIBUTED_CUTOUT_ROUND_HH

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "Distributed/Cutout.hh"
#include "Distributed/DistributedMesh.hh"
#include "Distributed/LookOptions.hh"
#include "Remesh/Ranks.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/RoundPlace.hh"

namespace hfr::mpi {

/// What is done to the slots and vertices of the whole.
struct SlotChange {
  std::uint64_t n_taken = 0;     ///< from the back of the free list
  std::uint64_t n_fresh = 0;     ///< beyond it, at the end of all slots
  std::uint64_t n_vertices = 0;  ///< that come
  std::uint64_t n_held_back = 0;
};
/// On every rank. `freed`: in the order in which they go to the free list.
void change_slots(DistributedMesh& parts, const SlotChange& slots, std::span<const std::uint64_t> freed);

/// What of a change lies near a part.
struct NearChange {
  std::vector<CellHandle> gone;
  std::vector<std::uint64_t> deleted;  ///< vertices
  DistributedMesh::Records come;

  /// The cells of these numbers go that the part has; false where it has none: whose vertices have one of the
  /// cells that stand for them has one of these.
  bool remove(const DistributedMesh& parts, std::span<const std::uint64_t> numbers);
};
/// Into the part, and then what has come near it by that. All take part.
void write_home(DistributedMesh& parts, const NearChange& change);

/// The place of a round on cutouts, one on each rank: seeds are evaluated, and winners committed, where they
/// are. Slots and new vertices are those of the whole. What lies near a winner of another rank is not brought
/// up to date here, but in the parts, by bring_home(). All ranks take part in what all of them are asked for.
class CutoutRound : public RoundPlace {
 public:
  CutoutRound(Cutout& cutout, DistributedMesh& parts) : cutout_(cutout), parts_(parts) {}

  std::uint64_t number(VertexHandle v) const override { return cutout_.number(v); }
  std::uint64_t number(CellHandle c) const override { return cutout_.number(c); }
  CellHandle slot(std::uint64_t number) override { return cutout_.add_slot(number); }
  /// None where an evaluation has come to the rim of a cutout: then the round is void.
  Selected select(const Candidates& candidates, std::size_t may_lose, std::size_t may_gain,
                  bool forbids_twice) override;
  void finish(std::span<const Commit> commits) override;
  RoundCounts total(RoundCounts mine) override;

  /// Of all ranks the cells from which an evaluation has come to the rim.
  const std::vector<std::uint64_t>& met() const { return met_; }
  /// Of each of this rank's winners its place among those of all.
  std::span<const std::uint64_t> order() const { return order_; }
  /// What the winners of all ranks have changed, into this part, unless the round is void: each rank takes
  /// what lies near its own vertices. A new vertex belongs to the owner of the vertex with the smallest
  /// number among its neighbours.
  void bring_home();

 private:
  using VertexRecord = DistributedMesh::VertexRecord;

  /// A vertex of a cell that a winner has made.
  struct Touched {
    VertexRecord record;
    std::uint32_t star_before = 0;  ///< 0 where it is new
  };
  struct Heard {
    Touched touched;
    int rank = 0;  ///< that has said it
  };
  /// What of one winner the other ranks need.
  struct Change {
    std::vector<std::uint64_t> removed, deleted;  // cells; a vertex
    std::vector<Touched> vertices;
    std::vector<DistributedMesh::CellRecord> cells;
    std::vector<LabelRecord> labels;
  };
  struct Contender;
  struct Prize;

  void decide(std::vector<Contender>& all, std::size_t may_lose, std::size_t may_gain, bool forbids_twice,
              std::vector<std::vector<Prize>>& prizes);
  static std::vector<VertexRecord> merged(std::vector<Heard> all);

  Cutout& cutout_;
  DistributedMesh& parts_;
  std::vector<std::uint64_t> met_, order_;
  bool has_candidates_ = false;  // on any rank
  SlotChange slots_;
  std::vector<std::uint64_t> freed_;  // in the order in which they go to the free list
  std::vector<Change> changes_;       // of this rank's winners
};

/// More layers round the cells from which an evaluation has come to the rim. `cells`, `met`: ascending.
void deepen(std::span<const std::uint64_t> cells, std::span<const std::uint64_t> met,
            std::span<std::uint8_t> depth);

/// A round of an operator whose clusters grow from cells, over a mesh in parts, with the bits that it has in
/// shared memory. What the cells of a rank have round them comes together there (see Cutout), where they are
/// evaluated; rank 0 selects among the candidates of all; each rank commits its own winners, and what has
/// changed goes to all. Where an evaluation comes to the rim, all of it is done again with more layers.
///
/// `make_op(cutout)`: the operator, with the qualities and the rim of the cutout. `cells`: numbers,
/// ascending, the same on all ranks. `first_depth`: layers that are tried first, at least 1; the result does
/// not depend on it. `make_seeds(cutout)`: those of its centres. `tell(cutout, round, order)`: before the
/// parts know of what this rank's winners have changed, once; see CutoutRound::order(). All take part.
template <class MakeOp, class MakeSeeds, class Tell>
RoundCounts round_on_cutout(DistributedMesh& parts, const Ranks::Look& look,
                            std::span<const std::uint64_t> cells, std::uint8_t first_depth, MakeOp&& make_op,
                            MakeSeeds&& make_seeds, Tell&& tell) {
  std::vector<std::uint8_t> depth(cells.size(), first_depth);
  for (;;) {
    Cutout cutout(parts, cells, depth);
    const auto op = make_op(cutout);
    using Op = std::remove_const_t<decltype(op)>;
    CutoutRound place(cutout, parts);
    Round<Op> round(cutout.mesh(), cutout.work(), options_of(look, place));
    const std::vector<typename Op::Seed> seeds = make_seeds(cutout);
    const RoundCounts counts = round.run(op, seeds);
    if (place.met().empty()) tell(cutout, round, place.order());
    place.bring_home();
    if (place.met().empty()) return counts;
    deepen(cells, place.met(), depth);
  }
}

/// The same of operators whose seeds are cells.
template <class MakeOp>
RoundCounts round_on_cutout(DistributedMesh& parts, const Ranks::Look& look,
                            std::span<const std::uint64_t> cells, std::uint8_t first_depth,
                            MakeOp&& make_op) {
  using Seed = typename std::invoke_result_t<MakeOp&, Cutout&>::Seed;
  return round_on_cutout(
      parts, look, cells, first_depth, make_op,
      [](const Cutout& cutout) {
        std::vector<Seed> seeds;
        for (std::uint64_t number : cutout.centres()) seeds.emplace_back(cutout.cell_at(number));
        return seeds;
      },
      [](const Cutout&, const auto&, std::span<const std::uint64_t>) {});
}

}  // namespace hfr::mpi

#endif
