// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartSearch.hh"

#include <algorithm>
#include <span>
#include <vector>

#include "Distributed/CutoutRound.hh"
#include "Operators/ClusterSearch.hh"

namespace hfr::mpi {
namespace {

/// Own cells of the lists of all ranks, by number, on each of them.
std::vector<std::uint64_t> listed_by_all(const DistributedMesh& parts, const Worklist& list) {
  std::vector<std::uint64_t> own;
  for (Index i : list.cells())
    if (const CellHandle c(i); parts.is_own(c)) own.push_back(parts.number(c));
  std::vector<std::uint64_t> all = parts.comm().all_gather(std::span<const std::uint64_t>(own));
  std::ranges::sort(all);
  return all;
}

template <class M>
RoundCounts search_clusters(DistributedMesh& parts, const Ranks::Search& search,
                            std::span<const std::uint64_t> cells, std::uint8_t depth, const M& metric) {
  return round_on_cutout(parts, search.look, cells, depth, [&](Cutout& cutout) {
    return ClusterSearch<M>{metric,
                            cutout.work().quality,
                            search.gain,
                            static_cast<std::size_t>(search.max_points),
                            static_cast<std::size_t>(search.max_nodes),
                            &cutout.rim()};
  });
}

}  // namespace

RoundCounts search_in_parts(DistributedMesh& parts, const Ranks::Search& search, const Worklist& list,
                            std::uint8_t depth) {
  const std::vector<std::uint64_t> cells = listed_by_all(parts, list);
  if (cells.empty()) return {};
  return with_metric(
      search.look, [&](const auto& metric) { return search_clusters(parts, search, cells, depth, metric); });
}

}  // namespace hfr::mpi
