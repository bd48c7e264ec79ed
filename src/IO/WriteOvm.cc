// SPDX-License-Identifier: BSD-3-Clause
// See ReadOvm.cc for the format.
#include <algorithm>
#include <array>

#include "IO/Formats.hh"
#include "IO/OutputFile.hh"
#include "IO/OvmProperties.hh"
#include "IO/Validate.hh"

namespace hfr::io {
namespace {

using Pair = std::array<Index, 2>;
using Triple = std::array<Index, 3>;

/// Items that have the same vertices are one: number[i] is what item i is counted as, in the order of first
/// appearance, and first[n] is the item that number n appeared as first.
struct Numbering {
  std::vector<std::size_t> number;
  std::vector<std::size_t> first;
};

/// Linear in the number of items: they are sorted by their smallest vertex in one counting pass, and the few
/// that share it among themselves.
template <std::size_t N>
Numbering number_distinct(const std::vector<std::array<Index, N>>& items, std::size_t n_points) {
  struct Entry {
    std::array<Index, N> key;
    std::size_t item;
  };
  std::vector<std::size_t> begin(n_points + 1, 0);
  for (const auto& item : items) ++begin[*std::min_element(item.begin(), item.end()) + 1];
  for (std::size_t i = 0; i < n_points; ++i) begin[i + 1] += begin[i];
  std::vector<Entry> entries(items.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < items.size(); ++i) {
    Entry entry{items[i], i};
    std::sort(entry.key.begin(), entry.key.end());
    entries[next[entry.key[0]]++] = entry;
  }
  // First the item that each one repeats, then numbers for those that repeat none before them.
  Numbering found;
  found.number.resize(items.size());
  for (std::size_t point = 0; point < n_points; ++point) {
    const auto first = entries.begin() + static_cast<std::ptrdiff_t>(begin[point]);
    const auto last = entries.begin() + static_cast<std::ptrdiff_t>(begin[point + 1]);
    std::sort(first, last, [](const Entry& a, const Entry& b) {
      return a.key != b.key ? a.key < b.key : a.item < b.item;
    });
    for (auto entry = first; entry != last; ++entry) {
      const bool repeats = entry != first && entry->key == (entry - 1)->key;
      found.number[entry->item] = repeats ? found.number[(entry - 1)->item] : entry->item;
    }
  }
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (found.number[i] == i) {
      found.number[i] = found.first.size();
      found.first.push_back(i);
    } else {
      found.number[i] = found.number[found.number[i]];
    }
  }
  return found;
}

/// Every edge and face of the mesh, those that are elements of their own first and in their order.
struct Skeleton {
  std::vector<Pair> edges;    ///< first the mesh's, then the three of each distinct face
  std::vector<Triple> faces;  ///< first the mesh's triangles, then the four of each cell
  Numbering edge_numbers;
  Numbering face_numbers;
};

Skeleton skeleton_of(const MeshData& mesh) {
  Skeleton found;
  found.faces.reserve(mesh.triangles.size() + 4 * mesh.cells.size());
  found.faces.assign(mesh.triangles.begin(), mesh.triangles.end());
  for (const auto& cell : mesh.cells) {
    for (const std::size_t corner : kOvmFaceOrder) {
      const auto& seen = kFaceCorners[corner];
      found.faces.push_back({cell[seen[0]], cell[seen[1]], cell[seen[2]]});
    }
  }
  found.face_numbers = number_distinct(found.faces, mesh.points.size());
  found.edges.reserve(mesh.edges.size() + 3 * found.face_numbers.first.size());
  found.edges.assign(mesh.edges.begin(), mesh.edges.end());
  for (const std::size_t i : found.face_numbers.first) {
    const Triple& face = found.faces[i];
    for (std::size_t k = 0; k < 3; ++k) found.edges.push_back({face[k], face[(k + 1) % 3]});
  }
  found.edge_numbers = number_distinct(found.edges, mesh.points.size());
  return found;
}

void put(OutputFile& out, std::size_t value) { out.text(" ").number(static_cast<std::int64_t>(value)); }

void begin(OutputFile& out, std::string_view section, std::size_t n) {
  out.text(section).text("\n").number(static_cast<std::int64_t>(n)).text("\n");
}

void write_points(OutputFile& out, const MeshData& mesh) {
  begin(out, "Vertices", mesh.points.size());
  for (const Vec3& p : mesh.points) {
    out.number(p.x).text(" ").number(p.y).text(" ").number(p.z).text("\n");
  }
}

void write_edges(OutputFile& out, const Skeleton& skeleton) {
  begin(out, "Edges", skeleton.edge_numbers.first.size());
  for (const std::size_t i : skeleton.edge_numbers.first) {
    out.number(static_cast<std::int64_t>(skeleton.edges[i][0]));
    put(out, skeleton.edges[i][1]);
    out.text("\n");
  }
}

void write_faces(OutputFile& out, const MeshData& mesh, const Skeleton& skeleton) {
  const std::vector<std::size_t>& distinct = skeleton.face_numbers.first;
  begin(out, "Faces", distinct.size());
  for (std::size_t n = 0; n < distinct.size(); ++n) {
    out.text("3");
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = mesh.edges.size() + 3 * n + k;
      const std::size_t edge = skeleton.edge_numbers.number[i];
      const bool opposite = skeleton.edges[skeleton.edge_numbers.first[edge]] != skeleton.edges[i];
      put(out, 2 * edge + (opposite ? 1 : 0));
    }
    out.text("\n");
  }
}

