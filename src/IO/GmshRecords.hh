// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_GMSH_RECORDS_HH
#define HFR_IO_GMSH_RECORDS_HH

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "HalfFace/Vec3.hh"
#include "IO/ReadGmsh.hh"

/// What $Nodes and $Elements consist of: for the readers of whole files and of ranges.
namespace hfr::io::gmsh {

/// Tags of nodes and elements: 64-bit in 4.1, 32-bit in all others.
template <class Source>
std::int64_t mesh_tag(Source& in, Version version) {
  return version == Version::k41 ? in.wide() : in.int32("a tag");
}

template <class Source>
constexpr std::size_t tag_bytes(Version version) {
  return version == Version::k41 ? Source::least(0, 1, 0) : Source::least(1, 0, 0);
}

/// Without parameters.
template <class Source>
constexpr std::size_t node_bytes(Version version) {
  return tag_bytes<Source>(version) + Source::least(0, 0, 3);
}

template <class Source>
Vec3 read_point(Source& in, int parameters) {
  Vec3 point;
  point.x = in.real();
  point.y = in.real();
  point.z = in.real();
  for (int k = 0; k < parameters; ++k) in.any_real();
  return point;
}

// Version 4.

struct Totals {
  std::size_t blocks = 0, items = 0;
};

/// What a section of blocks begins with.
template <class Source>
Totals read_totals(Source& in, Version version, std::size_t bytes_each, const char* what) {
  Totals totals;
  totals.blocks = bounded(in, in.count(), Source::least(3, 1, 0), "blocks");
  totals.items = bounded(in, in.count(), bytes_each, what);
  if (version == Version::k41) {
    in.wide();  // smallest and largest tag: known better once the items are read
    in.wide();
  }
  return totals;
}

struct Block {
  int dimension = 0;
  int entity = 0;
  int kind = 0;  ///< of nodes: whether they are parametric; of elements: their type
  std::uint64_t count = 0;
};

template <class Source>
Block read_block(Source& in, Version version) {
  Block block;
  block.dimension = in.int32("the dimension or tag of an entity");
  block.entity = in.int32("the tag or dimension of an entity");
  if (version == Version::k40) std::swap(block.dimension, block.entity);
  block.kind = in.int32("what a block holds");
  block.count = in.count();
  return block;
}

/// `left`: items of the section that are not yet in a block.
template <class Source>
std::size_t block_count(const Source& in, const Block& block, std::uint64_t left, std::size_t bytes_each,
                        const char* what) {
  if (block.count > left) {
    in.fail("a block holds " + std::to_string(block.count) + " " + what + ", but only " +
            std::to_string(left) + " of those announced are left");
  }
  return bounded(in, block.count, bytes_each, what);
}

/// How many parameters each node of the block has.
template <class Source>
int node_parameters(const Source& in, const Block& block) {
  if (block.dimension < 0 || block.dimension > 3)
    in.fail("nodes of an entity of dimension " + std::to_string(block.dimension));
  return block.kind != 0 ? block.dimension : 0;
}

// Version 2.

template <class Source>
int tag_count(Source& in) {
  constexpr int kMostTags = 1 << 16;  // an element has two tags, and one more for each partition it is in
  const int count = in.int32("the number of tags of an element");
  if (count < 0 || count > kMostTags) in.fail("an element with " + std::to_string(count) + " tags");
  return count;
}

template <class Source>
Membership read_group(Source& in, int n_tags) {
  Membership group;
  for (int k = 0; k < n_tags; ++k) {
    const int value = in.int32("a tag of an element");
    if (k == 0) group.physical = value;
    if (k == 1) group.elementary = value;
  }
  return group;
}

/// What elements of one type begin with in a binary file.
struct Following {
  ElementType type;
  int n = 0, n_tags = 0;
};

/// `left`: elements that are still to come. `type_of`: from Gmsh's number.
template <class TypeOf>
Following read_following(BinarySource& in, std::uint64_t left, TypeOf&& type_of) {
  Following following;
  following.type = type_of(in.int32("the type of elements"));
  following.n = in.int32("how many elements follow");
  if (following.n < 1 || static_cast<std::uint64_t>(following.n) > left)
    in.fail(std::to_string(following.n) + " elements follow where 1 to " + std::to_string(left) +
            " were expected");
  following.n_tags = tag_count(in);
  return following;
}

}  // namespace hfr::io::gmsh

#endif
