// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_EDGE_LENGTHS_HH
#define HFR_QUALITY_EDGE_LENGTHS_HH

#include "Parallel/Policy.hh"
#include "Quality/Statistics.hh"

/// The part of statistics() that tells how long edges are; internal to this folder.
namespace hfr::detail {

/// Percentiles over the six edges of every cell, to 1.1 % (from counts in bins of equal ratio). `least` and
/// `most`: lengths of the shortest and the longest edge. Minimum, mean and maximum are left to the caller.
Distribution edge_length_percentiles(const TetMesh& mesh, par::Policy policy, double least, double most);

}  // namespace hfr::detail

#endif
