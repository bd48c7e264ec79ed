// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MESH_IN_PARTS_HH
#define HFR_REMESH_MESH_IN_PARTS_HH

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Standing.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Unfolding.hh"

namespace hfr {

/// Vertices, deleted ones included, and those of them that may move.
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
