// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RISE_HH
#define HFR_REMESH_RISE_HH

#include <algorithm>

#include "Quality/Metric.hh"
#include "Remesh/Strategy.hh"

namespace hfr {

// When the worst angle has risen, so that a loop goes on: by a factor, but not among angles that nobody could
// tell from 0. There a factor is soon had, by rounding as well, and each time with more cells.

/// A gain in an angle that shows in a table: degrees.
inline constexpr double kLeastRise = 0.01;

/// Of worst angles in degrees: by that factor, and by what shows in a table. Before, it may have been that of
/// an inverted cell, or 0: then it has risen once no cell is inverted or flat.
inline bool has_risen(double now, double before, double factor) {
  return now > (before > 0 ? std::max(before * factor, before + kLeastRise) : 0);
}

/// What a worst decision value has to exceed, on the way to the one that is wanted: by that factor, and where
/// more is wanted than that no cell be all but flat, beyond that. With a factor of 1 any rise counts, and so
/// it does among inverted and flat cells.
inline double value_to_rise(double worst, double factor, double wanted) {
  if (worst <= 0) return worst;
  const double flat = dihedral_decision(kPlainGoal);
  return wanted > flat && factor > 1 ? std::max(worst * factor, flat) : worst * factor;
}

}  // namespace hfr

#endif
