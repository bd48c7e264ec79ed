// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "IO/VtkSamples.hh"

namespace hfr::io {
namespace {

using samples::has_note;
using samples::TemporaryFolder;

/// A unit cube of five tetrahedra, one point inside each face of nothing: point 8 is used by no cell.
MeshData cube() {
  MeshData mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points.push_back({i & 1 ? 1.0 / 3.0 : 0.1, i & 2 ? 0.7 : 0.0, i & 4 ? 1e-3 : -1e-3});
  mesh.points.push_back({9, 9, 9});
  mesh.cells = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}};
  for (auto& cell : mesh.cells) {
    const Vec3 a = mesh.points[cell[0]];
    const double volume =
        dot(cross(mesh.points[cell[1]] - a, mesh.points[cell[2]] - a), mesh.points[cell[3]] - a);
    if (volume < 0) std::swap(cell[0], cell[1]);
  }
  return mesh;
}

double enclosed_volume(const MeshData& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.points[t[0]], cross(mesh.points[t[1]], mesh.points[t[2]])) / 6;
  return sum;
}

constexpr double kCubeVolume = (1.0 / 3.0 - 0.1) * 0.7 * 2e-3;

struct Case {
  const char* file;
  bool binary;
  bool exact;
};

class SurfaceFiles : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(All, SurfaceFiles,
                         testing::Values(Case{"a.stl", false, true}, Case{"b.stl", true, false},
                                         Case{"a.obj", false, true}, Case{"a.off", false, true},
                                         Case{"a.ply", false, true}, Case{"b.ply", true, true}));

TEST_P(SurfaceFiles, TheBoundaryOfATetrahedralMeshFacesOutwards) {
  const TemporaryFolder folder;
  const auto path = folder / GetParam().file;
  const MeshData mesh = cube();
  const auto notes = write_mesh(path, mesh, {GetParam().binary, ""});
  ASSERT_EQ(notes.size(), GetParam().exact ? 1u : 2u);
  const MeshData read = read_mesh(path);
  EXPECT_TRUE(read.cells.empty());
  EXPECT_EQ(read.points.size(), 8u) << "points inside or unused are left out";
  EXPECT_EQ(read.triangles.size(), 12u);
  EXPECT_EQ(read.triangle_labels.size(), 12u);
  EXPECT_NEAR(enclosed_volume(read), kCubeVolume, 1e-9);
  std::vector<Vec3> corners;
  for (const auto& t : read.triangles)
    for (const Index v : t) corners.push_back(read.points[v]);
  std::size_t n_exact = 0;
  for (const Vec3& p : corners)
    for (std::size_t i = 0; i < 8; ++i) n_exact += p == mesh.points[i];
  EXPECT_EQ(n_exact == 36, GetParam().exact);
}

TEST_P(SurfaceFiles, AMeshOfTheOtherOrientationHasItsOutsideThereToo) {
  const TemporaryFolder folder;
  MeshData mesh = cube();
  for (auto& cell : mesh.cells) std::swap(cell[0], cell[1]);
  write_mesh(folder / GetParam().file, mesh, {GetParam().binary, ""});
  EXPECT_NEAR(enclosed_volume(read_mesh(folder / GetParam().file)), kCubeVolume, 1e-9);
}

TEST_P(SurfaceFiles, TrianglesWithoutCellsComeBackInTheirOrder) {
  const TemporaryFolder folder;
  MeshData mesh = samples::random_bits(60, 3);
  mesh.cells.clear();
  mesh.regions.clear();
  for (Vec3& p : mesh.points)  // within the range of 32 bits, so that binary STL can hold them
    p = {std::remainder(p.x, 1e3), std::remainder(p.y, 1e3), std::remainder(p.z, 1e3)};
  for (Index i = 0; i + 2 < 60; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  mesh.triangle_labels.assign(mesh.triangles.size(), 0);
  write_mesh(folder / GetParam().file, mesh, {GetParam().binary, ""});
  const MeshData read = read_mesh(folder / GetParam().file);
  if (!GetParam().exact) {
    const auto rounded = [&](Index v) {
      Vec3 p = mesh.points[v];
      for (int d = 0; d < 3; ++d) p[d] = static_cast<double>(static_cast<float>(p[d]));
      return p;
    };
    std::erase_if(mesh.triangles, [&](const auto& t) {  // two corners in one place are dropped
      return rounded(t[0]) == rounded(t[1]) || rounded(t[1]) == rounded(t[2]) ||
             rounded(t[2]) == rounded(t[0]);
    });
    ASSERT_GT(mesh.triangles.size(), 50u);
    ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(read.points[read.triangles[i][k]], rounded(mesh.triangles[i][k])) << i;
    return;
  }
  EXPECT_TRUE(samples::same_bits(read.points, mesh.points));
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST_P(SurfaceFiles, AFileCutAnywhereIsRefusedOrReadInPart) {
  const TemporaryFolder folder;
  write_mesh(folder / GetParam().file, cube(), {GetParam().binary, ""});
  const std::string bytes = samples::read_bytes(folder / GetParam().file);
  const std::string name = std::string("cut") + GetParam().file;
  std::size_t n_refused = 0;
  for (std::size_t length = 1; length < bytes.size(); ++length) {
    const std::string message = samples::message_for(folder / name, bytes.substr(0, length));
    if (message.empty()) continue;
    EXPECT_TRUE(message.starts_with((folder / name).string() + ":")) << message;
    ++n_refused;
  }
  // OBJ announces no counts: a file cut at the end of a line is a good file.
  const bool has_counts = std::string(GetParam().file) != "a.obj";
  EXPECT_GT(n_refused, has_counts ? bytes.size() - 20 : bytes.size() / 5);
}

TEST_P(SurfaceFiles, AByteChangedNeverDoesMoreThanThrow) {
  const TemporaryFolder folder;
  write_mesh(folder / GetParam().file, cube(), {GetParam().binary, ""});
  const std::string bytes = samples::read_bytes(folder / GetParam().file);
  const std::string name = std::string("bad") + GetParam().file;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const char value : {'9', '\xff'}) {
      std::string broken = bytes;
      broken[at] = value;
      static_cast<void>(samples::message_for(folder / name, broken));
    }
  }
}

