// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Lowest.hh"

namespace hfr {

Lowest lowest_of(const double* numbers, std::size_t n) {
  return with_widest_lanes<lowest_in<Lanes<8>>, lowest_in<Lanes<4>>, lowest_in<Lanes<2>>>(numbers, n);
}

}  // namespace hfr
