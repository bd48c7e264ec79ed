// SPDX-License-Identifier: BSD-3-Clause
// Surfaces: STL and OBJ and OFF here, PLY in ReadPly.cc. OpenMesh's readers are not used because they hold
// every coordinate in 32 bits, merge or split vertices as its half-edges need it, and trust the counts that
// a broken file announces.
#include "IO/ReadSurface.hh"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "HalfFace/Errors.hh"
#include "HalfFace/TupleMap.hh"
#include "IO/Formats.hh"
#include "IO/TextScanner.hh"
#include "IO/VtuData.hh"
#include "IO/Words.hh"

namespace hfr::io {

void add_polygon(MeshData& mesh, std::span<const Index> corners, int label, std::size_t& n_split) {
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    mesh.triangle_labels.push_back(label);
  }
  if (corners.size() > 3) ++n_split;
}

void note_polygons(MeshData& mesh, std::size_t n_split) {
  if (n_split > 0)
    mesh.notes.push_back(std::to_string(n_split) + (n_split == 1 ? " polygon" : " polygons") +
                         " with more than three corners cut into triangles");
}

namespace {

struct PointHash {
  std::size_t operator()(const Vec3& p) const {
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) h = mix64(h ^ std::bit_cast<std::uint64_t>(p[k] + 0.0));  // -0.0 equals 0.0
    return static_cast<std::size_t>(h);
  }
};

/// STL repeats the coordinates of a vertex in every triangle; equal ones are one vertex.
class TriangleSoup {
 public:
  void add(const std::array<Vec3, 3>& corners) {
    std::array<Index, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, is_new] = known_.try_emplace(corners[k], static_cast<Index>(mesh_.points.size()));
      if (is_new) mesh_.points.push_back(corners[k]);
      triangle[k] = at->second;
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[0] == triangle[2]) {
      ++n_degenerate_;
      return;
    }
    mesh_.triangles.push_back(triangle);
    mesh_.triangle_labels.push_back(0);
  }
  MeshData take() {
    if (n_degenerate_ > 0)
      mesh_.notes.push_back(std::to_string(n_degenerate_) + " triangles with two equal corners dropped");
    return std::move(mesh_);
  }

 private:
  MeshData mesh_;
  std::unordered_map<Vec3, Index, PointHash> known_;
  std::size_t n_degenerate_ = 0;
};

constexpr std::size_t kStlHeader = 84;
constexpr std::size_t kStlTriangle = 50;

MeshData read_binary_stl(const InputFile& file, std::size_t n) {
  const std::string_view bytes = file.bytes();
  constexpr bool kSwap = std::endian::native == std::endian::big;
  TriangleSoup soup;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t at = kStlHeader + i * kStlTriangle + 12;  // behind the normal
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 9; ++k) {
      const double value = double{loaded<float>(&bytes[at + 4 * k], kSwap)};
      if (!std::isfinite(value))
        throw InvalidInput(file.path().string() + ": at byte " + std::to_string(at + 4 * k) +
                           ": a coordinate is not finite");
      corners[k / 3][static_cast<int>(k % 3)] = value;
    }
    soup.add(corners);
  }
  return soup.take();
}

MeshData read_text_stl(const InputFile& file) {
  TextScanner in(file.bytes(), file.path().string());
  const auto expect = [&](std::string_view expected) {
    if (lower(in.peek_word()) != expected) {
      const std::string_view found = in.peek_word().substr(0, 20);
      in.fail("expected '" + std::string(expected) + "', found '" + std::string(found) + "'");
    }
    in.word();
  };
  TriangleSoup soup;
  do {  // a file may hold several solids
    expect("solid");
    in.rest_of_line();  // its name
    while (lower(in.peek_word()) == "facet") {
      in.word();
      expect("normal");
      for (int k = 0; k < 3; ++k) static_cast<void>(in.field_value());
      expect("outer");
      expect("loop");
      std::array<Vec3, 3> corners;
      for (Vec3& corner : corners) {
        expect("vertex");
        corner = {in.real(), in.real(), in.real()};
      }
      expect("endloop");
      expect("endfacet");
      soup.add(corners);
    }
    expect("endsolid");
    in.rest_of_line();
  } while (!in.at_end());
  return soup.take();
}

bool begins_with_solid(std::string_view bytes) {
  constexpr std::string_view kSolid = "solid";
  bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  return lower(bytes.substr(0, kSolid.size())) == kSolid;
}

