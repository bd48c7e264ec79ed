// SPDX-License-Identifier: BSD-3-Clause
// .msh of all versions in ranges: text, and bytes of either order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "IO/GmshFiles.hh"
#include "IO/ShareTests.hh"

namespace hfr::test {
namespace {

using io::gmsh_files::Bytes;
using testing::HasSubstr;

const std::string kGmshPoints =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";

/// `nodes` in four lines, then one tetrahedron of the corners.
std::string gmsh2(const std::string& nodes, const std::string& corners) {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n" + nodes + "$EndNodes\n$Elements\n1\n1 4 2 0 1 " +
         corners + "\n$EndElements\n";
}

TEST(GmshShare, Gmsh2FilesThatCannotBeReadInRangesSayWhy) {
  const auto found = [](const std::string& bytes) { return refusal_of("a.msh", bytes); };
  const auto elements = [](const std::string& lines) {
    return kGmshPoints + "$Elements\n" + lines + "$EndElements\n";
  };
  const std::string cell = "1 4 2 0 1 1 2 3 4\n", good = elements("1\n" + cell);
  EXPECT_EQ(found(good), "");
  EXPECT_EQ(found(elements("4\n1 15 2 7 1 2\n2 15 2 0 2 3\n3 1 2 0 1 1 2\n4 4 2 7 1 1 2 3 4\n")), "");
  EXPECT_THAT(found("x\n"), HasSubstr("expected $MeshFormat"));
  EXPECT_THAT(found("$MeshFormat\n"), HasSubstr("the file ends"));
  EXPECT_THAT(found("\n$MeshFormat\n2.2 0 8\n"), HasSubstr("is not closed"));
  EXPECT_THAT(found("$MeshFormat\n3 0 8\n"), HasSubstr("this version of Gmsh's format cannot be read"));
  EXPECT_THAT(found("$MeshFormat\n2.2 2 8\n"), HasSubstr("0 (ASCII) or 1 (binary)"));
  EXPECT_THAT(found("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"), HasSubstr("without a $Nodes section"));
  EXPECT_THAT(found(kGmshPoints), HasSubstr("without an $Elements section"));
  EXPECT_THAT(found(kGmshPoints + "$Elements\n1\n"), HasSubstr("is not closed"));
  EXPECT_THAT(found(good + "$Elements\n1\n" + cell + "$EndElements\n"), HasSubstr("a second $Elements"));
  EXPECT_THAT(found(good + kGmshPoints.substr(kGmshPoints.find("$Nodes"))), HasSubstr("a second section of"));
  EXPECT_THAT(found(good + "$ParametricNodes\n$EndParametricNodes\n"), HasSubstr("$ParametricNodes"));
  EXPECT_THAT(found(elements("9\n" + cell)), HasSubstr("9 elements are announced"));
  EXPECT_THAT(found(kGmshPoints + "$Elements 2\n" + cell + "2" + cell.substr(1) + "$EndElements\n"),
              HasSubstr("each entry on a line of its own"))
      << "whole readers take it";
  EXPECT_THAT(found(elements("1\n" + cell + cell)),
              HasSubstr("section $Elements has another number of lines"));
  EXPECT_THAT(found(elements("1\n1 4 2 0 1 1 2 3 9\n")), HasSubstr("there is no node 9"));
  EXPECT_THAT(found(elements("1\n1 4 2 0 1 1 2 3 3\n")), HasSubstr("has node 3 twice"));
  EXPECT_THAT(found(elements("1\n1 5 2 0 1 1 2 3 4 1 2 3 4\n")), HasSubstr("hexahedra"));
  EXPECT_THAT(found(elements("1\n1 99999 2 0 1 1 2 3 4\n")), HasSubstr("unknown Gmsh element type 99999"));
  EXPECT_THAT(found(elements("1\n1 11 2 0 1 1 2 3 4 1 2 3 4 1 2\n")), HasSubstr("of first order"));
  EXPECT_THAT(found(elements("2\n1 4 2 7 1 1 2 3 4\n2 4 2 8 1 1 2 3 4\n")),
              HasSubstr("in several physical groups"));
  EXPECT_EQ(found(elements("2\n1 3 2 0 1 1 2 3 4\n" + cell)), "") << "a quadrangle";
}

TEST(GmshShare, NodesMayHaveAnyTags) {
  const TemporaryFolder folder;
  const auto path = folder / "a.msh";
  for (const auto& t : std::vector<std::array<std::string, 4>>{
           {"5", "6", "7", "8"},
           {"-2", "-1", "0", "1"},
           {"1", "2", "7", "4"},
           {"9", "8", "7", "6"},
           {"9223372036854775806", "9223372036854775807", "-9223372036854775808", "-9223372036854775807"}}) {
    io::samples::write_bytes(
        path, gmsh2(t[0] + " 0 0 0\n" + t[1] + " 1 0 0\n" + t[2] + " 0 1 0\n" + t[3] + " 0 0 1\n",
                    t[3] + " " + t[1] + " " + t[2] + " " + t[0]));
    for (const std::size_t n : {1, 2, 4})
      EXPECT_EQ(put_together(read_shares(path, n, 10)).cells[0], (std::array<Index, 4>{3, 1, 2, 0})) << t[0];
  }
}

TEST(GmshShare, NodesThatAreNotThereOrThereTwice) {
  const auto found = [](const std::string& tags, const std::string& corners) {
    std::string lines;
    for (const char tag : tags) lines += std::string(1, tag) + " 0 0 0\n";
    return refusal_of("a.msh", gmsh2(lines, corners));
  };
  EXPECT_THAT(found("1274", "1 2 7 3"), HasSubstr("there is no node 3"));
  EXPECT_THAT(found("1274", "1 2 7 0"), HasSubstr("there is no node 0"));
  EXPECT_THAT(found("1274", "1 2 7 8"), HasSubstr("there is no node 8"));
  EXPECT_THAT(found("1231", "1 2 3 1"), HasSubstr("node 1 is given twice"));
  EXPECT_THAT(found("1232", "1 2 3 1"), HasSubstr("node 2 is given twice"));
  EXPECT_THAT(found("3123", "1 2 3 1"), HasSubstr("node 3 is given twice"));
}

TEST(GmshShare, NodesNumberedInTooManyPiecesAreRefused) {
  const int n_pieces = (1 << 20) + 1;
  Bytes file;
  file.text("$MeshFormat\n2.2 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n$Nodes\n");
  file.text(std::to_string(n_pieces) + "\n");
  const std::string head = file.str();
  std::string nodes(28 * static_cast<std::size_t>(n_pieces), '\0');
  for (int i = 0; i < n_pieces; ++i) {
    const int tag = 2 * i;
    std::memcpy(nodes.data() + 28 * i, &tag, sizeof tag);
  }
  const std::string elements = Bytes()
                                   .text("\n$EndNodes\n$Elements\n1\n")
                                   .put<int>({4, 1, 2, 1, 0, 1, 0, 2, 4, 6})
                                   .text("\n$EndElements\n")
                                   .str();
  EXPECT_THAT(refusal_of("a.msh", head + nodes + elements), HasSubstr("in more than 1048576 pieces"));
  const int one_after_the_other = 1;
  std::memcpy(nodes.data() + 28, &one_after_the_other, sizeof one_after_the_other);
  EXPECT_THAT(refusal_of("a.msh", head + nodes + elements), HasSubstr("there is no node 2"));
}

TEST(GmshShare, Gmsh4BlocksAreEntities) {
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

/// How a program writes a binary file.
struct Style {
  std::string version;
  bool is_swapped = false;
  std::size_t at_once = 1;     ///< elements behind one heading, at most
  bool has_partitions = true;  ///< in version 2: some elements, which then have more tags than others

  std::string name() const {
    return version + (is_swapped ? " other order, " : " own order, ") + std::to_string(at_once) + " at once";
  }
};

std::vector<Style> styles() {
  std::vector<Style> all;
  for (const char* const version : {"2.2", "4.0", "4.1"})
    for (const bool is_swapped : {false, true})
      for (const std::size_t at_once : {1, 7, 1000}) all.push_back({version, is_swapped, at_once});
  return all;
}

/// A mesh as other programs write it: kinds of elements in any order, tags of any number, quadrangles, nodes
/// in several blocks and with parameters, blocks that are empty, sections between and behind that say
/// nothing.
class BinaryGmsh {
 public:
  BinaryGmsh(const MeshData& mesh, const Style& style, unsigned seed)
      : style_(style), mesh_(mesh), random_(seed), file_(style.is_swapped) {
    list_elements();
    file_.text("$MeshFormat\n" + style.version + " 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n");
    file_.text("$PhysicalNames\n1\n3 101 \"steel\"\n$EndPhysicalNames\n");
    file_.text("$Comments\n" + std::string(700, '$') + "\n$EndCommentsOf\n$EndComments\n");
    if (!is_2()) put_entities();
    file_.text("$Nodes\n");
    is_2() ? put_nodes2() : put_nodes4();
    file_.text("\n$EndNodes\n$Elements\n");
    is_2() ? put_elements2() : put_elements4();
    file_.text("\n$EndElements\n$NodeData\n1\n\"v\"\n1\n0\n3\n0\n3\n2\n");
    for (const int tag : {1, 2}) file_.put<int>({tag}).put<double>({1, 2, 3});
    file_.text("\n$EndNodeData\n$Periodic\n").put<int>({1, 2, 3}).text("\n$EndPeriodic\n");
  }
  const std::string& bytes() const { return file_.str(); }

 private:
  struct Item {
    int type = 0, entity = 0;
    std::vector<int> nodes;
    bool is_like(const Item& other) const { return type == other.type && entity == other.entity; }
  };

  bool is_2() const { return style_.version == "2.2"; }
  std::size_t some(std::size_t n) { return random_() % n; }
  template <class Elements>
  void list(int type, const Elements& elements, const std::vector<int>& labels) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      Item& item = items_.emplace_back();
      item.type = type;
      item.entity = labels[i];
      for (const Index node : elements[i]) item.nodes.push_back(static_cast<int>(node) + 1);
    }
  }
  void list_elements() {
    list(4, mesh_.cells, mesh_.regions);
    list(2, mesh_.triangles, mesh_.triangle_labels);
    list(1, mesh_.edges, mesh_.edge_labels);
    list(3, std::vector<std::array<Index, 4>>(5, {0, 1, 2, 3}), std::vector<int>(5, 40));
    for (std::size_t i = 0; i < mesh_.vertex_labels.size(); ++i)
      if (mesh_.vertex_labels[i] != 0)
        items_.push_back({15, mesh_.vertex_labels[i], {static_cast<int>(i) + 1}});
    if (style_.at_once == 1)
      std::shuffle(items_.begin(), items_.end(), random_);
    else
      std::stable_sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
        return std::pair(a.type, a.entity) < std::pair(b.type, b.entity);
      });
  }
  void put_tag(std::size_t tag) {
    if (style_.version == "4.1")
      file_.put<std::uint64_t>({tag});
    else
      file_.put<int>({static_cast<int>(tag)});
  }
  void put_totals(std::size_t blocks, std::size_t items) {
    file_.put<std::uint64_t>({blocks, items});
    if (style_.version == "4.1") file_.put<std::uint64_t>({1, items});
  }
  void put_heading(int dimension, int entity, int kind, std::size_t n) {
    if (style_.version == "4.0") std::swap(dimension, entity);
    file_.put<int>({dimension, entity, kind}).put<std::uint64_t>({n});
  }
  /// Of all labels but the last ones, whose elements are in no group.
  void put_entities() {
    file_.text("$Entities\n").put<std::uint64_t>({0, 1, 1, 2});
    const auto put = [&](int tag, const std::vector<int>& groups) {
      file_.put<int>({tag}).put<double>({0, 0, 0, 1, 1, 1}).put<std::uint64_t>({groups.size()});
      file_.put<int>(groups).put<std::uint64_t>({0});
    };
    put(20, {120});
    put(11, {-111, 5});
    put(1, {101});
    put(2, {102, 101});
    file_.text("\n$EndEntities\n");
  }
  void put_point(std::size_t i) {
    for (int k = 0; k < 3; ++k) file_.put<double>({mesh_.points[i][k]});
  }
  void put_nodes2() {
    file_.text(std::to_string(mesh_.points.size()) + "\n");
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      file_.put<int>({static_cast<int>(i) + 1});
      put_point(i);
    }
  }
  void put_nodes4() {
    const std::size_t n = mesh_.points.size(), each = 9;
    put_totals((n + each - 1) / each + 1, n);
    for (std::size_t begin = 0; begin < n; begin += each) {
      const std::size_t end = std::min(begin + each, n);
      const int dimension = static_cast<int>(some(4)), is_parametric = static_cast<int>(some(2));
      if (begin == each) put_heading(1, 7, 0, 0);
      put_heading(dimension, 1, is_parametric, end - begin);
      const auto put = [&](std::size_t i) {
        put_point(i);
        for (int k = 0; k < dimension * is_parametric; ++k) file_.put<double>({0.5});
      };
      for (std::size_t i = begin; i < end; ++i) {
        put_tag(i + 1);
        if (style_.version == "4.0") put(i);
      }
      for (std::size_t i = begin; style_.version == "4.1" && i < end; ++i) put(i);
    }
  }
  /// use(begin, end) for runs of elements that may stand behind one heading.
  template <class Use>
  void for_runs(Use&& use) const {
    for (std::size_t begin = 0, end = 0; begin < items_.size(); begin = end) {
      while (end < items_.size() && end - begin < style_.at_once && items_[end].is_like(items_[begin])) ++end;
      use(begin, end);
    }
  }
  void put_elements2() {
    file_.text(std::to_string(items_.size()) + "\n");
    for_runs([&](std::size_t begin, std::size_t end) {
      const std::vector<std::vector<int>> more = {{}, {0}, {1, 3}};
      const std::vector<int>& partitions = more[some(style_.has_partitions ? more.size() : 1)];
      file_.put<int>(
          {items_[begin].type, static_cast<int>(end - begin), 2 + static_cast<int>(partitions.size())});
      for (std::size_t i = begin; i < end; ++i) {
        const Item& item = items_[i];
        file_.put<int>({static_cast<int>(i) + 1, item.entity + 100, item.entity});
        file_.put<int>(partitions).put<int>(item.nodes);
      }
    });
  }
  void put_elements4() {
    std::size_t n_runs = 0;
    for_runs([&](std::size_t, std::size_t) { ++n_runs; });
    put_totals(n_runs + 2, items_.size());
    put_heading(3, 2, 4, 0);
    for_runs([&](std::size_t begin, std::size_t end) {
      const int type = items_[begin].type, dimension = type == 15 ? 0 : type == 3 ? 2 : std::min(type, 3);
      put_heading(dimension, items_[begin].entity, type, end - begin);
      for (std::size_t i = begin; i < end; ++i) {
        put_tag(i + 1);
        for (const int node : items_[i].nodes) put_tag(static_cast<std::size_t>(node));
      }
    });
    put_heading(3, 1, 4, 0);
  }

  Style style_;
  MeshData mesh_;
  std::mt19937_64 random_;
  Bytes file_;
  std::vector<Item> items_;
};

