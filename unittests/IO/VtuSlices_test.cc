// SPDX-License-Identifier: BSD-3-Clause
#include "IO/VtuSlices.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "HalfFace/Errors.hh"
#include "HalfFace/Generate.hh"
#include "HalfFace/TetMesh.hh"
#include "IO/MeshDataSamples.hh"
#include "IO/ReadWrite.hh"
#include "ScratchFolder.hh"

namespace hfr::test {
namespace {

using io::ShareItems;

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
    const std::uint64_t n = file.n_points(), m = file.n_items();
    EXPECT_EQ(file.points(0, n).size(), n);
    file.vertex_labels(0, n);
    file.fixed(0, n);
    const ShareItems items = file.items(0, m);
    EXPECT_EQ(items.cells.corners.size() + items.triangles.corners.size() + items.edges.corners.size(), m);
    EXPECT_EQ(items.cells.labels.size(), items.cells.corners.size());
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
  ASSERT_EQ(file.n_items(), mesh.n_cells());
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
      const ShareItems items = file.items(from, to);
      const auto& cells = items.cells.corners;
      const auto& regions = items.cells.labels;
      ASSERT_EQ(cells.size(), to - from);
      for (std::size_t c = 0; c < cells.size(); ++c) {
        EXPECT_EQ(regions[c], mesh.region(CellHandle(from + c)));
        for (std::size_t k = 0; k < 4; ++k)
          EXPECT_EQ(cells[c][k], mesh.cell(CellHandle(from + c)).v[k].idx());
      }
    }
  }
  EXPECT_TRUE(file.points(5, 5).empty());
  EXPECT_TRUE(file.items(mesh.n_cells(), mesh.n_cells()).cells.corners.empty());
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

/// Raw appended arrays as other programs may write them.
class Appended {
 public:
  Appended(bool big_endian, bool wide_header)
      : swap_(big_endian != (std::endian::native == std::endian::big)),
        big_endian_(big_endian),
        wide_(wide_header) {}

  template <class T>
  std::string array(const std::string& name, const std::string& type, int components,
                    const std::vector<T>& values) {
    const std::string element = "<DataArray type=\"" + type + "\" Name=\"" + name +
                                "\" NumberOfComponents=\"" + std::to_string(components) +
                                "\" format=\"appended\" offset=\"" + std::to_string(data_.size()) + "\"/>\n";
    const std::size_t n_bytes = values.size() * sizeof(T);
    if (wide_)
      put(static_cast<std::uint64_t>(n_bytes));
    else
      put(static_cast<std::uint32_t>(n_bytes));
    for (const T value : values) put(value);
    return element;
  }
  std::string file(const std::string& piece) const {
    return std::string(
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"") +
           (big_endian_ ? "BigEndian" : "LittleEndian") + "\"" + (wide_ ? " header_type=\"UInt64\"" : "") +
           ">\n<UnstructuredGrid>\n" + piece + "</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n  _" +
           data_ + "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  template <class T>
  void put(T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (swap_) std::reverse(bytes.begin(), bytes.end());
    data_.append(bytes.data(), bytes.size());
  }

  bool swap_, big_endian_, wide_;
  std::string data_;
};

TEST(VtuSlices, NumbersOfAnyKindAndByteOrder) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  for (const bool big_endian : {false, true})
    for (const bool wide : {false, true}) {
      Appended data(big_endian, wide);
      const std::string points =
          data.array<float>("Points", "Float32", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5F, 2, 300});
      const std::string corners =
          data.array<std::int64_t>("connectivity", "Int64", 1, {0, 1, 2, 3, 1, 2, 3, 4});
      const std::string ends = data.array<std::uint16_t>("offsets", "UInt16", 1, {4, 8});
      const std::string types = data.array<std::int32_t>("types", "Int32", 1, {10, 10});
      const std::string regions = data.array<std::int16_t>("region", "Int16", 1, {-2, 500});
      std::ofstream(path, std::ios::binary) << data.file(
          "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<Points>" + points + "</Points>\n<Cells>" +
          corners + ends + types + "</Cells>\n<CellData>" + regions + "</CellData>\n</Piece>\n");
      ASSERT_EQ(fault(path), "");
      io::VtuSlices file(path);
      EXPECT_EQ(file.points(3, 5), (std::vector<Vec3>{{0, 0, 1}, {0.5, 2, 300}}));
      EXPECT_EQ(file.items(1, 2).cells.corners, (std::vector<std::array<std::uint64_t, 4>>{{1, 2, 3, 4}}));
      EXPECT_EQ(file.items(0, 2).cells.labels, (std::vector<std::int32_t>{-2, 500}));
      const TetMesh whole = io::read(path);
      EXPECT_EQ(whole.n_cells(), 2U);
      EXPECT_EQ(whole.region(CellHandle(1)), 500);
    }
}

