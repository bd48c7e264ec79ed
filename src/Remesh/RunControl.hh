// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RUN_CONTROL_HH
#define HFR_REMESH_RUN_CONTROL_HH

#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Remesh/Improve.hh"

namespace hfr {

/// Which of the meshes of a run it is. What has become of one that was put back is another, also after as
/// many operators.
struct Revision {
  std::size_t n_changes = 0;  ///< operators that are committed in it
  std::size_t number = 0;     ///< 0: the input

  bool operator==(const Revision&) const = default;
};

/// Clock, cancel and report of one run; asked between rounds, so that a stop leaves a valid mesh.
class RunControl {
 public:
  /// `time_limit`: seconds from now.
  explicit RunControl(double time_limit = std::numeric_limits<double>::infinity(),
                      std::function<bool()> cancel = nullptr,
                      std::function<void(const Progress&)> progress = nullptr)
      : time_limit_(time_limit), cancel_(std::move(cancel)), progress_(std::move(progress)) {}

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double seconds_left() const { return time_limit_ - seconds(); }

  /// Where several processes run at the same time and ask the same questions: agree(reason of this one) is
  /// the reason of all of them to stop, if any has one.
  void agree_by(std::function<std::optional<Stop>(std::optional<Stop>)> agree) { agree_ = std::move(agree); }

  /// True once the time is up or the caller has cancelled; the first reason stays.
  bool stopped() {
    if (reason_) return true;
    if (cancel_ && cancel_())
      reason_ = Stop::kCancelled;
    else if (seconds() > time_limit_)
      reason_ = Stop::kTimeLimit;
    if (agree_) reason_ = agree_(reason_);
    return reason_.has_value();
  }
  /// Ends the run unless it has been ended before.
  void stop(Stop reason) {
    if (!reason_) reason_ = reason;
  }
  std::optional<Stop> reason() const { return reason_; }
  /// Of a run that is over, whether or not it was stopped.
  Stop reason_to_end(const ImproveOptions& options, bool goal_reached) const {
    if (reason_) return *reason_;
    if (goal_reached && options.min_dihedral) return Stop::kGoal;
    return options.iterations > 0 ? Stop::kIterations : Stop::kNoProgress;
  }

  void add(PassReport pass) {
    if (pass.winners > 0) revision_ = {revision_.n_changes + pass.winners, ++last_number_};
    passes_.push_back(std::move(pass));
  }
  /// Of the mesh as it is.
  Revision revision() const { return revision_; }
  /// Operators that are committed in the mesh, but for those that were undone.
  std::size_t n_changes() const { return revision_.n_changes; }
  /// The mesh is this one of before again: a line "undo" with what survey() has found there.
  void add_undo(Revision revision, std::size_t n_invalid, double worst) {
    PassReport pass;
    pass.stage = pass.op = "undo";
    pass.n_inverted = n_invalid;
    pass.worst = worst;
    add(std::move(pass));
    revision_ = revision;
  }
  std::vector<PassReport>& passes() { return passes_; }

  /// Estimate of how much of the run is done, 0 … 1; never goes back.
  double fraction() const { return fraction_; }
  void set_fraction(double fraction) { fraction_ = fraction > fraction_ ? fraction : fraction_; }
  /// Tells the caller, if that was asked for. `smallest()`: degrees; called only then.
  template <class Smallest>
  void tell(const std::string& stage, int iteration, std::size_t n_invalid, Smallest&& smallest) const {
    if (progress_) progress_({stage, iteration, fraction_, n_invalid, smallest()});
  }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point start_ = Clock::now();
  double time_limit_;
  std::function<bool()> cancel_;
  std::function<std::optional<Stop>(std::optional<Stop>)> agree_;
  std::function<void(const Progress&)> progress_;
  std::optional<Stop> reason_;
  double fraction_ = 0;
  Revision revision_;
  std::size_t last_number_ = 0;  // that was given
  std::vector<PassReport> passes_;
};

}  // namespace hfr

#endif
