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
#include <string>
#include <utility>
#include <vector>

#include "IO/ShareTests.hh"
#include "IO/WritableFormats.hh"

namespace hfr::test {
namespace {

using testing::HasSubstr;

/// The ways to write what is read in ranges.
const std::vector<io::samples::FormatVariant> kFormats = {{".mesh", {}},
                                                          {".meshb", {}},
                                                          {".msh", {false, "2.2"}},
                                                          {".msh", {true, "2.2"}},
                                                          {".msh", {false, "4.0"}},
                                                          {".msh", {true, "4.0"}},
                                                          {".msh", {false, "4.1"}},
                                                          {".msh", {true, "4.1"}},
                                                          {".vtu", {}}};

/// The bytes of a small file with all that there may be.
std::string full_file(const io::samples::FormatVariant& format) {
  const TemporaryFolder folder;
  const auto path = folder / ("a" + format.extension);
  io::write_mesh(path, io::samples::full(), format.options);
  return io::samples::read_bytes(path);
}

TEST(MeshShare, SharesOfAnyNumberOfProcessesAreTheFile) {
  const TemporaryFolder folder;
  for (const auto& format : kFormats)
    for (unsigned seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE(format.name() + " " + std::to_string(seed));
      const auto path = folder / ("a" + format.extension);
      io::write_mesh(path, seed == 0 ? io::samples::full() : labelled_box(seed), format.options);
      expect_shares_of(path);
    }
}

TEST(MeshShare, WhatIsNotReadIsSaid) {
  const TemporaryFolder folder;
  const auto path = folder / "a.msh";
  for (const bool binary : {false, true}) {
    io::write_mesh(path, io::samples::full(), {binary, "4.1"});
    EXPECT_THAT(read_shares(path, 2, 10)[1].notes,
                testing::UnorderedElementsAre(HasSubstr("fields on points ($NodeData) left out"),
                                              HasSubstr("fields on cells ($ElementData) left out")));
  }
}

TEST(MeshShare, AFileThatEndsAnywhereIsRefusedOrReadAsAWholeOne) {
  for (const auto& format : kFormats) {
    SCOPED_TRACE(format.name());
    BrokenShares broken;
    ASSERT_NO_FATAL_FAILURE(broken.end_anywhere(format.extension, full_file(format)));
    EXPECT_GT(broken.n_refused, 200);
  }
}

TEST(MeshShare, ChangedBytesAreRefusedOrReadAsByAWholeReader) {
  for (const auto& format : kFormats) {
    SCOPED_TRACE(format.name());
    BrokenShares broken;
    ASSERT_NO_FATAL_FAILURE(broken.change_bytes(format.extension, full_file(format), 1500));
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
  EXPECT_THAT(found("MFEM mesh v1.0\n"), HasSubstr("a mesh of MFEM's own format"));
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
  // A keyword inside a line is one to a reader of the whole.
  EXPECT_THAT(found(good + "Unknown 1 RequiredVertices 1\n1\n"), HasSubstr("RequiredVertices stands inside"));
  EXPECT_THAT(found(good + "Normals\n2\n0 0 1\n0 1 0 Corners 1\n"), HasSubstr("Corners stands inside"));
  EXPECT_THAT(found(good + "Corners 0 RequiredVertices 1\n1\n"), HasSubstr("there is more on this line"));
  EXPECT_THAT(found(good + "Corners 0\n1\n"), HasSubstr("more entries than it says"));
  EXPECT_THAT(found("MeshVersionFormatted 2 Corners 0\n" + good.substr(23)), HasSubstr("more on this line"));
  EXPECT_THAT(found("MeshVersionFormatted 2\n1 Corners 0\n" + good.substr(23)),
              HasSubstr("MeshVersionFormatted: a keyword has to follow"));
  EXPECT_EQ(found(good + "Unknown words\nin lines # Corners\n"), "");
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
  EXPECT_THAT(changed(28, 5), HasSubstr("5 entries")) << "the fifth would be the heading of the next section";
  EXPECT_THAT(changed(32 + 4 * 28 + 12, 5), HasSubstr("vertex 5 is out of range"));
}

}  // namespace
}  // namespace hfr::test
