// SPDX-License-Identifier: BSD-3-Clause
// Replaces operator new for the whole test program, so that "never allocates" is counted and not believed.
#include "CountingNew.hh"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> n_calls{0};
}

std::size_t hfr::test::n_allocations() { return n_calls.load(); }

#if HFR_COUNTS_ALLOCATIONS
// Both forms, since AddressSanitizer has its own of what is not replaced, and its memory must not meet our
// delete.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  n_calls.fetch_add(1, std::memory_order_relaxed);
  return std::malloc(size == 0 ? 1 : size);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif
