// SPDX-License-Identifier: BSD-3-Clause
#include "Threads.hh"

#include <algorithm>
#include <latch>
#include <system_error>
#include <thread>
#include <vector>
#ifdef __GLIBC__
#include <malloc.h>
#include <sys/resource.h>
#endif

namespace hfr::app {

int usable_threads(int wanted) {
#ifdef __GLIBC__
  // Where address space is short, a heap for each thread, which reserves 64 MiB of it, leaves none for
  // stacks. Threads make one when they end, too.
  rlimit space;
  if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) mallopt(M_ARENA_MAX, 1);
#endif
  std::latch all_are_there(1);
  std::vector<std::thread> others;
  others.reserve(static_cast<std::size_t>(std::max(wanted, 1)));
  try {
    for (int i = 1; i < wanted; ++i) others.emplace_back([&] { all_are_there.wait(); });
  } catch (const std::system_error&) {
  }
  all_are_there.count_down();
  for (std::thread& thread : others) thread.join();
  const int made = 1 + static_cast<int>(others.size());
  if (made >= wanted) return wanted;
  return std::max(1, made / 2);
}

}  // namespace hfr::app
