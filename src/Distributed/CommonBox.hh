// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_COMMON_BOX_HH
#define HFR_DISTRIBUTED_COMMON_BOX_HH

#include <algorithm>
#include <cstddef>
#include <limits>

#include "Distributed/Comm.hh"
#include "Remesh/Unfolding.hh"

namespace hfr::mpi {

/// Of the points of all ranks, of which this one has point_of(0) to point_of(n - 1). All take part.
template <class PointOf>
Box common_box(Comm& comm, std::size_t n, PointOf&& point_of) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Box box{{kNone, kNone, kNone}, {-kNone, -kNone, -kNone}};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = point_of(i);
    for (int d = 0; d < 3; ++d) {
      box.low[d] = std::min(box.low[d], p[d]);
      box.high[d] = std::max(box.high[d], p[d]);
    }
  }
  for (int d = 0; d < 3; ++d) {
    box.low[d] = comm.min(box.low[d]);
    box.high[d] = -comm.min(-box.high[d]);
  }
  return box;
}

}  // namespace hfr::mpi

#endif
