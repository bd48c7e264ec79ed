// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_ROUND_PLACE_HH
#define HFR_SCHEDULER_ROUND_PLACE_HH

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"
#include "Scheduler/Rank.hh"
#include "Scheduler/SeedAddress.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

/// What a round asks whoever holds the rest of a mesh that is cut into parts: the mesh of the round is one of
/// them, and its seeds are those of this part. All parts run the round at the same time. Numbers are those
/// of the whole mesh; handles and numbers of vertices have the same order.
class RoundPlace {
 public:
  /// Those of this part, which come in the order of their keys, then of their names: there are many, so
  /// what is asked of one is made when it is asked.
  class Candidates {
   public:
    virtual ~Candidates() = default;
    virtual std::size_t size() const = 0;
    virtual std::uint64_t key(std::size_t i) const = 0;
    virtual SeedName name(std::size_t i) const = 0;
    virtual SeedAddress seed(std::size_t i) const = 0;
    virtual const PlanBase& plan(std::size_t i) const = 0;
    virtual std::span<const CellHandle> scope(std::size_t i) const = 0;
    /// Hashes of the edges and faces that it would make, where nothing may be made twice.
    virtual std::vector<std::uint64_t> made(std::size_t i) const = 0;
  };
  /// What has to be committed here: all winners, of any part, that lie near a vertex of this one.
  struct Winner {
    static constexpr std::size_t kOfOthers = static_cast<std::size_t>(-1);
    std::size_t candidate = kOfOthers;  ///< of this part's candidates
    SeedAddress seed;
    /// Numbers of the slots beyond those of its removed cells, in the order of use.
    std::vector<std::uint64_t> fresh;
  };
  struct Selected {
    std::vector<Winner> winners;  ///< ascending by key, then by name
    std::size_t held_back = 0;    ///< over all parts
  };
  /// What was committed: the cells that went, in the order of the scope, and those that came.
  struct Commit {
    std::span<const CellHandle> removed, created;
    VertexHandle removed_vertex;
  };

  virtual ~RoundPlace() = default;
  virtual std::uint64_t number(VertexHandle v) const = 0;
  virtual std::uint64_t number(CellHandle c) const = 0;
  /// The slot of that number; adds it to the mesh where this part has none.
  virtual CellHandle slot(std::uint64_t number) = 0;
  /// The first independent set over all parts, within the bounds on cells of the whole. `forbids_twice`: no
  /// two winners make the same edge or face; a candidate that would is refused when its turn comes.
  virtual Selected select(const Candidates& candidates, std::size_t may_lose, std::size_t may_gain,
                          bool forbids_twice) = 0;
  /// After the winners were committed, in their order: brings what this part holds of others up to date.
  virtual void finish(std::span<const Commit> commits) = 0;
  /// Of the counts of all parts the sum.
  virtual RoundCounts total(RoundCounts mine) = 0;
};

}  // namespace hfr

#endif
