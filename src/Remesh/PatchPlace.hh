// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PATCH_PLACE_HH
#define HFR_REMESH_PATCH_PLACE_HH

#include <cstddef>
#include <span>

#include "HalfFace/TetMesh.hh"

namespace hfr {

class Patch;

/// Where patches are cut out and put back: a mesh, or the surroundings of the worst cells of one in parts.
class PatchPlace {
 public:
  virtual ~PatchPlace() = default;
  virtual TetMesh& mesh() = 0;
  /// Those that the search is for, the worst first.
  virtual std::span<const CellHandle> worst() const = 0;
  /// Cells of the whole.
  virtual std::size_t n_cells() const = 0;
  /// See Patch::put_back().
  virtual void put_back(const Patch& patch, const TetMesh& changed) = 0;
};

/// What a turn of the search has come to.
struct PatchesDone {
  std::size_t n_patches = 0, n_candidates = 0, n_changed = 0;
  bool worst_rose = false;
  bool met_bound = false;  ///< of cells
  bool is_folded = false;  ///< the boundary lies on or goes through itself now
};

}  // namespace hfr

#endif