TEST(GmshShare, BinaryFilesOfOtherProgramsAreReadInAnyNumberOfShares) {
  const TemporaryFolder folder;
  const auto path = folder / "a.msh";
  for (const Style& style : styles()) {
    SCOPED_TRACE(style.name());
    io::samples::write_bytes(path, BinaryGmsh(labelled_box(1), style, 1).bytes());
    expect_shares_of(path);
    const auto notes = read_shares(path, 3, 10)[2].notes;
    EXPECT_THAT(notes,
                testing::IsSupersetOf({HasSubstr("fields on points ($NodeData) left out"),
                                       HasSubstr("5 quadrangles left out"), HasSubstr("($Periodic)")}));
    EXPECT_EQ(notes.size(), style.version == "2.2" ? 3U : 4U)
        << "one line for two entities in several groups";
  }
}

TEST(GmshShare, BinaryFilesOfOtherProgramsThatEndAnywhereOrHaveOtherBytes) {
  MeshData mesh = labelled_box(2);
  const auto keep = [](auto& values, std::size_t n) { values.resize(std::min(values.size(), n)); };
  keep(mesh.cells, 6);
  keep(mesh.triangles, 3);
  keep(mesh.edges, 2);
  keep(mesh.points, 14);
  keep(mesh.vertex_labels, 14);
  for (std::size_t i = 0; i < mesh.cells.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) mesh.cells[i][k] = static_cast<Index>(2 * i + k) % 14;
  for (auto& triangle : mesh.triangles) triangle = {0, 1, 2};
  for (auto& edge : mesh.edges) edge = {3, 4};
  for (const Style& style : styles()) {
    if (style.at_once != (style.is_swapped ? 7 : 1)) continue;  // each takes some time
    SCOPED_TRACE(style.name());
    const std::string good = BinaryGmsh(mesh, style, 3).bytes();
    BrokenShares broken;
    ASSERT_NO_FATAL_FAILURE(broken.end_anywhere(".msh", good));
    EXPECT_GT(broken.n_refused, 1000);
    ASSERT_NO_FATAL_FAILURE(broken.change_bytes(".msh", good, 400));
    EXPECT_GT(broken.n_same, 50);
  }
}

