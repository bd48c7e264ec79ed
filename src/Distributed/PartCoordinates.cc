// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartCoordinates.hh"

#include <algorithm>
#include <span>
#include <vector>

#include "Distributed/OwnItems.hh"
#include "Remesh/Coordinates.hh"

namespace hfr::mpi {

void require_sound_coordinates(DistributedMesh& mesh, par::Policy policy) {
  const auto n_cells = static_cast<std::size_t>(mesh.n_cells());
  if (n_cells == 0) return;
  const TetMesh& part = mesh.part();
  const CoordinateBox mine = coordinate_box(part, policy);
  const std::vector<CoordinateBox> boxes = mesh.comm().all_gather(std::span(&mine, 1));
  CoordinateBox all = boxes.front();
  for (const CoordinateBox& box : boxes) all = joined(all, box);
  hfr::require_sound_coordinates(all, n_cells, [&](double least) {
    const std::vector<CellHandle> own = own_cells(mesh);
    const auto n = std::ranges::count_if(own, [&](CellHandle c) { return longest_edge(part, c) < least; });
    return static_cast<std::size_t>(mesh.comm().sum(static_cast<std::uint64_t>(n)));
  });
}

}  // namespace hfr::mpi
