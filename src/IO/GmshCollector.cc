// SPDX-License-Identifier: BSD-3-Clause
#include "IO/GmshCollector.hh"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include "HalfFace/Errors.hh"
#include "IO/Linearise.hh"
#include "IO/ReserveMore.hh"

namespace hfr::io::gmsh {
namespace {

template <std::size_t N>
void reserve_more(Elements<N>& elements, std::size_t count) {
  io::reserve_more(elements.nodes, count);
  io::reserve_more(elements.groups, count);
  io::reserve_more(elements.tags, count);
}

template <std::size_t N>
void append(Elements<N>& elements, std::int64_t tag, Membership group, const std::vector<Index>& nodes) {
  std::copy_n(nodes.begin(), N, elements.nodes.emplace_back().begin());
  elements.groups.push_back(group);
  elements.tags.push_back(tag);
}

template <class T>
std::vector<T> picked(const std::vector<T>& items, const std::vector<std::size_t>& order) {
  std::vector<T> result;
  result.reserve(order.size());
  for (const std::size_t i : order) result.push_back(items[i]);
  return result;
}

template <std::size_t N>
void pick(Elements<N>& elements, const std::vector<std::size_t>& order) {
  elements.nodes = picked(elements.nodes, order);
  elements.groups = picked(elements.groups, order);
  elements.tags = picked(elements.tags, order);
}

std::vector<std::size_t> identity(std::size_t n) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

/// Is some entity in more than one physical group?
bool groups_overlap(const std::vector<Membership>& groups) {
  std::map<int, int> physical_of;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto [elementary_before, physical_before] =
        i > 0 ? std::pair(groups[i - 1].elementary, groups[i - 1].physical) : std::pair(0, 0);
    if (i > 0 && groups[i].elementary == elementary_before && groups[i].physical == physical_before) continue;
    const auto [entry, is_new] = physical_of.emplace(groups[i].elementary, groups[i].physical);
    if (!is_new && entry->second != groups[i].physical) return true;
  }
  return false;
}

/// Keeps the first of the copies that Gmsh 2 writes of an element, one for each group that its entity is in.
/// Returns how many went.
template <std::size_t N>
std::size_t drop_copies(Elements<N>& elements) {
  if (!groups_overlap(elements.groups)) return 0;
  std::vector<std::size_t> order = identity(elements.nodes.size());
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return elements.nodes[a] < elements.nodes[b]; });
  std::vector<bool> copy(order.size(), false);
  for (std::size_t i = 1, first = 0; i < order.size(); ++i) {
    const std::size_t a = order[first];
    const std::size_t b = order[i];
    if (elements.nodes[a] != elements.nodes[b]) {
      first = i;
    } else if (elements.groups[a].elementary == elements.groups[b].elementary &&
               elements.groups[a].physical != elements.groups[b].physical) {
      copy[b] = true;
    }
  }
  std::vector<std::size_t> kept = identity(copy.size());
  std::erase_if(kept, [&](std::size_t i) { return copy[i]; });
  const std::size_t dropped = copy.size() - kept.size();
  if (dropped > 0) pick(elements, kept);
  return dropped;
}

template <std::size_t N>
bool has_physical(const Elements<N>& elements) {
  return std::any_of(elements.groups.begin(), elements.groups.end(),
                     [](Membership group) { return group.physical != 0; });
}

void require_indexable(std::size_t count, const char* what) {
  if (count >= TagIndex::kNone) {
    throw ResourceLimit(std::to_string(count) + " " + what + " are more than this build can index; " +
                        "build with HFR_INDEX64");
  }
}

std::string several(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

}  // namespace

void Collector::begin_nodes(std::size_t count) {
  require_indexable(count, "nodes");
  mesh_.points.reserve(count);
  node_tags_.reserve(count);
}

std::optional<std::int64_t> Collector::end_nodes() {
  has_nodes_ = true;
  nodes_by_tag_ = TagIndex(node_tags_);
  return nodes_by_tag_.duplicate();
}

