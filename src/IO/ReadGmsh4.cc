// SPDX-License-Identifier: BSD-3-Clause
// "MSH file format" (4.1) and "MSH file format version 4.0" of the Gmsh manual.
// Between the two, the order of dimension and tag, the width of node and element tags, the place of a block's
// node tags and the position of point entities changed.
#include "IO/ReadGmsh.hh"

#include <algorithm>
#include <set>
#include <utility>

#include "IO/GmshRecords.hh"

namespace hfr::io::gmsh {
namespace {

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

/// Refuses a section whose blocks hold less than it announced; more is refused block by block.
template <class Source>
void require_all(const Source& in, std::size_t done, std::size_t announced, const char* what) {
  if (done != announced) {
    in.fail(std::to_string(announced) + " " + what + " are announced, but the blocks hold " +
            std::to_string(done));
  }
}

}  // namespace

Entities::Entities(std::vector<Entity> entities) : entities_(std::move(entities)) {
  std::stable_sort(entities_.begin(), entities_.end(), before);
}

const Entity* Entities::find(int dimension, int tag) const {
  const Entity key{.dimension = dimension, .tag = tag, .group = {}};
  const auto found = std::lower_bound(entities_.begin(), entities_.end(), key, before);
  return found != entities_.end() && !before(key, *found) ? &*found : nullptr;
}

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
  const auto [blocks, announced] = read_totals(in, version, node_bytes<Source>(version), "nodes");
  mesh.begin_nodes(announced);
  std::size_t done = 0;
  std::vector<std::int64_t> tags;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block block = read_block(in, version);
    const std::size_t count = block_count(in, block, announced - done, node_bytes<Source>(version), "nodes");
    const int parameters = node_parameters(in, block);
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
void read_elements4(Source& in, Version version, std::vector<Entity> listed, Collector& mesh) {
  const Entities entities(std::move(listed));
  std::set<const Entity*> noted;  // that are in several groups
  const std::size_t tag = tag_bytes<Source>(version);
  const auto [blocks, announced] = read_totals(in, version, 2 * tag, "elements");
  mesh.begin_elements(announced);
  std::size_t done = 0;
  std::vector<Index> nodes;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block block = read_block(in, version);
    const ElementType type = supported_type(in, block.kind);
    const auto n_nodes = static_cast<std::size_t>(type.nodes);
    const std::size_t count = block_count(in, block, announced - done, (1 + n_nodes) * tag, "elements");
    const Entity* const entity = entities.find(block.dimension, block.entity);
    const Membership group = entity ? entity->group : Membership{.physical = 0, .elementary = block.entity};
    if (entity && entity->in_several_groups && noted.insert(entity).second) mesh.note_several_groups();
    mesh.reserve(type, count);
    nodes.resize(n_nodes);
    for (std::size_t k = 0; k < count; ++k) {
      const std::int64_t number = mesh_tag(in, version);
      if (is_simplex(type)) {
        for (Index& node : nodes) node = node_position(in, mesh, mesh_tag(in, version));
        mesh.add(type, number, group, nodes);
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
