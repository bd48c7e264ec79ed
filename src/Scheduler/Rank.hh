// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_RANK_HH
#define HFR_SCHEDULER_RANK_HH

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TupleMap.hh"
#include "Operators/Cavity.hh"
#include "Parallel/Sort.hh"
#include "kernels/priority.h"

namespace hfr {

/// Numbers of the vertices that name a seed; kNoVertex where there are fewer than four.
using SeedName = std::array<std::uint64_t, 4>;
/// The same for indices of either width.
inline constexpr std::uint64_t kNoVertex = 0xffffffffU;

/// The name of a seed in a mesh that is all there is, where numbers are indices.
constexpr SeedName name_of(const Tet& identity) {
  SeedName name{};
  for (std::size_t i = 0; i < 4; ++i)
    name[i] = identity[i].is_valid() ? std::uint64_t{identity[i].idx()} : kNoVertex;
  return name;
}

/// Worse clusters first: 0 for what is inverted or flat, then one level a power of two of the decision value.
constexpr std::uint64_t quality_bucket(double old_worst) {
  return hfr_quality_bucket(std::bit_cast<std::uint64_t>(old_worst));
}

/// Priority of a candidate: smaller wins. Equal buckets are in the order of a hash of the vertices that name
/// the seed, salted by the round, so that neighbours in storage are no neighbours in rank.
constexpr std::uint64_t priority(double old_worst, const SeedName& name, std::uint64_t salt) {
  return hfr_priority(std::bit_cast<std::uint64_t>(old_worst), name[0], name[1], name[2], name[3], salt);
}

/// The same where candidates of several kinds compete for one cluster: within a bucket, those that raise the
/// worst to more go first, in steps of a sixteenth of a power of two; then the hash decides.
constexpr std::uint64_t priority_by_gain(double old_worst, double new_worst, const SeedName& name,
                                         std::uint64_t salt) {
  constexpr std::uint64_t kLowest = std::uint64_t{1008} << 4;  // 2^-15 and below are level 0, 1 is level 240
  const std::uint64_t bits = new_worst > 0 ? std::bit_cast<std::uint64_t>(new_worst) >> 48 : 0;
  const std::uint64_t above = bits < kLowest ? 0 : bits - kLowest;
  const std::uint64_t level = above > 255 ? 255 : above;
  const std::uint64_t key = priority(old_worst, name, salt);
  return (key >> 60) << 60 | (255 - level) << 52 | (key << 4) >> 12;
}

constexpr std::uint64_t priority(double old_worst, const Tet& identity, std::uint64_t salt) {
  return priority(old_worst, name_of(identity), salt);
}
constexpr std::uint64_t priority_by_gain(double old_worst, double new_worst, const Tet& identity,
                                         std::uint64_t salt) {
  return priority_by_gain(old_worst, new_worst, name_of(identity), salt);
}

/// The decision value as an integer in the same order: the worst first, without buckets.
constexpr std::uint64_t worst_first(double old_worst) {
  const auto bits = std::bit_cast<std::uint64_t>(old_worst == 0 ? 0.0 : old_worst);
  return bits >> 63 ? ~bits : bits | std::uint64_t{1} << 63;
}

/// Sorts by key; equal keys, which a 60-bit hash all but excludes, by identity.
void rank(par::Policy policy, std::vector<par::KeyIndex>& keys, std::vector<par::KeyIndex>& scratch,
          std::span<const Tet> identities);

}  // namespace hfr

#endif
