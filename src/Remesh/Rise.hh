// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RISE_HH
#define HFR_REMESH_RISE_HH

#include <algorithm>

#include "Quality/Metric.hh"
#include "Remesh/Strategy.hh"

namespace hfr {

// Loops that go on while the worst angle rises by a factor. Among cells that are all but flat, below
// kPlainGoal, a factor is soon had, by rounding as well, and each time with more cells: there it has to come
// beyond that, unless no more is wanted. With a factor of 1 any rise counts, and so it does among inverted
// and flat cells.

namespace detail {

inline double to_rise(double worst, double factor, double wanted, double flat) {
  if (worst <= 0) return worst;
  return wanted > flat && factor > 1 ? std::max(worst * factor, flat) : worst * factor;
}

}  // namespace detail

/// What the smallest angle has to exceed on the way to the one that is wanted: degrees.
inline double angle_to_rise(double worst, double factor, double wanted) {
  return detail::to_rise(worst, factor, wanted, kPlainGoal);
}
/// The same of decision values of dihedral angles.
inline double value_to_rise(double worst, double factor, double wanted) {
  return detail::to_rise(worst, factor, wanted, dihedral_decision(kPlainGoal));
}

}  // namespace hfr

#endif
