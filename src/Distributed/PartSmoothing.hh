// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_SMOOTHING_HH
#define HFR_DISTRIBUTED_PART_SMOOTHING_HH

#include <algorithm>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Scheduler/SmoothPass.hh"

namespace hfr::mpi {

/// What a smoothing pass over the parts of a mesh has to agree about: colours, and who has moved where.
class PartSmoothing {
 public:
  /// `vertices`: those of the pass that this part knows of, ascending: all within one edge of own vertices.
  PartSmoothing(DistributedMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy);

  /// Own vertices of the pass by colour, as many groups on each rank: those of colour_vertices(), which are
  /// the first fit in the order of numbers, and one each for what would need a 64th colour.
  std::vector<std::vector<VertexHandle>> colour_groups();
  /// Half-faces opposite an own vertex of the pass, in the order of the numbers of their cells.
  std::span<const HalfFaceHandle> link(VertexHandle own) const;

  struct MovedVertex {
    std::uint64_t number = 0;
    Vec3 point;
  };
  /// A vertex of another rank: where it is now, and the half-faces opposite it in the cells that are held
  /// here.
  struct Come {
    VertexHandle vertex;
    Vec3 point;
    std::span<const HalfFaceHandle> link;
  };
  /// Tells the ranks that hold them of own vertices that have moved; returns what came from others and is
  /// held here. The first time that something comes: O(zone).
  std::vector<Come> tell(std::span<const VertexHandle> moved);
  /// The same without half-faces.
  std::vector<Come> tell_points(std::span<const VertexHandle> moved);

 private:
  class Ready;

  std::uint8_t first_fit(VertexHandle v) const;
  void find_links_of_others();

  DistributedMesh& mesh_;
  std::vector<VertexHandle> own_;
  std::vector<Index> place_;          // of own ones in own_, by vertex of the part
  std::vector<std::uint8_t> colour_;  // by vertex of the part
  std::vector<std::size_t> begin_;    // by own_
  std::vector<HalfFaceHandle> links_;
  std::vector<std::uint32_t> begin_of_other_;  // by vertex of the part, none before they are needed
  std::vector<HalfFaceHandle> links_of_others_;
};

/// smooth_pass() over the parts of a mesh, with the same moves. Counts are those of the whole.
template <class Search, class Metric>
RoundCounts smooth_parts(DistributedMesh& parts, const Search& search, const Metric& metric,
                         std::span<const VertexHandle> vertices, par::Policy policy) {
  TetMesh& mesh = parts.part();
  Workspace& work = parts.work();
  RoundCounts counts;
  counts.rounds = 1;
  ++work.clock;
  PartSmoothing pass(parts, vertices, policy);
  const par::Policy by_cost = policy.for_items_of(vertex_nanoseconds<Search>());
  std::vector<CellHandle> cells;
  const auto touch = [&](std::span<const HalfFaceHandle> link) {
    cells.clear();
    for (HalfFaceHandle h : link) cells.push_back(cell_of(h));
    work.touch(cells);
  };
  for (const auto& group : pass.colour_groups()) {
    std::vector<std::uint8_t> has_moved(group.size(), 0);
    par::for_each_dynamic(by_cost, group.size(), 1, [&](std::size_t k) {
      const VertexHandle v = group[k];
      const auto link = pass.link(v);
      const std::optional<Move> move = search(mesh, v, link, metric, std::span<const double>(work.quality));
      if (!move) return;
      if (!(move->old_worst > 0) && worsens_damage(mesh, work, metric, v, link, move->target)) return;
      move_vertex(mesh, work, metric, v, link, move->target);
      has_moved[k] = 1;
    });
    std::vector<VertexHandle> moved;
    for (std::size_t k = 0; k < group.size(); ++k)
      if (has_moved[k]) moved.push_back(group[k]);
    for (VertexHandle v : moved) touch(pass.link(v));
    for (const PartSmoothing::Come& one : pass.tell(moved)) {
      move_vertex(mesh, work, metric, one.vertex, one.link, one.point);
      touch(one.link);
    }
    counts.winners += moved.size();
  }
  for (VertexHandle v : vertices) counts.seeds += parts.is_own(v) ? 1 : 0;
  std::array<std::uint64_t, 2> sums = {counts.seeds, counts.winners};
  parts.comm().sum(sums);
  counts.seeds = static_cast<std::size_t>(sums[0]);
  counts.winners = counts.candidates = static_cast<std::size_t>(sums[1]);
  return counts;
}

}  // namespace hfr::mpi

#endif
