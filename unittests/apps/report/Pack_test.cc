// SPDX-License-Identifier: BSD-3-Clause
#include "Pack.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "Angles.hh"
#include "apps/report/Decode.hh"
#include "hfremesh/HalfFace/Generate.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::app::test {
namespace {

TetMesh cavity_mesh() {
  const generate::Arrays arrays = generate::cavity();
  return build(arrays.points, arrays.cells);
}

std::int64_t unzigzag(std::uint64_t code) {
  const auto half = static_cast<std::int64_t>(code / 2);
  return code % 2 == 0 ? half : -half - 1;
}

/// The streams of a packed mesh, read as Pack.hh describes them.
class Unpacked {
 public:
  explicit Unpacked(const view::PackedMesh& packed) : n_vertices_(packed.n_vertices) {
    std::size_t size = 0;
    for (const std::size_t n : packed.sizes) size += n;
    const std::string all = inflated(packed.deflated, size);
    for (std::size_t i = 0, at = 0; i < packed.sizes.size(); at += packed.sizes[i++])
      streams_[view::PackedMesh::kStreams[i]] = all.substr(at, packed.sizes[i]);
    read_links();
  }

  const std::string& stream(const std::string& name) { return streams_[name]; }
  std::uint64_t number(const std::string& name) {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(streams_[name].at(at_[name]++));
      value |= static_cast<std::uint64_t>(byte & 127) << shift;
      if (byte < 128) return value;
    }
  }
  std::uint64_t link(std::size_t v, std::uint64_t place) const { return links_.at(v).at(place); }
  bool at_end(const std::string& name) { return at_[name] == streams_[name].size(); }

 private:
  void read_links() {
    for (std::size_t v = 0; v < n_vertices_; ++v) {
      std::vector<std::uint64_t> mine(number("link_n"));
      std::uint64_t last = v;
      for (std::uint64_t& neighbour : mine) neighbour = last += 1 + number("link");
      links_.push_back(std::move(mine));
    }
  }

  std::size_t n_vertices_;
  std::map<std::string, std::string> streams_;
  std::map<std::string, std::size_t> at_;
  std::vector<std::vector<std::uint64_t>> links_;
};

/// Coordinates of 16 bits.
using Place = std::array<int, 3>;

std::vector<Place> places_of(Unpacked& back, std::size_t n_vertices) {
  std::vector<Place> places(n_vertices);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    int last = 0;
    for (std::size_t k = 0; k < n_vertices; ++k) {
      const std::size_t i = axis * n_vertices + k;
      const auto byte = [&](const char* name) {
        return std::uint64_t{static_cast<unsigned char>(back.stream(name).at(i))};
      };
      last = (last + static_cast<int>(unzigzag(byte("low") | byte("high") << 8))) & 65535;
      places[k][axis] = last;
    }
  }
  return places;
}

/// The mesh's vertex of each one in the pack, told by its coordinates: none of them is there twice.
std::vector<std::size_t> vertices_of(Unpacked& back, const view::PackedMesh& packed, const TetMesh& mesh) {
  std::map<Place, std::size_t> vertex_at;
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    Place place{};
    for (int i = 0; i < 3; ++i) {
      const double share =
          (mesh.point(VertexHandle(v))[i] - packed.box_low[i]) / (packed.box_high[i] - packed.box_low[i]);
      place[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(65535 * share));
    }
    vertex_at[place] = v;
  }
  EXPECT_EQ(vertex_at.size(), mesh.n_vertices());
  std::vector<std::size_t> vertices;
  for (const Place& place : places_of(back, packed.n_vertices)) {
    EXPECT_TRUE(vertex_at.contains(place));
    vertices.push_back(vertex_at[place]);
  }
  return vertices;
}

/// The mesh's cells in the order of the pack.
std::vector<std::size_t> cells_of(Unpacked& back, const std::vector<std::size_t>& vertices,
                                  const TetMesh& mesh) {
  std::map<std::set<std::size_t>, std::size_t> cell_of;
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    std::set<std::size_t> corners;
    for (const VertexHandle v : mesh.cell_vertices(CellHandle(i))) corners.insert(v.idx());
    cell_of[corners] = i;
  }
  std::vector<std::size_t> cells;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    std::uint64_t a = 0;
    for (std::uint64_t left = back.number("cell_n"); left > 0; --left) {
      a += back.number("cell_a");
      const std::uint64_t b = a + 1 + back.number("cell_b"), c = b + 1 + back.number("cell_c");
      const auto found = cell_of.find(
          {vertices[v], vertices[back.link(v, a)], vertices[back.link(v, b)], vertices[back.link(v, c)]});
      EXPECT_NE(found, cell_of.end());
      if (found != cell_of.end()) cells.push_back(found->second);
    }
  }
  return cells;
}