TEST(VtuSlices, OtherArraysAreFields) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  TetMesh mesh = meshed();
  auto height = mesh.request_vertex_property<double>("height");
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) height[VertexHandle(i)] = static_cast<double>(i);
  io::write(path, mesh);
  io::VtuSlices file(path);
  EXPECT_THAT(file.notes(), testing::IsEmpty());
  ASSERT_EQ(file.point_fields().size(), 1U);
  EXPECT_EQ(file.point_fields()[0].name, "height");
  EXPECT_EQ(file.point_fields()[0].components, 1);
  EXPECT_FALSE(file.point_fields()[0].integer);
  EXPECT_THAT(file.point_rows(1, 3), testing::ElementsAre(1, 2));
  EXPECT_THAT(file.cell_fields(), testing::IsEmpty());
}

TEST(VtuSlices, OfTwoArraysOfOneNameTheFirstHoldsTheLabels) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  Appended data(false, true);
  const std::string points = data.array<float>("Points", "Float32", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const std::string corners = data.array<std::int64_t>("connectivity", "Int64", 1, {0, 1, 2, 3});
  const std::string ends = data.array<std::int64_t>("offsets", "Int64", 1, {4});
  const std::string types = data.array<std::uint8_t>("types", "UInt8", 1, {10});
  std::string first = data.array<std::int32_t>("fixed", "Int32", 1, {0, 1, 0, 0});
  first.replace(first.find("DataArray"), 9, "Array");  // which readers do not look at
  const std::string second = data.array<std::int32_t>("fixed", "Int32", 1, {0, 0, 1, 0});
  std::ofstream(path, std::ios::binary) << data.file(
      "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points>" + points + "</Points>\n<Cells>" + corners +
      ends + types + "</Cells>\n<PointData>" + first + second + "</PointData>\n</Piece>\n");
  ASSERT_EQ(fault(path), "");
  EXPECT_TRUE(io::read(path).is_fixed(VertexHandle(1)));
  io::VtuSlices file(path);
  EXPECT_EQ(file.fixed(0, 4), (std::vector<std::uint8_t>{0, 1, 0, 0}));
  ASSERT_EQ(file.point_fields().size(), 1U) << "as in shared memory";
  EXPECT_EQ(file.point_fields()[0].name, "fixed");
  EXPECT_THAT(file.point_rows(0, 4), testing::ElementsAre(0, 0, 1, 0));
}

/// Rows hold all components of all arrays; of cells alone, while what others have is said.
TEST(VtuSlices, RowsAreOfTetrahedra) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  io::MeshData mesh = io::samples::full();
  const std::size_t n = mesh.cells.size();
  mesh.cell_fields = {{"a", 1, true, {}}, {"b", 2, false, {}}};
  for (std::size_t i = 0; i < n; ++i) {
    mesh.cell_fields[0].values.push_back(static_cast<double>(i));
    mesh.cell_fields[1].values.insert(mesh.cell_fields[1].values.end(), {0.5, -static_cast<double>(i)});
  }
  io::write_mesh(path, mesh);
  io::VtuSlices file(path);
  ASSERT_EQ(file.cell_fields().size(), 2U);
  EXPECT_TRUE(file.cell_fields()[0].integer);
  EXPECT_EQ(file.cell_fields()[1].components, 2);
  const io::ShareItems all = file.items(0, file.n_items());
  ASSERT_EQ(all.cell_rows.size(), 3 * n);
  EXPECT_EQ(all.cell_rows[3 * (n - 1)], static_cast<double>(n - 1));
  EXPECT_EQ(all.cell_rows[3 * (n - 1) + 2], -static_cast<double>(n - 1));
  EXPECT_THAT(all.has_other_values, testing::ElementsAre(0, 0));
}

