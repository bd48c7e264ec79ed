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

namespace hfr::mpi {

/// Marks the own vertices of each rank that few enough edges lead to from some cells. Each step goes one edge
/// further; what it comes to of other ranks is told to them.
class Spread {
 public:
  explicit Spread(const DistributedMesh& parts) : parts_(parts), to_(parts.comm().n_ranks()) {}

  void begin(CellHandle c, std::uint32_t depth) {
    for (VertexHandle v : parts_.part().cell(c).v) reach(v, depth);
  }
  void run() {
    for (bool is_done = false; !is_done;) {
      const Comm::Exchanged came = parts_.comm().exchange(to_, next_.size());
      to_.assign(parts_.comm().n_ranks(), {});
      for (const Comm::Message& message : came.messages)
        for (Unpacker in(message.bytes); !in.at_end();) {
          const auto told = in.get<Told>();
          reach(parts_.vertex_at(told.number), told.left);
        }
      is_done = came.sum + came.n_messages == 0;
      for (VertexHandle v : std::exchange(next_, {})) go_on_from(v);
    }
  }
  /// Ascending.
  std::vector<VertexHandle> own() const {
    std::vector<VertexHandle> vertices;
    for (const auto& [v, left] : left_)
      if (parts_.is_own(VertexHandle(v))) vertices.push_back(VertexHandle(v));
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  }

 private:
  struct Told {
    std::uint64_t number = 0;
    std::uint32_t left = 0;
  };

  void reach(VertexHandle v, std::uint32_t left) {
    const auto [at, is_first] = left_.emplace(v.idx(), left);
    if (!is_first && at->second >= left) return;
    at->second = left;
    if (parts_.is_own(v))
      next_.push_back(v);
    else
      to_[static_cast<std::size_t>(parts_.owner(v))].put(Told{parts_.number(v), left});
  }
  void go_on_from(VertexHandle v) {
    const std::uint32_t left = left_.at(v.idx());
    if (left == 0) return;
    for (CellHandle c : parts_.part().vertex_cells(v))
      for (VertexHandle u : parts_.part().cell(c).v) reach(u, static_cast<std::uint32_t>(left - 1));
  }

  const DistributedMesh& parts_;
  std::unordered_map<Index, std::uint32_t> left_;  // edges to go, by vertex
  std::vector<VertexHandle> next_;                 // own ones to go on from
  std::vector<Packer> to_;
};

}  // namespace hfr::mpi

#endif
