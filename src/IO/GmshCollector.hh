// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_GMSH_COLLECTOR_HH
#define HFR_IO_GMSH_COLLECTOR_HH

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "IO/GmshElements.hh"
#include "IO/GmshTags.hh"
#include "IO/MeshData.hh"

namespace hfr::io::gmsh {

/// Gmsh's two numbers for what an element belongs to. 0: none.
struct Membership {
  int physical = 0;    ///< group that the user made; negative where the group runs against the entity
  int elementary = 0;  ///< entity of the geometry
};

/// Elements of one dimension; nodes as positions.
template <std::size_t N>
struct Elements {
  std::vector<std::array<Index, N>> nodes;
  std::vector<Membership> groups;
  std::vector<std::int64_t> tags;
};

/// Takes what the sections of a .msh file say, in file order, and makes MeshData of it.
/// Calls come as begin_nodes, add_node …, end_nodes, add …, end_elements, begin_field, set_value …, finish.
class Collector {
 public:
  void begin_nodes(std::size_t count);
  void add_node(std::int64_t tag, const Vec3& point) {
    node_tags_.push_back(tag);
    mesh_.points.push_back(point);
  }
  /// Returns a tag that two nodes have, if there is one.
  std::optional<std::int64_t> end_nodes();
  bool has_nodes() const { return has_nodes_; }
  Index find_node(std::int64_t tag) const {
    return nodes_by_tag_.find(tag);
  }  ///< TagIndex::kNone: no such node

  /// Throws ResourceLimit when that many cannot be indexed.
  void begin_elements(std::size_t count) const;
  /// Room for `count` more elements of a type.
  void reserve(const ElementType& type, std::size_t count);
  /// `nodes` holds positions of all nodes of a simplex; those after the corners are dropped.
  void add(const ElementType& type, std::int64_t tag, Membership group, const std::vector<Index>& nodes);
  void skip_quadrangle() { ++skipped_quadrangles_; }
  /// Older files hold an element once for each physical group that its entity is in: keep the first.
  void end_elements(bool drop_copies_in_groups);
  bool has_elements() const { return has_elements_; }

  void add_name(int dimension, int label, std::string name) {
    mesh_.names[{dimension, label}] = std::move(name);
  }

  /// A section of values follows. A later section of the same name adds to it if it is of the same time step,
  /// and replaces it otherwise.
  void begin_field(bool on_points, const std::string& name, int components, int step);
  /// Position that a value's tag means for the current field: kNone when the tag is of no point or cell.
  Index find_item(std::int64_t tag) const;
  void set_value(Index item, int component, double value);
  void skip_value() { ++pending().outside; }

  void note_several_groups() { ++entities_in_several_groups_; }
  void note(const std::string& line);  ///< once, however often it is given

  MeshData finish();

 private:
  struct PendingField {
    Field field;
    bool on_points = true;
    int step = 0;
    bool replaced = false;
    bool repeated = false;         ///< values of one time step given twice
    std::size_t outside = 0;       ///< values on what is neither point nor cell
    std::vector<bool> given = {};  ///< per item
  };

  PendingField& pending() { return fields_[current_field_]; }
  static void restart(PendingField& entry, int components, int step);
  bool any_physical() const;
  template <std::size_t N>
  std::vector<int> labels(const Elements<N>& elements) const;
  void set_vertex_labels();
  void take_fields();
  void drop_unused_midside_nodes();
  void add_notes();

  MeshData mesh_;
  std::vector<std::int64_t> node_tags_;
  TagIndex nodes_by_tag_;
  std::optional<TagIndex> cells_by_tag_;  ///< made for the first field on elements
  bool has_nodes_ = false;
  bool has_elements_ = false;

  Elements<1> points_;
  Elements<2> edges_;
  Elements<3> triangles_;
  Elements<4> cells_;
  std::vector<bool> midside_;  ///< per node, once there is a curved element

  std::vector<PendingField> fields_;
  std::size_t current_field_ = 0;

  std::size_t linearised_ = 0;
  std::size_t dropped_nodes_ = 0;
  std::size_t skipped_quadrangles_ = 0;
  std::size_t entities_in_several_groups_ = 0;
  std::size_t repeated_elements_ = 0;
};

}  // namespace hfr::io::gmsh

#endif
