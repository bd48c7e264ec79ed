// SPDX-License-Identifier: BSD-3-Clause
// "MSH file format version 2" of the Gmsh manual.
#include "IO/WriteGmsh.hh"

namespace hfr::io::gmsh {
namespace {

void write_nodes(Sink& sink, const MeshData& mesh) {
  sink.line("$Nodes");
  sink.line(mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    sink.int32(static_cast<std::int64_t>(i) + 1);
    for (int k = 0; k < 3; ++k) sink.real(mesh.points[i][k]);
    sink.end_line();
  }
  sink.end_data();
  sink.line("$EndNodes");
}

/// In a binary file one header serves all elements of a dimension.
void write_dimension(Sink& sink, const MeshData& mesh, const Layout& layout, int dimension) {
  const Dimension& elements = layout.dimensions[static_cast<std::size_t>(dimension)];
  constexpr int kTags = 2;
  if (elements.count == 0) return;
  if (sink.binary()) {
    sink.int32(elements.type);
    sink.int32(static_cast<std::int64_t>(elements.count));
    sink.int32(kTags);
  }
  for (const Run& run : elements.runs) {
    const Group group = elements.groups[run.group];
    for (std::size_t i = run.begin; i < run.end; ++i) {
      sink.int32(static_cast<std::int64_t>(elements.first_tag + i));
      if (!sink.binary()) {
        sink.int32(elements.type);
        sink.int32(kTags);
      }
      sink.int32(group.label);
      sink.int32(group.entity);
      for (const Index node : element_nodes(mesh, layout, dimension, i)) {
        sink.int32(static_cast<std::int64_t>(node) + 1);
      }
      sink.end_line();
    }
  }
}

}  // namespace

void write_mesh2(Sink& sink, const MeshData& mesh, const Layout& layout) {
  write_nodes(sink, mesh);
  sink.line("$Elements");
  sink.line(layout.n_elements());
  for (int dimension = 0; dimension < 4; ++dimension) write_dimension(sink, mesh, layout, dimension);
  sink.end_data();
  sink.line("$EndElements");
}

}  // namespace hfr::io::gmsh
