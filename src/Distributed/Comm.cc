// SPDX-License-Identifier: BSD-3-Clause
// Messages whose receivers do not know of them: T. Hoefler, C. Siebert, A. Lumsdaine, Scalable communication
// protocols for dynamic sparse data exchange, PPoPP 2010 (the nonblocking consensus).
#include "Distributed/Comm.hh"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <string>
#include <thread>

namespace hfr::mpi {
namespace {

constexpr std::int64_t kNobody = std::numeric_limits<std::int64_t>::max();
constexpr int kCodes = 256;
constexpr int kTags = 16'384;
constexpr std::size_t kLongestMessage = 512;  // of a rank that fails

/// Gives way to other processes while there is nothing to do, the longer the more: ranks may share a core.
class Patience {
 public:
  void pause() {
    // Who sleeps is woken before those who only give way: on a busy machine that is what counts.
    if (++n_ > 500) std::this_thread::sleep_for(std::chrono::microseconds(n_ < 20'000 ? 20 : 500));
  }

 private:
  int n_ = 0;
};

int to_count(std::size_t n) {
  if (n > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw ResourceLimit("a message between ranks has more than 2 GiB: use more ranks");
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
}

Comm::~Comm() {
  int is_over = 0;
  MPI_Finalized(&is_over);
  if (!is_over) MPI_Comm_free(&comm_);
}

void Comm::require(int result) {
  if (result != MPI_SUCCESS) throw ResourceLimit("MPI reports error " + std::to_string(result));
}

void Comm::wait(MPI_Request& request) {
  Patience patience;
  for (int done = 0;;) {
    require(MPI_Test(&request, &done, MPI_STATUS_IGNORE));
    if (done) return;
    patience.pause();
  }
}

std::optional<RankFailed> Comm::ask(int code, const std::string& message) {
  const std::int64_t mine = code == 0 ? kNobody : std::int64_t{kCodes} * rank_ + code;
  std::int64_t first = kNobody;
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Iallreduce(&mine, &first, 1, MPI_INT64_T, MPI_MIN, comm_, &request));
  wait(request);
  if (first == kNobody) return std::nullopt;
  const int rank = static_cast<int>(first / kCodes);
  std::array<char, kLongestMessage> text{};
  if (rank == rank_) message.copy(text.data(), text.size() - 1);
  require(MPI_Ibcast(text.data(), to_count(text.size()), MPI_CHAR, rank, comm_, &request));
  wait(request);
  return RankFailed(rank, static_cast<int>(first % kCodes), text.data());
}

void Comm::agree() {
  if (++n_calls_ == fail_at_) throw ResourceLimit("a fault that was asked for");
  if (const auto failed = ask(0, {})) throw *failed;
}

RankFailed Comm::fail(int code, const std::string& message) {
  return *ask(std::clamp(code, 1, kCodes - 1), message);
}

std::vector<Comm::Message> Comm::exchange(std::vector<Packer>& to) {
  agree();
  ++traffic_.exchanges;
  tag_ = (tag_ + 1) % kTags;
  std::vector<Message> came;
  std::vector<MPI_Request> sends;
  for (int r = 0; r < size_; ++r) {
    auto& bytes = to[static_cast<std::size_t>(r)].bytes();
    if (bytes.empty()) continue;
    if (r == rank_) {
      came.push_back({r, std::move(bytes)});
      continue;
    }
    ++traffic_.messages;
    traffic_.bytes += bytes.size();
    sends.emplace_back();
    require(MPI_Issend(bytes.data(), to_count(bytes.size()), MPI_BYTE, r, tag_, comm_, &sends.back()));
  }
  MPI_Request barrier = MPI_REQUEST_NULL;
  bool in_barrier = false;
  Patience patience;
  for (int done = 0; !done;) {
    int is_there = 0;
    MPI_Status status;
    require(MPI_Iprobe(MPI_ANY_SOURCE, tag_, comm_, &is_there, &status));
    if (is_there) {
      int n = 0;
      require(MPI_Get_count(&status, MPI_BYTE, &n));
      Message message{status.MPI_SOURCE, std::vector<std::byte>(static_cast<std::size_t>(n))};
      require(MPI_Recv(message.bytes.data(), n, MPI_BYTE, status.MPI_SOURCE, tag_, comm_, MPI_STATUS_IGNORE));
      came.push_back(std::move(message));
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
    patience.pause();
  }
  std::sort(came.begin(), came.end(), [](const Message& a, const Message& b) { return a.from < b.from; });
  return came;
}

std::vector<std::byte> Comm::all_gather_bytes(std::span<const std::byte> mine) {
  agree();
  ++traffic_.collectives;
  traffic_.collective_bytes += mine.size();
  const int n = to_count(mine.size());
  std::vector<int> counts(n_ranks()), begins(n_ranks());
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Iallgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, comm_, &request));
  wait(request);
  std::size_t sum = 0;
  for (std::size_t r = 0; r < n_ranks(); ++r) {
    begins[r] = to_count(sum);
    sum += static_cast<std::size_t>(counts[r]);
  }
  std::vector<std::byte> all(static_cast<std::size_t>(to_count(sum)));
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
  agree();
  ++traffic_.collectives;
  traffic_.collective_bytes += values.size_bytes();
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Iallreduce(MPI_IN_PLACE, values.data(), to_count(values.size()), MPI_UINT64_T, MPI_SUM, comm_,
                         &request));
  wait(request);
}

double Comm::min(double mine) {
  agree();
  ++traffic_.collectives;
  traffic_.collective_bytes += sizeof(double);
  MPI_Request request = MPI_REQUEST_NULL;
  double least = mine;
  require(MPI_Iallreduce(&mine, &least, 1, MPI_DOUBLE, MPI_MIN, comm_, &request));
  wait(request);
  return least;
}

std::vector<std::byte> Comm::from_first(std::vector<std::byte> bytes) {
  agree();
  ++traffic_.collectives;
  std::uint64_t n = bytes.size();
  MPI_Request request = MPI_REQUEST_NULL;
  require(MPI_Ibcast(&n, 1, MPI_UINT64_T, 0, comm_, &request));
  wait(request);
  bytes.resize(n);
  require(MPI_Ibcast(bytes.data(), to_count(bytes.size()), MPI_BYTE, 0, comm_, &request));
  wait(request);
  if (rank_ == 0) traffic_.collective_bytes += n;
  return bytes;
}

}  // namespace hfr::mpi
