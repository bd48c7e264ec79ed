// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_BYTE_TABLE_HH
#define HFR_SCHEDULER_BYTE_TABLE_HH

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr {

/// A byte for each slot of a mesh, of which some are set and all others have the same one. Where few are, its
/// memory and the time to make it go with them and not with the mesh.
class ByteTable {
 public:
  /// Of `n` slots; at most `n_set` will be set.
  ByteTable(std::size_t n, std::size_t n_set, std::uint8_t otherwise) {
    if (n > 0 && n_set >= n / kFew)
      all_.assign(n, otherwise);
    else
      few_.assign(std::bit_ceil(2 * n_set + 2), {kNoSlot, otherwise});
  }

  std::uint8_t operator[](Index slot) const { return all_.empty() ? few_[place(slot)].byte : all_[slot]; }
  /// Whether threads may set different slots at a time.
  bool is_for_threads() const { return !all_.empty(); }
  void set(Index slot, std::uint8_t byte) {
    if (!all_.empty()) {
      all_[slot] = byte;
      return;
    }
    Entry& entry = few_[place(slot)];
    if (entry.slot == kNoSlot) ++n_set_;
    HFR_ASSERT(2 * n_set_ <= few_.size());  // or a search for another one would not end
    entry = {slot, byte};
  }

 private:
  // Of one in so many and more, the work on what is set outweighs a byte for each slot.
  static constexpr std::size_t kFew = 256;
  static constexpr Index kNoSlot = CellHandle::kInvalid;
  struct Entry {
    Index slot;
    std::uint8_t byte;
  };

  /// Where the slot is, or would be.
  std::size_t place(Index slot) const {
    const std::size_t mask = few_.size() - 1;
    std::size_t at = mix64(slot) & mask;
    while (few_[at].slot != slot && few_[at].slot != kNoSlot) at = (at + 1) & mask;
    return at;
  }

  std::vector<std::uint8_t> all_;  // by slot; empty where few are set
  std::vector<Entry> few_;         // a power of two of them, at most half of them in use
  std::size_t n_set_ = 0;          // of those
};

}  // namespace hfr

#endif