TEST(SurfaceFormats, PlyKeepsTheLabelsOfTheBoundary) {
  const TemporaryFolder folder;
  MeshData mesh = cube();
  mesh.triangles = {{2, 0, 1}, {1, 2, 4}};  // a boundary face in some order, and one inside
  mesh.triangle_labels = {7, 8};
  for (const bool binary : {false, true}) {
    write_mesh(folder / "a.ply", mesh, {binary, ""});
    const MeshData read = read_mesh(folder / "a.ply");
    EXPECT_EQ(std::count(read.triangle_labels.begin(), read.triangle_labels.end(), 7), 1);
    EXPECT_EQ(std::count(read.triangle_labels.begin(), read.triangle_labels.end(), 0), 11);
  }
  EXPECT_EQ(write_mesh(folder / "a.off", mesh).size(), 2u);
}

TEST(SurfaceFormats, WhatASurfaceFormatCannotHoldIsNamed) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_mesh(folder / "a.obj", samples::full()),
            (std::vector<std::string>{"only the boundary is written: surface formats hold no tetrahedra",
                                      "labels of triangles are not written; PLY holds them",
                                      "regions are not written", "edges and their labels are not written",
                                      "labels of vertices and fixed vertices are not written",
                                      "names of labels are not written", "fields are not written"}));
  EXPECT_THROW(write_mesh(folder / "a.stl", samples::full(), {true, ""}), InvalidInput)
      << "1e300 is no float";
  EXPECT_FALSE(std::filesystem::exists(folder / "a.stl"));
}

MeshData read_text(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / name, text);
  return read_mesh(folder / name);
}

TEST(SurfaceFormats, ObjOfOtherProgramsIsRead) {
  const MeshData mesh =
      read_text("a.obj",
                "# made elsewhere\r\nmtllib x.mtl\r\no thing\r\nv 0 0 0 1.0\r\nv 1 0 0 .5 .5 .5\r\n"
                "v 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\nvn 0 0 1\r\ng a\r\nusemtl b\r\ns off\r\n"
                "f 1/1/1 2//1 3/1 4 # a square\r\nf -4 -3 -2\r\nl 1 2\r\n");
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
  EXPECT_TRUE(has_note(mesh, "1 polygon with more than three corners cut into triangles"));
}

TEST(SurfaceFormats, OffWithColoursCommentsAndCountsOnTheFirstLineIsRead) {
  const MeshData mesh = read_text("a.off",
                                  "COFF 4 2 0 # counts\n# points\n0 0 0 255 0 0\n1 0 0 1 1 1\n1 1 0 0 0 0\n"
                                  "0 1 0 9 9 9\n4 0 1 2 3 0.5 0.5 0.5\n3 0 1 2\n");
  EXPECT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
}

TEST(SurfaceFormats, PlyWithOtherElementsAndPropertiesIsRead) {
  const MeshData mesh = read_text(
      "a.ply",
      "ply\nformat ascii 1.0\ncomment x\nobj_info y\nelement camera 1\nproperty list uchar float view\n"
      "element vertex 3\nproperty float nx\nproperty float x\nproperty double y\nproperty int z\n"
      "property uchar red\nelement face 1\nproperty uchar flags\nproperty list uchar uint vertex_index\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
      "2 0.5 0.5\n9 0.1 0 0 255\n9 1 0 0 255\n9 0 1 0 255\n1 3 0 1 2\n0 1\n");
  EXPECT_EQ(mesh.points[0], (Vec3{0.1, 0, 0}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}}));
}