void Collector::begin_elements(std::size_t count) const { require_indexable(count, "elements"); }

void Collector::reserve(const ElementType& type, std::size_t count) {
  if (!is_simplex(type)) return;
  if (type.dimension == 0) reserve_more(points_, count);
  if (type.dimension == 1) reserve_more(edges_, count);
  if (type.dimension == 2) reserve_more(triangles_, count);
  if (type.dimension == 3) reserve_more(cells_, count);
}

void Collector::add(const ElementType& type, std::int64_t tag, Membership group,
                    const std::vector<Index>& nodes) {
  if (type.nodes > type.corners) {
    ++linearised_;
    midside_.resize(mesh_.points.size(), false);
    for (int k = type.corners; k < type.nodes; ++k) midside_[nodes[static_cast<std::size_t>(k)]] = true;
  }
  switch (type.dimension) {
    case 0:
      append(points_, tag, group, nodes);
      break;
    case 1:
      append(edges_, tag, group, nodes);
      break;
    case 2:
      append(triangles_, tag, group, nodes);
      break;
    default:
      append(cells_, tag, group, nodes);
      break;
  }
}

void Collector::end_elements(bool drop_copies_in_groups) {
  has_elements_ = true;
  if (!drop_copies_in_groups) return;
  repeated_elements_ =
      drop_copies(points_) + drop_copies(edges_) + drop_copies(triangles_) + drop_copies(cells_);
}

void Collector::restart(PendingField& entry, int components, int step) {
  entry.step = step;
  entry.field.components = components;
  entry.field.values.clear();
  entry.given.clear();
  entry.outside = 0;
}

void Collector::begin_field(bool on_points, const std::string& name, int components, int step) {
  if (!on_points && !cells_by_tag_) cells_by_tag_.emplace(cells_.tags);
  const auto found = std::find_if(fields_.begin(), fields_.end(), [&](const PendingField& entry) {
    return entry.on_points == on_points && entry.field.name == name;
  });
  current_field_ = static_cast<std::size_t>(found - fields_.begin());
  if (found == fields_.end()) {
    fields_.emplace_back().field.name = name;
    fields_.back().on_points = on_points;
    restart(fields_.back(), components, step);
  } else if (found->step != step || found->field.components != components) {
    restart(*found, components, step);
    found->replaced = true;
  }
}

Index Collector::find_item(std::int64_t tag) const {
  return (fields_[current_field_].on_points ? nodes_by_tag_ : *cells_by_tag_).find(tag);
}

void Collector::set_value(Index item, int component, double value) {
  PendingField& entry = pending();
  if (entry.given.empty()) {  // a file may have any number of headers without values
    const std::size_t items = entry.on_points ? mesh_.points.size() : cells_.nodes.size();
    entry.field.values.assign(items * static_cast<std::size_t>(entry.field.components), 0.0);
    entry.given.assign(items, false);
  }
  if (component == 0) {
    if (entry.given[item]) entry.repeated = true;
    entry.given[item] = true;
  }
  entry.field
      .values[item * static_cast<std::size_t>(entry.field.components) + static_cast<std::size_t>(component)] =
      value;
}

void Collector::note(const std::string& line) {
  if (std::find(mesh_.notes.begin(), mesh_.notes.end(), line) == mesh_.notes.end())
    mesh_.notes.push_back(line);
}

bool Collector::any_physical() const {
  return has_physical(points_) || has_physical(edges_) || has_physical(triangles_) || has_physical(cells_);
}

/// Physical groups, or entities where the whole file has no group. A single entity with the tag that writers
/// give by default says nothing, so it is no label.
template <std::size_t N>
std::vector<int> Collector::labels(const Elements<N>& elements) const {
  const bool physical = any_physical();
  std::vector<int> result;
  result.reserve(elements.groups.size());
  for (const Membership group : elements.groups)
    result.push_back(physical ? group.physical : group.elementary);
  const bool one_entity =
      std::adjacent_find(result.begin(), result.end(), std::not_equal_to<>()) == result.end();
  if (!physical && one_entity && !result.empty() && result[0] == 1)
    std::fill(result.begin(), result.end(), 0);
  return result;
}

