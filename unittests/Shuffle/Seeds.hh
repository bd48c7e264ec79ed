// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_SHUFFLE_SEEDS_HH
#define HFR_UNITTESTS_SHUFFLE_SEEDS_HH

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "Operators/LimitMeshes.hh"
#include "Parallel/Parallel.hh"

namespace hfr::test {

/// A number of the environment, or what stands for it.
inline std::uint64_t number_from(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

/// Calls run(seed) for HFR_SHUFFLE_SEEDS seeds from HFR_SHUFFLE_FIRST on; by default 1 … n.
template <class Run>
void for_seeds(std::uint64_t n, Run&& run) {
  const std::uint64_t first = number_from("HFR_SHUFFLE_FIRST", 1);
  const std::uint64_t end = first + number_from("HFR_SHUFFLE_SEEDS", n);
  for (std::uint64_t seed = first; seed < end && !testing::Test::HasFatalFailure(); ++seed) {
    SCOPED_TRACE("HFR_SHUFFLE_FIRST=" + std::to_string(seed) + " HFR_SHUFFLE_SEEDS=1");
    run(seed);
  }
}

/// True when all seeds of a run of the default length are there: then what they met is counted.
inline bool counts_what_it_met(std::uint64_t n) { return number_from("HFR_SHUFFLE_SEEDS", n) >= n; }

/// Threads and bounds of loops for a seed.
inline par::Policy policy_of(Engine& engine) {
  constexpr std::array<int, 3> kThreads = {4, 7, 16};
  constexpr std::array<std::size_t, 4> kSerialBelow = {0, 1, 2, 40};
  const int threads = kThreads[engine() % kThreads.size()];
  return {threads, kSerialBelow[engine() % kSerialBelow.size()]};
}
inline constexpr par::Policy kOneThread = {1, 0};

enum class Limit {
  kManyEqual,  ///< a regular box: many equal keys
  kJittered,   ///< a box, some of its cells inverted
  kFolded,     ///< a deformed cavity
  kPinched,    ///< two boxes that touch in a vertex
  kSmallHub,   ///< rings about the bounds of 32 and 63 cells
  kHub,        ///< stars about the bound of 256 cells, and far beyond
  kLimits
};

/// A mesh made to meet a limit; `kind` says which.
inline TetMesh limit_mesh(Limit kind, Engine& engine) {
  const std::uint64_t seed = engine();
  const auto n = static_cast<Index>(2 + engine() % 3);
  switch (kind) {
    case Limit::kManyEqual:
      return built(generate::box({n, n + 1, 3}));
    case Limit::kJittered:
      return jittered(n, uniform(engine, 0.2, 0.5), seed);
    case Limit::kFolded: {
      generate::CavityOptions options;
      options.counts = {5, 5, 5};
      options.amplitude = uniform(engine, 0.3, 0.6);
      options.seed = seed;
      return built(generate::cavity(options));
    }
    case Limit::kPinched:
      return built(pinched(2, uniform(engine, 0.1, 0.4), seed));
    default: {
      constexpr std::array<Index, 6> kRings = {31, 32, 33, 63, 64, 65};
      constexpr std::array<Index, 4> kStars = {86, 128, 129, 150};  // 2 and 3 cells a vertex of the ring
      const Index ring =
          kind == Limit::kHub ? kStars[engine() % kStars.size()] : kRings[engine() % kRings.size()];
      TetMesh mesh = built(hub(ring));
      shake_inner(mesh, uniform(engine, 0.0, 0.4) / static_cast<double>(engine() % 2 == 0 ? 1 : ring / 6),
                  seed);
      return mesh;
    }
  }
}

}  // namespace hfr::test

#endif