/// How often all have to be heard until a file is read. `n`: of processes.
std::size_t n_meetings(const std::filesystem::path& path, std::size_t n) {
  std::size_t n_gathered = 0;
  io::samples::Meeting meeting(n);
  std::vector<std::thread> threads;
  for (std::size_t rank = 1; rank < n; ++rank)
    threads.emplace_back([&, rank] { io::samples::read_share(path, meeting.as(rank), 1000); });
  io::Processes first = meeting.as(0);
  first.all_gather = [&, gather = first.all_gather](std::span<const std::byte> mine) {
    ++n_gathered;
    return gather(mine);
  };
  io::samples::read_share(path, first, 1000);
  for (std::thread& thread : threads) thread.join();
  return n_gathered;
}

/// A file is cut into 16 stretches for each process. Gmsh writes a heading for each element of version 2.
TEST(GmshShare, HeadingsAreFoundTogetherWhereBlocksAreAlike) {
  const generate::Arrays box = generate::box({12, 12, 12});
  MeshData mesh;
  mesh.points = box.points;
  for (const auto& cell : box.cells) {
    auto& v = mesh.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) v[k] = static_cast<Index>(cell[k]);
    mesh.regions.push_back(1);
  }
  const TemporaryFolder folder;
  const auto path = folder / "a.msh";
  const auto n_meetings_of = [&](const Style& style, std::size_t n_processes) {
    io::samples::write_bytes(path, BinaryGmsh(mesh, style, 1).bytes());
    return n_meetings(path, n_processes);
  };
  constexpr std::size_t kStretches = 16, kOthers = 20;
  for (const std::size_t n : {1, 2, 4}) {
    const std::size_t alike = n_meetings_of({"2.2", false, 1, false}, n);
    EXPECT_LT(alike, kStretches + kOthers);
    const std::size_t unlike = n_meetings_of({"2.2", false, 1, true}, n);
    EXPECT_LT(unlike, kStretches * n + kOthers) << "a stretch at a time, where guesses go wrong";
    if (n > 1) {
      EXPECT_GT(unlike, alike);
    }
    EXPECT_LT(n_meetings_of({"2.2", false, 1'000'000, false}, n), kOthers) << "one block";
  }
}

