// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_FUZZ_PROMISES_HH
#define HFR_UNITTESTS_FUZZ_PROMISES_HH

#include <string>
#include <vector>

#include "Fuzz/Measure.hh"
#include "Fuzz/RandomOptions.hh"

namespace hfr::fuzz {

/// A promise that a run did not keep.
struct Finding {
  std::string promise;  ///< one word or two, for grouping
  std::string detail;
};

/// Holds what docs/fuzzing.md lists against a mesh before and after a run.
void compare_meshes(const Measure& before, const Measure& after, const RandomOptions& options,
                    const SurfaceReport& surface, std::vector<Finding>& findings);

/// Holds what a run says of its mesh against the mesh. `same_bits`: whether it is the one that went in.
void compare_result(const TetMesh& mesh, const Result& result, bool same_bits, const RandomOptions& options,
                    std::vector<Finding>& findings);

}  // namespace hfr::fuzz

#endif
