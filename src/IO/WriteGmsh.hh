// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_WRITE_GMSH_HH
#define HFR_IO_WRITE_GMSH_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "IO/MeshData.hh"
#include "IO/OutputFile.hh"

/// The parts of the Gmsh writer.
namespace hfr::io::gmsh {

/// Writes numbers as the words of a line or as bytes in this machine's order.
class Sink {
 public:
  Sink(OutputFile& out, bool binary) : out_(out), binary_(binary) {}

  bool binary() const { return binary_; }
  void int32(std::int64_t value) {
    if (binary_) {
      out_.raw(static_cast<std::int32_t>(value));
    } else {
      word().number(value);
    }
  }
  void wide(std::size_t value) {
    if (binary_) {
      out_.raw(static_cast<std::uint64_t>(value));
    } else {
      word().number(static_cast<std::int64_t>(value));
    }
  }
  void real(double value) {
    if (binary_) {
      out_.raw(value);
    } else {
      word().number(value);
    }
  }
  /// Ends a line of words; nothing in a binary file.
  void end_line() {
    if (!binary_) out_.text("\n");
    at_line_start_ = true;
  }
  /// Ends the data of a section, before the line that closes it.
  void end_data() {
    if (binary_) out_.text("\n");
  }
  /// A line that is text in both kinds of file.
  void line(std::string_view text) { out_.text(text).text("\n"); }
  void line(std::size_t value) { out_.number(static_cast<std::int64_t>(value)).text("\n"); }

 private:
  OutputFile& word() {
    if (!at_line_start_) out_.text(" ");
    at_line_start_ = false;
    return out_;
  }

  OutputFile& out_;
  bool binary_;
  bool at_line_start_ = true;
};

/// Elements of one dimension with one label: they make one entity, which is in one physical group.
struct Group {
  int label = 0;   ///< also the physical group
  int entity = 1;  ///< tag of the entity: positive, and unlike the others of its dimension
};

/// Elements begin … end-1 have one label. Blocks of 4.x are made of runs, so that elements keep their order
/// and have ascending tags: there are readers that match values with elements by order.
struct Run {
  std::size_t group = 0;  ///< position in Dimension::groups
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Elements of one dimension. Element i has tag first_tag + i.
struct Dimension {
  std::vector<Group> groups;  ///< by label
  std::vector<Run> runs;
  std::size_t count = 0;
  std::size_t first_tag = 1;
  int type = 0;  ///< Gmsh's number for the linear element
};

struct Layout {
  std::array<Dimension, 4> dimensions;
  std::vector<Index> labelled_points;  ///< the elements of dimension 0
  bool has_labels = false;             ///< some label is not 0: all elements are in physical groups

  std::size_t n_elements() const {
    std::size_t n = 0;
    for (const Dimension& dimension : dimensions) n += dimension.count;
    return n;
  }
};

inline std::span<const Index> element_nodes(const MeshData& mesh, const Layout& layout, int dimension,
                                            std::size_t element) {
  switch (dimension) {
    case 0:
      return {&layout.labelled_points[element], 1};
    case 1:
      return mesh.edges[element];
    case 2:
      return mesh.triangles[element];
    default:
      return mesh.cells[element];
  }
}

/// $Nodes and $Elements.
void write_mesh2(Sink& sink, const MeshData& mesh, const Layout& layout);
/// $Entities, $Nodes and $Elements. `wide_tags`: the layout of 4.1, otherwise that of 4.0.
void write_mesh4(Sink& sink, const MeshData& mesh, const Layout& layout, bool wide_tags);

}  // namespace hfr::io::gmsh

#endif
