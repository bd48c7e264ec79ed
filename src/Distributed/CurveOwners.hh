// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_CURVE_OWNERS_HH
#define HFR_DISTRIBUTED_CURVE_OWNERS_HH

#include <cstddef>
#include <cstdint>

#include "Distributed/CommonBox.hh"
#include "Distributed/Stretches.hh"
#include "HalfFace/Reorder.hh"

namespace hfr::mpi {

/// Who owns what: stretches of Hilbert's curve through the box of all points, about as many points on each.
class CurveOwners {
 public:
  /// Of n points of this rank, point_of(i) is one. All take part.
  template <class PointOf>
  CurveOwners(Comm& comm, std::size_t n, PointOf&& point_of)
      : grid_(common_grid(comm, n, point_of)),
        stretches_(comm, n, [&](std::size_t i) { return grid_.place(point_of(i)); }) {}

  std::int32_t operator()(Vec3 p) const { return stretches_.rank_of(grid_.place(p)); }

 private:
  template <class PointOf>
  static CurveGrid common_grid(Comm& comm, std::size_t n, PointOf&& point_of) {
    const Box box = common_box(comm, n, point_of);
    return {SpaceCurve::kHilbert, box.low, box.high};
  }

  CurveGrid grid_;
  Stretches<> stretches_;
};

}  // namespace hfr::mpi

#endif
