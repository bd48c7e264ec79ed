// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_BEST_HH
#define HFR_REMESH_BEST_HH

#include <array>
#include <optional>

#include "Remesh/Checkpoint.hh"
#include "Remesh/Run.hh"
#include "Remesh/Snapshot.hh"

namespace hfr {

/// The best mesh that a stage has had on its way, by Standing: fewer inverted, fewer flat cells, less
/// overlap, a larger worst angle. One whose 1st or 5th percentile has lost more than a share of `may_fall`
/// since the beginning, with no fewer inverted and flat cells, is none. Makes a Snapshot, and another one in
/// its place with each note() of a better mesh.
class Best {
 public:
  Best(const Run& run, double may_fall);
  Best(const Best&) = delete;
  Best& operator=(const Best&) = delete;

  /// The mesh may have become better.
  void note();
  /// At the end of the stage: where the mesh is worse than the best one was, puts that back. Worst angles
  /// that look alike in a table count alike; then the 1st percentile decides, and the 5th.
  void settle();

 private:
  /// Smallest dihedrals below which 1 and 5 % of the cells lie: decision values.
  using Percentiles = std::array<double, 2>;
  Standing now() const;
  Percentiles percentiles() const;
  bool is_admissible(const Standing& found) const;

  Run run_;
  Percentiles least_;
  Standing standing_;
  Percentiles low_;  // of the best mesh
  std::optional<Snapshot> mesh_;
};

}  // namespace hfr

#endif
