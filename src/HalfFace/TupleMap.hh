// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_TUPLE_MAP_HH
#define HFR_HALFFACE_TUPLE_MAP_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "HalfFace/Handles.hh"

namespace hfr {

/// Mixes 64 bits (the finaliser of splitmix64).
constexpr std::uint64_t mix64(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Values keyed by an unordered set of N vertices: an edge (N = 2) or a face (N = 3). Edges and faces are not
/// stored by the kernel, so what is attached to them hangs on their vertices: it then survives any operator
/// that keeps the edge or face, at no cost to those that do not touch it. Entries keep their order of insertion.
/// Reading is thread-safe.
template <std::size_t N, class T>
class TupleMap {
 public:
  struct Entry {
    std::array<VertexHandle, N> vertices;  ///< in the order in which they were given
    T value;
  };

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  std::span<const Entry> entries() const { return entries_; }

  /// nullptr when nothing is attached to these vertices.
  const T* find(const std::array<VertexHandle, N>& vertices) const {
    const auto at = position_.find(sorted(vertices));
    return at == position_.end() ? nullptr : &entries_[at->second].value;
  }
  T* find(const std::array<VertexHandle, N>& vertices) {
    return const_cast<T*>(static_cast<const TupleMap&>(*this).find(vertices));
  }

  /// Overwrites what is there.
  T& set(const std::array<VertexHandle, N>& vertices, T value) {
    const auto [at, is_new] = position_.try_emplace(sorted(vertices), entries_.size());
    if (is_new)
      entries_.push_back({vertices, std::move(value)});
    else
      entries_[at->second].value = std::move(value);
    return entries_[at->second].value;
  }

  void clear() {
    entries_.clear();
    position_.clear();
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
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 0x9e3779b97f4a7c15ULL;
      for (VertexHandle v : key) h = mix64(h ^ v.idx());
      return static_cast<std::size_t>(h);
    }
  };
  static Key sorted(Key key) {
    std::sort(key.begin(), key.end());
    return key;
  }

  std::vector<Entry> entries_;
  std::unordered_map<Key, std::size_t, Hash> position_;
};

}  // namespace hfr

#endif
