// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_SHUFFLE_SHUFFLE_HH
#define HFR_UNITTESTS_SHUFFLE_SHUFFLE_HH

#include <cstddef>
#include <cstdint>

/// The backend of src/Parallel that these tests are linked with (BackendShuffled.cc). The parts of a loop run
/// on fibres of one thread: one goes on until it comes to par::before_shared_access(), where the next number
/// of a random sequence decides who goes on, and for how long. So a seed gives the same order of all shared
/// accesses each time. It cannot show what a weaker memory order than that of one thread would bring; that is
/// for scripts/tsan.sh.
namespace hfr::test {

/// Begins the random sequence of the loops that follow.
void shuffle(std::uint64_t seed);

/// How often one part gave way to another since the last call of shuffle().
std::size_t n_switches();

}  // namespace hfr::test

#endif
