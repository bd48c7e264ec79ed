// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of tetrahedral meshes as STL, OBJ, OFF and PLY. OpenMesh's writers are not used: they pass every
// coordinate through a 32-bit float whatever precision is asked for, so no text would read back to the same
// double.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "HalfFace/Errors.hh"
#include "HalfFace/TupleMap.hh"
#include "IO/Formats.hh"
#include "IO/OutputFile.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

struct Surface {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<int> labels;  ///< one a triangle, or empty
};

std::array<Index, 3> sorted(std::array<Index, 3> face) {
  std::sort(face.begin(), face.end());
  return face;
}

struct FaceHash {
  std::size_t operator()(const std::array<Index, 3>& face) const {
    std::uint64_t h = 0;
    for (const Index v : face) h = mix64(h ^ v) + v;
    return static_cast<std::size_t>(h);
  }
};

/// Faces that one cell alone has, in the order of cells and corners. A face is looked for among those with
/// the same smallest vertex.
std::vector<std::array<Index, 3>> boundary_faces(const MeshData& mesh) {
  const auto face_of = [&](std::size_t i) {
    const auto& cell = mesh.cells[i / 4];
    const auto& corners = kFaceCorners[i % 4];
    // kFaceCorners is as the cell sees it from inside; seen from outside the order is the other one.
    return std::array<Index, 3>{cell[corners[0]], cell[corners[2]], cell[corners[1]]};
  };
  std::vector<std::size_t> first(mesh.points.size() + 1, 0);
  const std::size_t n_faces = 4 * mesh.cells.size();
  for (std::size_t i = 0; i < n_faces; ++i) ++first[sorted(face_of(i))[0] + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  struct Entry {
    Index middle, last;
    std::size_t face;
  };
  std::vector<Entry> entries(n_faces);
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < n_faces; ++i) {
    const auto key = sorted(face_of(i));
    entries[next[key[0]]++] = {key[1], key[2], i};
  }
  std::vector<bool> single(n_faces, false);
  for (std::size_t v = 0; v + 1 < first.size(); ++v) {
    const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(first[v]);
    const auto end = entries.begin() + static_cast<std::ptrdiff_t>(first[v + 1]);
    const auto same = [](const Entry& a, const Entry& b) { return a.middle == b.middle && a.last == b.last; };
    std::sort(begin, end, [](const Entry& a, const Entry& b) {
      return a.middle != b.middle ? a.middle < b.middle : a.last < b.last;
    });
    for (auto run = begin; run != end;) {
      auto run_end = run + 1;
      while (run_end != end && same(*run, *run_end)) ++run_end;
      if (run_end - run == 1) single[run->face] = true;
      run = run_end;
    }
  }
  std::vector<std::array<Index, 3>> faces;
  for (std::size_t i = 0; i < n_faces; ++i)
    if (single[i]) faces.push_back(face_of(i));
  return faces;
}

double total_volume(const MeshData& mesh) {
  double sum = 0;
  for (const auto& cell : mesh.cells) {
    const Vec3 a = mesh.points[cell[0]];
    sum += dot(cross(mesh.points[cell[1]] - a, mesh.points[cell[2]] - a), mesh.points[cell[3]] - a);
  }
  return sum;
}

