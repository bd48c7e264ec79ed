// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_PARALLEL_INTERLEAVE_HH
#define HFR_PARALLEL_INTERLEAVE_HH

namespace hfr::par {

namespace detail {
/// Whether the backend interleaves the parts of a loop on purpose, as that of the tests does
/// (unittests/Shuffle). Defined with the backend.
extern const bool kInterleaves;
/// Lets other parts of the loop go on. Called from inside a part, where the backend interleaves.
void interleave();
}  // namespace detail

/// Stands before each access to what other parts of the loop may write at that moment: where they may come in
/// between. Does nothing but in the backend of the tests; elsewhere it costs a look at a constant
/// (docs/scheduler.md).
inline void before_shared_access() {
  if (detail::kInterleaves) [[unlikely]]
    detail::interleave();
}

}  // namespace hfr::par

#endif
