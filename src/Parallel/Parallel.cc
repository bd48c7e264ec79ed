// SPDX-License-Identifier: BSD-3-Clause
#include "Parallel/Parallel.hh"

#include <atomic>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace hfr::par {

Policy Policy::all() {
  Policy policy;
#ifdef _OPENMP
  policy.threads = omp_get_max_threads();
#endif
  return policy;
}

int thread_count(Policy policy, std::size_t n) {
#ifdef _OPENMP
  if (n < policy.serial_below || policy.threads <= 1) return 1;
  return policy.threads;
#else
  (void)policy;
  (void)n;
  return 1;
#endif
}

namespace detail {

void run_parts(int parts, void (*body)(void*, int), void* context) {
  std::vector<std::exception_ptr> failed(static_cast<std::size_t>(parts));
#ifdef _OPENMP
// One iteration a part, so that the result never depends on how many threads the runtime really grants.
#pragma omp parallel for num_threads(parts) schedule(static, 1)
#endif
  for (int part = 0; part < parts; ++part) {
    try {
      body(context, part);
    } catch (...) {
      failed[static_cast<std::size_t>(part)] = std::current_exception();
    }
  }
  for (const std::exception_ptr& error : failed)
    if (error) std::rethrow_exception(error);
}

void run_blocks(int n_threads, std::size_t n_blocks, void (*body)(void*, std::size_t), void* context) {
  std::atomic<std::size_t> next{0};
  parts(n_threads, [&](int) {
    for (std::size_t b = next.fetch_add(1, std::memory_order_relaxed); b < n_blocks;
         b = next.fetch_add(1, std::memory_order_relaxed))
      body(context, b);
  });
}

}  // namespace detail
}  // namespace hfr::par