TEST(Pack, CellsAndTheirAnglesNumbersAndReasonsComeBack) {
  const TetMesh mesh = cavity_mesh();
  const auto degrees = view::smallest_dihedrals(mesh, {});
  std::vector<std::uint8_t> reasons(mesh.n_cells(), view::kNoReason);
  for (std::size_t i = 0; i < reasons.size(); i += 7) reasons[i] = static_cast<std::uint8_t>(i % 10);
  const view::PackedMesh packed = view::pack(mesh, degrees, reasons);
  EXPECT_TRUE(packed.has_all_cells);
  Unpacked back(packed);
  const std::vector<std::size_t> cells = cells_of(back, vertices_of(back, packed, mesh), mesh);
  EXPECT_EQ(std::set<std::size_t>(cells.begin(), cells.end()).size(), mesh.n_cells());
  std::size_t n_listed = 0;
  std::int64_t id = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const float angle = degrees[cells[k]];
    const int code = static_cast<unsigned char>(back.stream("angle").at(k));
    EXPECT_EQ(code, view::is_invalid(angle) ? 0 : angle >= 30 ? 255 : 1 + static_cast<int>(8.0 * angle));
    if (code == 255) continue;
    id += unzigzag(back.number("id"));
    EXPECT_EQ(id, static_cast<std::int64_t>(cells[k]));
    EXPECT_EQ(static_cast<unsigned char>(back.stream("reason").at(n_listed++)), reasons[cells[k]]);
  }
  EXPECT_EQ(n_listed, packed.n_listed);
  EXPECT_GT(n_listed, 1000U);
  for (const char* name : {"link_n", "link", "cell_n", "cell_a", "cell_b", "cell_c", "id"})
    EXPECT_TRUE(back.at_end(name)) << name;
}

TEST(Pack, TheSkinIsTheBoundary) {
  const TetMesh mesh = cavity_mesh();
  const view::PackedMesh packed = view::pack(mesh, view::smallest_dihedrals(mesh, {}), {});
  Unpacked back(packed);
  const std::vector<std::size_t> vertices = vertices_of(back, packed, mesh);
  std::set<FaceHandle> faces;
  for (std::size_t v = 0; v < packed.n_vertices; ++v)
    for (std::uint64_t left = back.number("skin_n"); left > 0; --left) {
      const std::uint64_t b = back.number("skin"), c = b + 1 + back.number("skin");
      faces.insert(mesh.find_face({VertexHandle(vertices[v]), VertexHandle(vertices[back.link(v, b)]),
                                   VertexHandle(vertices[back.link(v, c)])}));
    }
  EXPECT_EQ(faces.size(), 2696U);
  for (const FaceHandle face : faces) EXPECT_TRUE(face.is_valid() && mesh.is_boundary(face));
  EXPECT_TRUE(back.at_end("skin_n") && back.at_end("skin"));
}

TEST(Pack, OfAMeshBeyondTheBoundThePoorestCellsStay) {
  const TetMesh mesh = cavity_mesh();
  const auto degrees = view::smallest_dihedrals(mesh, {});
  const auto n_below = [&](float bound) {
    return static_cast<std::size_t>(
        std::count_if(degrees.begin(), degrees.end(), [&](float d) { return d < bound; }));
  };
  const view::PackedMesh packed = view::pack(mesh, degrees, {}, {.most_cells = n_below(15) + 1});
  EXPECT_FALSE(packed.has_all_cells);
  EXPECT_EQ(packed.n_cells, n_below(15));
  EXPECT_EQ(packed.n_skin, 2696U);
  EXPECT_EQ(packed.n_listed, packed.n_cells);
}

TEST(Pack, Base64OfEveryRemainder) {
  EXPECT_EQ(view::base64(""), "");
  EXPECT_EQ(view::base64("f"), "Zg==");
  EXPECT_EQ(view::base64("fo"), "Zm8=");
  EXPECT_EQ(view::base64("foo"), "Zm9v");
  EXPECT_EQ(view::base64(std::string("\0\xff\x80", 3)), "AP+A");
}

}  // namespace
}  // namespace hfr::app::test
