// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_TUPLE_MAP_HH
#define HFR_HALFFACE_TUPLE_MAP_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/kernels/priority.h"

namespace hfr {

/// Mixes 64 bits; see kernels/priority.h.
constexpr std::uint64_t mix64(std::uint64_t x) { return hfr_mix64(x); }

/// Key of an edge or face: its vertices in any order.
struct AnyOrder {
  static constexpr bool kDirected = false;
  template <std::size_t N>
  static std::array<VertexHandle, N> key(std::array<VertexHandle, N> vertices) {
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  }
};

/// Key of a half-edge or half-face: its vertices in their cyclic order.
struct CyclicOrder {
  static constexpr bool kDirected = true;
  template <std::size_t N>
  static std::array<VertexHandle, N> key(std::array<VertexHandle, N> vertices) {
    if constexpr (N > 2)  // a half-edge a→b is no cycle: b→a is its opposite
      std::rotate(vertices.begin(), std::min_element(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }
};

/// Hash of a key made by AnyOrder or CyclicOrder.
struct TupleHash {
  template <std::size_t N>
  std::size_t operator()(const std::array<VertexHandle, N>& key) const {
    std::uint64_t h = 0x9e3779b97f4a7c15ULL;
    for (VertexHandle v : key) h = mix64(h ^ v.idx());
    return static_cast<std::size_t>(h);
  }
};

/// Values keyed by N vertices: an edge (N = 2) or a face (N = 3), or with CyclicOrder a half-edge or
/// half-face. Edges and faces are not stored by the kernel, so what is attached to them hangs on their
/// vertices: it then survives any operator that keeps the edge or face, at no cost to those that do not touch
/// it. Entries keep their order of insertion. Reading is thread-safe.
template <std::size_t N, class T, class Order = AnyOrder>
class TupleMap {
 public:
  struct Entry {
    std::array<VertexHandle, N> vertices;  ///< in the order in which they were given
    T value;
  };

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  std::span<const Entry> entries() const { return entries_; }

  /// Index into entries(); size() when nothing is attached to these vertices.
  std::size_t position(const std::array<VertexHandle, N>& vertices) const {
    const auto key = Order::key(vertices);
    if (!may_have(key)) return entries_.size();
    const auto at = position_.find(key);
    return at == position_.end() ? entries_.size() : at->second;
  }
  /// nullptr when nothing is attached to these vertices.
  const T* find(const std::array<VertexHandle, N>& vertices) const {
    const std::size_t at = position(vertices);
    return at == entries_.size() ? nullptr : &entries_[at].value;
  }
  T* find(const std::array<VertexHandle, N>& vertices) {
    return const_cast<T*>(static_cast<const TupleMap&>(*this).find(vertices));
  }

  /// Overwrites what is there.
  T& set(const std::array<VertexHandle, N>& vertices, T value) {
    const auto [at, is_new] = position_.try_emplace(Order::key(vertices), entries_.size());
    if (is_new) {
      entries_.push_back({vertices, std::move(value)});
      mark(at->first);
    } else {
      entries_[at->second].value = std::move(value);
    }
    return entries_[at->second].value;
  }

  /// Forgets one entry, keeping the order of the others: O(size()). False when there was none.
  bool erase(const std::array<VertexHandle, N>& vertices) {
    const auto found = position_.find(Order::key(vertices));
    if (found == position_.end()) return false;
    const std::size_t gone = found->second;
    position_.erase(found);
    entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(gone));
    for (auto& [key, at] : position_)
      if (at > gone) --at;
    return true;
  }

  /// Forgets one entry, whose place in the order the last one takes: O(1). False when there was none.
  bool erase_unordered(const std::array<VertexHandle, N>& vertices) {
    const auto found = position_.find(Order::key(vertices));
    if (found == position_.end()) return false;
    const std::size_t gone = found->second;
    position_.erase(found);
    if (gone + 1 < entries_.size()) {
      entries_[gone] = std::move(entries_.back());
      position_[Order::key(entries_[gone].vertices)] = gone;
    }
    entries_.pop_back();
    return true;
  }

  /// Puts the entry of `vertices` under others, which have none; it keeps its place in the order: O(1). False
  /// when there was none.
  bool rekey(const std::array<VertexHandle, N>& vertices, const std::array<VertexHandle, N>& others) {
    const auto found = position_.find(Order::key(vertices));
    if (found == position_.end()) return false;
    const std::size_t at = found->second;
    position_.erase(found);
    position_[Order::key(others)] = at;
    entries_[at].vertices = others;
    mark(Order::key(others));
    return true;
  }

  void clear() {
    entries_.clear();
    position_.clear();
    marks_.clear();
  }

  /// Heap memory in bytes, estimated for the hash table.
  std::size_t memory_bytes() const {
    return entries_.capacity() * sizeof(Entry) + marks_.capacity() * sizeof(marks_[0]) +
           position_.bucket_count() * sizeof(void*) +
           position_.size() * (sizeof(std::array<VertexHandle, N>) + sizeof(std::size_t) + 2 * sizeof(void*));
  }

  /// Replaces every vertex v by rename(v) and drops the entries with an invalid one or with !keep(vertices).
  template <class Rename, class Keep>
  void rename_vertices(Rename&& rename, Keep&& keep) {
    std::vector<Entry> old = std::move(entries_);
    clear();
    for (Entry& entry : old) {
      if (!keep(entry.vertices)) continue;
      bool valid = true;
      for (VertexHandle& v : entry.vertices) {
        v = rename(v);
        valid = valid && v.is_valid();
      }
      if (valid) set(entry.vertices, std::move(entry.value));
    }
  }

 private:
  using Key = std::array<VertexHandle, N>;

  static constexpr std::size_t kMarksOfEntry = 16;

  std::size_t mark_of(const Key& key) const { return TupleHash()(key) & (64 * marks_.size() - 1); }
  /// False for most keys that nothing is attached to, which is what most are that are asked for: one look at
  /// a bit instead of a walk through the table.
  bool may_have(const Key& key) const {
    if (marks_.empty()) return false;
    const std::size_t bit = mark_of(key);
    return (marks_[bit / 64] >> (bit % 64) & 1) != 0;
  }
  /// Marks of entries that are gone stay until there is no more room.
  void mark(const Key& key) {
    if (64 * marks_.size() < kMarksOfEntry * position_.size()) {
      marks_.assign(std::max<std::size_t>(2 * marks_.size(), 1), 0);
      for (const auto& [other, at] : position_) mark(other);
    }
    const std::size_t bit = mark_of(key);
    marks_[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }

  std::vector<Entry> entries_;
  std::unordered_map<Key, std::size_t, TupleHash> position_;
  std::vector<std::uint64_t> marks_;  // bits by hash; their number is a power of two
};

}  // namespace hfr

#endif