Surface surface_of(const MeshData& mesh) {
  Surface surface;
  if (mesh.cells.empty()) {
    surface.triangles = mesh.triangles;
    surface.labels = mesh.triangle_labels;
  } else {
    surface.triangles = boundary_faces(mesh);
    // A mesh whose cells are all ordered the other way round has its outside there too.
    if (total_volume(mesh) < 0)
      for (auto& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
    std::unordered_map<std::array<Index, 3>, int, FaceHash> labels;
    for (std::size_t i = 0; i < mesh.triangle_labels.size(); ++i)
      if (mesh.triangle_labels[i] != 0) labels[sorted(mesh.triangles[i])] = mesh.triangle_labels[i];
    for (const auto& triangle : surface.triangles) {
      const auto found = labels.find(sorted(triangle));
      surface.labels.push_back(found == labels.end() ? 0 : found->second);
    }
  }
  if (std::all_of(surface.labels.begin(), surface.labels.end(), [](int label) { return label == 0; }))
    surface.labels.clear();
  std::vector<Index> number(mesh.points.size(), VertexHandle::kInvalid);
  for (const auto& triangle : surface.triangles)
    for (const Index v : triangle) number[v] = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] != 0) continue;
    number[v] = static_cast<Index>(surface.points.size());
    surface.points.push_back(mesh.points[v]);
  }
  for (auto& triangle : surface.triangles)
    for (Index& v : triangle) v = number[v];
  return surface;
}

void put_point(OutputFile& out, const Vec3& p, std::string_view end) {
  out.number(p.x).text(" ").number(p.y).text(" ").number(p.z).text(end);
}

void put_triangle(OutputFile& out, const std::array<Index, 3>& triangle, std::int64_t base) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (k > 0) out.text(" ");
    out.number(base + static_cast<std::int64_t>(triangle[k]));
  }
}

Vec3 unit_normal(const std::array<Vec3, 3>& corners) {
  const Vec3 n = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double length = norm(n);
  return length > 0 && std::isfinite(length) ? (1 / length) * n : Vec3{};
}

std::array<Vec3, 3> corners_of(const Surface& surface, const std::array<Index, 3>& triangle) {
  return {surface.points[triangle[0]], surface.points[triangle[1]], surface.points[triangle[2]]};
}

void write_text_stl(OutputFile& out, const Surface& surface) {
  out.text("solid hfremesh\n");
  for (const auto& triangle : surface.triangles) {
    const auto corners = corners_of(surface, triangle);
    out.text("facet normal ");
    put_point(out, unit_normal(corners), "\nouter loop\n");
    for (const Vec3& corner : corners) {
      out.text("vertex ");
      put_point(out, corner, "\n");
    }
    out.text("endloop\nendfacet\n");
  }
  out.text("endsolid hfremesh\n");
}

template <class T>
void put_little_endian(OutputFile& out, T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  out.text({bytes.data(), bytes.size()});
}

void write_binary_stl(OutputFile& out, const Surface& surface, const std::string& name, Notes& notes) {
  HFR_REQUIRE(surface.triangles.size() <= std::numeric_limits<std::uint32_t>::max(),
              name + ": binary STL holds at most 4294967295 triangles");
  std::string header = "binary STL written by hfremesh";
  header.resize(80, ' ');
  out.text(header);
  put_little_endian(out, static_cast<std::uint32_t>(surface.triangles.size()));
  bool rounded = false;
  const auto put = [&](const Vec3& p) {
    for (int k = 0; k < 3; ++k) {
      HFR_REQUIRE(std::abs(p[k]) <= double{std::numeric_limits<float>::max()},
                  name + ": a coordinate is too large for binary STL; write it as text");
      const auto value = static_cast<float>(p[k]);
      rounded = rounded || double{value} != p[k];
      put_little_endian(out, value);
    }
  };
  bool corners_rounded = false;
  for (const auto& triangle : surface.triangles) {
    const auto corners = corners_of(surface, triangle);
    put(unit_normal(corners));
    rounded = false;  // that of the normal does not matter
    for (const Vec3& corner : corners) put(corner);
    corners_rounded = corners_rounded || rounded;
    put_little_endian(out, std::uint16_t{0});
  }
  if (corners_rounded) notes.emplace_back("binary STL rounds coordinates to 32 bits; text STL keeps them");
}

void write_obj(OutputFile& out, const Surface& surface) {
  for (const Vec3& point : surface.points) {
    out.text("v ");
    put_point(out, point, "\n");
  }
  for (const auto& triangle : surface.triangles) {
    out.text("f ");
    put_triangle(out, triangle, 1);
    out.text("\n");
  }
}

