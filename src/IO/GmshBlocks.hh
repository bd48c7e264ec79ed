// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_GMSH_BLOCKS_HH
#define HFR_IO_GMSH_BLOCKS_HH

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "IO/ByteRanges.hh"
#include "IO/GmshSource.hh"
#include "IO/MeshShare.hh"
#include "IO/ReadGmsh.hh"

namespace hfr::io::gmsh {

/// A binary file that is read wherever it is asked to, and ahead where that goes on closely behind what was
/// read before. Holds some 64 kB of it, or what was asked for.
class BinaryCursor {
 public:
  explicit BinaryCursor(const std::filesystem::path& path) : file_(path), in_({}, "", 0, false) {}
  BinaryCursor(const BinaryCursor&) = delete;
  BinaryCursor& operator=(const BinaryCursor&) = delete;

  std::uint64_t size() const { return file_.size(); }
  const ByteRanges& file() const { return file_; }
  void set_swapped(bool is_swapped);
  /// Stands at `byte`, and has the n bytes from there on, or what the file has of them; good until the next
  /// call.
  BinarySource& at(std::uint64_t byte, std::uint64_t n) {
    const std::uint64_t wanted = std::min(n, size() - std::min(byte, size()));
    if (byte < begin_ || byte - begin_ > window_.size() || window_.size() - (byte - begin_) < wanted)
      load(byte, wanted);
    in_.seek(static_cast<std::size_t>(byte - begin_));
    return in_;
  }
  /// Where the source of the last call stands.
  std::uint64_t position() const { return begin_ + in_.offset(); }
  /// The n bytes from `byte` on, n of them at most and those that the file has.
  std::string bytes(std::uint64_t byte, std::uint64_t n) {
    byte = std::min(byte, size());
    return file_.bytes(byte, std::min(n, size() - byte));
  }

 private:
  void load(std::uint64_t byte, std::uint64_t n);

  ByteRanges file_;
  bool is_swapped_ = false;
  std::uint64_t begin_ = 0;  // of the window
  std::string window_;
  BinarySource in_;
};

/// What stands before the items of a block, which are records of one size.
struct Heading {
  ElementType type;               ///< of elements
  int dimension = 0, entity = 0;  ///< of version 4
  int n_tags = 0;                 ///< of each element of version 2
  int parameters = 0;             ///< of each node
  std::uint64_t n = 0;            ///< items
  std::uint64_t record = 0;       ///< bytes of each
};

/// The blocks of a section, of which no process has a list: there may be as many as items. Some are known,
/// one in each stretch of 4 MB at most, and lead to the others.
class BlockIndex {
 public:
  struct Section {
    std::uint64_t begin = 0;  ///< of the first heading
    std::uint64_t n_blocks = kAnyNumber;
    std::uint64_t n_items = 0;
    std::uint64_t heading = 0;  ///< bytes of each
    const char* what = "";      ///< items
    /// `left`: items of the section from this heading on.
    std::function<Heading(BinarySource&, std::uint64_t left)> read;
  };
  static constexpr std::uint64_t kAnyNumber = std::numeric_limits<std::uint64_t>::max();

  /// All processes make one at the same time, and go through the section together: each steps from heading to
  /// heading in a stretch of its own, into which it guesses the way on the assumption that all blocks before
  /// it are alike. A guess that is wrong is found out by who comes from the stretch before. Throws
  /// InvalidInput where blocks are not what was announced.
  BlockIndex(BinaryCursor& file, Section section, const Processes& processes);

  /// Where the section's items end.
  std::uint64_t end() const { return end_; }
  /// use(heading, first byte of the records, begin, end) for parts of blocks that have the items begin …
  /// end-1 of all, by their own numbers.
  template <class Use>
  void for_parts(std::uint64_t begin, std::uint64_t end, Use&& use) {
    if (begin >= end) return;
    const auto is_behind = [](std::uint64_t item, const Known& known) { return item < known.first; };
    const auto known = std::upper_bound(known_.begin(), known_.end(), begin, is_behind) - 1;
    std::uint64_t at = known->byte, first = known->first;
    while (first < end) {
      const Heading heading = heading_at(at, kAnyNumber);
      const std::uint64_t records = at + section_.heading;
      const std::uint64_t low = std::max(begin, first), high = std::min(end, first + heading.n);
      if (low < high) use(heading, records, low - first, high - first);
      at = records + heading.n * heading.record;
      first += heading.n;
    }
  }

 private:
  /// A block that is known, and the number of its first item.
  struct Known {
    std::uint64_t byte = 0, first = 0;
  };
  struct Left {
    std::uint64_t blocks = kAnyNumber, items = kAnyNumber;
    bool counts_blocks() const { return blocks <= kAnyNumber / 2; }
    bool none() const { return (counts_blocks() ? blocks : items) == 0; }  // the last blocks may be empty
  };
  /// What a process has gone through.
  struct Walk {
    std::uint64_t begin = 0, end = 0, blocks = 0, items = 0;
    std::uint64_t is_sound = 0;
  };

  Heading heading_at(std::uint64_t byte, std::uint64_t left) {
    return section_.read(file_->at(byte, section_.heading), left);
  }
  Walk walk(std::uint64_t begin, std::uint64_t until, Left left);
  Walk guess(std::uint64_t begin, std::uint64_t stretch, std::size_t rank);

  BinaryCursor* file_;
  Section section_;
  std::vector<Known> known_;
  std::uint64_t end_ = 0;
};

}  // namespace hfr::io::gmsh

#endif
