// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_DEVICE_PASSES_HH
#define HFR_REMESH_DEVICE_PASSES_HH

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "Remesh/PassState.hh"

namespace hfr {

/// The passes of a stage in volume-length on an OpenCL device. The mesh stays there from one pass to the
/// next, and comes back when a pass on the processor asks for it. Until then the mesh on the host is the one
/// that was uploaded; should the device fail, the passes since then are done again on the processor, with the
/// same bits.
class DevicePasses {
 public:
  /// Does a pass on the processor.
  using Replay = std::function<void(PassKind, const Turn&)>;

  DevicePasses(PassState& state, Replay replay);
  DevicePasses(const DevicePasses&) = delete;
  DevicePasses& operator=(const DevicePasses&) = delete;

  /// Changes that a pass has committed; nothing where it does not run there, or where the device has failed
  /// and the processor has to go on.
  std::optional<std::size_t> run(PassKind kind, const char* name, std::uint8_t pending_bit, const Turn& turn);
  /// Downloads the mesh if the device has it.
  void bring_back();
  /// Whether the device has the mesh, and the host an older one.
  bool is_resident() const { return is_resident_; }

  /// Degrees; of the mesh on the processor where the device is lost over it.
  double smallest_dihedral();

 private:
  struct DonePass {
    PassKind kind;
    Turn turn;
    std::size_t rounds;
  };
  using Looked = decltype(PassState::looked_);

  bool takes(PassKind kind) const;
  /// True with the mesh on the device.
  bool take_mesh();
  DeviceLook look(PassKind kind, std::uint8_t pending_bit, const Focus& focus);
  std::optional<std::size_t> rounds(PassKind kind, const char* name, std::uint8_t pending_bit,
                                    const Turn& turn);
  std::optional<std::size_t> smooth(const char* name, std::uint8_t pending_bit, const Turn& turn);
  void count();
  /// Does on the processor what was done on the device since the mesh was uploaded.
  void lose(const std::string& why);
  void give_up(const std::string& why);

  PassState& state_;
  Replay replay_;
  bool is_resident_ = false;
  std::vector<DonePass> done_;  // since the mesh was uploaded
  Looked looked_at_upload_{};   // what had been looked at by then
  std::uint32_t clock_at_upload_ = 0;
};

}  // namespace hfr

#endif
