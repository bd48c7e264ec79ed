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
  int label = 0;   ///< also the physical group; 0: in none
  int entity = 1;  ///< tag of the entity: positive, and unlike the others of its dimension
  std::vector<Index> items = {};
};

/// The elements of a mesh by dimension and label. Element `item` of dimension d has tag first_tag[d] + item,
/// so that tags keep the order that grouping breaks. Items of dimension 0 are points with a label.
struct Layout {
  std::array<std::vector<Group>, 4> groups;
  std::array<std::size_t, 4> counts{};
  std::array<std::size_t, 4> first_tag{};

  std::size_t n_elements() const { return counts[0] + counts[1] + counts[2] + counts[3]; }
};

/// Gmsh's number for the linear element of each dimension.
inline constexpr std::array<int, 4> kTypeOfDimension = {15, 1, 2, 4};

inline std::span<const Index> element_nodes(const MeshData& mesh, int dimension, const Index& item) {
  switch (dimension) {
    case 0:
      return {&item, 1};
    case 1:
      return mesh.edges[item];
    case 2:
      return mesh.triangles[item];
    default:
      return mesh.cells[item];
  }
}

/// $Nodes and $Elements.
void write_mesh2(Sink& sink, const MeshData& mesh, const Layout& layout);
/// $Entities, $Nodes and $Elements. `wide_tags`: the layout of 4.1, otherwise that of 4.0.
void write_mesh4(Sink& sink, const MeshData& mesh, const Layout& layout, bool wide_tags);

}  // namespace hfr::io::gmsh

#endif
