// SPDX-License-Identifier: BSD-3-Clause
#include "IO/GmshBlocks.hh"

#include "HalfFace/Errors.hh"

namespace hfr::io::gmsh {

void BinaryCursor::set_swapped(bool is_swapped) {
  is_swapped_ = is_swapped;
  load(0, 0);
}

void BinaryCursor::load(std::uint64_t byte, std::uint64_t n) {
  constexpr std::uint64_t kAhead = std::uint64_t{1} << 16;
  if (byte > size()) file_.fail("the file ends in the middle of its data");
  const bool goes_on = byte >= begin_ && byte <= begin_ + window_.size() + kAhead;
  if (goes_on) n = std::min(std::max(n, kAhead), size() - byte);
  window_ = bytes(byte, n);
  begin_ = byte;
  in_ = BinarySource(window_, file_.name(), 0, is_swapped_, {byte, size() - byte - window_.size()});
}

BlockIndex::BlockIndex(BinaryCursor& file, Section section, const Processes& processes)
    : file_(&file), section_(std::move(section)), end_(section_.begin) {
  constexpr std::uint64_t kLongest = std::uint64_t{1} << 22, kShortest = 256, kStretchesEach = 16;
  const std::uint64_t stretch = std::clamp(file.size() / (kStretchesEach * processes.n), kShortest, kLongest);
  Left left{section_.n_blocks, section_.n_items};
  while (!left.none()) {
    const Walk mine =
        processes.rank == 0 ? walk(end_, end_ + stretch, left) : guess(end_, stretch, processes.rank);
    for (const Walk& w : processes.gather(std::span<const Walk>(&mine, 1))) {
      // Who guesses does not see where the section ends.
      if (w.is_sound == 0 || w.begin != end_ || w.blocks > left.blocks || w.items > left.items) break;
      if (w.blocks > 0) known_.push_back({w.begin, section_.n_items - left.items});
      end_ = w.end;
      left.blocks -= w.blocks;
      left.items -= w.items;
    }
  }
  if (left.items > 0)
    file.file().fail(std::to_string(section_.n_items) + " " + section_.what +
                     " are announced, but the blocks hold " + std::to_string(section_.n_items - left.items));
}

/// From heading to heading, up to the first one that does not begin before `until`, or the last one.
BlockIndex::Walk BlockIndex::walk(std::uint64_t begin, std::uint64_t until, Left left) {
  Walk walk{begin, begin, 0, 0, 1};
  while (walk.end < until && !left.none()) {
    const Heading heading = heading_at(walk.end, left.items);
    // All of it is in the file, as reading the heading has made sure.
    walk.end += section_.heading + heading.n * heading.record;
    walk.items += heading.n;
    ++walk.blocks;
    left.items -= heading.n;
    --left.blocks;
  }
  return walk;
}

BlockIndex::Walk BlockIndex::guess(std::uint64_t begin, std::uint64_t stretch, std::size_t rank) {
  try {
    const Heading heading = heading_at(begin, kAnyNumber);
    const std::uint64_t block = section_.heading + heading.n * heading.record;
    const std::uint64_t first = begin + (rank * stretch + block - 1) / block * block;
    if (first >= file_->size()) return {first, first, 0, 0, 1};
    return walk(first, begin + (rank + 1) * stretch, Left());
  } catch (const InvalidInput&) {
    return {};
  }
}

}  // namespace hfr::io::gmsh
