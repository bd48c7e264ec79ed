// SPDX-License-Identifier: BSD-3-Clause
// "MSH file format version 2" of the Gmsh manual. Counts are text even in binary files; all integers are
// 32-bit.
#include "IO/ReadGmsh.hh"

#include <type_traits>

#include "IO/GmshRecords.hh"

namespace hfr::io::gmsh {
namespace {

template <class Source>
void read_element(Source& in, Collector& mesh, const ElementType& type, std::int64_t tag, int n_tags,
                  std::vector<Index>& nodes) {
  const Membership group = read_group(in, n_tags);
  nodes.resize(static_cast<std::size_t>(type.nodes));
  if (!is_simplex(type)) {
    for (std::size_t k = 0; k < nodes.size(); ++k) in.int32("a node");
    mesh.skip_quadrangle();
    return;
  }
  for (Index& node : nodes) node = node_position(in, mesh, in.int32("a node"));
  mesh.add(type, tag, group, nodes);
}

}  // namespace

template <class Source>
void read_nodes2(Source& in, Collector& mesh, bool parametric) {
  const std::size_t count = bounded(in, in.ascii_count(), node_bytes<Source>(Version::k2), "nodes");
  in.begin_data();
  mesh.begin_nodes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int tag = in.int32("the number of a node");
    mesh.add_node(tag, read_point(in, 0));
    if (!parametric) continue;
    const int dimension = in.int32("the dimension of an entity");
    in.int32("the tag of an entity");
    for (int k = 0; k < dimension && dimension < 3; ++k) in.any_real();
  }
  close_nodes(in, mesh);
}

template <class Source>
void read_elements2(Source& in, Collector& mesh) {
  // An element is at least a number and a node; in text also its type and how many tags it has.
  constexpr bool kText = std::is_same_v<Source, TextSource>;
  const std::size_t count = bounded(in, in.ascii_count(), Source::least(kText ? 4 : 2, 0, 0), "elements");
  in.begin_data();
  mesh.begin_elements(count);
  std::vector<Index> nodes;
  for (std::size_t done = 0; done < count;) {
    if constexpr (kText) {
      const int tag = in.int32("the number of an element");
      const ElementType type = supported_type(in, in.int32("the type of an element"));
      read_element(in, mesh, type, tag, tag_count(in), nodes);
      ++done;
    } else {
      const auto [type, n, n_tags] =
          read_following(in, count - done, [&](int number) { return supported_type(in, number); });
      for (int k = 0; k < n; ++k) read_element(in, mesh, type, in.int32("a number"), n_tags, nodes);
      done += static_cast<std::size_t>(n);
    }
  }
  mesh.end_elements(/*drop_copies_in_groups=*/true);
}

template void read_nodes2(TextSource&, Collector&, bool);
template void read_nodes2(BinarySource&, Collector&, bool);
template void read_elements2(TextSource&, Collector&);
template void read_elements2(BinarySource&, Collector&);

}  // namespace hfr::io::gmsh