TEST(SurfaceFormats, WhatPlyHasBesideVerticesAndFacesIsNamed) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  const MeshData mesh =
      read_text("a.ply", head + "element cloud 2\nproperty int i\nend_header\n" + points + "1\n2\n");
  EXPECT_THAT(mesh.notes, testing::ElementsAre("element cloud (2) is not kept"));
  const TemporaryFolder folder;
  EXPECT_EQ(
      samples::short_message_for(
          folder / "a.ply", head + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                                points + "3 0 1 2\n"),
      ":12: triangles in strips (element 'tristrips') are not read: convert them to element 'face'");
}

TEST(SurfaceFormats, PlyOfOneByteAnItemIsRead) {
  const TemporaryFolder folder;
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement flag 1000\nproperty uchar v\nend_header\n";
  EXPECT_EQ(samples::short_message_for(folder / "a.ply", text + std::string(999, 'x')),
            ": at byte " + std::to_string(text.size()) +
                ": number of flag 1000 is more than the rest of the file can hold");
  EXPECT_THAT(read_text("a.ply", text + std::string(1000, 'x')).notes,
              testing::ElementsAre("element flag (1000) is not kept"));
}

TEST(SurfaceFormats, StlInCapitalsOrBehindBlanksIsText) {
  const std::string text =
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid\n";
  std::string capitals = text;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(read_text("a.stl", capitals).triangles.size(), 1u);
  EXPECT_EQ(read_text("a.stl", "\n  " + text).triangles.size(), 1u);
}

TEST(SurfaceFormats, PlyMessagesAreShortWhateverTheFileSays) {
  const TemporaryFolder folder;
  const std::string long_word(3000, 'x');
  for (const std::string& rest : {std::string(" -1\nend_header\n"), std::string(" 2\nend_header\n1 2\n")})
    EXPECT_LT(
        samples::message_of_reading(folder, "a.ply", "ply\nformat ascii 1.0\nelement " + long_word + rest)
            .size(),
        200U);
}

TEST(SurfaceFormats, BigEndianPlyIsRead) {
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto put = [&](auto value) {
    auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    if constexpr (std::endian::native == std::endian::little) std::reverse(bytes.begin(), bytes.end());
    text.append(bytes.data(), bytes.size());
  };
  for (const float value : {0.5f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f}) put(value);
  text += '\3';
  for (const std::int32_t v : {2, 1, 0}) put(v);
  const MeshData mesh = read_text("a.ply", text);
  EXPECT_EQ(mesh.points[0].x, 0.5);
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<Index, 3>>{{2, 1, 0}}));
}

TEST(SurfaceFormats, BinaryStlThatBeginsWithSolidIsRead) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.stl", cube(), {true, ""});
  const std::string bytes = samples::read_bytes(folder / "a.stl");
  EXPECT_EQ(read_text("b.stl", "solid" + bytes.substr(5)).triangles.size(), 12u);
}

TEST(SurfaceFormats, WhatIsBrokenIsNamedWithItsPlace) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& text) {
    return samples::short_message_for(folder / name, text);
  };
  EXPECT_EQ(message("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
            ":4: vertex 4 is out of range (there are 3 before it, counted from 1)");
  EXPECT_EQ(message("a.obj", "v 0 0 0\nf 1 0 1\n"),
            ":2: vertex 0 is out of range (there are 1 before it, counted from 1)");
  EXPECT_EQ(message("a.obj", "v 0 0 0\nf 1 1\n"), ":2: a face has 2 corners");
  EXPECT_EQ(message("a.obj", "v 0 0 nan\n"), ":1: expected a finite number, found 'nan'");
  EXPECT_EQ(message("a.off", "4OFF\n1 0 0\n0 0 0 0\n"),
            ":1: only surfaces in three dimensions are supported, not '4off'");
  EXPECT_EQ(message("a.off", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n"), ":4: vertex 1 is out of range (0 to 0)");
  EXPECT_EQ(message("a.off", "OFF\n1000000000 1 0\n0 0 0\n").substr(0, 3), ":2:");
  EXPECT_EQ(message("a.ply", "plx\n"), ":1: this is no PLY file: it must begin with 'ply'");
  EXPECT_EQ(message("a.stl", "solid\nfacet normal 0 0 1\nouter lop\n"), ":3: expected 'loop', found 'lop'");
  std::string stl(84, ' ');
  stl[80] = '\7';
  stl[81] = stl[82] = stl[83] = '\0';
  EXPECT_EQ(message("a.stl", stl), ": at byte 80: 7 triangles need 434 bytes, but the file has 84");
}

}  // namespace
}  // namespace hfr::io
