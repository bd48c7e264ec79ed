// SPDX-License-Identifier: BSD-3-Clause
#include "PrintFigures.hh"

#include <algorithm>
#include <cstdio>

void hfr::app::print_figures(std::span<const hfr::mpi::RankFigures> ranks) {
  using hfr::mpi::Traffic;
  const auto n = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    Traffic sum;
    for (const Traffic& one : ranks[r].traffic) sum += one;
    std::fprintf(
        stderr,
        "hfremesh-mpi: rank %zu: sent %llu messages of %llu bytes in %llu exchanges, %llu collectives of "
        "%llu bytes; %llu rounds; part: %llu own cells, %llu held, %llu near others; peak memory %llu "
        "bytes; %llu vertices borrowed for the run\n",
        r, n(sum.messages), n(sum.bytes), n(sum.exchanges), n(sum.collectives), n(sum.collective_bytes),
        n(ranks[r].n_rounds), n(ranks[r].n_own), n(ranks[r].n_held), n(ranks[r].n_border),
        n(ranks[r].peak_bytes), n(ranks[r].n_borrowed));
  }
  for (std::size_t p = 0; p < hfr::mpi::kPhaseNames.size(); ++p) {
    double slowest = 0;
    Traffic most;
    for (const auto& rank : ranks) {
      slowest = std::max(slowest, rank.seconds[p]);
      most.messages = std::max(most.messages, rank.traffic[p].messages);
      most.bytes = std::max(most.bytes, rank.traffic[p].bytes);
      most.exchanges = std::max(most.exchanges, rank.traffic[p].exchanges + rank.traffic[p].collectives);
      most.collective_bytes = std::max(most.collective_bytes, rank.traffic[p].collective_bytes);
    }
    std::fprintf(
        stderr,
        "hfremesh-mpi: phase %s: %.3f s on rank 0, %.3f s on the slowest; of a rank at most %llu messages "
        "of %llu bytes, %llu bytes to all, %llu calls\n",
        hfr::mpi::kPhaseNames[p], ranks[0].seconds[p], slowest, n(most.messages), n(most.bytes),
        n(most.collective_bytes), n(most.exchanges));
  }
}
