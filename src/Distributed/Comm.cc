// SPDX-License-Identifier: BSD-3-Clause
// Messages whose receivers do not know of them: T. Hoefler, C. Siebert, A. Lumsdaine, Scalable communication
// protocols for dynamic sparse data exchange, PPoPP 2010 (the nonblocking consensus).
#include "Distributed/Comm.hh"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <new>
#include <string>
#include <thread>
#include <utility>

namespace hfr::mpi {
namespace {

constexpr std::int64_t kNobody = std::numeric_limits<std::int64_t>::max();
constexpr int kCodes = 256;
constexpr int kTags = 16'384;
constexpr std::size_t kLongestMessage = 512;          // of a rank that fails
constexpr std::size_t kPiece = std::size_t{1} << 30;  // of a block
/// Bytes from which a message goes out in many pieces, one with each call of MPI: who sleeps between them
/// holds it up.
constexpr std::size_t kManyPieces = std::size_t{1} << 20;

/// Gives way to other processes while there is nothing to do: ranks may share a core. What comes soon is met
/// awake, since to sleep and to be woken takes longer than most answers. Then it sleeps: on a busy machine
/// who sleeps is woken before those who only give way. It does so for a sixteenth of the time that it has
/// waited, so that it comes little late and takes little from whoever works.
class Patience {
 public:
  void pause() const {
    using namespace std::chrono;
    constexpr microseconds kAwake(500), kLongest(2'000);
    const auto waited = duration_cast<microseconds>(steady_clock::now() - start_);
    if (waited < kAwake)
      std::this_thread::yield();
    else
      std::this_thread::sleep_for(std::min(waited / 16, kLongest));
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

constexpr std::size_t kMostToCount = std::numeric_limits<int>::max();

int to_count(std::size_t n) {
  if (n > kMostToCount) throw InternalError("more than MPI can count");
  return static_cast<int>(n);
}

}  // namespace

Comm::Comm(MPI_Comm comm) {
  int is_on = 0;
  MPI_Initialized(&is_on);
  HFR_REQUIRE(is_on != 0, "MPI is not initialised: call MPI_Init_thread first");
  require(MPI_Comm_dup(comm, &comm_));
  require(MPI_Comm_rank(comm_, &rank_));
  require(MPI_Comm_size(comm_, &size_));
  static_assert(std::is_trivially_copyable_v<Question>);
  require(MPI_Type_contiguous(static_cast<int>(sizeof(Question)), MPI_BYTE, &question_type_));
  require(MPI_Type_commit(&question_type_));
  require(MPI_Op_create(&Comm::combine, /*commute=*/1, &combine_));
}

Comm::~Comm() {
  int is_over = 0;
  MPI_Finalized(&is_over);
  if (is_over) return;
  MPI_Op_free(&combine_);
  MPI_Type_free(&question_type_);
  MPI_Comm_free(&comm_);
}

void Comm::combine(void* in, void* in_out, int* n, MPI_Datatype*) {
  const auto* mine = static_cast<const std::byte*>(in);
  auto* all = static_cast<std::byte*>(in_out);
  for (int i = 0; i < *n; ++i, mine += sizeof(Question), all += sizeof(Question)) {
    Question a, b;
    std::memcpy(&a, mine, sizeof(Question));
    std::memcpy(&b, all, sizeof(Question));
    b.first_failed = std::min(a.first_failed, b.first_failed);
    b.least = std::min(a.least, b.least);
    for (std::size_t k = 0; k < kMostSums; ++k) b.sums[k] += a.sums[k];
    std::memcpy(all, &b, sizeof(Question));
  }
}

/// Before a call in which others take part: who has more than one message holds leaves it to none to wait.
void Comm::require_short(std::size_t n) const {
  if (n > std::min(kMostToCount, most_bytes_))
    throw ResourceLimit("a message between ranks has more than 2 GiB: use more ranks");
}

/// Returns the phase until now.
Phase Comm::enter(Phase phase) {
  const auto now = Clock::now();
  seconds_[static_cast<std::size_t>(phase_)] += std::chrono::duration<double>(now - since_).count();
  since_ = now;
  if (phase != Phase::kWait) counted_ = phase;
  return std::exchange(phase_, phase);
}

void Comm::require(int result) {
  if (result != MPI_SUCCESS) throw ResourceLimit("MPI reports error " + std::to_string(result));
}

void Comm::wait(MPI_Request& request) {
  const InPhase waiting(*this, Phase::kWait);
  const Patience patience;
  for (int done = 0;;) {
    require(MPI_Test(&request, &done, MPI_STATUS_IGNORE));
    if (done) return;
    patience.pause();
  }
}

std::optional<RankFailed> Comm::ask(Question& question, int code, const std::string& message) {
  question.first_failed = code == 0 ? kNobody : std::int64_t{kCodes} * rank_ + code;
  const Question mine = question;
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Iallreduce(&mine, &question, 1, question_type_, combine_, comm_, &request));
  wait(request);
  if (question.first_failed == kNobody) return std::nullopt;
  const int rank = static_cast<int>(question.first_failed / kCodes);
  std::array<char, kLongestMessage> text{};
  if (rank == rank_) message.copy(text.data(), text.size() - 1);
  require(MPI_Ibcast(text.data(), to_count(text.size()), MPI_CHAR, rank, comm_, &request));
  wait(request);
  return RankFailed(rank, static_cast<int>(question.first_failed % kCodes), text.data());
}

void Comm::agree(Question& question) {
  if (++n_calls_ == fail_at_) throw ResourceLimit("a fault that was asked for");
  if (const auto failed = ask(question, 0, {})) throw *failed;
}

RankFailed Comm::fail(int code, const std::string& message) {
  Question question;
  return *ask(question, std::clamp(code, 1, kCodes - 1), message);
}

/// Where nobody sends anything, the question is all.
Comm::Exchanged Comm::exchange(std::vector<Packer>& to, std::uint64_t value) {
  Question question;
  question.sums[0] = value;
  for (std::size_t r = 0; r < n_ranks(); ++r) {
    if (static_cast<int>(r) == rank_ || to[r].empty()) continue;
    require_short(to[r].bytes().size());
    ++question.sums[1];
  }
  agree(question);
  ++counts().exchanges;
  Exchanged result;
  result.sum = question.sums[0];
  result.n_messages = question.sums[1];
  if (question.sums[1] > 0)
    result.messages = send_and_receive(to);
  else if (auto& mine = to[static_cast<std::size_t>(rank_)]; !mine.empty())
    result.messages.push_back({rank_, std::move(mine.bytes())});
  return result;
}

std::vector<Comm::Message> Comm::send_and_receive(std::vector<Packer>& to) {
  const InPhase waiting(*this, Phase::kWait);
  tag_ = (tag_ + 1) % kTags;
  std::vector<Message> came;
  std::vector<MPI_Request> sends;
  std::size_t longest = 0;
  for (int r = 0; r < size_; ++r) {
    auto& bytes = to[static_cast<std::size_t>(r)].bytes();
    if (bytes.empty()) continue;
    if (r == rank_) {
      came.push_back({r, std::move(bytes)});
      continue;
    }
    ++counts().messages;
    counts().bytes += bytes.size();
    longest = std::max(longest, bytes.size());
    sends.emplace_back();
    require(MPI_Issend(bytes.data(), to_count(bytes.size()), MPI_BYTE, r, tag_, comm_, &sends.back()));
  }
  MPI_Request barrier = MPI_REQUEST_NULL;
  bool in_barrier = false, has_room = true;
  const Patience patience;
  for (int done = 0; !done;) {
    int is_there = 0;
    MPI_Status status;
    require(MPI_Iprobe(MPI_ANY_SOURCE, tag_, comm_, &is_there, &status));
    if (is_there) {
      int n = 0;
      require(MPI_Get_count(&status, MPI_BYTE, &n));
      Message message{status.MPI_SOURCE, {}};
      try {
        message.bytes.resize(static_cast<std::size_t>(n));
      } catch (
          const std::bad_alloc&) {  // it cannot be refused: this rank makes room, and fails once all is sent
        has_room = false;
        came = {};
        try {
          message.bytes.resize(static_cast<std::size_t>(n));
        } catch (const std::bad_alloc&) {  // cut off: who has sent it waits for that
          static_cast<void>(
              MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, tag_, comm_, MPI_STATUS_IGNORE));
          continue;
        }
      }
      require(MPI_Recv(message.bytes.data(), n, MPI_BYTE, status.MPI_SOURCE, tag_, comm_, MPI_STATUS_IGNORE));
      if (has_room) came.push_back(std::move(message));
      continue;
    }
    if (in_barrier) {
      require(MPI_Test(&barrier, &done, MPI_STATUS_IGNORE));
    } else {
      int all_sent = 0;
      require(MPI_Testall(static_cast<int>(sends.size()), sends.data(), &all_sent, MPI_STATUSES_IGNORE));
      if (all_sent) {
        require(MPI_Ibarrier(comm_, &barrier));
        in_barrier = true;
      }
    }
    if (longest >= kManyPieces && !in_barrier)
      std::this_thread::yield();
    else
      patience.pause();
  }
  if (!has_room) throw ResourceLimit("no memory for what other ranks send");
  std::sort(came.begin(), came.end(), [](const Message& a, const Message& b) { return a.from < b.from; });
  return came;
}

std::vector<std::byte> Comm::all_gather_bytes(std::span<const std::byte> mine) {
  constexpr int kNoRoom = -1;
  std::vector<int> counts(n_ranks()), begins(n_ranks());
  require_short(mine.size());
  Question question;
  question.sums[0] = mine.size();
  agree(question);
  ++this->counts().collectives;
  this->counts().collective_bytes += mine.size();
  if (question.sums[0] == 0) return {};
  require_short(question.sums[0]);  // of all ranks, which all throw
  int n = to_count(mine.size());
  std::vector<std::byte> all;
  try {
    all.resize(question.sums[0]);
  } catch (const std::bad_alloc&) {
    n = kNoRoom;
  }
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Iallgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, comm_, &request));
  wait(request);
  if (n == kNoRoom) throw ResourceLimit("no memory for what the ranks tell each other");
  if (std::find(counts.begin(), counts.end(), kNoRoom) != counts.end()) {
    agree();  // with a rank that has failed
    throw InternalError("a rank without room has not failed");
  }
  std::size_t sum = 0;
  for (std::size_t r = 0; r < n_ranks(); ++r) {
    begins[r] = to_count(sum);
    sum += static_cast<std::size_t>(counts[r]);
  }
  require(MPI_Iallgatherv(mine.data(), n, MPI_BYTE, all.data(), counts.data(), begins.data(), MPI_BYTE, comm_,
                          &request));
  wait(request);
  return all;
}

