// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Lowest.hh"

namespace hfr {

Lowest lowest_of(const double* numbers, std::size_t n) {
  return with_widest_lanes<lowest_in<Lanes<8>>, lowest_in<Lanes<4>>, lowest_in<Lanes<2>>>(numbers, n);
}

Floor floor_of(const double* numbers, std::size_t n, double bound) {
  return with_widest_lanes<floor_in<Lanes<8>>, floor_in<Lanes<4>>, floor_in<Lanes<2>>>(numbers, n, bound);
}

}  // namespace hfr
