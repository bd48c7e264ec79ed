// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_FUZZ_RANDOM_HH
#define HFR_UNITTESTS_FUZZ_RANDOM_HH

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "HalfFace/Vec3.hh"

namespace hfr::fuzz {

/// The splitmix64 sequence of a seed: the same numbers with every compiler and library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// What the bytes say, two of them for each number, lower byte first: unit() grows with the two, and a byte
  /// that is changed changes one number. After them follows the sequence of seed 0. `bytes` has to outlive
  /// the sequence and its copies.
  explicit Random(std::span<const std::uint8_t> bytes) : state_(0), bytes_(bytes) {}

  std::uint64_t next() {
    if (bytes_.size() >= 2) {
      const auto two = static_cast<std::uint64_t>(bytes_[0] | bytes_[1] << 8);
      bytes_ = bytes_.subspan(2);
      return two * 0x0001000100010001ULL;
    }
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
    return z ^ z >> 31;
  }
  /// In [0, 1), 53 random bits.
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// 0 … n-1; 0 for n = 0.
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(next() % n); }
  /// low … high, both ends included.
  int from_to(int low, int high) {
    return low + static_cast<int>(below(static_cast<std::size_t>(high - low + 1)));
  }
  bool chance(double probability) { return unit() < probability; }
  /// In [-r, r] along each axis.
  Vec3 step(double r) {
    const double x = between(-r, r);
    const double y = between(-r, r);
    return {x, y, between(-r, r)};
  }
  template <class T>
  T pick(std::initializer_list<T> list) {
    return *(list.begin() + below(list.size()));
  }
  template <class T>
  const T& pick(const std::vector<T>& list) {
    return list[below(list.size())];
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[below(i)]);
  }

 private:
  std::uint64_t state_;
  std::span<const std::uint8_t> bytes_;
};

}  // namespace hfr::fuzz

#endif
