// SPDX-License-Identifier: BSD-3-Clause
// OpenVolumeMesh's ASCII format: vertices; edges as pairs of vertices; faces as cycles of half-edges;
// polyhedra as sets of half-faces. Half-edge 2e is edge e as listed and 2e+1 its opposite; half-faces
// likewise. M. Kremer, D. Bommes, L. Kobbelt: "OpenVolumeMesh - a versatile index-based data structure for 3D
// polytopal complexes", 2013.
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/OvmProperties.hh"
#include "IO/TextScanner.hh"
#include "IO/Validate.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

using Triple = std::array<Index, 3>;

bool same_cycle(const Triple& a, const Triple& b) {
  return a == b || (a[0] == b[1] && a[1] == b[2] && a[2] == b[0]) ||
         (a[0] == b[2] && a[1] == b[0] && a[2] == b[1]);
}

/// The vertex of `corners` that `face` has not; nothing unless the face has three of them.
std::optional<Index> opposite(const std::array<Index, 4>& corners, const Triple& face) {
  std::optional<Index> found;
  int missing = 0;
  for (const Index corner : corners) {
    if (std::find(face.begin(), face.end(), corner) == face.end()) {
      found = corner;
      ++missing;
    }
  }
  return missing == 1 ? found : std::nullopt;
}

class OvmReader {
 public:
  explicit OvmReader(const InputFile& file) : in_(file.bytes(), file.path().string(), '#') {}

  MeshData read() {
    read_header();
    read_points();
    read_edges();
    read_faces();
    read_cells();
    while (!in_.at_end()) read_property();
    if (!in_.ends_with_line_break()) {
      mesh_.notes.emplace_back("the last line has no end; the file may have been cut short");
    }
    take_elements();
    return std::move(mesh_);
  }

 private:
  void read_header() {
    if (in_.text().starts_with("OVMB\n")) {
      in_.fail("the binary format of OpenVolumeMesh is not read; save the mesh as .ovm");
    }
    if (lower(in_.peek_word()) == "vertices") return;
    if (lower(in_.peek_word()) != "ovm") in_.fail("not an OpenVolumeMesh file: it does not begin with OVM");
    in_.word();
    if (lower(in_.peek_word()) != "ascii") in_.fail("only ASCII files of OpenVolumeMesh are read");
    in_.word();
  }

  std::size_t begin_section(std::string_view name, std::size_t words_per_item) {
    if (lower(in_.peek_word()) != lower(name)) in_.fail("expected the section " + std::string(name));
    in_.word();
    return in_.count(words_per_item, "number of " + lower(name));
  }

  Index index_below(std::size_t end, std::string_view what) {
    return static_cast<Index>(in_.integer_in(0, static_cast<std::int64_t>(end) - 1, what));
  }

