// SPDX-License-Identifier: BSD-3-Clause
// "MSH file format" (4.1) and "MSH file format version 4.0" of the Gmsh manual.
// All nodes stand in one block, of the first entity of the highest dimension: the order of the points is
// kept.
#include "IO/WriteGmsh.hh"

#include <algorithm>
#include <limits>

namespace hfr::io::gmsh {
namespace {

struct Box {
  Vec3 low;
  Vec3 high;
};

Box box_of(const MeshData& mesh, int dimension, const Group& group) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const Index& item : group.items) {
    for (const Index node : element_nodes(mesh, dimension, item)) {
      for (int k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], mesh.points[node][k]);
        box.high[k] = std::max(box.high[k], mesh.points[node][k]);
      }
    }
  }
  return group.items.empty() ? Box{} : box;
}

/// Tags of nodes and elements: 32-bit in 4.0, 64-bit in 4.1.
void put_tag(Sink& sink, std::size_t tag, bool wide_tags) {
  if (wide_tags) {
    sink.wide(tag);
  } else {
    sink.int32(static_cast<std::int64_t>(tag));
  }
}

void put_block(Sink& sink, int dimension, int entity, int kind, std::size_t count, bool wide_tags) {
  sink.int32(wide_tags ? dimension : entity);
  sink.int32(wide_tags ? entity : dimension);
  sink.int32(kind);
  sink.wide(count);
  sink.end_line();
}

/// Counts of a section; tags run from 1 to `count`.
void put_totals(Sink& sink, std::size_t blocks, std::size_t count, bool wide_tags) {
  sink.wide(blocks);
  sink.wide(count);
  if (wide_tags) {
    sink.wide(count > 0 ? 1 : 0);
    sink.wide(count);
  }
  sink.end_line();
}

void write_entities(Sink& sink, const MeshData& mesh, const Layout& layout, bool wide_tags) {
  sink.line("$Entities");
  for (const auto& groups : layout.groups) sink.wide(groups.size());
  sink.end_line();
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (const Group& group : layout.groups[static_cast<std::size_t>(dimension)]) {
      const Box box = box_of(mesh, dimension, group);
      sink.int32(group.entity);
      for (int k = 0; k < 3; ++k) sink.real(box.low[k]);
      for (int k = 0; k < 3 && (dimension > 0 || !wide_tags); ++k) sink.real(box.high[k]);
      sink.wide(group.label != 0 ? 1 : 0);
      if (group.label != 0) sink.int32(group.label);
      if (dimension > 0) sink.wide(0);  // bounding entities
      sink.end_line();
    }
  }
  sink.end_data();
  sink.line("$EndEntities");
}

void write_nodes(Sink& sink, const MeshData& mesh, const Layout& layout, bool wide_tags) {
  int dimension = 3;
  while (dimension > 0 && layout.groups[static_cast<std::size_t>(dimension)].empty()) --dimension;
  const std::size_t count = mesh.points.size();
  sink.line("$Nodes");
  put_totals(sink, count > 0 ? 1 : 0, count, wide_tags);
  if (count > 0) {
    const int entity = layout.groups[static_cast<std::size_t>(dimension)].front().entity;
    put_block(sink, dimension, entity, /*kind=*/0, count, wide_tags);
  }
  for (std::size_t i = 0; wide_tags && i < count; ++i) {
    sink.wide(i + 1);
    sink.end_line();
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!wide_tags) put_tag(sink, i + 1, wide_tags);
    for (int k = 0; k < 3; ++k) sink.real(mesh.points[i][k]);
    sink.end_line();
  }
  sink.end_data();
  sink.line("$EndNodes");
}

void write_elements(Sink& sink, const MeshData& mesh, const Layout& layout, bool wide_tags) {
  std::size_t blocks = 0;
  for (const auto& groups : layout.groups) {
    for (const Group& group : groups) blocks += group.items.empty() ? 0 : 1;
  }
  sink.line("$Elements");
  put_totals(sink, blocks, layout.n_elements(), wide_tags);
  for (int dimension = 0; dimension < 4; ++dimension) {
    const auto d = static_cast<std::size_t>(dimension);
    std::size_t point_tag = layout.first_tag[0];
    for (const Group& group : layout.groups[d]) {
      if (group.items.empty()) continue;
      put_block(sink, dimension, group.entity, kTypeOfDimension[d], group.items.size(), wide_tags);
      for (const Index& item : group.items) {
        put_tag(sink, dimension == 0 ? point_tag++ : layout.first_tag[d] + item, wide_tags);
        for (const Index node : element_nodes(mesh, dimension, item))
          put_tag(sink, node + std::size_t{1}, wide_tags);
        sink.end_line();
      }
    }
  }
  sink.end_data();
  sink.line("$EndElements");
}

}  // namespace

void write_mesh4(Sink& sink, const MeshData& mesh, const Layout& layout, bool wide_tags) {
  write_entities(sink, mesh, layout, wide_tags);
  write_nodes(sink, mesh, layout, wide_tags);
  write_elements(sink, mesh, layout, wide_tags);
}

}  // namespace hfr::io::gmsh