/// Reals of one component under the name of labels may be such in shared memory, where none come before them.
TEST(VtuSlices, ArraysThatAreNoFieldsAreNamed) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  for (const bool has_labels : {false, true}) {
    Appended data(false, true);
    const std::string points =
        data.array<float>("Points", "Float32", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
    const std::string corners = data.array<std::int64_t>("connectivity", "Int64", 1, {0, 1, 2, 3, 0, 1, 2});
    const std::string ends = data.array<std::int64_t>("offsets", "Int64", 1, {4, 7});
    const std::string types = data.array<std::uint8_t>("types", "UInt8", 1, {10, 5});
    std::string arrays = data.array<double>("material", "Float64", 1, {0.5, 0.5}) +
                         data.array<double>("attribute", "Float64", 2, {1, 2, 3, 4}) +
                         data.array<double>("number", "Float64", 1, {0, 0}) +
                         data.array<double>("attribute", "Float64", 1, {7, 0}) +
                         "<DataArray type=\"Float64\" Name=\"text\" format=\"ascii\">1 2</DataArray>";
    if (has_labels) arrays += data.array<std::int32_t>("region", "Int32", 1, {4, 5});
    std::ofstream(path, std::ios::binary) << data.file(
        "<Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n<Points>" + points + "</Points>\n<Cells>" +
        corners + ends + types + "</Cells>\n<CellData>" + arrays + "</CellData>\n</Piece>\n");
    io::VtuSlices file(path);
    std::vector<std::string> names;
    for (const io::ShareField& field : file.cell_fields()) names.push_back(field.name);
    const io::ShareItems items = file.items(0, 2);
    if (has_labels) {
      EXPECT_THAT(names, testing::ElementsAre("material", "attribute"));
      EXPECT_THAT(file.notes(), testing::ElementsAre("array 'number' of cells left out",
                                                     "a second array 'attribute' of cells left out",
                                                     "array 'text' of cells left out"));
      EXPECT_THAT(items.cell_rows, testing::ElementsAre(0.5, 1, 2));
      EXPECT_THAT(items.has_other_values, testing::ElementsAre(1, 1));
    } else {
      EXPECT_THAT(names, testing::ElementsAre("attribute"));
      EXPECT_THAT(file.notes(), testing::ElementsAre(
                                    "array 'material' of cells left out", "array 'number' of cells left out",
                                    "array 'attribute' of cells left out", "array 'text' of cells left out"));
    }
  }
}

TEST(VtuSlices, LabelsAndNamesOfAllKinds) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.vtu";
  TetMesh mesh = meshed();
  mesh.set_fixed(VertexHandle(3));
  const auto& v = mesh.cell(CellHandle(2)).v;
  mesh.labels().faces.set({v[2], v[0], v[1]}, 5);
  mesh.labels().edges.set({v[3], v[0]}, -6);
  mesh.labels().vertices.assign(mesh.n_vertices(), 0);
  mesh.labels().vertices[4] = 8;
  mesh.labels().names[{2, 5}] = "a side";
  io::write(path, mesh);
  ASSERT_EQ(fault(path), "");
  io::VtuSlices file(path);
  EXPECT_EQ(file.n_items(), mesh.n_cells() + 2);
  const ShareItems items = file.items(mesh.n_cells() - 1, mesh.n_cells() + 2);
  EXPECT_EQ(items.cells.corners.size(), 1U);
  EXPECT_EQ(items.triangles.corners,
            (std::vector<std::array<std::uint64_t, 3>>{{v[2].idx(), v[0].idx(), v[1].idx()}}));
  EXPECT_EQ(items.triangles.labels, (std::vector<std::int32_t>{5}));
  EXPECT_EQ(items.edges.corners, (std::vector<std::array<std::uint64_t, 2>>{{v[3].idx(), v[0].idx()}}));
  EXPECT_EQ(items.edges.labels, (std::vector<std::int32_t>{-6}));
  EXPECT_EQ(file.fixed(2, 5), (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_EQ(file.vertex_labels(3, 6), (std::vector<std::int32_t>{0, 8, 0}));
  EXPECT_EQ(file.names(), mesh.labels().names);
  EXPECT_THAT(file.notes(), testing::IsEmpty());
}

}  // namespace
}  // namespace hfr::test
