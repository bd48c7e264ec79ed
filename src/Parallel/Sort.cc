// SPDX-License-Identifier: BSD-3-Clause
#include "Parallel/Sort.hh"

#include <algorithm>
#include <array>

namespace hfr::par {
namespace {

constexpr std::size_t kRadixFrom = 512;  // below this, std::stable_sort is faster

/// One stable counting pass on byte `shift / 8`, from `in` to `out`.
void radix_pass(Policy policy, const std::vector<KeyIndex>& in, std::vector<KeyIndex>& out, int shift) {
  const std::size_t n = in.size();
  const int n_parts = thread_count(policy, n);
  using Histogram = std::array<std::size_t, 256>;
  std::vector<Histogram> offset(static_cast<std::size_t>(n_parts), Histogram{});
  const auto digit = [shift](const KeyIndex& item) { return (item.key >> shift) & 255U; };
  parts(n_parts, [&](int part) {
    Histogram& mine = offset[static_cast<std::size_t>(part)];
    const std::size_t end = part_begin(n, n_parts, part + 1);
    for (std::size_t i = part_begin(n, n_parts, part); i < end; ++i) ++mine[digit(in[i])];
  });
  std::size_t sum = 0;  // digit by digit, and part by part within a digit: that is what makes the pass stable
  for (std::size_t d = 0; d < 256; ++d) {
    for (Histogram& part : offset) {
      const std::size_t count = part[d];
      part[d] = sum;
      sum += count;
    }
  }
  parts(n_parts, [&](int part) {
    Histogram& mine = offset[static_cast<std::size_t>(part)];
    const std::size_t end = part_begin(n, n_parts, part + 1);
    for (std::size_t i = part_begin(n, n_parts, part); i < end; ++i) out[mine[digit(in[i])]++] = in[i];
  });
}

}  // namespace

void stable_sort(Policy policy, std::vector<KeyIndex>& items, std::vector<KeyIndex>& scratch) {
  const auto by_key = [](const KeyIndex& a, const KeyIndex& b) { return a.key < b.key; };
  if (items.size() < kRadixFrom) {
    std::stable_sort(items.begin(), items.end(), by_key);
    return;
  }
  const auto bits_or = [](std::uint64_t a, std::uint64_t b) { return a | b; };
  const auto bits_and = [](std::uint64_t a, std::uint64_t b) { return a & b; };
  const auto key_of = [&](std::size_t i) { return items[i].key; };
  const std::uint64_t any = reduce(policy, items.size(), std::uint64_t{0}, key_of, bits_or);
  const std::uint64_t all = reduce(policy, items.size(), ~std::uint64_t{0}, key_of, bits_and);
  const std::uint64_t differ = any ^ all;
  scratch.resize(items.size());
  for (int shift = 0; shift < 64; shift += 8) {
    if (((differ >> shift) & 255U) == 0) continue;
    radix_pass(policy, items, scratch, shift);
    items.swap(scratch);
  }
}

}  // namespace hfr::par
