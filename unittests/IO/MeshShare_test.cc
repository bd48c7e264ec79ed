// SPDX-License-Identifier: BSD-3-Clause
// The shares of a file together are what the readers of whole files have.
#include "IO/MeshShare.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "HalfFace/Errors.hh"
#include "HalfFace/Generate.hh"
#include "IO/MeshDataSamples.hh"
#include "IO/MeshFile.hh"
#include "IO/Shares.hh"
#include "LibFuzzer/Formats.hh"

namespace hfr::test {
namespace {

using io::MeshData;
using io::samples::comparable;
using io::samples::put_together;
using io::samples::read_shares;
using io::samples::TemporaryFolder;
using testing::HasSubstr;

/// The ways to write what is read in ranges.
const std::vector<std::pair<std::string, io::WriteOptions>> kFormats = {
    {".mesh", {}}, {".meshb", {}}, {".msh", {false, "2.2"}}, {".msh", {false, "4.1"}}, {".vtu", {}}};

/// A box of a few hundred cells, with regions, patches, edges and labels, so that a text has many chunks.
MeshData labelled_box(unsigned seed) {
  const generate::Arrays box = generate::box({4, 3, 3});
  MeshData mesh;
  mesh.points = box.points;
  std::mt19937_64 random(seed);
  const auto some = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (const auto& cell : box.cells) {
    auto& v = mesh.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) v[k] = static_cast<Index>(cell[k]);
    mesh.regions.push_back(1 + some(3));
    if (some(3) == 0) {
      mesh.triangles.push_back({v[0], v[1], v[2]});
      mesh.triangle_labels.push_back(10 + some(4));
    }
    if (some(5) == 0) {
      mesh.edges.push_back({v[1], v[3]});
      mesh.edge_labels.push_back(20 + some(2));
    }
  }
  mesh.vertex_labels.resize(mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (some(4) == 0) mesh.vertex_labels[i] = 30 + some(3);
    if (some(6) == 0) mesh.fixed_vertices.push_back(static_cast<Index>(i));
  }
  mesh.names = {{{3, 1}, "steel"}, {{2, 11}, "a side"}};
  return mesh;
}

/// The line with which one process refuses the file; empty where it has read all.
std::string refusal(const std::filesystem::path& path, std::size_t n_processes = 1) {
  try {
    put_together(read_shares(path, n_processes, 3));
  } catch (const InvalidInput& error) {
    return error.what();
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

std::string refusal_of(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  io::samples::write_bytes(folder / name, bytes);
  const std::string line = refusal(folder / name), alone = (folder / name).string() + ": ";
  for (const std::size_t n : {2, 3})
    EXPECT_EQ(refusal(folder / name, n).empty(), line.empty()) << n << " processes: " << line;
  EXPECT_TRUE(line.empty() || line.starts_with(alone)) << line;
  return line.empty() ? line : line.substr(alone.size());
}

TEST(MeshShare, SharesOfAnyNumberOfProcessesAreTheFile) {
  const TemporaryFolder folder;
  for (const auto& [extension, options] : kFormats)
    for (unsigned seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE(extension + " " + options.variant + " " + std::to_string(seed));
      const auto path = folder / ("a" + extension);
      io::write_mesh(path, seed == 0 ? io::samples::full() : labelled_box(seed), options);
      const MeshData whole = comparable(io::read_mesh(path));
      for (const std::size_t n : {1, 2, 3, 7})
        for (const std::uint64_t at_once : {1, 5, 1000})
          EXPECT_EQ(fuzz::difference(put_together(read_shares(path, n, at_once)), whole), "")
              << n << " processes, " << at_once << " at once";
    }
}

TEST(MeshShare, WhatIsNotReadIsSaid) {
  const TemporaryFolder folder;
  const auto path = folder / "a.msh";
  io::write_mesh(path, io::samples::full(), {false, "4.1"});
  EXPECT_THAT(read_shares(path, 2, 10)[1].notes,
              testing::UnorderedElementsAre(HasSubstr("fields on points ($NodeData) left out"),
                                            HasSubstr("fields on cells ($ElementData) left out")));
}

/// Cut off anywhere, or with other bytes: what both readers take is the same mesh, and what is refused is so
/// in one line that begins with the path. `n_same` and `n_refused` count what was seen.
struct Broken {
  const TemporaryFolder folder;
  int n_same = 0, n_refused = 0;

  void look(const std::string& extension, const std::string& bytes, std::size_t n_processes) {
    const auto path = folder / ("a" + extension);
    io::samples::write_bytes(path, bytes);
    std::optional<MeshData> parts;
    try {
      parts = put_together(read_shares(path, n_processes, 4));
    } catch (const InvalidInput& error) {
      ASSERT_NO_FATAL_FAILURE(look_at_line(path, error.what()));
      return;
    } catch (const IoError& error) {
      ASSERT_NO_FATAL_FAILURE(look_at_line(path, error.what()));
      return;
    }
    try {
      const std::string differs = fuzz::difference(*parts, comparable(io::read_mesh(path)));
      ++n_same;
      ASSERT_EQ(differs, "");
    } catch (const InvalidInput&) {  // in parts that shares leave out
    }
  }

 private:
  void look_at_line(const std::filesystem::path& path, const std::string& line) {
    ++n_refused;
    ASSERT_THAT(line, testing::StartsWith(path.string() + ": "));
    ASSERT_EQ(line.find('\n'), std::string::npos) << line;
  }
};

TEST(MeshShare, AFileThatEndsAnywhereIsRefusedOrReadAsAWholeOne) {
  for (const auto& [extension, options] : kFormats) {
    SCOPED_TRACE(extension + " " + options.variant);
    Broken broken;
    const auto path = broken.folder / ("good" + extension);
    io::write_mesh(path, io::samples::full(), options);
    const std::string good = io::samples::read_bytes(path);
    for (std::size_t n = 0; n < good.size(); ++n)
      ASSERT_NO_FATAL_FAILURE(broken.look(extension, good.substr(0, n), 1 + n % 2)) << n;
    EXPECT_GT(broken.n_refused, 200);
  }
}

TEST(MeshShare, ChangedBytesAreRefusedOrReadAsByAWholeReader) {
  for (const auto& [extension, options] : kFormats) {
    SCOPED_TRACE(extension + " " + options.variant);
    Broken broken;
    const auto path = broken.folder / ("good" + extension);
    io::write_mesh(path, io::samples::full(), options);
    const std::string good = io::samples::read_bytes(path);
    std::mt19937_64 random(1);
    for (int run = 0; run < 1500; ++run) {
      std::string bytes = good;
      for (std::uint64_t k = random() % 3 + 1; k > 0; --k) {
        // Half of them are bytes that the file has, and so more like a file.
        const auto other = run % 2 == 0 ? static_cast<char>(random()) : good[random() % good.size()];
        bytes[random() % bytes.size()] = other;
      }
      ASSERT_NO_FATAL_FAILURE(broken.look(extension, bytes, 1 + random() % 2)) << run;
    }
    EXPECT_GT(broken.n_same, 50);
    EXPECT_GT(broken.n_refused, 50);
  }
}

TEST(MeshShare, FilesOfOtherFormatsAreRefused) {
  EXPECT_TRUE(io::has_shares("a.MESH"));
  EXPECT_FALSE(io::has_shares("a.node"));
  EXPECT_THAT(refusal_of("a.node", "x"), HasSubstr("cannot be read in ranges"));
  for (const char* name : {"a.mesh", "a.msh", "a.vtu"}) {
    const TemporaryFolder folder;
    EXPECT_THAT(refusal(folder / name), HasSubstr("cannot be opened")) << name;
  }
}

const std::string kMeditPoints =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";
const std::string kMeditCell = "Tetrahedra\n1\n1 2 3 4 0\n";

TEST(MeshShare, MeditFilesThatCannotBeReadInRangesSayWhy) {
  const auto found = [](const std::string& bytes) { return refusal_of("a.mesh", bytes); };
  const std::string &points = kMeditPoints, good = points + kMeditCell;
  EXPECT_EQ(found(good), "");
  EXPECT_EQ(found(""), "the file is empty");
  EXPECT_THAT(found("x\n"), HasSubstr("not a Medit file"));
  EXPECT_THAT(found("MeshVersionFormatted 2\nDimension 2\n"), HasSubstr("number of entries 2"));
  EXPECT_THAT(found("MeshVersionFormatted 2\nDimension 3\n" + kMeditCell), HasSubstr("no Vertices"));
  EXPECT_THAT(found(points), HasSubstr("it has no cells"));
  EXPECT_THAT(found(good + kMeditCell), HasSubstr("a second section Tetrahedra"));
  EXPECT_THAT(found(good + "Vertices 1\n0 0 0 0\n"), HasSubstr("a second section Vertices"));
  EXPECT_THAT(found(points + "Tetrahedra\n2\n1 2 3 4 0\nEnd\n"), HasSubstr("announces 2 entries and has 1"));
  EXPECT_THAT(found(points + "Tetrahedra\n1\n1 2 3\n4 0\nEnd\n"), HasSubstr("more entries than it says"));
  EXPECT_THAT(found(points + "Tetrahedra\n1\n1 2 3 4\nEnd\n"), HasSubstr("the line ends too early"));
  EXPECT_THAT(found(points + "Tetrahedra\n1\n1 2 3 4 0 0\n"), HasSubstr("there is more on this line"));
  EXPECT_THAT(found(points + "Tetrahedra\n1\n1 2 3 3 0\n"), HasSubstr("vertices are the same"));
  EXPECT_THAT(found(points + "Hexahedra\n1\n1 2 3 4 1 2 3 4 0\n"), HasSubstr("1 Hexahedra"));
  EXPECT_THAT(found(good + "RequiredTriangles\n1\n2\n"), HasSubstr("RequiredTriangles 2 is out of range"));
  EXPECT_THAT(found(points + "Tetrahedra\n1\n" + std::string(70'000, ' ') + "1 2 3 4 0\n"),
              HasSubstr("a line of more than 65536 bytes"));
}

TEST(MeshShare, RequiredElementsFixTheirVertices) {
  const TemporaryFolder folder;
  const auto path = folder / "a.mesh";
  io::samples::write_bytes(
      path, kMeditPoints + kMeditCell +
                "Triangles\n2\n1 2 3 5\n2 3 4 6\nEdges\n2\n1 2 7\n3 4 8\nRequiredTriangles\n1\n1\n"
                "RequiredEdges\n1\n2\nCorners\n1\n4\nNormals\n1\n0 0 1\nEnd\n");
  io::samples::write_bytes(folder / "a.sol", "MeshVersionFormatted 2\n");
  const auto shares = read_shares(path, 3, 1);
  EXPECT_THAT(put_together(shares).fixed_vertices, testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(shares[0].notes,
              testing::UnorderedElementsAre(HasSubstr("Corners (1)"), HasSubstr("RequiredTriangles (1)"),
                                            HasSubstr("RequiredEdges (1)"), HasSubstr("is not kept"),
                                            HasSubstr("a.sol left out")));
}

/// A binary file of one cell, of any version and byte order.
class BinaryMedit {
 public:
  BinaryMedit(int version, bool big_endian) : version_(version), big_endian_(big_endian) {
    put(1, 4);
    put(version, 4);
    section(3, [&] { put(3, 4); });
    section(4, [&] {
      integer(4);
      for (const auto& p : {std::array<double, 3>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}) {
        for (const double x : p) real(x);
        integer(0);
      }
    });
    section(8, [&] {
      integer(1);
      for (const int v : {1, 2, 3, 4, 9}) integer(v);
    });
    put(54, 4);
    put(0, version < 3 ? 4 : 8);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  template <class Body>
  void section(int code, Body&& body) {
    put(static_cast<std::uint64_t>(code), 4);
    const std::size_t at = bytes_.size(), n = version_ < 3 ? 4 : 8;
    put(0, n);
    body();
    const std::string rest = std::exchange(bytes_, bytes_.substr(0, at)).substr(at + n);
    put(at + n + rest.size(), n);
    bytes_ += rest;
  }
  void integer(int value) { put(static_cast<std::uint64_t>(value), version_ < 4 ? 4 : 8); }
  void real(double value) {
    if (version_ == 1)
      put(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
    else
      put(std::bit_cast<std::uint64_t>(value), 8);
  }
  void put(std::uint64_t value, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i)
      bytes_ += static_cast<char>(value >> (8 * (big_endian_ ? n - 1 - i : i)) & 0xFF);
  }

  int version_;
  bool big_endian_;
  std::string bytes_;
};

TEST(MeshShare, BinaryMeditOfAllVersionsAndByteOrders) {
  for (const int version : {1, 2, 3, 4})
    for (const bool big_endian : {false, true}) {
      SCOPED_TRACE(std::to_string(version) + (big_endian ? " big" : " little"));
      const TemporaryFolder folder;
      const auto path = folder / "a.meshb";
      io::samples::write_bytes(path, BinaryMedit(version, big_endian).bytes());
      const MeshData mesh = put_together(read_shares(path, 2, 3));
      EXPECT_EQ(fuzz::difference(mesh, comparable(io::read_mesh(path))), "");
      EXPECT_EQ(mesh.points[3].z, 0.5);
      EXPECT_EQ(mesh.regions, std::vector<int>{9});
    }
}

TEST(MeshShare, BinaryMeditThatCannotBeReadSaysWhy) {
  const auto changed = [](std::size_t at, char value) {
    std::string bytes = BinaryMedit(2, false).bytes();
    bytes.at(at) = value;
    return refusal_of("a.meshb", bytes);
  };
  const std::string good = BinaryMedit(2, false).bytes();
  EXPECT_EQ(refusal_of("a.meshb", good), "");
  EXPECT_THAT(refusal_of("a.meshb", good.substr(0, 7)), HasSubstr("ends too early"));
  EXPECT_THAT(changed(4, 5), HasSubstr("this version is not known"));
  EXPECT_THAT(changed(15, 127), HasSubstr("the position of the next section"));
  EXPECT_THAT(changed(16, 2), HasSubstr("only dimension 3 is read"));
  EXPECT_THAT(changed(28, 100), HasSubstr("100 entries"));
  EXPECT_THAT(changed(28, 9), HasSubstr("9 entries"));
  EXPECT_THAT(changed(32 + 4 * 28 + 12, 5), HasSubstr("vertex 5 is out of range"));
}

const std::string kGmshPoints =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";

/// `nodes` in four lines, then one tetrahedron of the corners.
std::string gmsh2(const std::string& nodes, const std::string& corners) {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n" + nodes + "$EndNodes\n$Elements\n1\n1 4 2 0 1 " +
         corners + "\n$EndElements\n";
}

TEST(MeshShare, Gmsh2FilesThatCannotBeReadInRangesSayWhy) {
  const auto found = [](const std::string& bytes) { return refusal_of("a.msh", bytes); };
  const auto elements = [](const std::string& lines) {
    return kGmshPoints + "$Elements\n" + lines + "$EndElements\n";
  };
  const std::string cell = "1 4 2 0 1 1 2 3 4\n", good = elements("1\n" + cell);
  EXPECT_EQ(found(good), "");
  EXPECT_EQ(found(elements("4\n1 15 2 7 1 2\n2 15 2 0 2 3\n3 1 2 0 1 1 2\n4 4 2 7 1 1 2 3 4\n")), "");
  EXPECT_THAT(found("x\n"), HasSubstr("expected $MeshFormat"));
  EXPECT_THAT(found("$MeshFormat\n"), HasSubstr("the file ends too early"));
  EXPECT_THAT(found("$MeshFormat\n2.2 1 8\n"), HasSubstr("as text of version 2.2 or 4.1"));
  EXPECT_THAT(found("$MeshFormat\n4.0 0 8\n$EndMeshFormat\n"), HasSubstr("as text of version 2.2 or 4.1"));
  EXPECT_THAT(found("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"), HasSubstr("without a $Nodes section"));
  EXPECT_THAT(found(kGmshPoints), HasSubstr("without an $Elements section"));
  EXPECT_THAT(found(kGmshPoints + "$Elements\n1\n"), HasSubstr("is not closed"));
  EXPECT_THAT(found(good + "$Elements\n1\n" + cell + "$EndElements\n"), HasSubstr("a second $Elements"));
  EXPECT_THAT(found(good + kGmshPoints.substr(kGmshPoints.find("$Nodes"))), HasSubstr("a second section of"));
  EXPECT_THAT(found(good + "$ParametricNodes\n$EndParametricNodes\n"), HasSubstr("$ParametricNodes"));
  EXPECT_THAT(found(elements("9\n" + cell)), HasSubstr("9 elements are announced"));
  EXPECT_THAT(found(elements("1\n1 4 2 0 1 1 2 3 9\n")), HasSubstr("there is no node 9"));
  EXPECT_THAT(found(elements("1\n1 4 2 0 1 1 2 3 3\n")), HasSubstr("has node 3 twice"));
  EXPECT_THAT(found(elements("1\n1 5 2 0 1 1 2 3 4 1 2 3 4\n")), HasSubstr("hexahedra"));
  EXPECT_THAT(found(elements("1\n1 99999 2 0 1 1 2 3 4\n")), HasSubstr("unknown Gmsh element type 99999"));
  EXPECT_THAT(found(elements("1\n1 11 2 0 1 1 2 3 4 1 2 3 4 1 2\n")), HasSubstr("of first order"));
  EXPECT_THAT(found(elements("2\n1 4 2 7 1 1 2 3 4\n2 4 2 8 1 1 2 3 4\n")),
              HasSubstr("in several physical groups"));
  EXPECT_EQ(found(elements("2\n1 3 2 0 1 1 2 3 4\n" + cell)), "") << "a quadrangle";
}

TEST(MeshShare, GmshNodesAreNumberedOneAfterTheOther) {
  EXPECT_EQ(refusal_of("a.msh", gmsh2("5 0 0 0\n6 1 0 0\n7 0 1 0\n8 0 0 1\n", "5 6 7 8")), "");
  EXPECT_EQ(refusal_of("a.msh", gmsh2("-2 0 0 0\n-1 1 0 0\n0 0 1 0\n1 0 0 1\n", "-2 -1 0 1")), "");
  EXPECT_THAT(refusal_of("a.msh", gmsh2("1 0 0 0\n2 1 0 0\n7 0 1 0\n4 0 0 1\n", "1 2 7 4")),
              HasSubstr("numbered one after the other"));
  // Behind the largest number comes none, and before the smallest one, which is 2^64 before, neither.
  EXPECT_THAT(refusal_of("a.msh", gmsh2("9223372036854775806 0 0 0\n9223372036854775807 1 0 0\n"
                                        "-9223372036854775808 0 1 0\n-9223372036854775807 0 0 1\n",
                                        "9223372036854775806 9223372036854775807 -9223372036854775808 "
                                        "-9223372036854775807")),
              HasSubstr("numbered one after the other"));
}

TEST(MeshShare, Gmsh4BlocksAreEntities) {
  const std::string head =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 5 \"steel\"\n"
      "$EndPhysicalNames\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 2 5 6 0\n$EndEntities\n";
  const std::string nodes =
      "$Nodes\n2 4 1 4\n3 1 0 1\n1\n0 0 0\n3 1 0 3\n2\n3\n4\n1 0 0\n0 1 0\n0 0 1\n"
      "$EndNodes\n";
  const std::string cells = "$Elements\n2 2 1 2\n2 1 3 1\n1 1 2 3 4\n3 1 4 1\n2 1 2 3 4\n$EndElements\n";
  const TemporaryFolder folder;
  const auto path = folder / "a.msh";
  io::samples::write_bytes(path, head + nodes + cells + "$Periodic\n0\n$EndPeriodic\n");
  const auto shares = read_shares(path, 2, 10);
  const MeshData mesh = put_together(shares);
  EXPECT_EQ(mesh.regions, std::vector<int>{5});
  EXPECT_EQ(mesh.names.at({3, 5}), "steel");
  EXPECT_THAT(shares[1].notes,
              testing::UnorderedElementsAre(HasSubstr("in several physical groups; the first is taken"),
                                            HasSubstr("1 quadrangles left out"), HasSubstr("$Periodic")));
  const auto found = [](const std::string& bytes) { return refusal_of("a.msh", bytes); };
  std::string other = nodes;
  other.replace(other.find("2 4 1 4"), 7, "2 5 1 4");
  EXPECT_THAT(found(head + other + cells), HasSubstr("5 nodes are announced, but the blocks hold 4"));
  other = nodes;
  other.replace(other.find("3 1 0 3"), 7, "3 1 0 9");
  EXPECT_THAT(found(head + other + cells), HasSubstr("9 nodes are announced"));
}

}  // namespace
}  // namespace hfr::test
