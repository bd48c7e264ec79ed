// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_READ_GMSH_HH
#define HFR_IO_READ_GMSH_HH

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "IO/GmshCollector.hh"
#include "IO/GmshElements.hh"
#include "IO/GmshSource.hh"
#include "IO/Words.hh"

/// The parts of the Gmsh reader: sections whose layout changed between versions. Each function template is
/// instantiated for TextSource and BinarySource, begins after the line that names the section, and ends
/// before the line that closes it.
namespace hfr::io::gmsh {

enum class Version { k2, k40, k41 };

/// What $MeshFormat says.
struct Format {
  Version version = Version::k2;
  bool is_binary = false;
};
/// From the word $MeshFormat on; of a binary file up to its data, the number 1 in the file's byte order.
Format read_format(TextSource& in);
/// Whether that number, which is next, has the other byte order than this machine. Fails where it is no 1.
bool is_swapped(const BinarySource& in);

/// Where the line `closing`, such as $EndNodes, begins; npos: nowhere from `from` on.
std::size_t find_closing(std::string_view text, std::string_view closing, std::size_t from);
template <class Source>
void close_section(Source& in, const std::string& name) {
  const std::string_view found = in.word();
  if (found != "$End" + name) in.fail("expected $End" + name + " and found '" + shown(found) + "'");
}

std::string unquoted(std::string_view line);
/// add(dimension, label, name) for each line of $PhysicalNames.
template <class Source, class Add>
void read_names(Source& in, Add&& add) {
  constexpr std::size_t kShortest = 7;  // 3 1 "a" and a line break
  const std::size_t count = bounded(in, in.ascii_count(), kShortest, "physical names");
  for (std::size_t k = 0; k < count; ++k) {
    const int dimension = in.ascii_integer("the dimension of a physical name");
    if (dimension < 0 || dimension > 3) in.fail("a physical name of dimension " + std::to_string(dimension));
    const int label = in.ascii_integer("the tag of a physical name");
    add(dimension, label, unquoted(in.line()));
  }
}

/// What $NodeData and $ElementData begin with.
struct DataHeader {
  std::string name;
  int step = 0;
  int components = 0;     ///< 1 to 9
  std::size_t count = 0;  ///< of values: a tag of 32 bits and the components each
};
template <class Source>
DataHeader read_data_header(Source& in);

/// $Nodes and, with `parametric`, $ParametricNodes of 2.x.
template <class Source>
void read_nodes2(Source& in, Collector& mesh, bool parametric);
template <class Source>
void read_elements2(Source& in, Collector& mesh);

/// An entity of $Entities or $PartitionedEntities.
struct Entity {
  int dimension = 0;
  int tag = 0;
  Membership group;
  bool in_several_groups = false;
};

/// By dimension and tag.
class Entities {
 public:
  explicit Entities(std::vector<Entity> entities);
  /// The first one that is listed; null where none is.
  const Entity* find(int dimension, int tag) const;

 private:
  std::vector<Entity> entities_;
};

/// Adds what $Entities, or with `partitioned` $PartitionedEntities, lists.
template <class Source>
void read_entities4(Source& in, Version version, bool partitioned, std::vector<Entity>& entities);
template <class Source>
void read_nodes4(Source& in, Version version, Collector& mesh);
template <class Source>
void read_elements4(Source& in, Version version, std::vector<Entity> entities, Collector& mesh);

/// Type number `type` of the file, when the reader can take or skip its elements; fails by name otherwise.
template <class Source>
ElementType supported_type(const Source& in, int type) {
  const ElementType found = element_type(type);
  if (found.name == nullptr) in.fail("unknown Gmsh element type " + std::to_string(type));
  if (!is_simplex(found) && found.nodes == 0) {
    in.fail(std::string(found.name) + " (Gmsh element type " + std::to_string(type) +
            ") cannot be read: split them into tetrahedra first");
  }
  return found;
}

template <class Source>
Index node_position(const Source& in, const Collector& mesh, std::int64_t tag) {
  const Index position = mesh.find_node(tag);
  if (position == TagIndex::kNone) in.fail("there is no node " + std::to_string(tag));
  return position;
}

template <class Source>
void close_nodes(const Source& in, Collector& mesh) {
  if (const auto twice = mesh.end_nodes()) in.fail("node " + std::to_string(*twice) + " is given twice");
}

}  // namespace hfr::io::gmsh

#endif
