// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_BEST_HH
#define HFR_REMESH_BEST_HH

#include <optional>

#include "Remesh/Checkpoint.hh"
#include "Remesh/Run.hh"
#include "Remesh/Snapshot.hh"

namespace hfr {

/// The best mesh that a stage has had on its way, by Standing: fewer inverted, fewer flat cells, less
/// overlap, a larger worst angle. Makes a Snapshot, and another one in its place with each note() of a better
/// mesh.
class Best {
 public:
  explicit Best(const Run& run);
  Best(const Best&) = delete;
  Best& operator=(const Best&) = delete;

  /// The mesh may have become better.
  void note();
  /// At the end of the stage: where the mesh is worse than the best one was, puts that back. An angle that
  /// does not show in a table makes no mesh worse.
  void settle();

 private:
  Standing now() const;

  Run run_;
  Standing standing_;
  std::optional<Snapshot> mesh_;
};

}  // namespace hfr

#endif