TEST(GmshShare, BinaryFilesThatCannotBeReadInRangesSayWhy) {
  const auto found = [](const Bytes& file) { return refusal_of("a.msh", file.str()); };
  const auto head = [](const std::string& version) {
    Bytes file;
    return file.text("$MeshFormat\n" + version + " 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n");
  };
  const auto nodes2 = [&](const std::string& count = "4") {
    Bytes file = head("2.2").text("$Nodes\n" + count + "\n");
    for (int i = 0; i < 4; ++i)
      file.put<int>({i + 1}).put<double>({1.0 * (i == 1), 1.0 * (i == 2), 1.0 * (i == 3)});
    return file.text("\n$EndNodes\n");
  };
  const auto elements2 = [&](const std::string& count, const std::vector<int>& numbers) {
    return nodes2().text("$Elements\n" + count + "\n").put<int>(numbers).text("\n$EndElements\n");
  };
  const std::vector<int> cell = {4, 1, 2, 1, 0, 1, 1, 2, 3, 4};
  const Bytes good = elements2("1", cell);
  EXPECT_EQ(found(good), "");
  EXPECT_THAT(found(Bytes().text("$MeshFormat\n2.2 1 8\n").put<int>({2})), HasSubstr("the byte order"));
  EXPECT_THAT(found(Bytes().text("$MeshFormat\n2.2 1 4\n").put<int>({1})), HasSubstr("numbers of 4 bytes"));
  EXPECT_THAT(found(head("2.2").text("Nodes\n")), HasSubstr("expected the name of a section"));
  EXPECT_THAT(found(head("2.2")), HasSubstr("without a $Nodes section"));
  EXPECT_THAT(found(nodes2()), HasSubstr("without an $Elements section"));
  EXPECT_THAT(found(nodes2("5")), HasSubstr("5 nodes are announced"));
  EXPECT_THAT(found(nodes2("3")), HasSubstr("expected $EndNodes"));
  EXPECT_THAT(found(nodes2("99999999999999999999")), HasSubstr("expected a count"));
  EXPECT_THAT(found(nodes2("18446744073709551615")), HasSubstr("18446744073709551615 nodes are announced"));
  EXPECT_THAT(found(nodes2("4 4")), HasSubstr("expected the end of the line before binary data"));
  EXPECT_THAT(found(head("2.2").text("$Elements\n0\n")), HasSubstr("stands before $Nodes"));
  EXPECT_THAT(found(head("2.2").text("$Elements\n0")), HasSubstr("stands before $Nodes"));
  EXPECT_THAT(found(head("2.2").text("$NodeData\n0")), HasSubstr("before $Nodes and $Elements"));
  EXPECT_THAT(found(head("2.2").text("$ParametricNodes\n0\n")), HasSubstr("are not read in ranges"));
  EXPECT_THAT(found(head("2.2").text("$PhysicalNames\n1\n")), HasSubstr("is not closed"));
  EXPECT_THAT(found(nodes2().text("$Nodes\n0\n")), HasSubstr("a second section of nodes"));
  EXPECT_THAT(found(elements2("1", cell).text("$Elements\n0\n")), HasSubstr("a second $Elements section"));
  EXPECT_THAT(found(elements2("1", cell).text("$Periodic\n")), HasSubstr("$Periodic is not closed"));
  EXPECT_THAT(found(elements2("0", {})), HasSubstr("it has no cells"));
  EXPECT_THAT(found(elements2("0", cell)), HasSubstr("expected $EndElements"));
  EXPECT_THAT(found(elements2("99999", cell)), HasSubstr("99999 elements are announced"));
  EXPECT_THAT(found(elements2("1", {4, 2, 2})), HasSubstr("2 elements follow where 1 to 1"));
  EXPECT_THAT(found(elements2("1", {4, 0, 2})), HasSubstr("0 elements follow"));
  EXPECT_THAT(found(elements2("1", {4, 1, 1 << 20})), HasSubstr("an element with 1048576 tags"));
  EXPECT_THAT(found(elements2("1", {4, 1, 1 << 15, 1, 2})), HasSubstr("1 elements are announced"));
  EXPECT_THAT(found(elements2("1", {5, 1, 2, 1, 0, 1, 1, 2, 3, 4, 1, 2, 3, 4})), HasSubstr("hexahedra"));
  EXPECT_THAT(found(elements2("1", {11, 1, 2})), HasSubstr("of first order"));
  EXPECT_THAT(found(elements2("1", {999, 1, 2})), HasSubstr("unknown Gmsh element type 999"));
  EXPECT_THAT(found(elements2("1", {4, 1, 2, 1, 0, 1, 1, 2, 3, 9})), HasSubstr("there is no node 9"));
  EXPECT_THAT(found(elements2("1", {4, 1, 2, 1, 0, 1, 1, 2, 3, 3})), HasSubstr("has node 3 twice"));
  EXPECT_THAT(found(elements2("2", {4, 2, 2, 1, 7, 1, 1, 2, 3, 4, 2, 8, 1, 1, 2, 3, 4})),
              HasSubstr("in several physical groups"));
  EXPECT_THAT(found(elements2("1", cell).text("$NodeData\n0\n0\n3\n0\n1\n999999999\n")),
              HasSubstr("values are announced"));
}

