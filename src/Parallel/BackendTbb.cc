// SPDX-License-Identifier: BSD-3-Clause
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include "Parallel/Backend.hh"
#include "Parallel/Interleave.hh"

namespace hfr::par::detail {

int backend_threads() { return tbb::this_task_arena::max_concurrency(); }

void backend_parts(int parts, void (*body)(void*, int), void* context) {
  // One part a task: more parts than threads are worked off one after the other.
  tbb::parallel_for(
      tbb::blocked_range<int>(0, parts, 1),
      [&](const tbb::blocked_range<int>& range) {
        for (int part = range.begin(); part != range.end(); ++part) body(context, part);
      },
      tbb::simple_partitioner());
}

const bool kInterleaves = false;
void interleave() {}

}  // namespace hfr::par::detail
