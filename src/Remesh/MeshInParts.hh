// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MESH_IN_PARTS_HH
#define HFR_REMESH_MESH_IN_PARTS_HH

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Remesh/PatchPlace.hh"
#include "Remesh/Standing.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Unfolding.hh"
#include "Surface/HeldCells.hh"

namespace hfr {

class SurfaceMesh;

/// Vertices, and those of them that may move.
struct VertexTally {
  std::size_t n = 0, n_movable = 0;
};

/// What stages ask of a mesh of which several processes hold a part each, beside its passes: see
/// Ranks::keep_mesh(). All answers are those of the whole, the same everywhere; all processes ask at the same
/// time.
class MeshInParts {
 public:
  virtual ~MeshInParts() = default;
  virtual std::size_t n_cells() const = 0;
  virtual Survey survey() = 0;
  virtual Standing standing() = 0;
  virtual AngleTally tally_below(std::span<const double> degrees) = 0;
  virtual VertexTally vertices() = 0;
  /// Whether it is this process that answers for a cell that it holds; some process does for each cell.
  virtual bool is_own(CellHandle c) const = 0;
  /// Over all processes.
  virtual std::size_t sum(std::size_t mine) = 0;
  virtual double min(double mine) = 0;
  /// The `rank` smallest, counted from 1, of the values of all processes, which are no NaN.
  virtual double smallest(std::span<const double> mine, std::size_t rank) = 0;
  /// Of all its points.
  virtual Box box() = 0;
  /// For Focus::is_marked: the vertices of these own cells of all processes, and of so many layers round
  /// them.
  virtual void mark_round(std::span<const CellHandle> cells, int layers) = 0;
  /// The numbers of the n worst cells below so many degrees, of which at most that many, the worst first; of
  /// two that are alike the one with the smaller number. `but`: own ones that do not count, ascending.
  virtual std::vector<std::uint64_t> worst_cells_below(double degrees, std::size_t n,
                                                       std::span<const CellHandle> but) = 0;
  /// Brings together, in each process, what lies within so many layers of these cells, and lets all search
  /// there, of which one puts back. All have what that one has made of it, and get what it says.
  /// `surface`: of the run, where its patches change it, too.
  virtual PatchesDone search_patches(std::span<const std::uint64_t> cells, int layers,
                                     const SurfaceMesh* surface,
                                     const std::function<PatchesDone(PatchPlace&)>& search) = 0;
  /// The surface as it is now, of all of it, for as long as what is returned lives.
  virtual std::shared_ptr<SurfaceMesh> surface(const SurfaceOptions& options) = 0;
  /// After cells have been replaced that nobody told that surface of: see SurfaceMesh::rebuild().
  virtual void rebuild(SurfaceMesh& surface) = 0;
  /// Of these own cells; see hfr::feature_ceilings(). Without the ends of edges.
  virtual std::vector<FeatureCeiling> feature_ceilings(std::span<const CellHandle> cells,
                                                       const SurfaceOptions& options) = 0;
  virtual std::unique_ptr<Unfolding> unfolding(const UntangleEffort& effort) = 0;
  /// Of the part, to come back to.
  virtual std::shared_ptr<const void> copy() const = 0;
  /// Makes the part what the copy is, with a workspace as after Workspace::attach().
  virtual void put_back(const std::shared_ptr<const void>& copy) = 0;
  /// The first rule of check() that the mesh breaks and the copy does not; empty where it breaks none.
  virtual std::string fault(const std::shared_ptr<const void>& copy) = 0;
};

}  // namespace hfr

#endif
