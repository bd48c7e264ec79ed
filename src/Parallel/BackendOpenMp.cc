// SPDX-License-Identifier: BSD-3-Clause
#include <omp.h>

#include "Parallel/Backend.hh"
#include "Parallel/Interleave.hh"

namespace hfr::par::detail {

int backend_threads() { return omp_get_max_threads(); }

void backend_parts(int parts, void (*body)(void*, int), void* context) {
// One iteration a part, so that the result never depends on how many threads the runtime really grants.
#pragma omp parallel for num_threads(parts) schedule(static, 1)
  for (int part = 0; part < parts; ++part) body(context, part);
}

const bool kInterleaves = false;
void interleave() {}

}  // namespace hfr::par::detail
