// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_RANK_HH
#define HFR_SCHEDULER_RANK_HH

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TupleMap.hh"
#include "Operators/Cavity.hh"
#include "Parallel/Sort.hh"
#include "kernels/priority.h"

namespace hfr {

/// Worse clusters first: 0 for what is inverted or flat, then one level a power of two of the decision value.
constexpr std::uint64_t quality_bucket(double old_worst) {
  return hfr_quality_bucket(std::bit_cast<std::uint64_t>(old_worst));
}

/// Priority of a candidate: smaller wins. Equal buckets are in the order of a hash of the vertices that name
/// the seed, salted by the round, so that neighbours in storage are no neighbours in rank.
constexpr std::uint64_t priority(double old_worst, const Tet& identity, std::uint64_t salt) {
  // Seeds of fewer vertices are padded: the padding counts the same for indices of either width.
  const auto index = [&](std::size_t i) {
    return identity[i].is_valid() ? std::uint64_t{identity[i].idx()} : 0xffffffffU;
  };
  return hfr_priority(std::bit_cast<std::uint64_t>(old_worst), index(0), index(1), index(2), index(3), salt);
}

/// Sorts by key; equal keys, which a 60-bit hash all but excludes, by identity.
void rank(par::Policy policy, std::vector<par::KeyIndex>& keys, std::vector<par::KeyIndex>& scratch,
          std::span<const Tet> identities);

}  // namespace hfr

#endif
