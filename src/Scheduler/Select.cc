// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, JPDC 73 (2013), section 4: ASSIGNMENT, in their serial form and in a lock-free one. The
// latter is the deterministic reservation of Blelloch, Fineman, Gibbons & Shun (PPoPP 2012).
#include "Scheduler/Select.hh"

#include <algorithm>

#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"

namespace hfr {
namespace {

enum class State : std::uint8_t { kUndecided, kWon, kLost };

std::uint32_t holder(std::span<std::uint32_t> claim, CellHandle c) {
  return par::atomic(claim[c.idx()]).load(std::memory_order_relaxed);
}

void lower(std::uint32_t& claim, std::uint32_t number) {
  const auto shared = par::atomic(claim);
  par::before_shared_access();
  std::uint32_t now = shared.load(std::memory_order_relaxed);
  while (number < now) {
    par::before_shared_access();
    if (shared.compare_exchange_weak(now, number, std::memory_order_relaxed)) return;
  }
}

}  // namespace

std::vector<std::uint32_t> select_by_marking(const ScopeList& scopes, std::span<std::uint32_t> claim,
                                             const std::function<bool(std::size_t)>& accept) {
  std::vector<std::uint32_t> winners;
  for (std::size_t i = 0; i < scopes.size(); ++i) {
    const auto cells = scopes[i];
    const bool free =
        std::all_of(cells.begin(), cells.end(), [&](CellHandle c) { return claim[c.idx()] == kUnclaimed; });
    if (!free || (accept && !accept(i))) continue;
    for (CellHandle c : cells) claim[c.idx()] = static_cast<std::uint32_t>(winners.size());
    winners.push_back(static_cast<std::uint32_t>(i));
  }
  return winners;
}

bool add_unless_there(std::span<const std::uint64_t> values, std::unordered_set<std::uint64_t>& there) {
  if (std::any_of(values.begin(), values.end(), [&](std::uint64_t v) { return there.contains(v); }))
    return false;
  there.insert(values.begin(), values.end());
  return true;
}

std::vector<std::uint32_t> select_by_claims(par::Policy policy, const ScopeList& scopes,
                                            std::span<std::uint32_t> claim, std::size_t* sub_rounds) {
  std::vector<State> state(scopes.size(), State::kUndecided);
  std::vector<std::uint32_t> undecided(scopes.size());
  for (std::size_t i = 0; i < undecided.size(); ++i) undecided[i] = static_cast<std::uint32_t>(i);
  std::size_t n_repetitions = 0;
  while (!undecided.empty()) {
    ++n_repetitions;
    par::for_each(policy, undecided.size(), [&](std::size_t k) {
      for (CellHandle c : scopes[undecided[k]]) lower(claim[c.idx()], undecided[k]);
    });
    par::for_each(policy, undecided.size(), [&](std::size_t k) {
      const auto cells = scopes[undecided[k]];
      if (std::all_of(cells.begin(), cells.end(),
                      [&](CellHandle c) { return holder(claim, c) == undecided[k]; }))
        state[undecided[k]] = State::kWon;
    });
    // A loser is recognised by a winner's claim, which nobody takes back, so the order of this loop is free.
    par::for_each(policy, undecided.size(), [&](std::size_t k) {
      const std::uint32_t i = undecided[k];
      if (state[i] == State::kWon) return;
      const auto cells = scopes[i];
      const bool lost = std::any_of(cells.begin(), cells.end(), [&](CellHandle c) {
        par::before_shared_access();
        const std::uint32_t other = holder(claim, c);
        if (other == i || other == kUnclaimed) return false;
        par::before_shared_access();
        return par::atomic(state[other]).load(std::memory_order_relaxed) == State::kWon;
      });
      if (!lost) return;
      par::before_shared_access();
      par::atomic(state[i]).store(State::kLost, std::memory_order_relaxed);
      for (CellHandle c : cells) {
        std::uint32_t mine = i;
        par::before_shared_access();
        par::atomic(claim[c.idx()]).compare_exchange_strong(mine, kUnclaimed, std::memory_order_relaxed);
      }
    });
    const auto left = par::compact<std::uint32_t>(
        policy, undecided.size(), [&](std::size_t k) { return state[undecided[k]] == State::kUndecided; });
    std::vector<std::uint32_t> next(left.size());
    for (std::size_t k = 0; k < left.size(); ++k) next[k] = undecided[left[k]];
    undecided = std::move(next);
  }
  auto winners = par::compact<std::uint32_t>(policy, state.size(),
                                             [&](std::size_t i) { return state[i] == State::kWon; });
  par::for_each(policy, winners.size(), [&](std::size_t w) {
    for (CellHandle c : scopes[winners[w]]) claim[c.idx()] = static_cast<std::uint32_t>(w);
  });
  if (sub_rounds) *sub_rounds = n_repetitions;
  return winners;
}

std::vector<std::uint32_t> select(par::Policy policy, const ScopeList& scopes, std::span<std::uint32_t> claim,
                                  std::size_t* sub_rounds) {
  if (policy.threads >= kClaimThreads && scopes.size() >= kClaimCandidates)
    return select_by_claims(policy, scopes, claim, sub_rounds);
  if (sub_rounds) *sub_rounds = 1;
  return select_by_marking(scopes, claim);
}

std::vector<std::uint32_t> colour_clusters(par::Policy policy, const ScopeList& scopes, std::size_t n_cells) {
  std::vector<std::uint32_t> colour(scopes.size(), 0);
  std::vector<std::uint32_t> claim(n_cells, kUnclaimed);
  std::vector<std::uint32_t> rest(scopes.size());
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = static_cast<std::uint32_t>(i);
  for (std::uint32_t next = 0; !rest.empty(); ++next) {
    const ScopeList left(policy, rest.size(), [&](std::size_t i, Scope& out) {
      out.clear();
      for (CellHandle c : scopes[rest[i]]) out.push_back(c);
    });
    const auto winners = select(policy, left, claim);
    for (std::uint32_t w : winners) {
      colour[rest[w]] = next;
      for (CellHandle c : left[w]) claim[c.idx()] = kUnclaimed;
      rest[w] = kUnclaimed;
    }
    std::erase(rest, kUnclaimed);
  }
  return colour;
}

}  // namespace hfr
