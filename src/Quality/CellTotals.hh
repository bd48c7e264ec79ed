// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_CELL_TOTALS_HH
#define HFR_QUALITY_CELL_TOTALS_HH

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Quality/EdgeLengths.hh"
#include "Quality/FixedSum.hh"

/// What statistics() gathers in its pass over the cells; internal to this folder.
namespace hfr::detail {

struct RegionTotals {
  std::size_t cells = 0;
  std::size_t inverted = 0;
  std::size_t flat = 0;
  FixedSum det;
  double min_decision = 2.0;
};

/// Totals of a contiguous range of cells. Every member merges exactly, so that the cut does not matter.
struct CellTotals {
  explicit CellTotals(double max_det, double max_length);
  /// Takes in a range that comes after this one.
  void merge(const CellTotals& next);

  std::size_t cells = 0;
  std::size_t boundary_faces = 0;
  std::vector<HalfFaceHandle> constrained;  ///< TetMesh::is_constrained(); ascending
  std::size_t interface_halffaces = 0;
  std::vector<CellHandle> inverted;
  std::vector<CellHandle> flat;
  std::array<std::uint64_t, 36> dihedral_histogram{};
  std::array<std::uint64_t, 71> min_dihedral_histogram{};
  std::array<std::uint64_t, 20> volume_length_histogram{};
  double min_decision = 2.0;  ///< of the smallest dihedral
  double max_decision = 2.0;  ///< of the largest dihedral, inverted cells left out
  CellHandle worst_cell;
  double min_length2 = 0.0;
  double max_length2 = 0.0;
  FixedSum negative_det;  ///< 6V of the inverted cells; that of all is in the regions
  CoarseSum angles;       ///< all six, radians
  CoarseSum min_angles;   ///< the smallest of each cell, radians
  CoarseSum volume_length;
  CoarseSum lengths;
  EdgeLengthBins length_bins;
  std::map<int, RegionTotals> regions;
};

/// Values per cell, at its place among the live cells of the mesh.
struct CellValues {
  std::vector<double> min_dihedral;   ///< decision form
  std::vector<double> volume_length;  ///< decision form
};

/// One pass over the cells. max_det and max_length bound 6|V| and the lengths of edges.
CellTotals gather_cells(const TetMesh& mesh, par::Policy policy, double max_det, double max_length,
                        CellValues& values);

/// Sum over those of `faces` that are boundary of the determinant of their corners about `centre`: six times
/// the enclosed volume.
double boundary_determinant(const TetMesh& mesh, std::span<const HalfFaceHandle> faces, Vec3 centre,
                            double max_det);

}  // namespace hfr::detail

#endif
