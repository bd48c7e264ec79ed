// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Rank.hh"

#include <algorithm>

namespace hfr {

void rank(par::Policy policy, std::vector<par::KeyIndex>& keys, std::vector<par::KeyIndex>& scratch,
          std::span<const Tet> identities) {
  par::stable_sort(policy, keys, scratch);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].key != keys[i - 1].key) continue;
    std::size_t end = i + 1;
    while (end < keys.size() && keys[end].key == keys[i].key) ++end;
    std::sort(keys.begin() + static_cast<std::ptrdiff_t>(i - 1),
              keys.begin() + static_cast<std::ptrdiff_t>(end),
              [&](const par::KeyIndex& a, const par::KeyIndex& b) {
                return identities[a.index] < identities[b.index];
              });
    i = end;
  }
}

}  // namespace hfr
