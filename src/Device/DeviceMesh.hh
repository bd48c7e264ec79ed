// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_DEVICE_MESH_HH
#define HFR_DEVICE_DEVICE_MESH_HH

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Device/Device.hh"
#include "HalfFace/TetMesh.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

/// Cells that a pass looks at: those with a pending bit of `pending_bit`, or, when that is 0, those with a
/// decision value below `below` and a vertex that has changed after clock `since`.
struct DeviceLook {
  double below = 0;
  std::uint32_t since = 0;
  std::uint8_t pending_bit = 0;
};

/// A mesh and its workspace in the memory of an OpenCL device, in the metric volume-length. Passes there give
/// the bits of the passes on the processor (Scheduler/Round.hh, SmoothPass.hh); between upload() and
/// download() the mesh on the host is left as it was, so that a run can go on from there when the device
/// fails. Every member throws DeviceError that names the call and the error.
class DeviceMesh {
 public:
  /// Compiles the kernels, or takes them from the cache, and refuses a device that rounds otherwise than the
  /// processor.
  explicit DeviceMesh(const DeviceChoice& choice, DeviceTuning tuning = {});
  ~DeviceMesh();
  DeviceMesh(const DeviceMesh&) = delete;
  DeviceMesh& operator=(const DeviceMesh&) = delete;

  const DeviceInfo& info() const;
  bool from_cache() const;  ///< whether an earlier run had compiled the kernels

  /// Bytes that a mesh of this size takes on a device at first.
  static std::uint64_t bytes_needed(std::size_t n_vertices, std::size_t n_cells);

  /// Throws DeviceError that says how much is needed when a mesh of this size does not fit.
  void require_room(std::size_t n_vertices, std::size_t n_cells) const;

  /// Calls require_room().
  void upload(const TetMesh& mesh, const Workspace& work);
  /// Writes back everything that passes have changed.
  void download(TetMesh& mesh, Workspace& work, par::Policy policy = {});

  /// Cells that are not deleted.
  std::size_t n_logical_cells() const;

  enum class Kind { kEdge, kFace, kVertex };  ///< edge removal, 2-3 swap, vertex collapse
  /// One round over the cells of `look`; `clock` as the workspace has it before the round. counts.rounds is
  /// 0, and nothing has happened, when there was no cell to look at. All cells are positive, and the mesh has
  /// no labels of faces, edges or vertices. `may_lose`: cells that vertex collapse may take away, as
  /// RoundOptions has it.
  RoundCounts round(Kind kind, const DeviceLook& look, std::uint64_t seed, std::uint32_t clock,
                    std::size_t may_lose = std::numeric_limits<std::size_t>::max());

  /// Smooths the vertices of the cells of `look` once: by Newton's method (stars with an inverted cell by
  /// candidates) or by candidates alone. Nothing, with the mesh as it was, when the device cannot: a star of
  /// more than Star::kCapacity cells, or more colours than a device counts. counts.seeds is 0 where there was
  /// no vertex to move.
  std::optional<RoundCounts> smooth(const DeviceLook& look, bool newton, std::uint32_t clock);

  struct Tally {
    std::size_t n_invalid = 0;  ///< cells whose decision value is not positive
    double worst = 0;           ///< smallest decision value
  };
  Tally tally();
  /// Smallest dihedral angle, as decision value; at most that of the regular tetrahedron.
  double smallest_dihedral();
  /// Decision value of every cell slot, evaluated anew from points; for tests.
  std::vector<double> qualities();

  /// By kernel, the costliest first; empty unless tuning.profile.
  std::vector<KernelTime> profile();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hfr

#endif
