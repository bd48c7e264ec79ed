// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_STAGE_ON_DEVICE_HH
#define HFR_REMESH_STAGE_ON_DEVICE_HH

// The passes of a stage on an OpenCL device, internal to Stage.cc. The mesh stays there from one pass to the
// next, and comes back when a pass on the processor asks for it. Until then the mesh on the host is the one
// that was uploaded; should the device fail, the passes since then are done again on the processor, with the
// same bits.

#include "Remesh/Stage.hh"

namespace hfr {

template <class Metric>
bool Stage<Metric>::on_device(Kind kind) {
  if constexpr (!std::is_same_v<Metric, VolumeLength>) {
    return false;
  } else {
    // Counts and options decide, never a clock: the same passes run on the device each time.
    if (!control_.device() || mesh_.n_logical_cells() < control_.device_from()) return false;
    if (control_.surface())
      return false;  // operators on the surface run on the processor, between the others
    if (kind == kSmooth) {
      const bool candidates =
          options_.compat == Compat::kJpdc2013 || options_.smoother == Smoother::kCandidates;
      if (!candidates && options_.smoother != Smoother::kNewton) return false;
    } else {
      const Labels& labels = mesh_.labels();
      if (options_.hybrid || n_invalid_ > 0 || control_.is_folded() || !labels.faces.empty() ||
          !labels.edges.empty() || !labels.vertices.empty() || !mesh_.locks().empty() ||
          !work_.pinched.empty())
        return false;
    }
    if (resident_) return true;
    try {
      control_.device()->upload(mesh_, work_);
    } catch (const DeviceError& error) {
      control_.lose_device(error.what());
      return false;
    }
    resident_ = true;
    done_there_.clear();
    looked_there_ = looked_;
    clock_there_ = work_.clock;
    return true;
  }
}

template <class Metric>
DeviceLook Stage<Metric>::device_look(Kind kind, Focus focus) {
  if (focus.everything()) return {0, 0, static_cast<std::uint8_t>(1U << kind)};
  const DeviceLook look{focus.below, looked_[kind], 0};
  looked_[kind] = work_.clock;
  return look;
}

template <class Metric>
void Stage<Metric>::to_host() {
  if (!resident_) return;
  resident_ = false;
  try {
    control_.device()->download(mesh_, work_);
  } catch (const DeviceError& error) {
    lose_device(error.what());
  }
}

template <class Metric>
void Stage<Metric>::lose_device(const std::string& why) {
  resident_ = false;
  control_.lose_device(why);
  looked_ = looked_there_;
  work_.clock = clock_there_;
  for (const DonePass& pass : done_there_) {
    replay_ = pass.rounds;
    if (pass.kind == kEdge)
      edge_pass(0, pass.focus);
    else if (pass.kind == kFace)
      face_pass(0, pass.focus);
    else if (pass.kind == kNode)
      node_pass(0, pass.focus);
    else
      smooth_pass(0, pass.focus);
  }
  replay_.reset();
  done_there_.clear();
  count(Focus{});
}

template <class Metric>
std::optional<std::size_t> Stage<Metric>::device_rounds(Kind kind, int iteration, Focus focus) {
  const double start = control_.seconds();
  const auto which = kind == kEdge   ? DeviceMesh::Kind::kEdge
                     : kind == kFace ? DeviceMesh::Kind::kFace
                                     : DeviceMesh::Kind::kVertex;
  RoundCounts total;
  std::size_t first = 0;
  done_there_.push_back({kind, focus, 0});
  try {
    for (int r = 0; r < kMaxRounds && !control_.stopped(); ++r) {
      DeviceMesh& there = *control_.device();
      const RoundCounts counts = there.round(which, device_look(kind, focus), options_.seed, work_.clock,
                                             may_lose(there.n_logical_cells()));
      if (counts.rounds == 0) break;
      if (counts.held_back > 0) control_.note_cell_bound(options_.max_cells);
      ++work_.clock;
      ++done_there_.back().rounds;
      total += counts;
      if (r == 0) first = counts.winners;
      if (counts.winners * kLittle <= first) break;
    }
    device_count();
  } catch (const DeviceError& error) {
    // A run that may go on does the whole pass on the processor; one that ends keeps its finished rounds.
    if (control_.may_go_on()) done_there_.pop_back();
    lose_device(error.what());
    return std::nullopt;
  }
  report(kNames[kind], iteration, total, control_.seconds() - start);
  return total.winners;
}

template <class Metric>
std::optional<std::size_t> Stage<Metric>::device_smooth(int iteration, Focus focus) {
  const double start = control_.seconds();
  const bool newton = options_.compat != Compat::kJpdc2013 && options_.smoother == Smoother::kNewton;
  const auto looked = looked_[kSmooth];
  std::optional<RoundCounts> counts;
  try {
    counts = control_.device()->smooth(device_look(kSmooth, focus), newton, work_.clock);
    if (counts && counts->seeds > 0) ++work_.clock;
    if (counts) device_count();
  } catch (const DeviceError& error) {
    lose_device(error.what());
    return std::nullopt;
  }
  if (!counts) {
    looked_[kSmooth] = looked;
    to_host();
    return std::nullopt;
  }
  done_there_.push_back({kSmooth, focus, 1});
  report(kNames[kSmooth], iteration, *counts, control_.seconds() - start);
  return counts->winners;
}

template <class Metric>
void Stage<Metric>::device_count() {
  const DeviceMesh::Tally tally = control_.device()->tally();
  n_invalid_ = tally.n_invalid;
  worst_ = tally.worst;
}

}  // namespace hfr

#endif
