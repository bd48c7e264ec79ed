// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/RankFigures.hh"

#ifdef __unix__
#include <sys/resource.h>
#endif

#include <span>

#include "Distributed/DistributedMesh.hh"

namespace hfr::mpi {

std::uint64_t peak_bytes() {
#ifdef __unix__
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
#endif
  return 0;
}

void look_at_part(const DistributedMesh& mesh, RankFigures& figures) {
  const TetMesh& part = mesh.part();
  figures.n_held = part.n_cells();
  figures.n_border = mesh.zone().size();
  figures.n_own = 0;
  for (std::size_t c = 0; c < part.n_cells(); ++c)
    if (!part.is_deleted(CellHandle(c)) && mesh.is_own(CellHandle(c))) ++figures.n_own;
}

std::vector<RankFigures> gather_figures(Comm& comm, RankFigures mine) {
  mine.traffic = comm.traffic();
  mine.seconds = comm.seconds();
  mine.peak_bytes = peak_bytes();
  return comm.all_gather(std::span<const RankFigures>(&mine, 1));
}

}  // namespace hfr::mpi