TEST(GmshShare, BlocksOfBinaryFilesAreWhatWasAnnounced) {
  const auto found = [](const Bytes& file) { return refusal_of("a.msh", file.str()); };
  using Wide = std::vector<std::uint64_t>;
  constexpr auto kHuge = ~std::uint64_t{0};
  const auto nodes = [](const Wide& totals, std::uint64_t n, int dimension = 3, int is_parametric = 0) {
    Bytes file;
    file.text("$MeshFormat\n4.1 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n$Nodes\n").put(totals);
    file.put<int>({dimension, 1, is_parametric}).put<std::uint64_t>({n, 1, 2, 3, 4});
    return file.put<double>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}).text("\n$EndNodes\n");
  };
  const auto elements = [&](const Wide& totals, std::uint64_t n) {
    Bytes file = nodes({1, 4, 1, 4}, 4).text("$Elements\n").put(totals).put<int>({3, 1, 4});
    return file.put<std::uint64_t>({n, 1, 1, 2, 3, 4}).text("\n$EndElements\n");
  };
  EXPECT_EQ(found(elements({1, 1, 1, 1}, 1)), "");
  EXPECT_THAT(found(nodes({1, kHuge, 1, 4}, 4)), HasSubstr("18446744073709551615 nodes are announced"));
  EXPECT_THAT(found(nodes({kHuge, 4, 1, 4}, 4)), HasSubstr("18446744073709551615 blocks are announced"));
  EXPECT_THAT(found(nodes({1, 4, 1, 4}, kHuge)), HasSubstr("a block holds 18446744073709551615 nodes"));
  EXPECT_THAT(found(nodes({1, 5, 1, 4}, 4)), HasSubstr("5 nodes are announced, but the blocks hold 4"));
  EXPECT_THAT(found(nodes({0, 4, 1, 4}, 4)), HasSubstr("4 nodes are announced, but the blocks hold 0"));
  EXPECT_THAT(found(nodes({2, 4, 1, 4}, 4)), testing::Not(testing::IsEmpty()));
  EXPECT_THAT(found(nodes({1, 4, 1, 4}, 4, 7)), HasSubstr("nodes of an entity of dimension 7"));
  EXPECT_THAT(found(nodes({1, 4, 1, 4}, 4, 3, 1)), HasSubstr("4 nodes are announced"));
  EXPECT_THAT(found(elements({1, kHuge, 1, 1}, 1)), HasSubstr("elements are announced"));
  EXPECT_THAT(found(elements({kHuge, 1, 1, 1}, 1)), HasSubstr("blocks are announced"));
  EXPECT_THAT(found(elements({1, 1, 1, 1}, kHuge)), HasSubstr("a block holds 18446744073709551615 elements"));
  EXPECT_THAT(found(elements({1, 2, 1, 1}, 1)), HasSubstr("2 elements are announced, but the blocks hold 1"));
}

TEST(GmshShare, ALongSectionThatIsLeftOutIsLookedThroughByAll) {
  Bytes file;
  file.text("$MeshFormat\n2.2 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n");
  const std::string closing = "\n$EndX\n";
  constexpr std::size_t kPart = std::size_t{1} << 20;  // what each looks through at a time
  const std::string head = file.str() + "$X";
  Bytes rest;
  rest.text("$Nodes\n4\n");
  for (int i = 0; i < 4; ++i)
    rest.put<int>({i + 1}).put<double>({1.0 * (i == 1), 1.0 * (i == 2), 1.0 * (i == 3)});
  rest.text("\n$EndNodes\n$Elements\n1\n").put<int>({4, 1, 2, 1, 0, 1, 1, 2, 3, 4}).text("\n$EndElements\n");
  for (std::size_t n = kPart - closing.size() - 1; n <= kPart + 1; ++n) {
    std::string fill(n, '\n');
    fill.replace(n / 2, 7, "\n$EndXY");
    EXPECT_EQ(refusal_of("a.msh", head + fill + closing + rest.str()), "") << n;
  }
}

}  // namespace
}  // namespace hfr::test
