// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Order.hh"

#include <algorithm>
#include <utility>

#include "Distributed/Stretches.hh"

namespace hfr::mpi {
namespace {

/// The places of what came to the rank that sorts this stretch of the order.
std::vector<std::vector<std::uint64_t>> places_of_stretch(Comm& comm,
                                                          const std::vector<std::vector<OrderKey>>& asked) {
  std::vector<OrderKey> distinct;
  for (const auto& of_rank : asked) distinct.insert(distinct.end(), of_rank.begin(), of_rank.end());
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const std::uint64_t n = distinct.size();
  const std::vector<std::uint64_t> counts = comm.all_gather(std::span<const std::uint64_t>(&n, 1));
  std::uint64_t before = 0;
  for (std::size_t r = 0; r < static_cast<std::size_t>(comm.rank()); ++r) before += counts[r];
  std::vector<std::vector<std::uint64_t>> places(asked.size());
  for (std::size_t r = 0; r < asked.size(); ++r)
    for (const OrderKey& key : asked[r])
      places[r].push_back(before +
                          static_cast<std::uint64_t>(std::lower_bound(distinct.begin(), distinct.end(), key) -
                                                     distinct.begin()));
  return places;
}

}  // namespace

std::vector<std::uint64_t> places_in_order(Comm& comm, std::span<const OrderKey> keys) {
  const Stretches<OrderKey> stretches(comm, keys.size(), [&](std::size_t i) { return keys[i]; });
  std::vector<std::vector<OrderKey>> questions(comm.n_ranks());
  std::vector<std::int32_t> asked;  // by key: the rank that knows
  asked.reserve(keys.size());
  for (const OrderKey& key : keys) {
    asked.push_back(stretches.rank_of(key));
    questions[static_cast<std::size_t>(asked.back())].push_back(key);
  }
  const auto answers =
      comm.ask(std::move(questions), [&](const auto& of_ranks) { return places_of_stretch(comm, of_ranks); });
  std::vector<std::size_t> next(comm.n_ranks(), 0);
  std::vector<std::uint64_t> places;
  places.reserve(keys.size());
  for (std::int32_t rank : asked) {
    const auto r = static_cast<std::size_t>(rank);
    places.push_back(answers[r][next[r]++]);
  }
  return places;
}

}  // namespace hfr::mpi