bool is_same_side(const Triple& a, const Triple& b) {
  const auto start = static_cast<std::size_t>(std::find(b.begin(), b.end(), a[0]) - b.begin());
  return a[1] == b[(start + 1) % 3];
}

void write_cells(OutputFile& out, const MeshData& mesh, const Skeleton& skeleton) {
  begin(out, "Polyhedra", mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    out.text("4");
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t i = mesh.triangles.size() + 4 * c + k;
      const std::size_t face = skeleton.face_numbers.number[i];
      const Triple& listed = skeleton.faces[skeleton.face_numbers.first[face]];
      put(out, 2 * face + (is_same_side(skeleton.faces[i], listed) ? 0 : 1));
    }
    out.text("\n");
  }
}

void begin_property(OutputFile& out, std::string_view entity, std::string_view type, std::string_view name) {
  out.text(entity).text(" ").text(type).text(" \"").text(name).text("\"\n");
}

/// A quote or a line's end would end the name.
std::string name_in_file(const Field& field, Notes& notes) {
  std::string name = field.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '"' || c == '\n' || c == '\r'; }, '_');
  if (name != field.name)
    notes.push_back("OpenVolumeMesh holds no quotes in names: '" + name + "' is written");
  return name;
}

void write_labels(OutputFile& out, std::string_view entity, std::string_view name,
                  const std::vector<int>& labels) {
  begin_property(out, entity, "int", name);
  for (const int label : labels) out.number(std::int64_t{label}).text("\n");
}

/// Elements are marked, and labelled, among all edges or faces of the file.
void write_element_labels(OutputFile& out, std::string_view entity, std::size_t n_elements,
                          const std::vector<int>& labels, const Numbering& numbering) {
  if (n_elements == 0) return;
  std::vector<int> label_of(numbering.first.size(), 0);
  begin_property(out, entity, "bool", kOvmElement);
  for (std::size_t n = 0; n < numbering.first.size(); ++n) {
    const std::size_t i = numbering.first[n];
    if (i < n_elements && !labels.empty()) label_of[n] = labels[i];
    out.text(i < n_elements ? "1\n" : "0\n");
  }
  write_labels(out, entity, kOvmLabel, label_of);
}

bool fits_int(const Field& field) {
  return field.integer && std::all_of(field.values.begin(), field.values.end(), is_label);
}

void write_fields(OutputFile& out, std::string_view entity, const std::vector<Field>& fields, Notes& notes) {
  for (const Field& field : fields) {
    const auto type = ovm_type(field.components, fits_int(field));
    if (!type) {
      notes.push_back("field '" + field.name + "' is left out: OpenVolumeMesh has no type with " +
                      std::to_string(field.components) + " components");
      continue;
    }
    begin_property(out, entity, type->name, name_in_file(field, notes));
    const auto n = static_cast<std::size_t>(field.components);
    for (std::size_t i = 0; i < field.values.size(); ++i) {
      type->integer ? out.number(static_cast<std::int64_t>(field.values[i])) : out.number(field.values[i]);
      out.text(i % n == n - 1 ? "\n" : " ");
    }
  }
}

void write_properties(OutputFile& out, const MeshData& mesh, const Skeleton& skeleton, Notes& notes) {
  if (!mesh.vertex_labels.empty()) write_labels(out, "VProp", kOvmLabel, mesh.vertex_labels);
  if (!mesh.fixed_vertices.empty()) {
    std::vector<char> is_fixed(mesh.points.size(), 0);
    for (const Index vertex : mesh.fixed_vertices) is_fixed[vertex] = 1;
    begin_property(out, "VProp", "bool", kOvmFixed);
    for (const char fixed : is_fixed) out.text(fixed ? "1\n" : "0\n");
  }
  write_fields(out, "VProp", mesh.point_fields, notes);
  write_element_labels(out, "EProp", mesh.edges.size(), mesh.edge_labels, skeleton.edge_numbers);
  write_element_labels(out, "FProp", mesh.triangles.size(), mesh.triangle_labels, skeleton.face_numbers);
  if (!mesh.regions.empty()) write_labels(out, "CProp", kOvmRegion, mesh.regions);
  write_fields(out, "CProp", mesh.cell_fields, notes);
}

/// Of the elements, those that repeat the vertices of an earlier one.
std::size_t repeated(const Numbering& numbering, std::size_t n_elements) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < n_elements; ++i) n += numbering.first[numbering.number[i]] != i;
  return n;
}

void note_losses(const MeshData& mesh, const Skeleton& skeleton, Notes& notes) {
  if (!mesh.names.empty()) {
    notes.push_back("OpenVolumeMesh files hold no names: " + std::to_string(mesh.names.size()) +
                    " names of regions and patches are left out");
  }
  const std::size_t triangles = repeated(skeleton.face_numbers, mesh.triangles.size());
  const std::size_t edges = repeated(skeleton.edge_numbers, mesh.edges.size());
  if (triangles > 0) notes.push_back(std::to_string(triangles) + " repeated triangles are left out");
  if (edges > 0) notes.push_back(std::to_string(edges) + " repeated edges are left out");
}

}  // namespace

Notes write_ovm(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& /*options*/) {
  const Skeleton skeleton = skeleton_of(mesh);
  Notes notes;
  OutputFile out(path);
  out.text("OVM ASCII\n");
  write_points(out, mesh);
  write_edges(out, skeleton);
  write_faces(out, mesh, skeleton);
  write_cells(out, mesh, skeleton);
  write_properties(out, mesh, skeleton, notes);
  out.commit();
  note_losses(mesh, skeleton, notes);
  return notes;
}

}  // namespace hfr::io
