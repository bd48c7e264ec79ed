// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_GMSH_TAGS_HH
#define HFR_IO_GMSH_TAGS_HH

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "HalfFace/Handles.hh"

namespace hfr::io::gmsh {

/// From the tags of a file, which may be any integers in any order, to positions 0 … n-1. Its size depends on
/// how many tags there are, never on how large they are.
class TagIndex {
 public:
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  TagIndex() = default;
  explicit TagIndex(const std::vector<std::int64_t>& tags);

  /// Position of the first occurrence; kNone when there is no such tag. O(1), or O(log n) for scattered tags.
  Index find(std::int64_t tag) const {
    const std::uint64_t slot = static_cast<std::uint64_t>(tag) - static_cast<std::uint64_t>(first_);
    if (slot < run_) return static_cast<Index>(slot);
    if (slot < table_.size()) return table_[static_cast<std::size_t>(slot)];
    return sorted_.empty() ? kNone : find_sorted(tag);
  }

  /// A tag that occurs more than once, if there is one.
  std::optional<std::int64_t> duplicate() const { return duplicate_; }

 private:
  Index find_sorted(std::int64_t tag) const;
  void build_table(const std::vector<std::int64_t>& tags, std::uint64_t span);
  void build_sorted(const std::vector<std::int64_t>& tags);

  // One of three forms: tag first_ + i at position i for i < run_; a table that begins at first_; a sorted
  // list.
  std::int64_t first_ = 0;
  std::uint64_t run_ = 0;
  std::vector<Index> table_;
  std::vector<std::pair<std::int64_t, Index>> sorted_;
  std::optional<std::int64_t> duplicate_;
};

}  // namespace hfr::io::gmsh

#endif
