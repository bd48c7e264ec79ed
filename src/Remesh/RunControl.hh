// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RUN_CONTROL_HH
#define HFR_REMESH_RUN_CONTROL_HH

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Device/DeviceMesh.hh"
#include "Remesh/Checkpoint.hh"
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

  /// Whether the boundary lies on or goes through itself somewhere: then positive cells may overlap, too, and
  /// rounds hold the link condition throughout.
  bool is_folded() const { return is_folded_; }
  void set_folded(bool is_folded) { is_folded_ = is_folded; }

  /// The surface that operators may work on; null while it is frozen.
  SurfaceMesh* surface() const { return surface_; }
  void set_surface(SurfaceMesh* surface) { surface_ = surface; }

  /// What the run must not end worse than; null where the caller sees to that, as for tries on a copy.
  Checkpoint* checkpoint() const { return checkpoint_; }
  void set_checkpoint(Checkpoint* checkpoint) { checkpoint_ = checkpoint; }
  /// Before something that may leave the mesh worse; see Checkpoint::keep().
  void keep(TetMesh& mesh, bool valid) {
    if (checkpoint_) checkpoint_->keep(mesh, valid, n_changes_);
  }

  /// Opens the device of the options. Where one was named, or the mesh does not fit, throws DeviceError;
  /// where the choice is free, does without and notes why.
  void open_device(const TetMesh& mesh) {
    if (options_.device.kind == DeviceChoice::Kind::kCpu) return;
    try {
      device_ = std::make_unique<DeviceMesh>(options_.device, options_.device_tuning);
      device_->require_room(mesh.n_vertices(), mesh.n_cells());
    } catch (const DeviceError& error) {
      device_.reset();
      if (options_.device.kind == DeviceChoice::Kind::kOpenCl) throw;
      device_note_ = error.what();
    }
  }
  /// The device, while there is one that works.
  DeviceMesh* device() { return device_.get(); }
  /// Cells from which passes run there: a small mesh is done before a copy of it would be.
  std::size_t device_from() const {
    return options_.device.kind == DeviceChoice::Kind::kOpenCl ? 0 : kDeviceCells;
  }
  /// Whether the processor takes over from a device that fails: not where that device was asked for by name.
  bool may_go_on() const { return options_.device.kind != DeviceChoice::Kind::kOpenCl; }
  /// The device is not used any more; without may_go_on(), the run stops.
  void lose_device(const std::string& why) {
    device_.reset();
    device_note_ = why;
    if (!may_go_on() && !reason_) reason_ = Stop::kDeviceLost;
  }
  /// Why a device that was wanted is not, or no longer, used.
  const std::string& device_note() const { return device_note_; }

  /// Something was left undone for the number of cells; `max_cells`: the bound on more of them, 0 for none.
  void note_cell_bound(std::size_t max_cells) {
    met_cell_bound_ = true;
    max_cells_ = max_cells;
  }
  void forget_cell_bound() {
    met_cell_bound_ = false;
    max_cells_ = 0;
  }
  bool met_cell_bound() const { return met_cell_bound_; }
  /// The bound on more cells at the last time that one was met; 0 for none.
  std::size_t max_cells_met() const { return max_cells_; }

  /// Every mesh with this boundary has an invalid cell: see unfillable_faces().
  void set_unfillable(bool unfillable) { unfillable_ = unfillable; }
  bool unfillable() const { return unfillable_; }

  /// From here on the worst angle counts at any cost: a new vertex may leave as many poor cells as it takes.
  void spare_nothing() { spares_nothing_ = true; }
  bool spares_nothing() const { return spares_nothing_; }

  void add(PassReport pass) {
    n_changes_ += pass.winners;
    passes_.push_back(std::move(pass));
  }
  /// Operators that are committed in the mesh, but for those that were undone.
  std::size_t n_changes() const { return n_changes_; }
  /// The mesh is what it was after so many.
  void take_back_changes(std::size_t n) { n_changes_ = n; }
  std::vector<PassReport>& passes() { return passes_; }
  /// Estimate of how much of the run is done, 0 … 1; never goes back.
  double fraction() const { return fraction_; }
  void set_fraction(double fraction) { fraction_ = fraction > fraction_ ? fraction : fraction_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kDeviceCells = 50000;
  const ImproveOptions& options_;
  Clock::time_point start_ = Clock::now();
  std::optional<Stop> reason_;
  double fraction_ = 0;
  bool met_cell_bound_ = false;
  std::size_t max_cells_ = 0;
  bool spares_nothing_ = false;
  bool unfillable_ = false;
  SurfaceMesh* surface_ = nullptr;
  Checkpoint* checkpoint_ = nullptr;
  bool is_folded_ = false;
  std::size_t n_changes_ = 0;
  std::vector<PassReport> passes_;
  std::unique_ptr<DeviceMesh> device_;
  std::string device_note_;
};

}  // namespace hfr

#endif