std::uint64_t Comm::sum(std::uint64_t mine) {
  sum(std::span<std::uint64_t>(&mine, 1));
  return mine;
}

void Comm::sum(std::span<std::uint64_t> values) {
  sum_and_min(values, std::numeric_limits<double>::infinity());
}

double Comm::min(double mine) { return sum_and_min({}, mine); }

double Comm::sum_and_min(std::span<std::uint64_t> values, double mine) {
  HFR_REQUIRE(values.size() <= kMostSums, "more sums at once than a question has room for");
  Question question;
  std::copy(values.begin(), values.end(), question.sums.begin());
  question.least = mine;
  agree(question);
  ++counts().collectives;
  counts().collective_bytes += sizeof(Question);
  std::copy_n(question.sums.begin(), values.size(), values.begin());
  return question.least;
}

Block Comm::hand_out(const std::function<Block(int)>& make) {
  agree();
  ++counts().exchanges;
  tag_ = (tag_ + 1) % kTags;
  if (rank_ != 0) return receive_block();
  Block before, block;  // of the rank before, while that of this one is made
  std::vector<MPI_Request> requests;
  const auto wait_for_all = [&] {
    for (MPI_Request& request : requests) wait(request);
    requests.clear();
  };
  for (int r = 1; r < size_; ++r) {
    try {
      block = make(r);
    } catch (...) {  // nobody may wait for what does not come
      wait_for_all();
      for (; r < size_; ++r) send_block(r, {}, requests);
      wait_for_all();
      throw;
    }
    wait_for_all();
    before = std::move(block);
    send_block(r, before, requests);
  }
  Block mine;
  try {
    mine = make(0);
  } catch (...) {  // the others have theirs, and hear of it at the next call
    wait_for_all();
    throw;
  }
  wait_for_all();
  return mine;
}