void write_off(OutputFile& out, const Surface& surface) {
  out.text("OFF\n").number(static_cast<std::int64_t>(surface.points.size())).text(" ");
  out.number(static_cast<std::int64_t>(surface.triangles.size())).text(" 0\n");
  for (const Vec3& point : surface.points) put_point(out, point, "\n");
  for (const auto& triangle : surface.triangles) {
    out.text("3 ");
    put_triangle(out, triangle, 0);
    out.text("\n");
  }
}

void write_ply(OutputFile& out, const Surface& surface, const std::string& name, bool binary) {
  HFR_REQUIRE(surface.points.size() <= std::size_t{std::numeric_limits<std::int32_t>::max()},
              name + ": PLY holds at most 2147483647 points");
  out.text("ply\nformat ").text(binary ? "binary_little_endian" : "ascii").text(" 1.0\nelement vertex ");
  out.number(static_cast<std::int64_t>(surface.points.size()));
  out.text("\nproperty double x\nproperty double y\nproperty double z\nelement face ");
  out.number(static_cast<std::int64_t>(surface.triangles.size()));
  out.text("\nproperty list uchar int vertex_indices\n");
  if (!surface.labels.empty()) out.text("property int label\n");
  out.text("end_header\n");
  for (const Vec3& point : surface.points) {
    if (!binary) {
      put_point(out, point, "\n");
      continue;
    }
    for (int k = 0; k < 3; ++k) put_little_endian(out, point[k]);
  }
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& triangle = surface.triangles[i];
    if (binary) {
      put_little_endian(out, std::uint8_t{3});
      for (const Index v : triangle) put_little_endian(out, static_cast<std::int32_t>(v));
      if (!surface.labels.empty()) put_little_endian(out, std::int32_t{surface.labels[i]});
      continue;
    }
    out.text("3 ");
    put_triangle(out, triangle, 0);
    if (!surface.labels.empty()) out.text(" ").number(std::int64_t{surface.labels[i]});
    out.text("\n");
  }
}

Notes losses(const MeshData& mesh, const Surface& surface, bool holds_labels) {
  Notes notes;
  const auto lose = [&](bool lost, const char* line) {
    if (lost) notes.emplace_back(line);
  };
  const auto is_set = [](int label) { return label != 0; };
  lose(!mesh.cells.empty(), "only the boundary is written: surface formats hold no tetrahedra");
  lose(!surface.labels.empty() && !holds_labels, "labels of triangles are not written; PLY holds them");
  lose(std::any_of(mesh.regions.begin(), mesh.regions.end(), is_set), "regions are not written");
  lose(!mesh.edges.empty(), "edges and their labels are not written");
  lose(!mesh.vertex_labels.empty() || !mesh.fixed_vertices.empty(),
       "labels of vertices and fixed vertices are not written");
  lose(!mesh.names.empty(), "names of labels are not written");
  lose(!mesh.point_fields.empty() || !mesh.cell_fields.empty(), "fields are not written");
  return notes;
}

}  // namespace

Notes write_surface(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options) {
  const std::string extension = lower(options.format.empty() ? path.extension().string() : options.format);
  const Surface surface = surface_of(mesh);
  Notes notes = losses(mesh, surface, extension == ".ply");
  OutputFile out(path);
  if (extension == ".stl" && options.binary) {
    write_binary_stl(out, surface, path.string(), notes);
  } else if (extension == ".stl") {
    write_text_stl(out, surface);
  } else if (extension == ".obj") {
    write_obj(out, surface);
  } else if (extension == ".off") {
    write_off(out, surface);
  } else if (extension == ".ply") {
    write_ply(out, surface, path.string(), options.binary);
  } else {
    throw InvalidInput(path.string() + ": unknown surface format '" + extension + "'");
  }
  out.commit();
  return notes;
}

}  // namespace hfr::io
