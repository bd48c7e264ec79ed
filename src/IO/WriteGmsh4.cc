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

/// What the elements of each group fill.
std::vector<Box> boxes_of(const MeshData& mesh, const Layout& layout, int dimension) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const Dimension& elements = layout.dimensions[static_cast<std::size_t>(dimension)];
  std::vector<Box> boxes(elements.groups.size(),
                         elements.count > 0 ? Box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}} : Box{});
  for (const Run& run : elements.runs) {
    Box& box = boxes[run.group];
    for (std::size_t i = run.begin; i < run.end; ++i) {
      for (const Index node : element_nodes(mesh, layout, dimension, i)) {
        for (int k = 0; k < 3; ++k) {
          box.low[k] = std::min(box.low[k], mesh.points[node][k]);
          box.high[k] = std::max(box.high[k], mesh.points[node][k]);
        }
      }
    }
  }
  return boxes;
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
  for (const Dimension& elements : layout.dimensions) sink.wide(elements.groups.size());
  sink.end_line();
  for (int dimension = 0; dimension < 4; ++dimension) {
    const std::vector<Group>& groups = layout.dimensions[static_cast<std::size_t>(dimension)].groups;
    const std::vector<Box> boxes = boxes_of(mesh, layout, dimension);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      sink.int32(groups[g].entity);
      for (int k = 0; k < 3; ++k) sink.real(boxes[g].low[k]);
      for (int k = 0; k < 3 && (dimension > 0 || !wide_tags); ++k) sink.real(boxes[g].high[k]);
      sink.wide(layout.has_labels ? 1 : 0);
      if (layout.has_labels) sink.int32(groups[g].label);
      if (dimension > 0) sink.wide(0);  // bounding entities
      sink.end_line();
    }
  }
  sink.end_data();
  sink.line("$EndEntities");
}

void write_nodes(Sink& sink, const MeshData& mesh, const Layout& layout, bool wide_tags) {
  int dimension = 3;
  while (dimension > 0 && layout.dimensions[static_cast<std::size_t>(dimension)].groups.empty()) --dimension;
  const std::size_t count = mesh.points.size();
  sink.line("$Nodes");
  put_totals(sink, count > 0 ? 1 : 0, count, wide_tags);
  if (count > 0) {
    const int entity = layout.dimensions[static_cast<std::size_t>(dimension)].groups.front().entity;
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
  for (const Dimension& elements : layout.dimensions) blocks += elements.runs.size();
  sink.line("$Elements");
  put_totals(sink, blocks, layout.n_elements(), wide_tags);
  for (int dimension = 0; dimension < 4; ++dimension) {
    const Dimension& elements = layout.dimensions[static_cast<std::size_t>(dimension)];
    for (const Run& run : elements.runs) {
      put_block(sink, dimension, elements.groups[run.group].entity, elements.type, run.end - run.begin,
                wide_tags);
      for (std::size_t i = run.begin; i < run.end; ++i) {
        put_tag(sink, elements.first_tag + i, wide_tags);
        for (const Index node : element_nodes(mesh, layout, dimension, i)) {
          put_tag(sink, node + std::size_t{1}, wide_tags);
        }
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
