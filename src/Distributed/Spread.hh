// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_SPREAD_HH
#define HFR_DISTRIBUTED_SPREAD_HH

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "Distributed/Buffer.hh"
#include "Distributed/DistributedMesh.hh"
#include "Distributed/WholeStars.hh"
#include "HalfFace/Errors.hh"

namespace hfr::mpi {

/// Marks the own vertices of each rank that few enough edges lead to from some cells, for each rank that
/// asks. Each step goes one edge further; what it comes to of other ranks is told to them.
class Spread {
 public:
  /// What a step goes along: the cells that a walk round a vertex sees, which for a pinched one depends on
  /// its incident cell, or all of them.
  enum class Stars : std::uint8_t { kWalked, kWhole };

  static constexpr int kDeepest = 254;

  /// `whom`: the rank that begin() marks for on this one; its own, or the same on all.
  Spread(const DistributedMesh& parts, Stars kind, int whom)
      : parts_(parts),
        kind_(kind),
        whom_(whom),
        stars_(parts.part(), parts.work()),
        mine_(parts.vertex_marks()),
        to_(parts.comm().n_ranks()) {
    if (!mine_.is_empty()) throw InternalError("two spread over one part at the same time");
  }
  ~Spread() { mine_.clear(); }
  Spread(const Spread&) = delete;
  Spread& operator=(const Spread&) = delete;

  /// kDeepest at most.
  void begin(CellHandle c, std::uint32_t depth) {
    for (VertexHandle v : parts_.part().cell(c).v) reach({v, whom_}, depth);
  }
  /// Each rank goes as far as it comes by itself before it asks others.
  void run() {
    for (bool is_done = false; !is_done;) {
      while (!next_.empty())
        for (const Mark& mark : std::exchange(next_, {})) go_on_from(mark);
      const Comm::Exchanged came = parts_.comm().exchange(to_, 0);
      to_.assign(parts_.comm().n_ranks(), {});
      for (const Comm::Message& message : came.messages)
        for (Unpacker in(message.bytes); !in.at_end();) {
          const auto told = in.get<Told>();
          reach({parts_.vertex_at(told.number), told.for_whom}, told.left);
        }
      is_done = came.n_messages == 0;
    }
  }
  /// By the rank that they are marked for, ascending; the marks go.
  std::vector<std::vector<VertexHandle>> take_own() {
    std::vector<std::vector<VertexHandle>> vertices(parts_.comm().n_ranks());
    for (const auto& [key, left] : of_others_)
      if (const Mark mark = mark_of(key); parts_.is_own(mark.v))
        vertices[static_cast<std::size_t>(mark.for_whom)].push_back(mark.v);
    for (auto& of_rank : vertices) std::sort(of_rank.begin(), of_rank.end());
    auto& mine = vertices[static_cast<std::size_t>(whom_)];
    mine = mine_.take<VertexHandle>();
    std::erase_if(mine, [&](VertexHandle v) { return !parts_.is_own(v); });
    return vertices;
  }

 private:
  struct Mark {
    VertexHandle v;
    int for_whom = 0;
  };
  struct Told {
    std::uint64_t number = 0;
    std::uint32_t left = 0;
    std::int32_t for_whom = 0;
  };
  std::uint64_t key_of(const Mark& mark) const {
    return mark.v.idx() * static_cast<std::uint64_t>(to_.size()) + static_cast<std::uint64_t>(mark.for_whom);
  }
  Mark mark_of(std::uint64_t key) const {
    return {VertexHandle(static_cast<Index>(key / to_.size())), static_cast<int>(key % to_.size())};
  }

  /// Edges to go, and one more; 0 where it was not reached.
  std::uint32_t more_than_left(const Mark& mark) const {
    if (mark.for_whom == whom_) return mine_[mark.v.idx()];
    const auto at = of_others_.find(key_of(mark));
    return at == of_others_.end() ? 0 : at->second;
  }
  void reach(const Mark& mark, std::uint32_t left) {
    if (more_than_left(mark) > left) return;
    if (mark.for_whom == whom_)
      mine_.set(mark.v.idx(), static_cast<std::uint8_t>(left + 1));
    else
      of_others_[key_of(mark)] = left + 1;
    if (parts_.is_own(mark.v))
      next_.push_back(mark);
    else
      to_[static_cast<std::size_t>(parts_.owner(mark.v))].put(
          Told{parts_.number(mark.v), left, mark.for_whom});
  }
  void go_on_from(const Mark& mark) {
    const std::uint32_t left = more_than_left(mark) - 1;
    if (left == 0) return;
    const auto go_through = [&](CellHandle c) {
      for (VertexHandle u : parts_.part().cell(c).v) reach({u, mark.for_whom}, left - 1);
    };
    if (kind_ == Stars::kWhole)
      stars_.for_cells(mark.v, go_through);
    else
      for (CellHandle c : parts_.part().vertex_cells(mark.v)) go_through(c);
  }

  const DistributedMesh& parts_;
  Stars kind_;
  int whom_;
  WholeStars stars_;
  Marks& mine_;  // for whom_, by vertex: edges to go, and one more
  std::unordered_map<std::uint64_t, std::uint32_t> of_others_;  // the same, by vertex and rank
  std::vector<Mark> next_;                                      // own ones to go on from
  std::vector<Packer> to_;
};

}  // namespace hfr::mpi

#endif
