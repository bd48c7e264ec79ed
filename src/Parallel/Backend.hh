// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_PARALLEL_BACKEND_HH
#define HFR_PARALLEL_BACKEND_HH

/// What a thread library has to do for src/Parallel; one of the Backend*.cc files is compiled. It defines
/// what Interleave.hh declares, too.
namespace hfr::par::detail {

/// Threads that the process may use; 0 when loops always run serially.
int backend_threads();
/// Calls body(context, part) for part = 0 … parts-1 in any order and on any threads; none of them throws, or
/// waits for another.
void backend_parts(int parts, void (*body)(void*, int), void* context);

}  // namespace hfr::par::detail

#endif
