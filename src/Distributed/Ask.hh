// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_ASK_HH
#define HFR_DISTRIBUTED_ASK_HH

#include <type_traits>
#include <utility>
#include <vector>

#include "Distributed/Comm.hh"

namespace hfr::mpi {

/// Sends questions[r] to rank r, and returns what each rank has answered: by rank, in the order of the
/// questions. `answer`: by rank what was asked → by rank the answers, as many. All take part.
template <class Question, class Answer>
auto ask(Comm& comm, std::vector<std::vector<Question>>& questions, Answer&& answer) {
  std::vector<Packer> to(comm.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    if (!questions[r].empty()) to[r].put_all(std::exchange(questions[r], {}));
  std::vector<std::vector<Question>> asked(comm.n_ranks());
  for (const Comm::Message& message : comm.exchange(to))
    asked[static_cast<std::size_t>(message.from)] = Unpacker(message.bytes).get_all<Question>();
  auto answers = answer(std::move(asked));
  using Value = typename std::remove_cvref_t<decltype(answers[0])>::value_type;
  to = std::vector<Packer>(comm.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    if (!answers[r].empty()) to[r].put_all(std::exchange(answers[r], {}));
  for (const Comm::Message& message : comm.exchange(to))
    answers[static_cast<std::size_t>(message.from)] = Unpacker(message.bytes).get_all<Value>();
  return answers;
}

}  // namespace hfr::mpi

#endif
