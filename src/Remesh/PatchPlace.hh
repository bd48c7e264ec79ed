// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PATCH_PLACE_HH
#define HFR_REMESH_PATCH_PLACE_HH

#include <cstddef>
#include <cstdint>
#include <span>

#include "HalfFace/TetMesh.hh"

namespace hfr {

class Patch;
class SurfaceMesh;

/// What the tries on one patch have come to.
struct PatchVerdict {
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);
  std::uint32_t best = kNone;  ///< the number of the try that counts
  bool held_back = false;      ///< there was one that had too many cells, or too few
};

/// Where patches are cut out and put back: a mesh, or the surroundings of the worst cells of one in parts,
/// which several processes have at the same time, so that each tries on some of the patches.
class PatchPlace {
 public:
  virtual ~PatchPlace() = default;
  virtual TetMesh& mesh() = 0;
  /// Those that the search is for, the worst first.
  virtual std::span<const CellHandle> worst() const = 0;
  /// As Workspace has it.
  virtual std::span<const std::uint8_t> pinched() const = 0;
  /// The surface of the run as this mesh sees it.
  virtual const SurfaceMesh* surface(const SurfaceMesh* of_run) { return of_run; }
  /// Cells of the whole.
  virtual std::size_t n_cells() const = 0;
  /// Whether it is this process that tries on patch i.
  virtual bool tries_on(std::size_t) const { return true; }
  /// Of all patches, by number: fills in the verdicts of other processes. False where another process goes
  /// on.
  virtual bool share(std::span<PatchVerdict>) { return true; }
  /// See Patch::put_back().
  virtual void put_back(const Patch& patch, const TetMesh& changed) = 0;
};

/// What a turn of the search has come to.
struct PatchesDone {
  std::size_t n_patches = 0, n_candidates = 0, n_changed = 0;
  bool worst_rose = false;
  bool met_bound = false;  ///< of cells
  bool is_folded = false;  ///< see Findings
};

}  // namespace hfr

#endif
