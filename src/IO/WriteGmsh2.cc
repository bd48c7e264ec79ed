// SPDX-License-Identifier: BSD-3-Clause
// "MSH file format version 2" of the Gmsh manual.
#include "IO/WriteGmsh.hh"

namespace hfr::io::gmsh {
namespace {

void write_nodes(Sink& sink, const MeshStretch& mesh) {
  if (mesh.is_first()) {
    sink.line("$Nodes");
    sink.line(mesh.n_points);
  }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    sink.int32(static_cast<std::int64_t>(mesh.first_point + i) + 1);
    for (int k = 0; k < 3; ++k) sink.real(mesh.points[i][k]);
    sink.end_line();
  }
  sink.next_stretch();
  if (!mesh.is_first()) return;
  sink.end_data();
  sink.line("$EndNodes");
}

/// In a binary file one header serves all elements of a dimension.
void write_dimension(Sink& sink, const MeshStretch& mesh, const Dimension& elements) {
  constexpr int kTags = 2;
  if (elements.count == 0) return;
  if (sink.binary() && mesh.is_first()) {
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
      for (std::size_t k = 0; k < elements.nodes.width(); ++k) {
        sink.int32(static_cast<std::int64_t>(elements.nodes(i, k)) + 1);
      }
      sink.end_line();
    }
  }
  sink.next_stretch();
}

}  // namespace

void write_mesh2(Sink& sink, const MeshStretch& mesh, const Layout& layout) {
  write_nodes(sink, mesh);
  if (mesh.is_first()) {
    sink.line("$Elements");
    sink.line(layout.n_elements());
  }
  for (const Dimension& elements : layout.dimensions) write_dimension(sink, mesh, elements);
  if (!mesh.is_first()) return;
  sink.end_data();
  sink.line("$EndElements");
}

}  // namespace hfr::io::gmsh
