// SPDX-License-Identifier: BSD-3-Clause
// What a broken .msh file is told: one line that says where.
#include <gmock/gmock.h>

#include "IO/GmshFiles.hh"

namespace hfr::io {
namespace {

using namespace gmsh_files;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

const std::string kAscii22 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
    "$Elements\n1\n1 4 2 7 1 1 2 3 4\n$EndElements\n";

const std::string kAscii41 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 7 0\n$EndEntities\n"
    "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
    "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";

class GmshCut : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, GmshCut, testing::ValuesIn(kVariants), variant_name);

TEST_P(GmshCut, FileCutAtAnyByteIsRefusedUnlessWholeSectionsAreLeft) {
  const samples::TemporaryFolder folder;
  const std::string whole = written(samples::full(), GetParam()).bytes;
  const std::size_t least = whole.find("$EndElements") + std::string("$EndElements").size();
  std::size_t refused = 0;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::string message = failure_at(folder, whole.substr(0, length));
    if (message.empty()) {
      EXPECT_GE(length, least);
      const std::string tail = whole.substr(0, length);
      const std::size_t last_section = tail.rfind('$');
      EXPECT_TRUE(tail.substr(last_section).starts_with("$End")) << "cut at " << length;
      continue;
    }
    ++refused;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, MatchesRegex("mesh.msh:( at byte)? ?[0-9]+: .+"));
  }
  EXPECT_GT(refused, whole.size() * 9 / 10);
}

TEST_P(GmshCut, AnyByteChangedIsReadOrRefusedInOneLine) {
  const samples::TemporaryFolder folder;
  const std::string whole = written(samples::full(), GetParam()).bytes;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ "\x01\x10\x7f"[at % 3]);
    EXPECT_EQ(failure_at(folder, bytes).find('\n'), std::string::npos) << "byte " << at;
  }
}

TEST(GmshBroken, TheSamplesAreWholeBeforeTheyAreBroken) {
  EXPECT_EQ(failure(kAscii22), "");
  EXPECT_EQ(failure(kAscii41), "");
}

TEST(GmshBroken, HeaderThatCannotBeRead) {
  EXPECT_THAT(failure("solid cube\n"), StartsWith("mesh.msh:1: expected $MeshFormat"));
  EXPECT_THAT(failure("$NOD\n1\n"), HasSubstr("version 1"));
  EXPECT_THAT(failure(replaced(kAscii22, "2.2 0 8", "3 0 8")), StartsWith("mesh.msh:2: this version"));
  EXPECT_THAT(failure(replaced(kAscii22, "2.2 0 8", "2.2 2 8")), HasSubstr("0 (ASCII) or 1 (binary)"));
  EXPECT_THAT(failure("$MeshFormat\n4.1 1 4\n"), HasSubstr("numbers of 4 bytes"));
  EXPECT_THAT(failure("$MeshFormat\n4.1 1 8\nabcd\n$EndMeshFormat\n"), StartsWith("mesh.msh: at byte 20: "));
}

TEST(GmshBroken, CountsBeyondTheFileAreRefusedBeforeAnythingIsAllocated) {
  const std::string huge = "1000000000000000000";
  EXPECT_THAT(failure(replaced(kAscii22, "$Nodes\n4", "$Nodes\n" + huge)),
              StartsWith("mesh.msh:5: " + huge + " nodes"));
  EXPECT_THAT(failure(replaced(kAscii22, "$Elements\n1\n", "$Elements\n" + huge + "\n")),
              HasSubstr("elements"));
  EXPECT_THAT(failure(replaced(kAscii41, "1 4 1 4", "1 " + huge + " 1 4")), HasSubstr("nodes are announced"));
  EXPECT_THAT(failure(replaced(kAscii41, "1 4 1 4", huge + " 4 1 4")), HasSubstr("blocks are announced"));
  EXPECT_THAT(failure(replaced(kAscii41, "1 1 1 1\n3", "1 " + huge + " 1 1\n3")), HasSubstr("elements"));
  EXPECT_THAT(failure(replaced(kAscii41, "0 0 0 1\n1", "0 0 0 " + huge + "\n1")), HasSubstr("entities"));
  EXPECT_THAT(failure(replaced(kAscii41, "1 1 1 1 7 0", "1 1 1 " + huge + " 7 0")),
              HasSubstr("physical groups"));
  EXPECT_THAT(failure(replaced(kAscii41, "$Entities", "$PhysicalNames\n" + huge + "\n$Entities")),
              HasSubstr("physical names"));
  EXPECT_THAT(failure(kAscii41 + "$NodeData\n0\n0\n3\n0\n1\n" + huge + "\n1 2\n$EndNodeData\n"),
              HasSubstr("values"));
  EXPECT_THAT(failure(replaced(kAscii22, "$Nodes\n4", "$Nodes\n-4")), HasSubstr("negative"));
}

