// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_REORDER_HH
#define HFR_HALFFACE_REORDER_HH

#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr {

/// A curve that fills a box; what is near on it is near in space.
enum class SpaceCurve {
  kHilbert,  ///< consecutive places are neighbours
  kMorton    ///< bits of the coordinates interleaved: quicker to compute, with jumps
};

struct ReorderOptions {
  SpaceCurve curve = SpaceCurve::kHilbert;
  bool vertices = true;  ///< false: vertices keep their order, and only cells are renumbered
  par::Policy policy = {};
};

/// Renumbers vertices along the curve and cells by where their centres are on it, so that what is near in
/// space is near in memory; deleted vertices and cells go. Labels, properties, regions and status follow.
/// Returns where each vertex and cell went. Ties keep the old order, so the result depends on mesh and curve
/// alone.
GarbageMap reorder(TetMesh& mesh, const ReorderOptions& options = {});

/// Gives cells the handles 0, 1, 2, … in this order, which names each of a mesh without deleted cells and
/// vertices once. Everything follows as in reorder(). Throws InvalidInput for another number of cells, or one
/// that is not there.
void order_cells(TetMesh& mesh, std::span<const CellHandle> order, par::Policy policy = {});

/// Puts cells back into the order that they had before a reorder() of cells alone; `went_to` as that returned
/// it. Needs that no cell was made or deleted since.
void restore_cell_order(TetMesh& mesh, std::span<const CellHandle> went_to, par::Policy policy = {});

/// True when walks over the mesh would often miss the cache: more than an eighth of the neighbours of
/// cells are kFarInOrder or more cells away.
bool is_scattered(const TetMesh& mesh, par::Policy policy = {});
/// Cell records: half a mebibyte, besides what else a walk reads.
inline constexpr std::size_t kFarInOrder = 16384;
/// The same of a mesh of so many cells, n_far of the neighbours of which are that far away.
inline bool is_scattered(std::size_t n_far, std::size_t n_cells) {
  return n_cells > kFarInOrder && n_far > n_cells / 2;
}

/// Place on the curve of the point whose coordinates are x, y, z: 21 bits each.
std::uint64_t curve_place(SpaceCurve curve, std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// The box from low to high as a grid of 2^21 places along its longest side.
class CurveGrid {
 public:
  CurveGrid(SpaceCurve curve, Vec3 low, Vec3 high);
  /// Place on the curve of a point of the box.
  std::uint64_t place(Vec3 p) const;
  /// Of the centre of a cell.
  std::uint64_t place(const TetMesh& mesh, CellHandle c) const;

 private:
  SpaceCurve curve_;
  Vec3 low_;
  double scale_ = 0;
};

}  // namespace hfr

#endif
