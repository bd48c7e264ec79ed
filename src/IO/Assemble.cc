// SPDX-License-Identifier: BSD-3-Clause
#include "IO/Assemble.hh"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "IO/FieldProperties.hh"

namespace hfr::io {
namespace {

template <std::size_t N>
std::array<VertexHandle, N> handles(const std::array<Index, N>& items) {
  std::array<VertexHandle, N> result;
  std::transform(items.begin(), items.end(), result.begin(), [](Index v) { return VertexHandle(v); });
  return result;
}

/// Attaches labels to edges or faces; labels may be shorter than items, the rest is 0.
template <std::size_t N>
void attach(const std::vector<std::array<Index, N>>& items, const std::vector<int>& labels,
            TupleMap<N, int>& map, std::string_view kind, std::vector<std::string>* notes) {
  for (std::size_t i = 0; i < items.size(); ++i)
    map.set(handles(items[i]), i < labels.size() ? labels[i] : 0);
  const std::size_t repeated = items.size() - map.size();
  if (repeated > 0 && notes)
    notes->push_back(std::string(kind) + " given more than once: " + std::to_string(repeated) +
                     "; the last label of each counts");
}

/// Old → new indices of what is not deleted; empty when nothing is.
template <class IsDeleted>
std::vector<Index> renumbering(std::size_t n, std::size_t n_left, IsDeleted&& is_deleted) {
  if (n == n_left) return {};
  std::vector<Index> new_index(n, VertexHandle::kInvalid);
  Index next = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (!is_deleted(i)) new_index[i] = next++;
  return new_index;
}

template <std::size_t N>
void detach(const TupleMap<N, int>& map, const std::vector<Index>& new_index,
            std::vector<std::array<Index, N>>& items, std::vector<int>& labels) {
  items.reserve(map.size());
  labels.reserve(map.size());
  for (const auto& entry : map.entries()) {
    std::array<Index, N> item;
    for (std::size_t k = 0; k < N; ++k) {
      const Index v = entry.vertices[k].idx();
      item[k] = new_index.empty() ? v : new_index[v];
    }
    if (std::count(item.begin(), item.end(), VertexHandle::kInvalid) > 0) continue;
    items.push_back(item);
    labels.push_back(entry.value);
  }
}

/// What became of triangles and edges at vertices that were copied.
class Copies {
 public:
  Copies(const TetMesh& mesh, const std::vector<VertexHandle>& copied)
      : copied_(copied), n_given_(mesh.n_vertices() - copied.size()), is_split_(n_given_, 0) {
    for (VertexHandle v : copied) is_split_[v.idx()] = 1;
    for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
      const auto& v = mesh.cell(CellHandle(c)).v;
      for (const auto& f : kFaceCorners) note<3>({v[f[0]], v[f[1]], v[f[2]]}, triangles_);
      for (const auto& e : kEdgeCorners) note<2>({v[e[0]], v[e[1]]}, edges_);
    }
  }

  /// Replaces every item by those that its cells have now, in the direction of the item.
  void follow(std::vector<std::array<Index, 3>>& items, std::vector<int>& labels) const {
    follow(items, labels, triangles_);
  }
  void follow(std::vector<std::array<Index, 2>>& items, std::vector<int>& labels) const {
    follow(items, labels, edges_);
  }

 private:
  /// By the given vertices, ascending: what the cells have, in the same order.
  template <std::size_t N>
  using Now = std::map<std::array<Index, N>, std::set<std::array<Index, N>>>;

  Index given(Index v) const { return v < n_given_ ? v : copied_[v - n_given_].idx(); }

  template <std::size_t N>
  void note(const std::array<VertexHandle, N>& vertices, Now<N>& now) {
    std::array<std::pair<Index, Index>, N> pairs;  // given, now
    bool any = false;
    for (std::size_t k = 0; k < N; ++k) {
      pairs[k] = {given(vertices[k].idx()), vertices[k].idx()};
      any = any || is_split_[pairs[k].first] != 0;
    }
    if (!any) return;
    std::sort(pairs.begin(), pairs.end());
    std::array<Index, N> key, value;
    for (std::size_t k = 0; k < N; ++k) std::tie(key[k], value[k]) = pairs[k];
    now[key].insert(value);
  }

  template <std::size_t N>
  void follow(std::vector<std::array<Index, N>>& items, std::vector<int>& labels, const Now<N>& now) const {
    std::vector<std::array<Index, N>> new_items;
    std::vector<int> new_labels;
    for (std::size_t i = 0; i < items.size(); ++i) {
      std::array<Index, N> key = items[i];
      std::sort(key.begin(), key.end());
      const auto at = now.find(key);
      const auto add = [&](const std::array<Index, N>& item) {
        new_items.push_back(item);
        if (!labels.empty()) new_labels.push_back(i < labels.size() ? labels[i] : 0);
      };
      if (at == now.end()) {
        add(items[i]);
        continue;
      }
      for (const auto& value : at->second) {
        std::array<Index, N> item = items[i];
        for (Index& v : item)
          v = value[static_cast<std::size_t>(std::find(key.begin(), key.end(), v) - key.begin())];
        add(item);
      }
    }
    items = std::move(new_items);
    labels = std::move(new_labels);
  }

