// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_FUZZ_CASE_HH
#define HFR_UNITTESTS_FUZZ_CASE_HH

#include <cstdint>
#include <string>
#include <vector>

#include "Fuzz/Promises.hh"
#include "Fuzz/RandomComplex.hh"
#include "Fuzz/RandomOptions.hh"

namespace hfr::fuzz {

/// A complex and what is done with it.
struct Case {
  std::uint64_t number = 0;
  Complex complex;
  RandomOptions options;
};
Case make_case(std::uint64_t number);

/// What became of one case.
struct Outcome {
  std::vector<Finding> findings;
  bool refused = false;  ///< the input or the options, with an error that says so
  std::string refusal;   ///< what improve() said then; empty where build() refused
  bool changed = false;
  bool was_invalid = false;  ///< the input had inverted or flat cells
  bool was_pinched = false;  ///< and vertices or edges at which it is no manifold
  double seconds = 0;        ///< of the run with one thread
  std::size_t cells_before = 0, cells_after = 0;
};

/// Runs the case with one thread and, for every second number, with more; writes and reads what came out.
/// `folder` is where files may be written.
Outcome run_case(const Case& wanted, const std::string& folder);

/// The same promise broken with fewer cells, labels and options, as far as trying takes it.
Case shrink(Case found, const std::string& promise, const std::string& folder);

}  // namespace hfr::fuzz

#endif