void Collector::set_vertex_labels() {
  const std::vector<int> point_labels = labels(points_);
  std::size_t conflicts = 0;
  for (std::size_t i = 0; i < point_labels.size(); ++i) {
    if (point_labels[i] == 0) continue;
    mesh_.vertex_labels.resize(mesh_.points.size(), 0);
    int& label = mesh_.vertex_labels[points_.nodes[i][0]];
    if (label != 0 && label != point_labels[i]) ++conflicts;
    if (label == 0) label = point_labels[i];
  }
  if (conflicts > 0)
    note(several(conflicts, "point has", "points have") + " several labels; the first is taken");
}

void Collector::take_fields() {
  for (PendingField& entry : fields_) {
    const std::string name = "field '" + entry.field.name + "'";
    const auto missing = static_cast<std::size_t>(std::count(entry.given.begin(), entry.given.end(), false));
    if (entry.replaced) note(name + " is given at several time steps; the last is taken");
    if (entry.repeated) note(name + " has several values in one place; the last is taken");
    if (entry.outside > 0) {
      note(name + ": " + several(entry.outside, "value", "values") +
           " on elements other than tetrahedra left out");
    }
    if (entry.given.empty()) {
      if (entry.outside == 0) note(name + " has no values and is left out");
      continue;
    }
    if (missing > 0) {
      note(name + " has no value on " +
           several(missing, entry.on_points ? "point" : "cell", entry.on_points ? "points" : "cells") +
           "; 0 is taken");
    }
    (entry.on_points ? mesh_.point_fields : mesh_.cell_fields).push_back(std::move(entry.field));
  }
}

void Collector::drop_unused_midside_nodes() {
  if (midside_.empty()) return;
  for (const auto& [node] : points_.nodes) midside_[node] = false;  // a point element is a use, too
  std::vector<Index> midside;
  for (std::size_t i = 0; i < midside_.size(); ++i) {
    if (midside_[i]) midside.push_back(static_cast<Index>(i));
  }
  const std::size_t before = mesh_.points.size();
  drop_midside_points(mesh_, midside);
  dropped_nodes_ = before - mesh_.points.size();
}

void Collector::add_notes() {
  if (linearised_ > 0) {
    note(several(linearised_, "element", "elements") + " of higher order made linear, " +
         several(dropped_nodes_, "node", "nodes") + " of them dropped");
  }
  if (skipped_quadrangles_ > 0) {
    note(several(skipped_quadrangles_, "quadrangle", "quadrangles") +
         " left out: only triangles are surface elements");
  }
  if (entities_in_several_groups_ > 0) {
    note(several(entities_in_several_groups_, "entity is", "entities are") +
         " in several physical groups; the first of each is taken");
  }
  if (repeated_elements_ > 0) {
    note(several(repeated_elements_, "element stands", "elements stand") +
         " in several physical groups; the first of each is taken");
  }
}

MeshData Collector::finish() {
  set_vertex_labels();
  mesh_.regions = labels(cells_);
  mesh_.triangle_labels = labels(triangles_);
  mesh_.edge_labels = labels(edges_);
  if (std::all_of(mesh_.regions.begin(), mesh_.regions.end(), [](int label) { return label == 0; })) {
    mesh_.regions.clear();
  }
  mesh_.cells = std::move(cells_.nodes);
  mesh_.triangles = std::move(triangles_.nodes);
  mesh_.edges = std::move(edges_.nodes);
  take_fields();
  drop_unused_midside_nodes();
  add_notes();
  return std::move(mesh_);
}

}  // namespace hfr::io::gmsh
