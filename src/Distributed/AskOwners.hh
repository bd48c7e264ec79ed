// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_ASK_OWNERS_HH
#define HFR_DISTRIBUTED_ASK_OWNERS_HH

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "Distributed/Comm.hh"

namespace hfr::mpi {

/// What the ranks that own these things know of them: `width` values for each, in their order. A thing has a
/// `number` and an `owner`; append(number, values): what this rank knows of one that it owns. All take part.
template <class T, class Thing, class Append>
std::vector<T> ask_owners(Comm& comm, const std::vector<Thing>& things, std::size_t width, Append&& append) {
  std::vector<std::vector<std::uint64_t>> asked(comm.n_ranks());
  for (const Thing& one : things) asked[static_cast<std::size_t>(one.owner)].push_back(one.number);
  const auto answer = [&](const std::vector<std::vector<std::uint64_t>>& questions) {
    std::vector<std::vector<T>> values(questions.size());
    for (std::size_t r = 0; r < questions.size(); ++r)
      for (std::uint64_t number : questions[r]) append(number, values[r]);
    return values;
  };
  const std::vector<std::vector<T>> answers = comm.ask(std::move(asked), answer);
  std::vector<std::size_t> next(comm.n_ranks(), 0);
  std::vector<T> all;
  all.reserve(width * things.size());
  for (const Thing& one : things) {
    const auto r = static_cast<std::size_t>(one.owner);
    const T* const first = answers[r].data() + next[r];
    all.insert(all.end(), first, first + width);
    next[r] += width;
  }
  return all;
}

}  // namespace hfr::mpi

#endif
