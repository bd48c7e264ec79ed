// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_LOOK_OPTIONS_HH
#define HFR_DISTRIBUTED_LOOK_OPTIONS_HH

#include "Remesh/Ranks.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/RoundPlace.hh"

namespace hfr::mpi {

/// Of the round that is asked for, at that place.
inline RoundOptions options_of(const Ranks::Look& look, RoundPlace& place) {
  RoundOptions options{par::Policy{look.threads}, look.check_links, look.seed};
  options.may_lose = static_cast<std::size_t>(look.may_lose);
  options.may_gain = static_cast<std::size_t>(look.may_gain);
  options.place = &place;
  return options;
}

/// use(metric) with what the passes of a look measure by.
template <class Use>
RoundCounts with_metric(const Ranks::Look& look, Use&& use) {
  switch (look.metric.metric) {
    case Metric::kMinSine:
      return use(MinSine2{});
    case Metric::kMinDihedral:
      return use(MinDihedral{});
    case Metric::kVolumeLength:
      return look.metric.untangles ? use(look.metric.untangling) : use(VolumeLength{});
    default:
      throw InternalError("passes over parts of a mesh do not have this metric");
  }
}

}  // namespace hfr::mpi

#endif
