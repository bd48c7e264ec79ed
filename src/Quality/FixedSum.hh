// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_FIXED_SUM_HH
#define HFR_QUALITY_FIXED_SUM_HH

#include <cmath>
#include <cstdint>
#include <limits>

namespace hfr {

/// Sum of doubles that does not depend on the order: each is cut to a multiple of 2^-85 of the bound, and
/// those are added as integers. For up to 2^40 numbers.
class FixedSum {
 public:
  /// No number added may exceed `bound` in size; one that does, or is not finite, makes the sum NaN.
  explicit FixedSum(double bound = 1.0) {
    int exponent = 0;
    std::frexp(bound, &exponent);
    to_unit_ = std::ldexp(kHigh, -exponent);
    from_unit_ = std::ldexp(1.0, exponent);
  }

  void add(double x) {
    const double high = x * to_unit_;
    if (!(std::abs(high) <= kHigh)) {
      valid_ = false;
      return;
    }
    const auto high_part = static_cast<std::int64_t>(high);
    high_ += high_part;
    low_ += static_cast<std::int64_t>((high - static_cast<double>(high_part)) * kLow);
    if (++pending_ == kFlush) flush();
  }

  void add(const FixedSum& other) {
    FixedSum rest = other;
    rest.flush();
    total_ += rest.total_;
    valid_ = valid_ && other.valid_;
  }

  double value() const {
    if (!valid_) return std::numeric_limits<double>::quiet_NaN();
    FixedSum all = *this;
    all.flush();
    return static_cast<double>(static_cast<long double>(all.total_) / (kHigh * kLow)) * from_unit_;
  }

 private:
  __extension__ typedef __int128 Wide;
  static constexpr double kHigh = 0x1p40;
  static constexpr double kLow = 0x1p45;
  static constexpr int kFlush = 1 << 17;  // low_ stays below 2^62, high_ below 2^57

  void flush() {
    total_ += static_cast<Wide>(high_) * static_cast<std::int64_t>(kLow) + low_;
    high_ = low_ = 0;
    pending_ = 0;
  }

  Wide total_ = 0;
  std::int64_t high_ = 0;
  std::int64_t low_ = 0;
  int pending_ = 0;
  bool valid_ = true;
  double to_unit_ = kHigh;
  double from_unit_ = 1.0;
};

/// The same with multiples of 2^-44 of the bound: for means that are printed. Half the cost.
class CoarseSum {
 public:
  /// As FixedSum, but a number beyond the bound, or NaN, counts as 0.
  explicit CoarseSum(double bound = 1.0) {
    int exponent = 0;
    std::frexp(bound, &exponent);
    to_unit_ = std::ldexp(0x1p44, -exponent);
    from_unit_ = std::ldexp(0x1p-44, exponent);
  }

  void add(double x) {
    const double scaled = x * to_unit_;
    pending_ += std::abs(scaled) <= 0x1p44 ? static_cast<std::int64_t>(scaled) : 0;
    if (++count_ == kFlush) flush();
  }

  void add(const CoarseSum& other) {
    CoarseSum rest = other;
    rest.flush();
    total_ += rest.total_;
  }

  double value() const {
    CoarseSum all = *this;
    all.flush();
    return static_cast<double>(all.total_) * from_unit_;
  }

 private:
  __extension__ typedef __int128 Wide;
  static constexpr int kFlush = 1 << 17;  // pending_ stays below 2^61

  void flush() {
    total_ += pending_;
    pending_ = 0;
    count_ = 0;
  }

  Wide total_ = 0;
  std::int64_t pending_ = 0;
  int count_ = 0;
  double to_unit_ = 1.0;
  double from_unit_ = 1.0;
};

}  // namespace hfr

#endif
