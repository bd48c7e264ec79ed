// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_HALFFACE_COUNTING_NEW_HH
#define HFR_UNITTESTS_HALFFACE_COUNTING_NEW_HH

#include <cstddef>

namespace hfr::test {

// ThreadSanitizer has an operator new of its own, which cannot be replaced.
#if defined(__SANITIZE_THREAD__)
#define HFR_COUNTS_ALLOCATIONS 0
#elif defined(__has_feature)
#define HFR_COUNTS_ALLOCATIONS (!__has_feature(thread_sanitizer))
#else
#define HFR_COUNTS_ALLOCATIONS 1
#endif

/// Calls of operator new in this program so far; 0 where they are not counted.
std::size_t n_allocations();

}  // namespace hfr::test

#endif
