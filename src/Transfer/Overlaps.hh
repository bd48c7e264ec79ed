// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_OVERLAPS_HH
#define HFR_TRANSFER_OVERLAPS_HH

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
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
  /// What old cells are looked for from: the old vertex near each corner, and the old cell that this lies in
  /// where it has moved or is new. May be invalid.
  std::array<VertexHandle, 4> near{};
  std::array<CellHandle, 4> places{};
};
std::vector<NewCell> shapes_of(const TetMesh& now, const Edits& edits, std::span<const CellHandle> cells);
/// Sets `near` and `places`.
void add_starts(const Edits& edits, std::span<NewCell> cells);

/// Between the new cells that are given and the old ones, ascending, that are where they are. The old cells
/// are found from what lies near a new cell's corners on, from half-face to half-face; where what is found
/// does not cover the cell, among all that are given. An old cell counts for nothing where its box does not
/// meet that of the new one: so those that do are all that the result hangs on.
Overlaps find_overlaps(const TetMesh& old, std::span<const NewCell> new_cells,
                       std::span<const CellHandle> old_cells, par::Policy policy);

/// By new cell: where no old one covers it, an old cell near it, that with the smallest handle round the
/// smallest of the old vertices near its corners; invalid where there is none, and of other cells.
/// shapes(places): of those new cells, by their places among the overlaps; not called where all are covered.
std::vector<CellHandle> old_cells_beside(
    const TetMesh& old, const Overlaps& overlaps, par::Policy policy,
    const std::function<std::vector<NewCell>(std::span<const std::size_t>)>& shapes);

/// The largest share first; of equal ones the smaller handle.
Parents parents_of(std::span<const NewCell> cells, const Overlaps& overlaps, par::Policy policy);
/// Those that the parents of created cells were made of, by entry of created_cells; nullptr: there are no
/// parents.
const Overlaps* overlaps_of_created(const Edits& edits);

/// Old cells that the new ones of the edits may cover: those that are gone, and those with a vertex that has
/// moved. Ascending.
std::vector<CellHandle> changed_old_cells(const Edits& edits);
/// New cells that are created or have a vertex that has moved. Ascending.
std::vector<CellHandle> changed_new_cells(const Edits& edits);

}  // namespace hfr

#endif
