// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_CHART_HH
#define HFR_APPS_REPORT_CHART_HH

#include <string>

#include "Canvas.hh"
#include "hfremesh/Quality/Statistics.hh"

namespace hfr::view {

struct Rectangle {
  double left = 0, top = 0, right = 0, bottom = 0;
};

inline constexpr Colour kInk = hex(0x1c2733), kPaleInk = hex(0x5c6b7a), kRule = hex(0xd5dbe2);

/// The largest share of all dihedral angles that a bin of 5 degrees has, from 0 to 1.
double highest_share(const Statistics& statistics);
/// Histogram of all dihedral angles, with the smallest, the largest and the number of inverted cells in
/// words. `highest`: the share at the upper end of the scale.
void draw_histogram(Canvas& canvas, Rectangle where, const Statistics& statistics, double highest);
/// What the colours of cells mean, its middle at (x, y).
void draw_legend(Canvas& canvas, double x, double y);

/// 1234567 as "1,234,567".
std::string grouped(std::size_t n);

}  // namespace hfr::view

#endif
