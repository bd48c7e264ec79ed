// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_BEST_HH
#define HFR_REMESH_BEST_HH

#include <array>
#include <optional>

#include "Remesh/Checkpoint.hh"
#include "Remesh/Run.hh"
#include "Remesh/Snapshot.hh"

namespace hfr {

/// What else may be lost for a larger worst angle.
enum class Loss {
  kLittle,  ///< a share of `may_fall` of the 1st and of the 5th percentile
  /// That, or no more degrees of both together than the worst angle gains, and each share of both together
  /// half of that which it gains: a worst angle far below the others is worth something of them.
  kMadeUpFor,
};

/// The best mesh that a stage has had on its way, by Standing: fewer inverted, fewer flat cells, less
/// overlap, a larger worst angle; where these are alike, a larger one of the cells that may rise. One that
/// has lost more than it may since the beginning, with no fewer inverted and flat cells, is none. Makes a
/// Snapshot, and another one in its place with each note() of a better mesh.
class Best {
 public:
  /// Smallest dihedrals below which 1 and 5 % of the cells lie: decision values.
  using Percentiles = std::array<double, 2>;
  /// What is held against what comes.
  struct Beginning {
    double worst;  ///< degrees
    Percentiles low;

    explicit Beginning(const Run& run);
  };

  Best(const Run& run, double may_fall, Loss loss = Loss::kLittle)
      : Best(run, may_fall, loss, Beginning(run)) {}
  /// A stage of several that begin with one another's best, and may lose no more together than one.
  Best(const Run& run, double may_fall, Loss loss, const Beginning& beginning);
  Best(const Best&) = delete;
  Best& operator=(const Best&) = delete;

  /// Smallest dihedral in degrees of the cells of the best mesh that may rise.
  double risen() const { return risen_; }
  /// The mesh may have become better.
  void note();
  /// At the end of the stage: where the mesh is worse than the best one was, puts that back. Angles that look
  /// alike in a table count alike; in the end the 1st and the 5th percentile decide, by their shares of what
  /// they were.
  void settle();

 private:
  /// -1 where the mesh is worse than the best by the worst angle of the cells that may rise, 1 where it is
  /// better, 0 where that does not decide.
  int by_risen(const Standing& found, double risen) const;
  bool is_admissible(const Standing& found) const;
  bool makes_up_for(double worst, const Percentiles& low) const;

  Run run_;
  Loss loss_;
  Beginning beginning_;
  Percentiles least_;
  Standing standing_;  // of the best mesh, as what follows
  double risen_;       // smallest_that_may_rise()
  Percentiles low_;
  std::optional<Snapshot> mesh_;
};

}  // namespace hfr

#endif
