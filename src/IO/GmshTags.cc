// SPDX-License-Identifier: BSD-3-Clause
#include "IO/GmshTags.hh"

#include <algorithm>

namespace hfr::io::gmsh {
namespace {

bool is_run(const std::vector<std::int64_t>& tags) {
  for (std::size_t i = 1; i < tags.size(); ++i) {
    if (static_cast<std::uint64_t>(tags[i]) != static_cast<std::uint64_t>(tags[0]) + i) return false;
  }
  return true;
}

}  // namespace

TagIndex::TagIndex(const std::vector<std::int64_t>& tags) {
  if (tags.empty()) return;
  if (is_run(tags)) {
    first_ = tags.front();
    run_ = tags.size();
    return;
  }
  const auto [low, high] = std::minmax_element(tags.begin(), tags.end());
  const std::uint64_t span = static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low);
  constexpr std::uint64_t kSparse = 4;  // the table may take so many slots a tag
  if (span / kSparse < tags.size()) {
    first_ = *low;
    build_table(tags, span);
  } else {
    build_sorted(tags);
  }
}

void TagIndex::build_table(const std::vector<std::int64_t>& tags, std::uint64_t span) {
  table_.assign(static_cast<std::size_t>(span) + 1, kNone);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    Index& slot = table_[static_cast<std::size_t>(static_cast<std::uint64_t>(tags[i]) -
                                                  static_cast<std::uint64_t>(first_))];
    if (slot == kNone) {
      slot = static_cast<Index>(i);
    } else if (!duplicate_) {
      duplicate_ = tags[i];
    }
  }
}

void TagIndex::build_sorted(const std::vector<std::int64_t>& tags) {
  sorted_.reserve(tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i) sorted_.emplace_back(tags[i], static_cast<Index>(i));
  std::sort(sorted_.begin(), sorted_.end());
  const auto equal = std::adjacent_find(sorted_.begin(), sorted_.end(),
                                        [](const auto& a, const auto& b) { return a.first == b.first; });
  if (equal != sorted_.end()) duplicate_ = equal->first;
}

Index TagIndex::find_sorted(std::int64_t tag) const {
  const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), tag,
                                      [](const auto& entry, std::int64_t t) { return entry.first < t; });
  return found != sorted_.end() && found->first == tag ? found->second : kNone;
}

}  // namespace hfr::io::gmsh
