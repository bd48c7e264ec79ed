// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_SURVEY_HH
#define HFR_REMESH_SURVEY_HH

#include <cstddef>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// The mesh in two numbers, from one pass over its cells.
struct Survey {
  double worst = 0;           ///< smallest decision value of MinDihedral; infinity without cells
  std::size_t n_invalid = 0;  ///< cells whose volume is not positive beyond rounding
};
Survey survey(const TetMesh& mesh, par::Policy policy);

}  // namespace hfr

#endif
