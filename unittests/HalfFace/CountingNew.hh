// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_HALFFACE_COUNTING_NEW_HH
#define HFR_UNITTESTS_HALFFACE_COUNTING_NEW_HH

#include <cstddef>

namespace hfr::test {

/// Calls of operator new in this program so far.
std::size_t n_allocations();

}  // namespace hfr::test

#endif
