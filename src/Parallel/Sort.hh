// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_PARALLEL_SORT_HH
#define HFR_PARALLEL_SORT_HH

#include <cstdint>
#include <span>
#include <vector>

#include "Parallel/Parallel.hh"

namespace hfr::par {

/// A 64-bit key with the index of what it stands for.
struct KeyIndex {
  std::uint64_t key;
  std::uint32_t index;
};

/// Stable ascending sort by key. Short inputs use a merge sort, long ones a least-significant-digit radix
/// sort over the bytes in which keys differ; `scratch` keeps its memory between calls.
void stable_sort(Policy policy, std::vector<KeyIndex>& items, std::vector<KeyIndex>& scratch);

}  // namespace hfr::par

#endif
