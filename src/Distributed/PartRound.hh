// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_ROUND_HH
#define HFR_DISTRIBUTED_PART_ROUND_HH

#include <functional>
#include <span>
#include <tuple>
#include <unordered_set>
#include <utility>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/RoundPlace.hh"

namespace hfr::mpi {

/// The place of a round on one part of a mesh. All ranks run the same round at the same time:
///   PartRound place(mesh);
///   Round<Op> round(mesh.part(), mesh.work(), place.options({...}));
///   round.run(op, seeds of own cells, or own vertices);
/// Each seed of the whole is to be looked at by one rank: an edge by the owner of the smallest listed cell of
/// its ring, a face by that of its smaller listed cell, a vertex by its owner. Commits, slots and ties are
/// those of the round in shared memory, whatever the number of ranks.
///
/// What ranks say to each other: candidates that reach within one edge of a vertex of another rank, then
/// whether they have won, until all have; where links are checked, all candidates to rank 0, and which have
/// won to all; the winners that take or leave slots, to all ranks; what has
/// changed within two edges of another rank's vertices.
class PartRound : public RoundPlace {
 public:
  /// A winner's place in the order of all.
  struct Place {
    std::uint64_t key = 0;
    SeedName name{};
    std::uint64_t seed_number = 0;
    std::uint32_t seed_place = 0;
    bool is_own = false;
    auto order() const { return std::tie(key, name, seed_number, seed_place); }
  };

  explicit PartRound(DistributedMesh& mesh) : mesh_(mesh), comm_(mesh.comm()) {}
  /// tell(places), once what was committed here stands in the part and before handles of vertices become
  /// others: the place of each of the round's winners.
  void when_committed(std::function<void(std::span<const Place>)> tell) { tell_ = std::move(tell); }
  RoundOptions options(RoundOptions options) {
    options.place = this;
    return options;
  }

  std::uint64_t number(VertexHandle v) const override { return mesh_.number(v); }
  std::uint64_t number(CellHandle c) const override { return mesh_.number(c); }
  CellHandle slot(std::uint64_t number) override { return mesh_.slot_of(number); }
  Selected select(const Candidates& candidates, std::size_t may_lose, std::size_t may_gain,
                  bool forbids_twice) override;
  void finish(std::span<const Commit> commits) override;
  RoundCounts total(RoundCounts mine) override;
  /// After cells have come and gone here by DistributedMesh::apply(): brings what is near to others' vertices
  /// now to whom it is, and drops what no longer is. Edges that have come join vertices that were within two
  /// edges of each other; where they may join others, `is_far`: then what is near is found in two steps. All
  /// ranks take part.
  void bring_near(bool is_touched, std::span<const Commit> commits = {}, bool is_far = false);

 private:
  enum class State : std::uint8_t { kUndecided, kWon, kLost };
  static constexpr std::uint32_t kNothing = static_cast<std::uint32_t>(-1);
  /// A candidate as selection sees it: an own one or one that another rank has told of. There are many, and
  /// most are nobody else's concern.
  struct Entry {
    std::uint32_t own = kNothing;    // number among the candidates
    std::uint32_t other = kNothing;  // of own ones in told_, where any rank knows of it; of others in others_
    State state = State::kUndecided;
  };
  struct OfOther {
    std::uint64_t key = 0;
    SeedName name{};
    std::uint64_t seed_number = 0;  // of its cell or vertex
    int home = 0;
    std::uint32_t number_at_home = 0;
    SeedAddress seed;
    std::vector<CellHandle> scope;  // what this rank holds of it
  };
  /// What a winner does to the slots of the whole.
  struct SlotUse {
    std::uint64_t key = 0;
    SeedName name{};
    std::uint32_t n_fresh = 0, n_freed = 0, loss = 0, gain = 0;
  };
  /// A winner that is committed here and lies in the zone, before it is committed.
  struct Pending {
    std::size_t winner = 0;
    std::vector<VertexHandle> vertices;  // of its scope
    RankSet receivers{0};                // ranks that hold cells of it, as far as this rank answers for it
  };

  struct Heard {
    bool is_anyone_told = false;  ///< any rank has told another of a candidate
    bool makes_any = false;       ///< something that may be made once, a candidate of any rank
  };
  Heard announce();
  void hear(const Comm::Message& message);
  void decide(bool is_anyone_told);
  void decide_on_first();
  void sweep();
  static bool is_own(const Entry& entry) { return entry.own != kNothing; }
  std::uint64_t key(const Entry& entry) const {
    return is_own(entry) ? candidates_->key(entry.own) : others_[entry.other].key;
  }
  SeedName name(const Entry& entry) const {
    return is_own(entry) ? candidates_->name(entry.own) : others_[entry.other].name;
  }
  SeedAddress seed(const Entry& entry) const {
    return is_own(entry) ? candidates_->seed(entry.own) : others_[entry.other].seed;
  }
  std::uint64_t seed_number(const Entry& entry) const;
  std::span<const CellHandle> scope(const Entry& entry) const {
    return is_own(entry) ? candidates_->scope(entry.own) : others_[entry.other].scope;
  }
  /// By key, then name, then seed. Two seeds may have one name where both find the same: then the first in
  /// the order of numbers comes first, as it does where all cells are in one mesh.
  bool is_before(const Entry& a, const Entry& b) const;
  std::uint64_t tell_decisions(std::uint64_t n_left);
  struct Uses {
    std::vector<SlotUse> uses;
    std::vector<std::uint64_t> freed;
  };
  Uses gather_uses(std::span<const SlotUse> mine, std::span<const std::uint64_t> freed);
  std::size_t hand_out_slots(std::size_t may_lose, std::size_t may_gain, std::vector<Winner>& winners);
  void note_pending(std::size_t winner, const Entry& entry);
  /// What one rank tells another of cells.
  struct Push {
    std::vector<std::uint64_t> removed;
    std::vector<CellHandle> cells;
    std::vector<VertexHandle> vertices;
  };
  /// body(push) for each other rank in the set.
  template <class Body>
  void for_others(std::span<const std::uint64_t> set, std::vector<Push>& pushes, Body&& body) const {
    for_ranks(set, [&](int r) {
      if (r != comm_.rank()) body(pushes[static_cast<std::size_t>(r)]);
    });
  }
  std::vector<Push> changed_cells(std::span<const Commit> commits) const;
  std::vector<Push> new_cells() const;
  struct Outcome {
    bool has_come = false;        ///< something, to this rank
    bool is_any_touched = false;  ///< the zone of some rank
  };
  Outcome exchange(std::vector<Push>&& pushes, std::span<const Commit> commits, bool is_touched);

  DistributedMesh& mesh_;
  Comm& comm_;
  const Candidates* candidates_ = nullptr;  // while select() lasts
  std::vector<Entry> entries_;              // in the order of is_before()
  std::vector<RankSet> told_;               // of own candidates: ranks that know of it
  std::vector<OfOther> others_;
  std::vector<std::vector<std::uint64_t>> made_;  // by own candidates, where nothing may be made twice
  std::vector<std::uint32_t> undecided_;
  std::vector<Pending> pending_;
  std::function<void(std::span<const Place>)> tell_;
  std::vector<Place> places_;           // where somebody is to be told
  std::vector<std::uint64_t> dropped_;  // entries given up for the number of cells
  std::size_t sub_rounds_ = 0;
};

}  // namespace hfr::mpi

#endif
