// SPDX-License-Identifier: BSD-3-Clause
// "MSH file format" (4.1) and "MSH file format version 4.0" of the Gmsh manual.
// All nodes stand in one block, of the first entity of the highest dimension: the order of the points is
// kept.
#include "IO/WriteGmsh.hh"

namespace hfr::io::gmsh {
namespace {

/// Tags of nodes and elements: 32-bit in 4.0, 64-bit in 4.1.
void put_tag(Sink& sink, std::uint64_t tag, bool wide_tags) {
  if (wide_tags) {
    sink.wide(tag);
  } else {
    sink.int32(static_cast<std::int64_t>(tag));
  }
}

void put_block(Sink& sink, int dimension, int entity, int kind, std::uint64_t count, bool wide_tags) {
  sink.int32(wide_tags ? dimension : entity);
  sink.int32(wide_tags ? entity : dimension);
  sink.int32(kind);
  sink.wide(count);
  sink.end_line();
}

/// Counts of a section; tags run from 1 to `count`.
void put_totals(Sink& sink, std::uint64_t blocks, std::uint64_t count, bool wide_tags) {
  sink.wide(blocks);
  sink.wide(count);
  if (wide_tags) {
    sink.wide(count > 0 ? 1 : 0);
    sink.wide(count);
  }
  sink.end_line();
}

void write_entities(Sink& sink, const Layout& layout, bool wide_tags) {
  sink.line("$Entities");
  for (const Dimension& elements : layout.dimensions) sink.wide(elements.groups.size());
  sink.end_line();
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (const Group& group : layout.dimensions[static_cast<std::size_t>(dimension)].groups) {
      const auto found = layout.boxes.find({dimension, group.label});
      const LabelBox box = found == layout.boxes.end() ? LabelBox{} : found->second;
      sink.int32(group.entity);
      for (int k = 0; k < 3; ++k) sink.real(box.low[k]);
      for (int k = 0; k < 3 && (dimension > 0 || !wide_tags); ++k) sink.real(box.high[k]);
      sink.wide(layout.has_labels ? 1 : 0);
      if (layout.has_labels) sink.int32(group.label);
      if (dimension > 0) sink.wide(0);  // bounding entities
      sink.end_line();
    }
  }
  sink.end_data();
  sink.line("$EndEntities");
}

void begin_nodes(Sink& sink, const MeshStretch& mesh, const Layout& layout, bool wide_tags) {
  int dimension = 3;
  while (dimension > 0 && layout.dimensions[static_cast<std::size_t>(dimension)].groups.empty()) --dimension;
  sink.line("$Nodes");
  put_totals(sink, mesh.n_points > 0 ? 1 : 0, mesh.n_points, wide_tags);
  if (mesh.n_points == 0) return;
  const int entity = layout.dimensions[static_cast<std::size_t>(dimension)].groups.front().entity;
  put_block(sink, dimension, entity, /*kind=*/0, mesh.n_points, wide_tags);
}

void write_nodes(Sink& sink, const MeshStretch& mesh, const Layout& layout, bool wide_tags) {
  if (mesh.is_first()) begin_nodes(sink, mesh, layout, wide_tags);
  if (wide_tags) {
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      sink.wide(mesh.first_point + i + 1);
      sink.end_line();
    }
    sink.next_stretch();
  }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (!wide_tags) put_tag(sink, mesh.first_point + i + 1, wide_tags);
    for (int k = 0; k < 3; ++k) sink.real(mesh.points[i][k]);
    sink.end_line();
  }
  sink.next_stretch();
  if (!mesh.is_first()) return;
  sink.end_data();
  sink.line("$EndNodes");
}

void write_dimension(Sink& sink, const Dimension& elements, int dimension, bool wide_tags) {
  for (const Run& run : elements.runs) {
    if (run.length > 0)
      put_block(sink, dimension, elements.groups[run.group].entity, elements.type, run.length, wide_tags);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      put_tag(sink, elements.first_tag + i, wide_tags);
      for (std::size_t k = 0; k < elements.nodes.width(); ++k) {
        put_tag(sink, elements.nodes(i, k) + 1, wide_tags);
      }
      sink.end_line();
    }
  }
  sink.next_stretch();
}

void write_elements(Sink& sink, const MeshStretch& mesh, const Layout& layout, bool wide_tags) {
  if (mesh.is_first()) {
    std::uint64_t blocks = 0;
    for (const Dimension& elements : layout.dimensions) blocks += elements.n_runs;
    sink.line("$Elements");
    put_totals(sink, blocks, layout.n_elements(), wide_tags);
  }
  for (int d = 0; d < 4; ++d)
    write_dimension(sink, layout.dimensions[static_cast<std::size_t>(d)], d, wide_tags);
  if (!mesh.is_first()) return;
  sink.end_data();
  sink.line("$EndElements");
}

}  // namespace

void write_mesh4(Sink& sink, const MeshStretch& mesh, const Layout& layout, bool wide_tags) {
  if (mesh.is_first()) write_entities(sink, layout, wide_tags);
  write_nodes(sink, mesh, layout, wide_tags);
  write_elements(sink, mesh, layout, wide_tags);
}

}  // namespace hfr::io::gmsh
