// SPDX-License-Identifier: BSD-3-Clause
// A library to be loaded before GNU's OpenMP runtime (LD_PRELOAD). Writes to the file of $ONE_THREAD_LOG, for
// each parallel region, when each of its threads began and ended its work: what bench/one_thread.py adds up.
#include <dlfcn.h>
#include <omp.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace {

constexpr std::size_t kMostThreads = 256;
using Body = void (*)(void*);
using Parallel = void (*)(Body, void*, unsigned, unsigned);

/// Seconds of CLOCK_MONOTONIC, as Python's time.monotonic() has them.
double now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Work {
  Body body;
  void* data;
  std::array<double, kMostThreads> begin, end;
};

/// Written when the program ends.
struct Log {
  std::vector<double> intervals;     // begin and end of each thread's work
  std::vector<std::size_t> regions;  // number of threads of each
  ~Log() {
    const char* name = std::getenv("ONE_THREAD_LOG");
    std::FILE* file = name && !regions.empty() ? std::fopen(name, "w") : nullptr;
    if (!file) return;
    std::size_t at = 0;
    for (const std::size_t n : regions) {
      for (std::size_t i = 0; i < n; ++i, at += 2)
        std::fprintf(file, "%.7f %.7f ", intervals[at], intervals[at + 1]);
      std::fputc('\n', file);
    }
    std::fclose(file);
  }
} log_of_regions;

void timed(void* context) {
  auto& work = *static_cast<Work*>(context);
  const auto thread = static_cast<std::size_t>(omp_get_thread_num());
  if (thread >= kMostThreads) return work.body(work.data);
  work.begin[thread] = now();
  work.body(work.data);
  work.end[thread] = now();
}

}  // namespace

extern "C" void GOMP_parallel(Body body, void* data, unsigned n_threads, unsigned flags) {
  static const auto real = reinterpret_cast<Parallel>(dlsym(RTLD_NEXT, "GOMP_parallel"));
  if (omp_in_parallel()) return real(body, data, n_threads, flags);
  Work work{body, data, {}, {}};
  real(timed, &work, n_threads, flags);
  std::size_t n = 0;
  for (std::size_t i = 0; i < kMostThreads && work.end[i] > 0; ++i, ++n) {
    log_of_regions.intervals.push_back(work.begin[i]);
    log_of_regions.intervals.push_back(work.end[i]);
  }
  log_of_regions.regions.push_back(n);
}