TEST(GmshBroken, HugeCountInABinaryFileIsRefused) {
  Bytes file;
  file.text("$MeshFormat\n4.1 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n$Nodes\n");
  file.put<std::uint64_t>({1, ~std::uint64_t{0}, 1, 4});
  EXPECT_THAT(failure(file.str()), MatchesRegex("mesh.msh: at byte 55: 18446744073709551615 nodes .*"));
}

TEST(GmshBroken, CountsThatDoNotAgree) {
  EXPECT_THAT(failure(replaced(kAscii41, "3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n",
                               "3 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n")),
              HasSubstr("4 nodes are announced, but the blocks hold 3"));
  EXPECT_THAT(failure(replaced(kAscii41, "3 1 0 4\n", "3 1 0 5\n")),
              StartsWith("mesh.msh:10: a block holds 5 nodes"));
  EXPECT_THAT(failure(replaced(kAscii22, "$Elements\n1\n", "$Elements\n2\n")), StartsWith("mesh.msh:"));
  EXPECT_THAT(failure(replaced(kAscii22, "$Nodes\n4", "$Nodes\n3")),
              HasSubstr("expected $EndNodes and found '4'"));
}

TEST(GmshBroken, NodesThatAreNotThereOrThereTwice) {
  EXPECT_EQ(failure(replaced(kAscii22, "1 2 3 4\n", "1 2 3 5\n")), "mesh.msh:13: there is no node 5");
  EXPECT_EQ(failure(replaced(kAscii41, "1 1 2 3 4", "1 1 2 3 -4")), "mesh.msh:23: there is no node -4");
  EXPECT_THAT(failure(replaced(kAscii22, "4 0 0 1", "3 0 0 1")), HasSubstr("node 3 is given twice"));
  EXPECT_THAT(failure(replaced(replaced(kAscii22, "4 0 0 1", "900 0 0 1"), "1 0 0 0", "900 0 0 0")),
              HasSubstr("node 900 is given twice"));
  EXPECT_THAT(failure(kAscii41 + "$NodeData\n0\n0\n3\n0\n1\n1\n5 2\n$EndNodeData\n"), HasSubstr("no node 5"));
}

TEST(GmshBroken, CoordinatesThatAreNotFinite) {
  EXPECT_THAT(failure(replaced(kAscii22, "2 1 0 0", "2 nan 0 0")), StartsWith("mesh.msh:7: "));
  Bytes file;
  file.text("$MeshFormat\n2.2 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n$Nodes\n1\n");
  file.put<int>({1}).put<double>({0, 1e308 * 10, 0}).text("\n$EndNodes\n");
  EXPECT_EQ(failure(file.str()), "mesh.msh: at byte 61: a coordinate is not a finite number");
}

TEST(GmshBroken, ElementsOtherThanSimplicesAreRefusedByName) {
  EXPECT_THAT(failure(replaced(kAscii22, "1 4 2 7 1 1 2 3 4", "1 5 2 7 1 1 2 3 4 1 2 3 4")),
              StartsWith("mesh.msh:13: hexahedra (Gmsh element type 5) cannot be read"));
  EXPECT_THAT(failure(replaced(kAscii41, "3 1 4 1\n", "3 1 6 1\n")), HasSubstr("prisms"));
  EXPECT_THAT(failure(replaced(kAscii41, "3 1 4 1\n", "3 1 7 1\n")), HasSubstr("pyramids"));
  EXPECT_THAT(failure(replaced(kAscii41, "3 1 4 1\n", "3 1 4711 1\n")),
              HasSubstr("unknown Gmsh element type 4711"));
}

TEST(GmshBroken, SectionsInTheWrongPlace) {
  const std::size_t elements = kAscii22.find("$Elements");
  const std::string nodes = kAscii22.substr(kAscii22.find("$Nodes"), elements - kAscii22.find("$Nodes"));
  EXPECT_THAT(failure(kAscii22.substr(0, elements) + nodes), HasSubstr("a second section of nodes"));
  EXPECT_THAT(failure(kAscii22 + kAscii22.substr(elements)), HasSubstr("a second $Elements section"));
  EXPECT_THAT(failure(replaced(kAscii22, nodes, "")), HasSubstr("$Elements stands before $Nodes"));
  EXPECT_THAT(failure(kAscii22.substr(0, elements)), HasSubstr("without an $Elements section"));
  EXPECT_THAT(failure(kAscii22.substr(0, kAscii22.find("$Nodes"))), HasSubstr("without a $Nodes section"));
  EXPECT_THAT(failure(kAscii22 + "$Surface\n1\n"), HasSubstr("section $Surface is not closed"));
  EXPECT_THAT(failure(kAscii22 + "stray\n"), HasSubstr("expected the name of a section"));
}

TEST(GmshBroken, FieldsThatMakeNoSense) {
  EXPECT_THAT(failure(kAscii41 + "$NodeData\n0\n0\n3\n0\n0\n1\n1\n$EndNodeData\n"),
              HasSubstr("0 components"));
  EXPECT_THAT(failure(kAscii41 + "$NodeData\n0\n0\n1\n0\n$EndNodeData\n"), HasSubstr("3 integer tags"));
}

}  // namespace
}  // namespace hfr::io
