// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Vectors.hh"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace hfr {
namespace {

Vectors vectors_of_processor() {
#if defined(__GNUC__) && defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return Vectors::kAvx512;
  if (__builtin_cpu_supports("avx2")) return Vectors::kAvx2;
#endif
  return Vectors::kBaseline;
}

Vectors allowed_vectors() {
  const char* const name = std::getenv("HFR_VECTORS");
  const std::string_view wish = name ? name : "";
  const Vectors wished = wish == "baseline" ? Vectors::kBaseline
                         : wish == "avx2"   ? Vectors::kAvx2
                                            : Vectors::kAvx512;
  return std::min(wished, vectors_of_processor());
}

}  // namespace

Vectors widest_vectors() {
  static const Vectors vectors = allowed_vectors();
  return vectors;
}

}  // namespace hfr
