// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_READ_GMSH_HH
#define HFR_IO_READ_GMSH_HH

#include <cstdint>
#include <string>
#include <vector>

#include "IO/GmshCollector.hh"
#include "IO/GmshElements.hh"
#include "IO/GmshSource.hh"

/// The parts of the Gmsh reader: sections whose layout changed between versions. Each function template is
/// instantiated for TextSource and BinarySource, begins after the line that names the section, and ends
/// before the line that closes it.
namespace hfr::io::gmsh {

enum class Version { k2, k40, k41 };

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