  void read_points() {
    const std::size_t n = begin_section("Vertices", 3);
    mesh_.points.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 p;
      p.x = in_.real();
      p.y = in_.real();
      p.z = in_.real();
      mesh_.points.push_back(p);
    }
  }

  void read_edges() {
    const std::size_t n = begin_section("Edges", 2);
    edges_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Index from = index_below(mesh_.points.size(), "vertex");
      edges_.push_back({from, index_below(mesh_.points.size(), "vertex")});
    }
  }

  void read_faces() {
    const std::size_t n = begin_section("Faces", 4);
    faces_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t valence = in_.integer();
      if (valence != 3) {
        in_.fail("a face of " + std::to_string(valence) + " edges: only tetrahedral meshes are read");
      }
      Triple from;
      Triple to;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index halfedge = index_below(2 * edges_.size(), "half-edge");
        const auto& edge = edges_[halfedge / 2];
        from[k] = edge[halfedge % 2];
        to[k] = edge[1 - halfedge % 2];
      }
      if (to[0] != from[1] || to[1] != from[2] || to[2] != from[0]) {
        in_.fail("the half-edges of face " + std::to_string(i) + " make no triangle");
      }
      faces_.push_back(from);
    }
  }

  void read_cells() {
    const std::size_t n = begin_section("Polyhedra", 5);
    mesh_.cells.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t valence = in_.integer();
      if (valence != 4) {
        in_.fail("a polyhedron of " + std::to_string(valence) + " faces: only tetrahedra are read");
      }
      std::array<Triple, 4> halffaces;
      for (Triple& corners : halffaces) {
        const Index halfface = index_below(2 * faces_.size(), "half-face");
        corners = faces_[halfface / 2];
        if (halfface % 2 == 1) std::swap(corners[1], corners[2]);
      }
      mesh_.cells.push_back(cell_of(halffaces, i));
    }
  }

  /// The vertices of a cell, in the order that the order of its half-faces tells (kOvmFaceOrder) if that
  /// agrees with their orientation, and with two of them exchanged otherwise.
  std::array<Index, 4> cell_of(const std::array<Triple, 4>& halffaces, std::size_t number) {
    const auto fail = [&] {
      in_.fail("the half-faces of cell " + std::to_string(number) + " do not close up to a tetrahedron");
    };
    std::array<Index, 4> corners = {halffaces[0][0], halffaces[0][1], halffaces[0][2], 0};
    const auto apex = std::find_if(halffaces[1].begin(), halffaces[1].end(), [&](Index v) {
      return std::find(halffaces[0].begin(), halffaces[0].end(), v) == halffaces[0].end();
    });
    if (apex == halffaces[1].end()) fail();
    corners[3] = *apex;
    std::array<Index, 4> cell;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto vertex = opposite(corners, halffaces[k]);
      if (!vertex) fail();
      cell[kOvmFaceOrder[k]] = *vertex;
    }
    const auto fits = [&](std::size_t k) {
      const auto corner = static_cast<std::size_t>(
          std::find(cell.begin(), cell.end(), *opposite(corners, halffaces[k])) - cell.begin());
      const auto& seen = kFaceCorners[corner];
      return same_cycle(halffaces[k], {cell[seen[0]], cell[seen[1]], cell[seen[2]]});
    };
    if (!fits(0)) std::swap(cell[0], cell[1]);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!fits(k)) fail();
    }
    return cell;
  }

  std::size_t n_items(OvmEntity entity) const {
    switch (entity) {
      case OvmEntity::kVertex:
        return mesh_.points.size();
      case OvmEntity::kEdge:
        return edges_.size();
      case OvmEntity::kHalfEdge:
        return 2 * edges_.size();
      case OvmEntity::kFace:
        return faces_.size();
      case OvmEntity::kHalfFace:
        return 2 * faces_.size();
      case OvmEntity::kCell:
        return mesh_.cells.size();
      case OvmEntity::kMesh:
        return 1;
    }
    return 0;
  }

  void read_property() {
    const std::string entity_name(in_.peek_word());
    const auto entity = ovm_entity(lower(entity_name));
    if (!entity)
      in_.fail("expected a property (VProp, CProp ...); a section may have more entries than it says");
    in_.word();
    const std::string type_name = lower(in_.word());
    std::string_view name = in_.rest_of_line();
    if (name.size() < 2 || name.front() != '"' || name.back() != '"') {
      in_.fail("the name of a property must stand in quotes");
    }
    name = name.substr(1, name.size() - 2);
    const std::string what = entity_name + " " + type_name + " \"" + std::string(name) + "\"";
    const auto type = ovm_type(type_name);
    if (!type) {
      skip_values();
      mesh_.notes.push_back("property " + what + " is left out: its type is not read");
      return;
    }
    Field field{std::string(name), type->components, type->integer, {}};
    const std::size_t n = n_items(*entity) * static_cast<std::size_t>(field.components);
    values_begin_ = in_.offset();
    field.values.reserve(n);
    for (std::size_t i = 0; i < n; ++i) field.values.push_back(in_.field_value());
    keep(*entity, std::move(field), what);
  }

  /// Values of an unknown type have an unknown number of lines: the next property tells where they end.
  void skip_values() {
    while (!in_.at_end() && !ovm_entity(lower(in_.peek_word()))) in_.rest_of_line();
  }

  void keep(OvmEntity entity, Field field, const std::string& what) {
    const bool is_label = field.name == kOvmLabel && field.components == 1;
    const bool is_element = field.name == kOvmElement && field.components == 1;
    if (entity == OvmEntity::kCell && field.name == kOvmRegion && field.components == 1) {
      mesh_.regions = labels(field);
    } else if (entity == OvmEntity::kVertex && is_label) {
      mesh_.vertex_labels = labels(field);
    } else if (entity == OvmEntity::kEdge && is_label) {
      edge_labels_ = labels(field);
    } else if (entity == OvmEntity::kFace && is_label) {
      face_labels_ = labels(field);
    } else if (entity == OvmEntity::kEdge && is_element) {
      is_edge_element_ = labels(field);
    } else if (entity == OvmEntity::kFace && is_element) {
      is_face_element_ = labels(field);
    } else if (entity == OvmEntity::kVertex && field.name == kOvmFixed && field.components == 1) {
      mesh_.fixed_vertices.clear();  // of a property that the file has twice the last counts
      for (std::size_t i = 0; i < field.values.size(); ++i) {
        if (field.values[i] != 0.0) mesh_.fixed_vertices.push_back(static_cast<Index>(i));
      }
    } else if (entity == OvmEntity::kVertex) {
      mesh_.point_fields.push_back(std::move(field));
    } else if (entity == OvmEntity::kCell) {
      mesh_.cell_fields.push_back(std::move(field));
    } else {
      mesh_.notes.push_back("property " + what + " is left out: only those of vertices and cells are kept");
    }
  }

  /// Of the property that has just been read.
  std::vector<int> labels(const Field& field) {
    std::vector<int> found;
    found.reserve(field.values.size());
    for (const double value : field.values) {
      if (!is_label(value)) {
        in_.seek(values_begin_);
        for (std::size_t i = 0; i < found.size(); ++i) in_.word();
        in_.fail("a value of property \"" + field.name +
                 "\" is no integer of 32 bits: " + std::string(in_.peek_word()));
      }
      found.push_back(static_cast<int>(value));
    }
    return found;
  }

  /// Every edge and face of the cells is in the file; only the marked ones are elements of their own.
  void take_elements() {
    for (std::size_t i = 0; i < is_edge_element_.size(); ++i) {
      if (is_edge_element_[i] == 0) continue;
      mesh_.edges.push_back(edges_[i]);
      mesh_.edge_labels.push_back(edge_labels_.empty() ? 0 : edge_labels_[i]);
    }
    for (std::size_t i = 0; i < is_face_element_.size(); ++i) {
      if (is_face_element_[i] == 0) continue;
      mesh_.triangles.push_back(faces_[i]);
      mesh_.triangle_labels.push_back(face_labels_.empty() ? 0 : face_labels_[i]);
    }
  }

  TextScanner in_;
  MeshData mesh_;
  std::vector<std::array<Index, 2>> edges_;
  std::vector<Triple> faces_;
  std::vector<int> edge_labels_;
  std::vector<int> face_labels_;
  std::vector<int> is_edge_element_;
  std::vector<int> is_face_element_;
  std::size_t values_begin_ = 0;  ///< of the last property, in the file
};

}  // namespace

MeshData read_ovm(const InputFile& file) { return OvmReader(file).read(); }

}  // namespace hfr::io
