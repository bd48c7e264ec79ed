// SPDX-License-Identifier: BSD-3-Clause
#include "IO/VtuSlices.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "HalfFace/Errors.hh"
#include "HalfFace/Generate.hh"
#include "HalfFace/TetMesh.hh"
#include "IO/ReadWrite.hh"
#include "ScratchFolder.hh"

namespace hfr::test {
namespace {

TetMesh meshed() {
  const generate::Arrays arrays = generate::box({2, 3, 2});
  TetMesh mesh = build(arrays.points, arrays.cells);
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) mesh.set_region(CellHandle(c), c % 2 == 0 ? 7 : -3);
  return mesh;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What is wrong with the file, in the words of the reader; empty where all of it can be read.
std::string fault(const std::filesystem::path& path) {
  try {
    io::VtuSlices file(path);
    const std::uint64_t n = file.n_points(), m = file.n_cells();
    EXPECT_EQ(file.points(0, n).size(), n);
    EXPECT_EQ(file.cells(0, m).size(), m);
    const std::uint64_t n_regions = file.has_regions() ? file.regions(0, m).size() : m;
    EXPECT_EQ(n_regions, m);
    return {};
  } catch (const InvalidInput& error) {
    return error.what();
  } catch (const IoError& error) {
    return error.what();
  }
}

TEST(VtuSlices, RangesAreTheMesh) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  const TetMesh mesh = meshed();
  io::write(path, mesh);
  io::VtuSlices file(path);
  ASSERT_EQ(file.n_points(), mesh.n_vertices());
  ASSERT_EQ(file.n_cells(), mesh.n_cells());
  ASSERT_TRUE(file.has_regions());
  EXPECT_THAT(file.notes(), testing::IsEmpty());
  for (const std::uint64_t n : {1, 7, 1000}) {
    for (std::uint64_t from = 0; from < mesh.n_vertices(); from += n) {
      const std::uint64_t to = std::min<std::uint64_t>(from + n, mesh.n_vertices());
      const auto points = file.points(from, to);
      ASSERT_EQ(points.size(), to - from);
      for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_EQ(points[i], mesh.point(VertexHandle(from + i)));
    }
    for (std::uint64_t from = 0; from < mesh.n_cells(); from += n) {
      const std::uint64_t to = std::min<std::uint64_t>(from + n, mesh.n_cells());
      const auto cells = file.cells(from, to);
      const auto regions = file.regions(from, to);
      ASSERT_EQ(cells.size(), to - from);
      for (std::size_t c = 0; c < cells.size(); ++c) {
        EXPECT_EQ(regions[c], mesh.region(CellHandle(from + c)));
        for (std::size_t k = 0; k < 4; ++k)
          EXPECT_EQ(cells[c][k], mesh.cell(CellHandle(from + c)).v[k].idx());
      }
    }
  }
  EXPECT_TRUE(file.points(5, 5).empty());
  EXPECT_TRUE(file.cells(mesh.n_cells(), mesh.n_cells()).empty());
}

TEST(VtuSlices, AFileThatEndsAnywhereIsRefusedInOneLine) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  io::write(path, meshed());
  const std::string good = bytes_of(path);
  const std::size_t end = good.find("\n</AppendedData>");
  for (std::size_t n = 0; n < end; n += n < 1500 ? 1 : 7) {
    std::ofstream(path, std::ios::binary) << good.substr(0, n);
    const std::string found = fault(path);
    ASSERT_THAT(found, testing::StartsWith(path.string() + ": ")) << n;
    ASSERT_EQ(found.find('\n'), std::string::npos) << n;
  }
}

TEST(VtuSlices, ChangedBytesAreReadOrRefused) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  io::write(path, meshed());
  const std::string good = bytes_of(path);
  const std::size_t head = good.find("\n_");
  std::mt19937_64 engine(1);
  int n_refused = 0;
  for (int run = 0; run < 3000; ++run) {
    std::string bytes = good;
    for (std::uint64_t k = engine() % 3 + 1; k > 0; --k)
      bytes[engine() % (run % 3 == 0 ? good.size() : head)] = static_cast<char>(engine());
    std::ofstream(path, std::ios::binary) << bytes;
    const std::string found = fault(path);
    if (found.empty()) continue;
    ++n_refused;
    ASSERT_THAT(found, testing::StartsWith(path.string() + ": ")) << run;
    ASSERT_EQ(found.find('\n'), std::string::npos) << run << ": " << found;
  }
  EXPECT_GT(n_refused, 1000);
  EXPECT_LT(n_refused, 3000);
}

TEST(VtuSlices, OtherArraysAreNamed) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  TetMesh mesh = meshed();
  auto height = mesh.request_vertex_property<double>("height");
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) height[VertexHandle(i)] = static_cast<double>(i);
  io::write(path, mesh);
  io::VtuSlices file(path);
  EXPECT_THAT(file.notes(), testing::ElementsAre("array 'height' of points left out"));
  mesh.set_fixed(VertexHandle(3));
  io::write(path, mesh);
  EXPECT_THAT(fault(path), testing::HasSubstr("array 'fixed' of points"));
}

}  // namespace
}  // namespace hfr::test
