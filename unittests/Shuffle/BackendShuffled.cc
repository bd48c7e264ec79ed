// SPDX-License-Identifier: BSD-3-Clause
#include <sys/mman.h>
#include <ucontext.h>

#include <algorithm>
#include <array>
#include <limits>
#include <new>
#include <numeric>
#include <vector>

#include "Parallel/Backend.hh"
#include "Parallel/Interleave.hh"
#include "Shuffle/Shuffle.hh"

namespace hfr::test {
namespace {

/// Memory that a fibre runs on; pages that it does not touch cost nothing.
class FibreStack {
 public:
  FibreStack()
      : bytes_(mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1,
                    0)) {
    if (bytes_ == MAP_FAILED) throw std::bad_alloc();
  }
  ~FibreStack() { munmap(bytes_, kSize); }
  FibreStack(const FibreStack&) = delete;
  FibreStack& operator=(const FibreStack&) = delete;

  stack_t get() const {
    stack_t stack{};
    stack.ss_sp = bytes_;
    stack.ss_size = kSize;
    return stack;
  }

 private:
  static constexpr std::size_t kSize = std::size_t{8} << 20;
  void* bytes_;
};

/// Runs the parts of a loop as its random sequence says.
class Conductor {
 public:
  static Conductor& get() {
    static Conductor conductor;
    return conductor;
  }

  void begin(std::uint64_t seed) {
    state_ = seed;
    n_switches_ = 0;
  }
  std::size_t n_switches() const { return n_switches_; }

  void run(int n_parts, void (*body)(void*, int), void* context) {
    const auto n = static_cast<std::size_t>(n_parts);
    if (inside_) {  // a loop within a part: its parts one after the other, in any order
      for (std::size_t part : shuffled(n)) body(context, static_cast<int>(part));
      return;
    }
    if (fibres_.size() < n) fibres_ = std::vector<Fibre>(n);
    body_ = body;
    context_ = context;
    std::vector<std::size_t> waiting = shuffled(n);
    for (std::size_t part : waiting) start(part);
    // Steps of most lengths: each length finds other faults.
    constexpr std::array<std::size_t, 6> kPaces = {1,   4,     20,
                                                   150, 2'000, std::numeric_limits<std::size_t>::max() / 4};
    pace_ = kPaces[below(kPaces.size())];
    // Now and then one part sleeps until the others are nearly done, or all but one.
    const std::size_t sleeper = below(4) == 0 ? waiting[0] : n;
    inside_ = true;
    while (!waiting.empty()) {
      std::size_t at = below(waiting.size());
      if (waiting[at] == sleeper && below(20) != 0) at = below(waiting.size());
      part_ = waiting[at];
      left_ = 1 + below(2 * pace_);
      swapcontext(&outside_, &fibres_[part_].context);
      if (fibres_[part_].done) waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(at));
    }
    inside_ = false;
  }

  void give_way() {
    if (!inside_ || --left_ > 0) return;
    ++n_switches_;
    swapcontext(&fibres_[part_].context, &outside_);
  }

 private:
  struct Fibre {
    FibreStack stack;
    ucontext_t context{};
    bool done = false;
  };

  std::uint64_t next() {  // splitmix64
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
    return z ^ z >> 31;
  }
  std::size_t below(std::size_t n) { return next() % n; }

  std::vector<std::size_t> shuffled(std::size_t n) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[below(i)]);
    return order;
  }

  void start(std::size_t part) {
    Fibre& fibre = fibres_[part];
    fibre.done = false;
    getcontext(&fibre.context);
    fibre.context.uc_stack = fibre.stack.get();
    fibre.context.uc_link = &outside_;
    makecontext(&fibre.context, run_part, 0);
  }

  static void run_part() {
    Conductor& conductor = get();
    const std::size_t part = conductor.part_;
    conductor.body_(conductor.context_, static_cast<int>(part));
    conductor.fibres_[part].done = true;
  }

  std::uint64_t state_ = 0;
  std::size_t n_switches_ = 0;
  std::vector<Fibre> fibres_;
  ucontext_t outside_{};
  void (*body_)(void*, int) = nullptr;
  void* context_ = nullptr;
  bool inside_ = false;
  std::size_t part_ = 0;  // that runs now
  std::size_t pace_ = 1;  // mean number of shared accesses between switches
  std::size_t left_ = 0;  // until the next one
};

}  // namespace

void shuffle(std::uint64_t seed) { Conductor::get().begin(seed); }
std::size_t n_switches() { return Conductor::get().n_switches(); }

}  // namespace hfr::test

namespace hfr::par::detail {

const bool kInterleaves = true;
void interleave() { test::Conductor::get().give_way(); }

int backend_threads() { return 16; }

void backend_parts(int parts, void (*body)(void*, int), void* context) {
  test::Conductor::get().run(parts, body, context);
}

}  // namespace hfr::par::detail
