// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_PARALLEL_PARALLEL_HH
#define HFR_PARALLEL_PARALLEL_HH

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <type_traits>
#include <vector>

#include "hfremesh/Parallel/Policy.hh"

/// The ground floor: the only folder that knows the thread library.
/// Every function gives the same result for any number of threads.
namespace hfr::par {

/// Number of threads that a loop of n items would use under the policy.
int thread_count(Policy policy, std::size_t n);

namespace detail {
/// Calls body(context, part) for part = 0 … parts-1, one thread a part. An exception of a part is rethrown
/// (that of the smallest part when there are several).
void run_parts(int parts, void (*body)(void*, int), void* context);
}  // namespace detail

/// Calls body(part) for part = 0 … parts-1 concurrently.
template <class Body>
void parts(int n_parts, Body&& body) {
  if (n_parts <= 1) {
    if (n_parts == 1) body(0);
    return;
  }
  using Plain = std::remove_reference_t<Body>;
  detail::run_parts(
      n_parts, [](void* context, int part) { (*static_cast<Plain*>(context))(part); },
      const_cast<void*>(static_cast<const void*>(&body)));
}

/// First item of part `part` when n items are cut into n_parts even parts.
inline std::size_t part_begin(std::size_t n, int n_parts, int part) {
  return n / static_cast<std::size_t>(n_parts) * static_cast<std::size_t>(part) +
         std::min<std::size_t>(n % static_cast<std::size_t>(n_parts), static_cast<std::size_t>(part));
}

/// Calls body(i) for each item i of that part.
template <class Body>
void for_part(std::size_t n, int n_parts, int part, Body&& body) {
  const std::size_t end = part_begin(n, n_parts, part + 1);
  for (std::size_t i = part_begin(n, n_parts, part); i < end; ++i) body(i);
}

namespace detail {
/// Hands out block numbers 0, 1, … to n_threads threads until n_blocks are gone.
void run_blocks(int n_threads, std::size_t n_blocks, void (*body)(void*, std::size_t), void* context);

/// Pieces for each thread that loops are cut into: a thread that is held up leaves the rest to the others.
inline constexpr int kPiecesAThread = 4;

/// Calls body(piece) for piece = 0 … n_pieces-1; threads take them as they come.
template <class Body>
void pieces(int n_threads, int n_pieces, Body&& body) {
  if (n_threads <= 1) {
    for (int piece = 0; piece < n_pieces; ++piece) body(piece);
    return;
  }
  using Plain = std::remove_reference_t<Body>;
  run_blocks(
      n_threads, static_cast<std::size_t>(n_pieces),
      [](void* context, std::size_t piece) { (*static_cast<Plain*>(context))(static_cast<int>(piece)); },
      const_cast<void*>(static_cast<const void*>(&body)));
}
inline int pieces_for(int n_threads) { return n_threads <= 1 ? 1 : kPiecesAThread * n_threads; }
}  // namespace detail

/// Calls body(begin, end) on even, contiguous pieces of [0, n), more than there are threads.
template <class Body>
void for_ranges(Policy policy, std::size_t n, Body&& body) {
  const int n_threads = thread_count(policy, n), n_pieces = detail::pieces_for(n_threads);
  detail::pieces(n_threads, n_pieces, [&](int piece) {
    body(part_begin(n, n_pieces, piece), part_begin(n, n_pieces, piece + 1));
  });
}

/// Calls body(i) for each i in [0, n).
template <class Body>
void for_each(Policy policy, std::size_t n, Body&& body) {
  for_ranges(policy, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Calls body(begin, end) concurrently on even, contiguous parts of [0, n_targets), where each call reads all
/// of n_items and writes only what its part of the targets gets: in the order of the items, without atomics.
/// So many parts at most, since each reads everything.
template <class Body>
void for_targets(Policy policy, std::size_t n_items, std::size_t n_targets, Body&& body) {
  constexpr int kMostParts = 8;
  const int n_parts = std::min(thread_count(policy, n_items), kMostParts);
  parts(n_parts, [&](int part) {
    body(part_begin(n_targets, n_parts, part), part_begin(n_targets, n_parts, part + 1));
  });
}

/// Calls body(i) for each i in [0, n) in blocks that free threads take as they come: for items of uneven
/// cost. The order of calls is not fixed; what body(i) writes must depend on i alone.
template <class Body>
void for_each_dynamic(Policy policy, std::size_t n, std::size_t block, Body&& body);

/// In-place exclusive prefix sum; returns the total.
template <class T>
T exclusive_scan(std::span<T> values) {
  T sum{};
  for (T& value : values) {
    const T next = sum + value;
    value = sum;
    sum = next;
  }
  return sum;
}

/// Indices i in [0, n) with keep(i), ascending.
template <class Out = std::uint32_t, class Keep>
std::vector<Out> compact(Policy policy, std::size_t n, Keep&& keep) {
  const int n_threads = thread_count(policy, n), n_pieces = detail::pieces_for(n_threads);
  std::vector<std::vector<Out>> found(static_cast<std::size_t>(n_pieces));
  detail::pieces(n_threads, n_pieces, [&](int piece) {
    auto& mine = found[static_cast<std::size_t>(piece)];
    const std::size_t end = part_begin(n, n_pieces, piece + 1);
    for (std::size_t i = part_begin(n, n_pieces, piece); i < end; ++i)
      if (keep(i)) mine.push_back(static_cast<Out>(i));
  });
  if (n_pieces == 1) return std::move(found[0]);
  std::size_t total = 0;
  for (const auto& piece : found) total += piece.size();
  std::vector<Out> all;
  all.reserve(total);
  for (const auto& piece : found) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

/// combine(identity, value(0), …, value(n-1)) for a combine that is associative, commutative and exact
/// (minimum, maximum, integer sum), so that the result does not depend on the cut into pieces.
template <class T, class Value, class Combine>
T reduce(Policy policy, std::size_t n, T identity, Value&& value, Combine&& combine) {
  struct Partial {  // so that a bool has a byte of its own: std::vector<bool> packs bits
    T value;
  };
  const int n_threads = thread_count(policy, n), n_pieces = detail::pieces_for(n_threads);
  std::vector<Partial> partial(static_cast<std::size_t>(n_pieces), Partial{identity});
  detail::pieces(n_threads, n_pieces, [&](int piece) {
    T mine = identity;
    const std::size_t end = part_begin(n, n_pieces, piece + 1);
    for (std::size_t i = part_begin(n, n_pieces, piece); i < end; ++i) mine = combine(mine, value(i));
    partial[static_cast<std::size_t>(piece)].value = mine;
  });
  T all = identity;
  for (const Partial& piece : partial) all = combine(all, piece.value);
  return all;
}

template <class Body>
void for_each_dynamic(Policy policy, std::size_t n, std::size_t block, Body&& body) {
  const int n_threads = thread_count(policy, n);
  auto run_block = [&](std::size_t b) {
    const std::size_t end = std::min(n, (b + 1) * block);
    for (std::size_t i = b * block; i < end; ++i) body(i);
  };
  const std::size_t n_blocks = (n + block - 1) / block;
  if (n_threads <= 1) {
    for (std::size_t b = 0; b < n_blocks; ++b) run_block(b);
    return;
  }
  using Run = decltype(run_block);
  detail::run_blocks(
      n_threads, n_blocks, [](void* context, std::size_t b) { (*static_cast<Run*>(context))(b); },
      &run_block);
}

}  // namespace hfr::par

#endif
