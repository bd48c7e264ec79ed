// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_PARALLEL_POLICY_HH
#define HFR_PARALLEL_POLICY_HH

#include <cstddef>

namespace hfr::par {

/// How a parallel loop runs; passed by value, there is no global state.
struct Policy {
  int threads = 1;                  ///< ≥ 1; Policy::all() for every core that the process may use
  std::size_t serial_below = 2048;  ///< loops shorter than this stay on the calling thread

  static Policy all();

  /// The same policy for a loop whose items cost about this much each: serial only where a second thread
  /// would cost more to wake than it saves.
  Policy for_items_of(double nanoseconds) const {
    Policy out = *this;
    const auto worth_it = static_cast<std::size_t>(kForkNanoseconds / nanoseconds) + 2;
    if (worth_it < serial_below) out.serial_below = worth_it;
    return out;
  }

 private:
  static constexpr double kForkNanoseconds = 100'000;
};

}  // namespace hfr::par

#endif
