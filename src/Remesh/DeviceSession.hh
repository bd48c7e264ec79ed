// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_DEVICE_SESSION_HH
#define HFR_REMESH_DEVICE_SESSION_HH

#include <memory>
#include <string>

#include "Device/DeviceMesh.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr {

/// The OpenCL device of a run, from the time it is opened until the end of the run or its failure.
class DeviceSession {
 public:
  /// No device.
  DeviceSession() = default;
  /// Opens the one that is chosen. Where one was named, or the mesh does not fit, throws DeviceError; where
  /// the choice is free, does without and notes why.
  DeviceSession(const DeviceChoice& choice, DeviceTuning tuning, const TetMesh& mesh)
      : is_named_(choice.kind == DeviceChoice::Kind::kOpenCl) {
    if (choice.kind == DeviceChoice::Kind::kCpu) return;
    try {
      mesh_ = std::make_unique<DeviceMesh>(choice, tuning);
      mesh_->require_room(mesh.n_vertices(), mesh.n_cells());
    } catch (const DeviceError& error) {
      mesh_.reset();
      if (is_named_) throw;
      note_ = error.what();
    }
  }

  /// The device, while there is one that works.
  DeviceMesh* mesh() { return mesh_.get(); }
  /// Whether the processor takes over from a device that fails: not where that device was asked for by name.
  bool may_go_on() const { return !is_named_; }
  /// The device is not used any more.
  void lose(const std::string& why) {
    mesh_.reset();
    note_ = why;
  }
  /// Why a device that was wanted is not, or no longer, used.
  const std::string& note() const { return note_; }

 private:
  bool is_named_ = false;
  std::unique_ptr<DeviceMesh> mesh_;
  std::string note_;
};

}  // namespace hfr

#endif
