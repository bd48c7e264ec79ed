// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_FUZZ_RANDOM_OPTIONS_HH
#define HFR_UNITTESTS_FUZZ_RANDOM_OPTIONS_HH

#include <string>

#include "Fuzz/RandomComplex.hh"
#include "Remesh/Improve.hh"

namespace hfr::fuzz {

/// Options of a run, and when it is cancelled.
struct RandomOptions {
  ImproveOptions improve;
  int cancel_at = 0;  ///< the number of the question that is answered with "stop"; 0: none
  int threads = 3;    ///< of the run that has to give the bits of one thread

  /// As arguments of the tool; what it has no argument for follows a '#'.
  std::string command_line() const;
};

/// The options of that number for that complex.
RandomOptions random_options(std::uint64_t number, const Complex& complex);
/// What the numbers that come next make.
RandomOptions random_options(Random random, const Complex& complex);

}  // namespace hfr::fuzz

#endif
