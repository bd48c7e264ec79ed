// SPDX-License-Identifier: BSD-3-Clause
#include "Parallel/Backend.hh"
#include "Parallel/Interleave.hh"

namespace hfr::par::detail {

int backend_threads() { return 0; }

void backend_parts(int parts, void (*body)(void*, int), void* context) {
  for (int part = 0; part < parts; ++part) body(context, part);
}

const bool kInterleaves = false;
void interleave() {}

}  // namespace hfr::par::detail
