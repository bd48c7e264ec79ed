// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/DevicePasses.hh"

#include <utility>

namespace hfr {

DevicePasses::DevicePasses(PassState& state, Replay replay) : state_(state), replay_(std::move(replay)) {
  state_.device_ = this;
}

bool DevicePasses::takes(PassKind kind) const {
  // Counts and options decide, never a clock: the same passes run on the device each time.
  const Run& run = state_.run_;
  const PassEffort& effort = run.strategy.pass;
  if (!run.device.mesh() || run.mesh.n_logical_cells() < effort.device_from) return false;
  if (run.surface) return false;  // operators on the surface run on the processor, between the others
  if (kind == PassKind::kSmooth)
    return effort.smoother == Smoother::kCandidates || effort.smoother == Smoother::kNewton;
  if (kind != PassKind::kEdge && kind != PassKind::kFace && kind != PassKind::kNode) return false;
  const Labels& labels = run.mesh.labels();
  if (effort.device_only_smooths || !labels.faces.empty() || !labels.edges.empty() ||
      !labels.vertices.empty() || !run.mesh.locks().empty() || !run.work.pinched.empty())
    return false;
  // To look into it may bring the mesh back, and with that lose the device.
  return !state_.checks_links() && run.device.mesh();
}

bool DevicePasses::take_mesh() {
  if (is_resident_) return true;
  Run& run = state_.run_;
  try {
    run.device.mesh()->upload(run.mesh, run.work);
  } catch (const DeviceError& error) {
    give_up(error.what());
    return false;
  }
  is_resident_ = true;
  done_.clear();
  looked_at_upload_ = state_.looked_;
  clock_at_upload_ = run.work.clock;
  return true;
}

std::optional<std::size_t> DevicePasses::run(PassKind kind, const char* name, std::uint8_t pending_bit,
                                             const Turn& turn) {
  if (!takes(kind)) return std::nullopt;
  if (kind == PassKind::kSmooth && state_.run_.control.stopped()) return 0;
  if (!take_mesh()) return std::nullopt;
  return kind == PassKind::kSmooth ? smooth(name, pending_bit, turn) : rounds(kind, name, pending_bit, turn);
}

DeviceLook DevicePasses::look(PassKind kind, std::uint8_t pending_bit, const Focus& focus) {
  if (focus.everything()) return {0, 0, pending_bit};
  auto& looked = state_.looked_[static_cast<std::size_t>(kind)];
  return {focus.below, std::exchange(looked, state_.run_.work.clock), 0};
}

std::optional<std::size_t> DevicePasses::rounds(PassKind kind, const char* name, std::uint8_t pending_bit,
                                                const Turn& turn) {
  Run& run = state_.run_;
  const PassEffort& effort = run.strategy.pass;
  const double start = run.control.seconds();
  const auto which = kind == PassKind::kEdge   ? DeviceMesh::Kind::kEdge
                     : kind == PassKind::kFace ? DeviceMesh::Kind::kFace
                                               : DeviceMesh::Kind::kVertex;
  RoundCounts total;
  std::size_t first = 0;
  done_.push_back({kind, turn, 0});
  try {
    DeviceMesh& there = *run.device.mesh();
    for (int r = 0; r < effort.rounds && !run.control.stopped(); ++r) {
      const RoundCounts counts = there.round(which, look(kind, pending_bit, turn.focus), effort.seed,
                                             run.work.clock, run.bounds.may_lose(there.n_logical_cells()));
      if (counts.rounds == 0) break;
      if (counts.held_back > 0) run.findings.note_cell_bound(run.bounds);
      ++run.work.clock;
      ++done_.back().rounds;
      total += counts;
      if (r == 0) first = counts.winners;
      if (counts.winners * effort.little <= first) break;
    }
    count();
  } catch (const DeviceError& error) {
    // A run that may go on does the whole pass on the processor; one that ends keeps its finished rounds.
    if (run.device.may_go_on()) done_.pop_back();
    lose(error.what());
    return std::nullopt;
  }
  state_.report(name, turn, total, run.control.seconds() - start);
  return total.winners;
}

std::optional<std::size_t> DevicePasses::smooth(const char* name, std::uint8_t pending_bit,
                                                const Turn& turn) {
  Run& run = state_.run_;
  const double start = run.control.seconds();
  const bool newton = run.strategy.pass.smoother == Smoother::kNewton;
  auto& looked = state_.looked_[static_cast<std::size_t>(PassKind::kSmooth)];
  const auto looked_before = looked;
  std::optional<RoundCounts> counts;
  try {
    counts =
        run.device.mesh()->smooth(look(PassKind::kSmooth, pending_bit, turn.focus), newton, run.work.clock);
    if (counts && counts->seeds > 0) ++run.work.clock;
    if (counts) count();
  } catch (const DeviceError& error) {
    lose(error.what());
    return std::nullopt;
  }
  if (!counts) {  // a star or colours beyond what the device has room for
    looked = looked_before;
    bring_back();
    return std::nullopt;
  }
  done_.push_back({PassKind::kSmooth, turn, 1});
  state_.report(name, turn, *counts, run.control.seconds() - start);
  return counts->winners;
}

double DevicePasses::smallest_dihedral() {
  try {
    return report_value(Metric::kMinDihedral, state_.run_.device.mesh()->smallest_dihedral());
  } catch (const DeviceError& error) {
    lose(error.what());
    return hfr::smallest_dihedral(state_.run_.mesh, state_.run_.policy());
  }
}

void DevicePasses::count() {
  const DeviceMesh::Tally tally = state_.run_.device.mesh()->tally();
  state_.count_as(tally.n_invalid, tally.worst);
}

void DevicePasses::bring_back() {
  if (!is_resident_) return;
  is_resident_ = false;
  Run& run = state_.run_;
  try {
    run.device.mesh()->download(run.mesh, run.work, run.policy());
  } catch (const DeviceError& error) {
    lose(error.what());
  }
}

void DevicePasses::give_up(const std::string& why) {
  Run& run = state_.run_;
  run.device.lose(why);
  if (!run.device.may_go_on()) run.control.stop(Stop::kDeviceLost);
}

void DevicePasses::lose(const std::string& why) {
  is_resident_ = false;
  give_up(why);
  state_.looked_ = looked_at_upload_;
  state_.run_.work.clock = clock_at_upload_;
  for (const DonePass& pass : std::exchange(done_, {})) {
    Turn turn = pass.turn;
    turn.replayed_rounds = pass.rounds;
    replay_(pass.kind, turn);
  }
  state_.count(Focus{});
}

}  // namespace hfr
