// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_STATISTICS_HH
#define HFR_QUALITY_STATISTICS_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/Vec3.hh"
#include "hfremesh/Parallel/Policy.hh"

namespace hfr {

class TetMesh;

/// Percentages at which a Distribution is given.
inline constexpr std::array<double, 9> kPercentiles = {0.1, 1, 5, 25, 50, 75, 95, 99, 100};

/// One value a cell, inverted and flat cells included. A percentile p is the smallest value that at least p %
/// of the cells do not exceed (nearest rank). All 0 when there is no cell.
struct Distribution {
  std::array<double, kPercentiles.size()> percentiles{};
  double min = 0.0;
  double mean = 0.0;
  double max = 0.0;
};

/// The angle that cells fill at an edge between two faces that may not change.
struct EdgeWedge {
  double degrees = 360.0;
  VertexHandle a, b;  ///< the edge; invalid when there is none
  CellHandle cell;    ///< a cell of the wedge
};

struct RegionStatistics {
  int region = 0;
  std::size_t cells = 0;
  std::size_t inverted = 0;
  std::size_t flat = 0;
  double volume = 0.0;        ///< signed
  double min_dihedral = 0.0;  ///< degrees
};

struct PatchStatistics {
  int label = 0;  ///< 0: boundary faces without a label
  std::size_t faces = 0;
  double area = 0.0;
};

/// What is known of a mesh at one glance. Angles in degrees; those of an inverted cell are negative. Equal to
/// the last bit for any number of threads.
struct Statistics {
  std::size_t vertices = 0;         ///< deleted ones do not count
  std::size_t unused_vertices = 0;  ///< without a cell
  std::size_t cells = 0;
  std::size_t edges = 0;  ///< by Euler's formula: right for a manifold mesh
  std::size_t faces = 0;
  std::size_t boundary_faces = 0;
  std::size_t interface_faces = 0;  ///< between cells of two regions
  std::size_t components = 0;       ///< sets of cells connected through faces; 0 when not asked for

  std::vector<CellHandle> inverted;  ///< negative volume, beyond rounding; ascending
  std::vector<CellHandle> flat;      ///< volume hides in rounding; ascending

  Distribution min_dihedral;   ///< of each cell's smallest dihedral
  Distribution volume_length;  ///< of q
  CellHandle worst_cell;       ///< the first one with the smallest dihedral of all

  /// Over all six dihedrals of all cells. The largest and the histogram leave inverted cells out.
  double mean_dihedral = 0.0;
  double max_dihedral = 0.0;
  std::array<std::uint64_t, 36> dihedral_histogram{};  ///< bins of 5 degrees; the last one holds 180
  /// Of each cell's smallest dihedral, in bins of 1 degree; inverted cells left out. So cells - (sum of the
  /// bins from N on) cells are below N degrees, to the cell.
  std::array<std::uint64_t, 71> min_dihedral_histogram{};
  std::array<std::uint64_t, 20> volume_length_histogram{};  ///< q from 0 to 1; inverted cells left out

  double min_edge = 0.0;
  double mean_edge = 0.0;  ///< over the six edges of every cell: an edge counts once per cell
  double max_edge = 0.0;
  Distribution edge_length;  ///< of these; percentiles at most 0.8 % too large
  Vec3 box_low, box_high;    ///< of all vertices that are not deleted

  double volume = 0.0;           ///< sum of signed volumes
  double absolute_volume = 0.0;  ///< sum of |volume|
  double enclosed_volume = 0.0;  ///< enclosed by the boundary faces, seen from outside
  double overlap = 0.0;          ///< absolute_volume / |enclosed_volume| - 1; 0 when nothing overlaps

  std::vector<RegionStatistics> regions;  ///< ascending
  std::vector<PatchStatistics> patches;   ///< labelled faces and unlabelled boundary faces; ascending

  /// Smallest angle between two boundary faces at an edge, measured through the cells: no cell there can have
  /// a larger dihedral while the surface is frozen.
  EdgeWedge surface_ceiling;
  /// The same with interfaces between regions and labelled faces frozen too.
  EdgeWedge interface_ceiling;
  /// What the smallest dihedral of all can be at most, proven, in every mesh that keeps these faces and whose
  /// cells go round each edge no more than once: the narrowest wedge between two of them has a single cell,
  /// the one on both, or cells of which one has no more than half of it. 360 where nothing is proven; no more
  /// than 0 where some cell is inverted or flat in every such mesh.
  EdgeWedge angle_ceiling;
};

/// Cells whose smallest dihedral is below so many whole degrees, inverted ones included.
std::size_t n_cells_below(const Statistics& statistics, std::size_t degrees);

struct StatisticsOptions {
  bool components = true;  ///< count connected components (serial, about 20 ns a cell)
  bool surface = true;     ///< patches and ceilings
};

/// Throws nothing of its own; meshes without cells give zeros.
Statistics statistics(const TetMesh& mesh, par::Policy policy = {}, const StatisticsOptions& options = {});

}  // namespace hfr

#endif
