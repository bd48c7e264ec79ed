// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_WRITE_GMSH_HH
#define HFR_IO_WRITE_GMSH_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "IO/ByteSink.hh"
#include "IO/MeshStretch.hh"

/// The parts of the Gmsh writer.
namespace hfr::io::gmsh {

/// Writes numbers as the words of a line or as bytes in this machine's order.
class Sink {
 public:
  Sink(ByteSink& out, bool binary) : out_(out), binary_(binary) {}

  bool binary() const { return binary_; }
  void int32(std::int64_t value) {
    if (binary_) {
      out_.raw(static_cast<std::int32_t>(value));
    } else {
      word().number(value);
    }
  }
  void wide(std::uint64_t value) {
    if (binary_) {
      out_.raw(value);
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
  void line(std::uint64_t value) { out_.number(static_cast<std::int64_t>(value)).text("\n"); }
  /// Behind what the last process has put: the first one goes on.
  void next_stretch() { out_.next_stretch(); }

 private:
  ByteSink& word() {
    if (!at_line_start_) out_.text(" ");
    at_line_start_ = false;
    return out_;
  }

  ByteSink& out_;
  bool binary_;
  bool at_line_start_ = true;
};

/// Elements of one dimension with one label: they make one entity, which is in one physical group.
struct Group {
  int label = 0;   ///< also the physical group
  int entity = 1;  ///< tag of the entity: positive, and unlike the others of its dimension
};

/// Elements of this process, begin … end-1 of them, have one label. Blocks of 4.x are made of runs, so that
/// elements keep their order and have ascending tags: there are readers that match values with elements by
/// order.
struct Run {
  std::size_t group = 0;  ///< position in Dimension::groups
  std::size_t begin = 0;
  std::size_t end = 0;
  /// With what of it the processes behind this one have; 0 where one before has begun it.
  std::uint64_t length = 0;
};

/// Elements of one dimension; element i of this process has tag first_tag + i.
struct Dimension {
  std::vector<Group> groups;  ///< of all processes, by label
  std::vector<Run> runs;
  std::uint64_t n_runs = 0, count = 0;  ///< of all processes
  std::uint64_t first_tag = 1;
  int type = 0;  ///< Gmsh's number for the linear element
  NumberRows nodes;
};

struct Layout {
  std::array<Dimension, 4> dimensions;
  std::vector<std::uint64_t> labelled_points;  ///< the elements of dimension 0
  bool has_labels = false;                     ///< some label is not 0: all elements are in physical groups
  std::map<std::pair<int, int>, LabelBox> boxes;  ///< (dimension, label) → of all processes

  std::uint64_t n_elements() const {
    std::uint64_t n = 0;
    for (const Dimension& dimension : dimensions) n += dimension.count;
    return n;
  }
};

/// Of the stretches of all processes, which make one at the same time. It refers to the mesh, and to itself:
/// not to be moved.
void lay_out(const MeshStretch& mesh, Layout& layout);

/// $Nodes and $Elements.
void write_mesh2(Sink& sink, const MeshStretch& mesh, const Layout& layout);
/// $Entities, $Nodes and $Elements. `wide_tags`: the layout of 4.1, otherwise that of 4.0.
void write_mesh4(Sink& sink, const MeshStretch& mesh, const Layout& layout, bool wide_tags);

}  // namespace hfr::io::gmsh

#endif
