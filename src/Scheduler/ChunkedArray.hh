// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_CHUNKED_ARRAY_HH
#define HFR_SCHEDULER_CHUNKED_ARRAY_HH

#include <cstddef>
#include <utility>
#include <vector>

namespace hfr {

/// A sequence that grows without moving what it holds. A vector of a round's candidates holds up to three
/// times their number while it grows, which was a quarter of the peak memory of a run.
template <class T>
class ChunkedArray {
 public:
  static constexpr std::size_t kChunk = 256;

  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
  const T& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }

  void push_back(const T& item) {
    if (size_ % kChunk == 0) {
      chunks_.emplace_back();
      chunks_.back().reserve(kChunk);
    }
    chunks_.back().push_back(item);
    ++size_;
  }

  /// Adds the items of `other`, giving its memory back as it goes.
  void append(ChunkedArray&& other) {
    if (size_ % kChunk == 0) {
      for (auto& chunk : other.chunks_) chunks_.push_back(std::move(chunk));
      size_ += other.size_;
    } else {
      for (auto& chunk : other.chunks_) {
        for (const T& item : chunk) push_back(item);
        chunk = {};
      }
    }
    other = {};
  }

 private:
  std::vector<std::vector<T>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace hfr

#endif
