// SPDX-License-Identifier: BSD-3-Clause
#include "Parallel/Parallel.hh"

#include <atomic>

#include "Parallel/Backend.hh"
#include "Parallel/Interleave.hh"

namespace hfr::par {

Policy Policy::all() {
  Policy policy;
  policy.threads = std::max(1, detail::backend_threads());
  return policy;
}

int thread_count(Policy policy, std::size_t n) {
  const bool serial = n < policy.serial_below || policy.threads <= 1 || detail::backend_threads() == 0;
  return serial ? 1 : policy.threads;
}

namespace detail {

void run_parts(int parts, void (*body)(void*, int), void* context) {
  std::vector<std::exception_ptr> failed(static_cast<std::size_t>(parts));
  auto run_part = [&](int part) {
    try {
      body(context, part);
    } catch (...) {
      failed[static_cast<std::size_t>(part)] = std::current_exception();
    }
  };
  using RunPart = decltype(run_part);
  backend_parts(
      parts, [](void* run, int part) { (*static_cast<RunPart*>(run))(part); }, &run_part);
  for (const std::exception_ptr& error : failed)
    if (error) std::rethrow_exception(error);
}

void run_blocks(int n_threads, std::size_t n_blocks, void (*body)(void*, std::size_t), void* context) {
  std::atomic<std::size_t> next{0};
  parts(n_threads, [&](int) {
    for (;;) {
      before_shared_access();
      const std::size_t b = next.fetch_add(1, std::memory_order_relaxed);
      if (b >= n_blocks) break;
      body(context, b);
    }
  });
}

}  // namespace detail
}  // namespace hfr::par
