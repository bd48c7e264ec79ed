// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_LOOK_OPTIONS_HH
#define HFR_DISTRIBUTED_LOOK_OPTIONS_HH

#include "Remesh/Ranks.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/RoundPlace.hh"

namespace hfr::mpi {

/// Of the round that is asked for, at that place.
inline RoundOptions options_of(const Ranks::Look& look, RoundPlace& place) {
  RoundOptions options{par::Policy{look.threads}, /*check_links=*/false, look.seed};
  options.may_lose = static_cast<std::size_t>(look.may_lose);
  options.may_gain = static_cast<std::size_t>(look.may_gain);
  options.place = &place;
  return options;
}

}  // namespace hfr::mpi

#endif
