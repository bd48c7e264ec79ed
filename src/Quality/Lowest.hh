// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_LOWEST_HH
#define HFR_QUALITY_LOWEST_HH

#include <cstddef>
#include <cstring>

#include "Quality/Vectors.hh"

namespace hfr {

/// What is searched is filled up to a multiple of this with infinity.
inline constexpr std::size_t kLowestBlock = 8;

HFR_FN double least_of_block(const double* v) {
  static_assert(kLowestBlock == 8);
  return hfr_min(hfr_min(hfr_min(v[0], v[1]), hfr_min(v[2], v[3])),
                 hfr_min(hfr_min(v[4], v[5]), hfr_min(v[6], v[7])));
}

/// The first of the smallest numbers, of those that are neither NaN nor +infinity; where there are none,
/// +infinity and 0. A value of zero may have either sign.
struct Lowest {
  std::size_t at = 0;
  double value = HFR_INFINITY;
};

template <class V>
HFR_FN void load(V& v, const double* from) {
  std::memcpy(&v, from, sizeof(V));
}

/// Finds it, for numbers that come in order, a V at a time.
template <class V>
struct LowestSearch {
  static constexpr std::size_t kLanes = sizeof(V) / sizeof(double);
  V value, at;  // by lane; places are kept as doubles, which are as wide as what is compared
  V next;       // places that come next

  HFR_FN void begin() {
    alignas(64) double lanes[kLowestBlock] = {0, 1, 2, 3, 4, 5, 6, 7};
    load(next, lanes);
    value = at = V{} + HFR_INFINITY;
  }
  HFR_FN void take(const V& v) {
    at = v < value ? next : at;
    value = v < value ? v : value;
    next = next + static_cast<double>(kLanes);
  }
  HFR_FN Lowest get() const {
    alignas(64) double v[kLowestBlock];
    for (std::size_t i = 0; i < kLowestBlock; ++i) v[i] = HFR_INFINITY;
    std::memcpy(v, &value, sizeof(V));
    const double least = least_of_block(v);
    if (!(least < HFR_INFINITY)) return {};
    const V here = value == least ? at : V{} + HFR_INFINITY;
    std::memcpy(v, &here, sizeof(V));
    return {static_cast<std::size_t>(static_cast<int>(least_of_block(v))), least};
  }
};

template <class V>
HFR_FN Lowest lowest_in(const double* numbers, std::size_t n) {
  LowestSearch<V> search;
  search.begin();
  for (std::size_t i = 0; i < n; i += search.kLanes) {
    V v;
    load(v, numbers + i);
    search.take(v);
  }
  return search.get();
}

/// Of n numbers, a multiple of kLowestBlock, with widest_vectors().
Lowest lowest_of(const double* numbers, std::size_t n);

/// The smallest of some numbers, of which NaN is none, a zero without its sign; and whether each of them is
/// at least a bound, which NaN is not.
struct Floor {
  double least = HFR_INFINITY;
  bool holds = true;
};

/// n: a multiple of kLowestBlock.
template <class V>
HFR_FN Floor floor_in(const double* numbers, std::size_t n, double bound) {
  V least = V{} + HFR_INFINITY, holds = V{} + 1.0;
  for (std::size_t i = 0; i < n; i += sizeof(V) / sizeof(double)) {
    V v;
    load(v, numbers + i);
    least = v < least ? v : least;
    holds = v >= V{} + bound ? holds : V{};
  }
  alignas(64) double lanes[2 * kLowestBlock];
  for (std::size_t i = 0; i < kLowestBlock; ++i) {
    lanes[i] = HFR_INFINITY;
    lanes[kLowestBlock + i] = 1;
  }
  std::memcpy(lanes, &least, sizeof(V));
  std::memcpy(lanes + kLowestBlock, &holds, sizeof(V));
  return {least_of_block(lanes) + 0.0, least_of_block(lanes + kLowestBlock) > 0};
}
Floor floor_of(const double* numbers, std::size_t n, double bound);

}  // namespace hfr

#endif