MeshData read_stl(const InputFile& file) {
  const std::string_view bytes = file.bytes();
  const bool solid = begins_with_solid(bytes);  // some binary files begin so too
  if (bytes.size() < kStlHeader) {
    if (solid) return read_text_stl(file);
    throw InvalidInput(file.path().string() + ": at byte " + std::to_string(bytes.size()) +
                       ": the file ends too early: binary STL has a header of 84 bytes");
  }
  const std::size_t n = loaded<std::uint32_t>(&bytes[80], std::endian::native == std::endian::big);
  const std::size_t size = kStlHeader + n * kStlTriangle;
  if (solid && size != bytes.size()) return read_text_stl(file);
  if (size > bytes.size())
    throw InvalidInput(file.path().string() + ": at byte 80: " + std::to_string(n) + " triangles need " +
                       std::to_string(size) + " bytes, but the file has " + std::to_string(bytes.size()));
  return read_binary_stl(file, n);
}

/// One corner of an OBJ face, "7", "7/1", "7//3" or "-2": the number before the slash, negative from the end.
Index obj_corner(const TextScanner& in, std::string_view word, std::size_t n_points) {
  std::int64_t number = 0;
  const std::string_view digits = word.substr(0, word.find('/'));
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc{} || stop != digits.data() + digits.size())
    in.fail("expected the number of a vertex, found '" + std::string(word.substr(0, 20)) + "'");
  const auto n = static_cast<std::int64_t>(n_points);
  const std::int64_t index = number > 0 ? number - 1 : n + number;
  if (number == 0 || index < 0 || index >= n)
    in.fail("vertex " + std::to_string(number) + " is out of range (there are " + std::to_string(n) +
            " before it, counted from 1)");
  return static_cast<Index>(index);
}

MeshData read_obj(const InputFile& file) {
  TextScanner in(file.bytes(), file.path().string(), '#');
  MeshData mesh;
  std::size_t n_split = 0;
  std::vector<Index> corners;
  while (!in.at_end()) {
    const std::string_view keyword = in.word();
    if (keyword == "v") {
      mesh.points.push_back({in.real(), in.real(), in.real()});
    } else if (keyword == "f") {
      const std::size_t line_begin = in.offset();
      std::string_view line = in.rest_of_line();
      const std::size_t line_end = in.offset();
      in.seek(line_begin);  // messages name this line
      line = line.substr(0, line.find('#'));
      corners.clear();
      for (;;) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
        if (line.empty()) break;
        const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
        corners.push_back(obj_corner(in, word, mesh.points.size()));
        line.remove_prefix(word.size());
      }
      if (corners.size() < 3) in.fail("a face has " + std::to_string(corners.size()) + " corners");
      add_polygon(mesh, corners, 0, n_split);
      in.seek(line_end);
      continue;
    }
    in.rest_of_line();  // a weight or colour behind the coordinates, or a line that is of no use here
  }
  note_polygons(mesh, n_split);
  return mesh;
}

MeshData read_off(const InputFile& file) {
  TextScanner in(file.bytes(), file.path().string(), '#');
  const std::string header = lower(in.peek_word());
  // Behind the coordinates may come normals, colours and texture coordinates; they stay on the same line.
  if (header.ends_with("off")) {
    constexpr std::array<std::string_view, 8> kKnown = {"off",   "coff",   "noff",   "cnoff",
                                                        "stoff", "stcoff", "stnoff", "stcnoff"};
    if (std::find(kKnown.begin(), kKnown.end(), header) == kKnown.end())
      in.fail("only surfaces in three dimensions are supported, not '" + header.substr(0, 20) + "'");
    in.word();
    if (lower(in.peek_word()) == "binary") in.fail("binary OFF is not supported");
  }
  MeshData mesh;
  const std::size_t n_points = in.count(3, "number of points");
  const std::size_t n_faces = in.count(4, "number of faces");
  in.rest_of_line();  // the number of edges, which nobody relies on
  mesh.points.reserve(n_points);
  for (std::size_t i = 0; i < n_points; ++i) {
    mesh.points.push_back({in.real(), in.real(), in.real()});
    in.rest_of_line();
  }
  std::size_t n_split = 0;
  std::vector<Index> corners;
  const auto last = static_cast<std::int64_t>(n_points) - 1;
  for (std::size_t i = 0; i < n_faces; ++i) {
    const std::size_t n = in.count(1, "number of corners");
    if (n < 3) in.fail("a face has " + std::to_string(n) + " corners");
    corners.clear();
    for (std::size_t k = 0; k < n; ++k)
      corners.push_back(static_cast<Index>(in.integer_in(0, last, "vertex")));
    add_polygon(mesh, corners, 0, n_split);
    in.rest_of_line();
  }
  note_polygons(mesh, n_split);
  return mesh;
}

}  // namespace

MeshData read_surface(const InputFile& file) {
  const std::string extension = lower(file.extension());
  if (extension == ".stl") return read_stl(file);
  if (extension == ".obj") return read_obj(file);
  if (extension == ".off") return read_off(file);
  if (extension == ".ply") return read_ply(file);
  throw InvalidInput(file.path().string() + ": unknown surface format '" + extension + "'");
}

}  // namespace hfr::io
