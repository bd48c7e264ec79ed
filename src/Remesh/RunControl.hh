// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RUN_CONTROL_HH
#define HFR_REMESH_RUN_CONTROL_HH

#include <chrono>
#include <optional>
#include <vector>

#include "Remesh/Improve.hh"

namespace hfr {

class SurfaceMesh;

/// Clock, cancel and report of one run; asked between rounds, so that a stop leaves a valid mesh.
class RunControl {
 public:
  explicit RunControl(const ImproveOptions& options) : options_(options) {}

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// True once the time is up or the caller has cancelled; the first reason stays.
  bool stopped() {
    if (!reason_ && options_.cancel && options_.cancel()) reason_ = Stop::kCancelled;
    if (!reason_ && seconds() > options_.time_limit) reason_ = Stop::kTimeLimit;
    return reason_.has_value();
  }
  std::optional<Stop> reason() const { return reason_; }

  /// The surface that operators may work on; null while it is frozen.
  SurfaceMesh* surface() const { return surface_; }
  void set_surface(SurfaceMesh* surface) { surface_ = surface; }

  void add(PassReport pass) { passes_.push_back(std::move(pass)); }
  std::vector<PassReport>& passes() { return passes_; }
  /// Estimate of how much of the run is done, 0 … 1; never goes back.
  double fraction() const { return fraction_; }
  void set_fraction(double fraction) { fraction_ = fraction > fraction_ ? fraction : fraction_; }

 private:
  using Clock = std::chrono::steady_clock;
  const ImproveOptions& options_;
  Clock::time_point start_ = Clock::now();
  std::optional<Stop> reason_;
  double fraction_ = 0;
  SurfaceMesh* surface_ = nullptr;
  std::vector<PassReport> passes_;
};

}  // namespace hfr

#endif