  const std::vector<VertexHandle>& copied_;
  std::size_t n_given_;
  std::vector<std::uint8_t> is_split_;
  Now<3> triangles_;
  Now<2> edges_;
};

/// Gives the copies of vertices what the vertices have.
void extend(MeshData& data, const TetMesh& mesh, const std::vector<VertexHandle>& copied) {
  const Copies copies(mesh, copied);
  copies.follow(data.triangles, data.triangle_labels);
  copies.follow(data.edges, data.edge_labels);
  const std::size_t n_given = mesh.n_vertices() - copied.size();
  const std::set<Index> fixed(data.fixed_vertices.begin(), data.fixed_vertices.end());
  if (!data.vertex_labels.empty()) data.vertex_labels.resize(n_given, 0);
  for (std::size_t i = 0; i < copied.size(); ++i) {
    const Index v = copied[i].idx();
    if (!data.vertex_labels.empty()) data.vertex_labels.push_back(data.vertex_labels[v]);
    if (fixed.contains(v)) data.fixed_vertices.push_back(static_cast<Index>(n_given + i));
    for (Field& field : data.point_fields) {
      const auto n = static_cast<std::size_t>(field.components);
      if (field.values.size() != n * (n_given + i)) continue;  // attach_fields() says so
      for (std::size_t k = 0; k < n; ++k) field.values.push_back(field.values[n * v + k]);
    }
  }
}

}  // namespace

TetMesh assemble(MeshData data, par::Policy policy, BuildReport* report, std::vector<std::string>* notes,
                 NonManifold non_manifold) {
  BuildReport built;
  TetMesh mesh = build(std::move(data.points), data.cells, policy, &built, non_manifold);
  if (!built.copied.empty()) extend(data, mesh, built.copied);
  if (report) *report = std::move(built);
  HFR_REQUIRE(data.regions.empty() || data.regions.size() == mesh.n_cells(),
              "there are " + std::to_string(data.regions.size()) + " regions for " +
                  std::to_string(mesh.n_cells()) + " cells");
  for (std::size_t c = 0; c < data.regions.size(); ++c) mesh.set_region(CellHandle(c), data.regions[c]);
  Labels& labels = mesh.labels();
  attach(data.triangles, data.triangle_labels, labels.faces, "triangles", notes);
  attach(data.edges, data.edge_labels, labels.edges, "edges", notes);
  if (std::any_of(data.vertex_labels.begin(), data.vertex_labels.end(),
                  [](int label) { return label != 0; })) {
    data.vertex_labels.resize(mesh.n_vertices(), 0);
    labels.vertices = std::move(data.vertex_labels);
  }
  labels.names = std::move(data.names);
  for (Index v : data.fixed_vertices) mesh.set_fixed(VertexHandle(v));
  attach_fields(mesh, data.point_fields, data.cell_fields, notes);
  return mesh;
}

MeshData disassemble(const TetMesh& mesh, par::Policy policy) {
  MeshData data;
  const auto new_vertex = renumbering(mesh.n_vertices(), mesh.n_logical_vertices(),
                                      [&](std::size_t v) { return mesh.is_deleted(VertexHandle(v)); });
  const auto new_cell = renumbering(mesh.n_cells(), mesh.n_logical_cells(),
                                    [&](std::size_t c) { return mesh.is_deleted(CellHandle(c)); });
  const auto moved = [](const std::vector<Index>& new_index, Index i) {
    return new_index.empty() ? i : new_index[i];
  };

  data.points.resize(mesh.n_logical_vertices());
  if (!mesh.labels().vertices.empty()) data.vertex_labels.resize(data.points.size());
  par::for_each(policy, mesh.n_vertices(), [&](std::size_t i) {
    const VertexHandle v(i);
    if (mesh.is_deleted(v)) return;
    const Index at = moved(new_vertex, v.idx());
    data.points[at] = mesh.point(v);
    if (!data.vertex_labels.empty()) data.vertex_labels[at] = mesh.labels().vertex(v);
  });
  data.cells.resize(mesh.n_logical_cells());
  if (mesh.has_regions()) data.regions.resize(data.cells.size());
  par::for_each(policy, mesh.n_cells(), [&](std::size_t i) {
    const CellHandle c(i);
    if (mesh.is_deleted(c)) return;
    const Index at = moved(new_cell, c.idx());
    for (std::size_t k = 0; k < 4; ++k) data.cells[at][k] = moved(new_vertex, mesh.cell(c).v[k].idx());
    if (!data.regions.empty()) data.regions[at] = mesh.region(c);
  });

  detach(mesh.labels().faces, new_vertex, data.triangles, data.triangle_labels);
  detach(mesh.labels().edges, new_vertex, data.edges, data.edge_labels);
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i)
    if (mesh.is_fixed(VertexHandle(i)) && !mesh.is_deleted(VertexHandle(i)))
      data.fixed_vertices.push_back(moved(new_vertex, static_cast<Index>(i)));
  data.names = mesh.labels().names;
  data.point_fields = point_fields(mesh);
  data.cell_fields = cell_fields(mesh);
  return data;
}

}  // namespace hfr::io
