// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_SPILL_ARRAY_HH
#define HFR_HALFFACE_SPILL_ARRAY_HH

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "HalfFace/RawArray.hh"

namespace hfr {

/// Room for as many items as are asked for, not initialised: in place up to N of them, on the heap beyond.
/// For scratch memory whose usual size is known and whose largest is not.
template <class T, std::size_t N>
class SpillArray {
 public:
  SpillArray() = default;
  explicit SpillArray(std::size_t n) { reserve(n); }
  SpillArray(const SpillArray&) = delete;
  SpillArray& operator=(const SpillArray&) = delete;

  /// Makes room for n items; those that are there stay.
  void reserve(std::size_t n) {
    if (n <= room_) return;
    const std::size_t room = std::max(n, 2 * room_);
    std::unique_ptr<T[]> wider(new T[room]);
    std::copy_n(items_, room_, wider.get());
    spilled_ = std::move(wider);
    items_ = spilled_.get();
    room_ = room;
  }
  std::size_t room() const { return room_; }

  T* data() { return items_; }
  const T* data() const { return items_; }
  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }

 private:
  RawArray<T, N> here_;
  std::unique_ptr<T[]> spilled_;
  T* items_ = here_.data();
  std::size_t room_ = N;
};

}  // namespace hfr

#endif