/// How long it is, then, as soon as there is room for it, the block, in pieces that MPI can count.
void Comm::send_block(int to, const Block& block, std::vector<MPI_Request>& requests) {
  std::uint64_t size = block.size();
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Isend(&size, 1, MPI_UINT64_T, to, tag_, comm_, &request));
  wait(request);
  if (size == 0) return;
  char has_room = 0;
  require(MPI_Irecv(&has_room, 1, MPI_CHAR, to, tag_, comm_, &request));
  wait(request);
  if (!has_room) return;
  ++counts().messages;
  counts().bytes += size;
  for (std::size_t at = 0; at < block.size(); at += kPiece) {
    requests.emplace_back();
    require(MPI_Isend(block.data() + at, to_count(std::min(kPiece, block.size() - at)), MPI_BYTE, to, tag_,
                      comm_, &requests.back()));
  }
}

Block Comm::receive_block() {
  std::uint64_t size = 0;
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Irecv(&size, 1, MPI_UINT64_T, 0, tag_, comm_, &request));
  wait(request);
  if (size == 0) {  // rank 0 has failed and says so now
    agree();
    throw InternalError("rank 0 sends nothing");
  }
  Block block;
  char has_room = 1;
  try {
    block = Block(size);
  } catch (const std::bad_alloc&) {
    has_room = 0;
  }
  require(MPI_Isend(&has_room, 1, MPI_CHAR, 0, tag_, comm_, &request));
  wait(request);
  if (!has_room) throw ResourceLimit("no memory for this rank's part of the mesh");
  for (std::size_t at = 0; at < block.size(); at += kPiece) {
    require(MPI_Irecv(block.data() + at, to_count(std::min(kPiece, block.size() - at)), MPI_BYTE, 0, tag_,
                      comm_, &request));
    wait(request);
  }
  return block;
}

std::vector<std::byte> told_by_first(Comm& comm, const Packer& said) {
  // Not a message to each, of which the first rank would hold as many copies.
  const std::vector<std::byte> none;
  return comm.all_gather(std::span<const std::byte>(comm.rank() == 0 ? said.bytes() : none));
}

}  // namespace hfr::mpi
