// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_COMM_HH
#define HFR_DISTRIBUTED_COMM_HH

#include <mpi.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hfremesh/Distributed/Buffer.hh"

namespace hfr::mpi {

/// Another rank has failed; thrown on every other one by the next call that all take part in.
class RankFailed : public std::runtime_error {
 public:
  RankFailed(int rank, int code, const std::string& message)
      : std::runtime_error("rank " + std::to_string(rank) + ": " + message), rank_(rank), code_(code) {}
  int rank() const { return rank_; }
  int code() const { return code_; }  ///< exit code, as that rank has it

 private:
  int rank_, code_;
};

/// What a rank has sent to others since the beginning.
struct Traffic {
  std::uint64_t messages = 0;     ///< between two ranks
  std::uint64_t bytes = 0;        ///< in them
  std::uint64_t exchanges = 0;    ///< times that all ranks took part in
  std::uint64_t collectives = 0;  ///< sums, minima and gatherings over all ranks
  std::uint64_t collective_bytes = 0;

  Traffic& operator+=(const Traffic& o) {
    messages += o.messages;
    bytes += o.bytes;
    exchanges += o.exchanges;
    collectives += o.collectives;
    collective_bytes += o.collective_bytes;
    return *this;
  }
};

/// What a rank's time goes to.
enum class Phase : std::uint8_t {
  kAlone,        ///< on rank 0 all that is not shared; nothing elsewhere
  kCut,          ///< who owns what
  kHandOut,      ///< making parts and messages of them
  kEvaluate,     ///< lists of seeds, evaluation, commits
  kSelect,       ///< candidates, decisions and slots among ranks
  kBorder,       ///< what has changed near other ranks
  kSmooth,       ///< colours and moves
  kTally,        ///< counts after a pass
  kPutTogether,  ///< the mesh of rank 0 from the parts
  kWait,         ///< for other ranks, in whatever phase
  kCount
};
template <class T>
using PerPhase = std::array<T, static_cast<std::size_t>(Phase::kCount)>;
inline constexpr PerPhase<const char*> kPhaseNames = {
    "alone", "cut", "hand out", "evaluate", "select", "border", "smooth", "tally", "put together", "wait"};

/// What the ranks of a communicator say to each other. All functions but rank(), size() and traffic() are
/// called by all ranks in the same order. Each begins with the question whether a rank has failed: so none
/// waits for one that has left. Throws RankFailed then, and hfr::Error for faults of MPI.
class Comm {
 public:
  /// Works on a copy of `comm`, whose messages meet no others'. MPI is initialised, with
  /// MPI_THREAD_FUNNELED at least where loops run on several threads.
  explicit Comm(MPI_Comm comm);
  ~Comm();
  Comm(const Comm&) = delete;
  Comm& operator=(const Comm&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  std::size_t n_ranks() const { return static_cast<std::size_t>(size_); }
  /// By the phase that it was sent in; what was sent while a rank waits is that of the phase that waits.
  const PerPhase<Traffic>& traffic() const { return traffic_; }
  MPI_Comm handle() const { return comm_; }

  struct Message {
    int from = 0;
    std::vector<std::byte> bytes;
  };
  /// Sends to[r] to rank r unless it is empty; nobody needs to know who sends to whom. Returns what came, by
  /// ascending rank; a message to oneself among them.
  std::vector<Message> exchange(std::vector<Packer>& to) { return exchange(to, 0).messages; }
  struct Exchanged {
    std::vector<Message> messages;
    std::uint64_t sum = 0;         ///< of the values of all ranks
    std::uint64_t n_messages = 0;  ///< between two ranks, over all of them
  };
  Exchanged exchange(std::vector<Packer>& to, std::uint64_t value);
  /// Sends questions[r] to rank r, and returns what each rank has answered: by rank, in the order of the
  /// questions. `answer`: by rank what was asked → by rank the answers, as many.
  template <class Question, class Answer>
  auto ask(std::vector<std::vector<Question>> questions, Answer&& answer) {
    auto answers = answer(swap_all(std::move(questions)));
    return swap_all(std::move(answers));
  }
  /// Each rank gets make(rank) of rank 0, in the order of ranks but for rank 0 itself, which is last: while
  /// one is made, that before it is on its way. What is sent may be of any size.
  Block hand_out(const std::function<Block(int)>& make);
  /// The values of all ranks, in the order of ranks.
  template <class T>
  std::vector<T> all_gather(std::span<const T> mine) {
    const std::vector<std::byte> all = all_gather_bytes(std::as_bytes(mine));
    std::vector<T> values(all.size() / sizeof(T));
    if (!all.empty()) std::memcpy(values.data(), all.data(), all.size());
    return values;
  }
  std::uint64_t sum(std::uint64_t mine);
  static constexpr std::size_t kMostSums = 16;
  /// kMostSums at most.
  void sum(std::span<std::uint64_t> values);
  double min(double mine);
  /// Both at once: sums, and the least.
  double sum_and_min(std::span<std::uint64_t> values, double mine);
  /// What rank 0 says. While rank 0 works, the others sleep here.
  template <class T>
  requires std::is_trivially_copyable_v<T> T from_first(const T& value) {
    static_assert(sizeof(T) <= sizeof(std::uint64_t) * kMostSums);
    std::array<std::uint64_t, kMostSums> words{};
    if (rank_ == 0) std::memcpy(words.data(), &value, sizeof(T));
    sum(words);  // of zeros, elsewhere
    T said;
    std::memcpy(static_cast<void*>(&said), words.data(), sizeof(T));
    return said;
  }

  /// Instead of the next call: this rank has failed. Returns what the others are told: of the smallest rank
  /// that has. `code`: 1 … 255.
  RankFailed fail(int code, const std::string& message);
  /// For tests of that: the call number `n`, from 1, of this rank throws ResourceLimit.
  void fail_at_call(std::uint64_t n) { fail_at_ = n; }
  std::uint64_t n_calls() const { return n_calls_; }
  /// For tests: a message of more bytes is refused by this rank, as one of more than 2 GiB is.
  void refuse_beyond(std::size_t n) { most_bytes_ = n; }

  /// The time of this rank from now on, until the end of the object, is that of the phase.
  class InPhase {
   public:
    InPhase(Comm& comm, Phase phase) : comm_(comm), before_(comm.enter(phase)) {}
    ~InPhase() { comm_.enter(before_); }
    InPhase(const InPhase&) = delete;
    InPhase& operator=(const InPhase&) = delete;

   private:
    Comm& comm_;
    Phase before_;
  };
  /// Since the beginning.
  PerPhase<double> seconds() {
    enter(phase_);
    return seconds_;
  }

 private:
  /// What every call asks all ranks, in one reduction: whether one has failed, and what the call itself has
  /// to count.
  struct Question {
    std::int64_t first_failed = 0;
    double least = std::numeric_limits<double>::infinity();
    std::array<std::uint64_t, kMostSums> sums{};
  };
  static void combine(void* in, void* in_out, int* n, MPI_Datatype* type);
  std::vector<std::byte> all_gather_bytes(std::span<const std::byte> mine);
  std::optional<RankFailed> ask(Question& question, int code, const std::string& message);
  void agree(Question& question);
  void agree() {
    Question question;
    agree(question);
  }
  /// values[r] to rank r; what came from each.
  template <class T>
  std::vector<std::vector<T>> swap_all(std::vector<std::vector<T>> values) {
    std::vector<Packer> to(n_ranks());
    for (std::size_t r = 0; r < to.size(); ++r)
      if (!values[r].empty()) to[r].put_all(std::exchange(values[r], {}));
    std::vector<std::vector<T>> came(n_ranks());
    for (const Message& message : exchange(to))
      came[static_cast<std::size_t>(message.from)] = Unpacker(message.bytes).get_all<T>();
    return came;
  }
  static void require(int result);
  void require_short(std::size_t n) const;
  void wait(MPI_Request& request);
  std::vector<Message> send_and_receive(std::vector<Packer>& to);
  void send_block(int to, const Block& block, std::vector<MPI_Request>& requests);
  Block receive_block();
  Phase enter(Phase phase);
  Traffic& counts() { return traffic_[static_cast<std::size_t>(counted_)]; }

  using Clock = std::chrono::steady_clock;

  MPI_Comm comm_ = MPI_COMM_NULL;
  MPI_Op combine_ = MPI_OP_NULL;
  MPI_Datatype question_type_ = MPI_DATATYPE_NULL;
  int rank_ = 0, size_ = 1;
  int tag_ = 0;
  std::uint64_t n_calls_ = 0, fail_at_ = 0;
  std::size_t most_bytes_ = std::numeric_limits<std::size_t>::max();
  PerPhase<Traffic> traffic_{};
  Phase phase_ = Phase::kAlone, counted_ = Phase::kAlone;  // counted: the last but waiting
  Clock::time_point since_ = Clock::now();
  PerPhase<double> seconds_{};
};

/// What rank 0 has packed, on all of them.
std::vector<std::byte> told_by_first(Comm& comm, const Packer& said);

}  // namespace hfr::mpi

#endif
