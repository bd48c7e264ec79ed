// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_OVERLAPS_HH
#define HFR_TRANSFER_OVERLAPS_HH

#include <cstddef>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Transfer/Edits.hh"
#include "Transfer/SharedVolume.hh"

namespace hfr {

/// A part of a new cell that an old one covers: its volume, negative where the old cell was inverted.
struct Overlap {
  CellHandle old_cell;
  double volume = 0;
};

/// For each of some new cells the old ones that it shares volume with, by ascending handle.
struct Overlaps {
  std::vector<std::size_t> first;  ///< n + 1 of them
  std::vector<Overlap> parts;

  std::span<const Overlap> of(std::size_t i) const {
    return {parts.data() + first[i], parts.data() + first[i + 1]};
  }
};

/// A cell of the mesh as it is.
struct NewCell {
  std::array<VertexHandle, 4> vertices;
  TetPoints points;
};
std::vector<NewCell> shapes_of(const TetMesh& now, std::span<const CellHandle> cells);

/// Between the new cells that are given and the old ones, ascending, that are where they are. The old cells
/// are found from the old vertices of a new cell on, from half-face to half-face; where what is found does
/// not cover the cell, among all that are given. `edits`: its maps and created vertices.
Overlaps find_overlaps(const TetMesh& old, const Edits& edits, std::span<const NewCell> new_cells,
                       std::span<const CellHandle> old_cells, par::Policy policy);

/// Old cells that the new ones of the edits may cover: those that are gone, and those with a vertex that has
/// moved. Ascending.
std::vector<CellHandle> changed_old_cells(const Edits& edits);
/// New cells that are created or have a vertex that has moved. Ascending.
std::vector<CellHandle> changed_new_cells(const Edits& edits);

}  // namespace hfr

#endif
