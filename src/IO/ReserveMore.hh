// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_RESERVE_MORE_HH
#define HFR_IO_RESERVE_MORE_HH

#include <algorithm>
#include <cstddef>
#include <vector>

namespace hfr::io {

/// Room for `count` more: exactly so much the first time, and at least twice as much as before later, so that
/// a file of many pieces is not copied once for each of them.
template <class T>
void reserve_more(std::vector<T>& vector, std::size_t count) {
  const std::size_t wanted = vector.size() + count;
  if (wanted > vector.capacity()) vector.reserve(std::max(wanted, 2 * vector.capacity()));
}

}  // namespace hfr::io

#endif
