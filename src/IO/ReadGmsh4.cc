// SPDX-License-Identifier: BSD-3-Clause
// "MSH file format" (4.1) and "MSH file format version 4.0" of the Gmsh manual.
// Between the two, the order of dimension and tag, the width of node and element tags, the place of a block's
// node tags and the position of point entities changed.
#include "IO/ReadGmsh.hh"

#include <algorithm>
#include <numeric>
#include <utility>

namespace hfr::io::gmsh {
namespace {

/// Tags of nodes and elements: 32-bit in 4.0, 64-bit in 4.1.
template <class Source>
std::int64_t mesh_tag(Source& in, Version version) {
  return version == Version::k40 ? in.int32("a tag") : in.wide();
}

template <class Source>
void skip_int32s(Source& in, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) in.int32("a tag");
}

template <class Source>
std::size_t tag_list(Source& in, std::string_view what) {
  return bounded(in, in.count(), Source::least(1, 0, 0), what);
}

/// Counts of $PartitionedEntities are 32-bit in 4.0.
template <class Source>
std::uint64_t partition_count(Source& in, Version version) {
  if (version == Version::k41) return in.count();
  const int count = in.int32("a count");
  if (count < 0) in.fail("a count cannot be negative, but " + std::to_string(count) + " stands here");
  return static_cast<std::uint64_t>(count);
}

/// Takes the partitions of an entity. Returns the tag of the entity that was cut into parts.
template <class Source>
int read_parent(Source& in, Version version, const Entity& entity) {
  const int parent_dimension = in.int32("the dimension of an entity");
  const int parent_tag = in.int32("the tag of an entity");
  skip_int32s(in, bounded(in, partition_count(in, version), Source::least(1, 0, 0), "partitions"));
  return parent_dimension == entity.dimension ? parent_tag : entity.tag;
}

template <class Source>
Entity read_entity(Source& in, Version version, bool partitioned, int dimension) {
  Entity entity{.dimension = dimension, .tag = in.int32("the tag of an entity"), .group = {}};
  entity.group.elementary = partitioned ? read_parent(in, version, entity) : entity.tag;
  const int extents = dimension == 0 && version == Version::k41 ? 3 : 6;
  for (int k = 0; k < extents; ++k) in.any_real();
  const std::size_t groups = tag_list(in, "physical groups");
  for (std::size_t k = 0; k < groups; ++k) {
    const int group = in.int32("a physical group");
    if (k == 0) entity.group.physical = group;
  }
  entity.in_several_groups = groups > 1;
  if (dimension > 0) skip_int32s(in, tag_list(in, "bounding entities"));
  return entity;
}

bool before(const Entity& a, const Entity& b) {
  return std::pair(a.dimension, a.tag) < std::pair(b.dimension, b.tag);
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

/// Refuses a section whose blocks hold less than it announced; more is refused block by block.
template <class Source>
void require_all(const Source& in, std::size_t done, std::size_t announced, const char* what) {
  if (done != announced) {
    in.fail(std::to_string(announced) + " " + what + " are announced, but the blocks hold " +
            std::to_string(done));
  }
}

template <class Source>
std::size_t block_count(const Source& in, const Block& block, std::size_t left, std::size_t bytes_each,
                        const char* what) {
  if (block.count > left) {
    in.fail("a block holds " + std::to_string(block.count) + " " + what + ", but only " +
            std::to_string(left) + " of those announced are left");
  }
  return bounded(in, block.count, bytes_each, what);
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

}  // namespace

template <class Source>
void read_entities4(Source& in, Version version, bool partitioned, std::vector<Entity>& entities) {
  if (partitioned) {
    partition_count(in, version);
    const std::uint64_t ghosts = partition_count(in, version);
    skip_int32s(in, 2 * bounded(in, ghosts, Source::least(2, 0, 0), "ghost entities"));
  }
  std::uint64_t counts[4];
  for (std::uint64_t& count : counts) count = in.count();
  for (int dimension = 0; dimension < 4; ++dimension) {
    const std::size_t count = bounded(in, counts[dimension], Source::least(1, 1, 3), "entities");
    for (std::size_t k = 0; k < count; ++k)
      entities.push_back(read_entity(in, version, partitioned, dimension));
  }
}

template <class Source>
void read_nodes4(Source& in, Version version, Collector& mesh) {
  const std::size_t blocks = bounded(in, in.count(), Source::least(3, 1, 0), "blocks");
  const std::size_t tag_bytes = version == Version::k40 ? Source::least(1, 0, 0) : Source::least(0, 1, 0);
  const std::size_t node_bytes = tag_bytes + Source::least(0, 0, 3);
  const std::size_t announced = bounded(in, in.count(), node_bytes, "nodes");
  if (version == Version::k41) {
    in.wide();  // smallest and largest tag: known better once the nodes are read
    in.wide();
  }
  mesh.begin_nodes(announced);
  std::size_t done = 0;
  std::vector<std::int64_t> tags;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block block = read_block(in, version);
    const std::size_t count = block_count(in, block, announced - done, node_bytes, "nodes");
    if (block.dimension < 0 || block.dimension > 3) {
      in.fail("nodes of an entity of dimension " + std::to_string(block.dimension));
    }
    const int parameters = block.kind != 0 ? block.dimension : 0;
    if (version == Version::k40) {
      for (std::size_t k = 0; k < count; ++k) {
        const std::int64_t tag = mesh_tag(in, version);
        mesh.add_node(tag, read_point(in, parameters));
      }
    } else {
      tags.resize(count);
      for (std::int64_t& tag : tags) tag = mesh_tag(in, version);
      for (const std::int64_t tag : tags) mesh.add_node(tag, read_point(in, parameters));
    }
    done += count;
  }
  require_all(in, done, announced, "nodes");
  close_nodes(in, mesh);
}

template <class Source>
void read_elements4(Source& in, Version version, std::vector<Entity> entities, Collector& mesh) {
  std::stable_sort(entities.begin(), entities.end(), before);
  const std::size_t blocks = bounded(in, in.count(), Source::least(3, 1, 0), "blocks");
  const std::size_t tag_bytes = version == Version::k40 ? Source::least(1, 0, 0) : Source::least(0, 1, 0);
  const std::size_t announced = bounded(in, in.count(), 2 * tag_bytes, "elements");
  if (version == Version::k41) {
    in.wide();
    in.wide();
  }
  mesh.begin_elements(announced);
  std::size_t done = 0;
  std::vector<Index> nodes;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block block = read_block(in, version);
    const ElementType type = supported_type(in, block.kind);
    const auto n_nodes = static_cast<std::size_t>(type.nodes);
    const std::size_t count = block_count(in, block, announced - done, (1 + n_nodes) * tag_bytes, "elements");
    const Entity key{.dimension = block.dimension, .tag = block.entity, .group = {}};
    const auto entity = std::lower_bound(entities.begin(), entities.end(), key, before);
    const bool known = entity != entities.end() && !before(key, *entity);
    const Membership group = known ? entity->group : Membership{.physical = 0, .elementary = block.entity};
    if (known && std::exchange(entity->in_several_groups, false)) mesh.note_several_groups();
    mesh.reserve(type, count);
    nodes.resize(n_nodes);
    for (std::size_t k = 0; k < count; ++k) {
      const std::int64_t tag = mesh_tag(in, version);
      if (is_simplex(type)) {
        for (Index& node : nodes) node = node_position(in, mesh, mesh_tag(in, version));
        mesh.add(type, tag, group, nodes);
      } else {
        for (std::size_t i = 0; i < n_nodes; ++i) mesh_tag(in, version);
        mesh.skip_quadrangle();
      }
    }
    done += count;
  }
  require_all(in, done, announced, "elements");
  mesh.end_elements(/*drop_copies_in_groups=*/false);
}

template void read_entities4(TextSource&, Version, bool, std::vector<Entity>&);
template void read_entities4(BinarySource&, Version, bool, std::vector<Entity>&);
template void read_nodes4(TextSource&, Version, Collector&);
template void read_nodes4(BinarySource&, Version, Collector&);
template void read_elements4(TextSource&, Version, std::vector<Entity>, Collector&);
template void read_elements4(BinarySource&, Version, std::vector<Entity>, Collector&);

}  // namespace hfr::io::gmsh
