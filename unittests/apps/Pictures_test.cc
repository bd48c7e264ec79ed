// SPDX-License-Identifier: BSD-3-Clause
// --png, --report and the subcommand report. What a browser makes of the page: page_test.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>
#ifdef HFR_HAS_PNG
#include <png.h>
#endif

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "Angles.hh"
#include "Chart.hh"
#include "Font.hh"
#include "Pack.hh"
#include "Png.hh"
#include "Raster.hh"
#include "Tool.hh"
#include "hfremesh/HalfFace/Generate.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

TetMesh cavity_mesh() {
  const generate::Arrays arrays = generate::cavity();
  return build(arrays.points, arrays.cells);
}

/// What stands in the element of that id.
std::string element(const std::string& page, const std::string& id) {
  const std::size_t begin = page.find(">", page.find("id=\"" + id + "\"")) + 1;
  return page.substr(begin, page.find("</script>", begin) - begin);
}

std::string unbase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int n = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    n += 6;
    if (n < 8) continue;
    n -= 8;
    bytes.push_back(static_cast<char>(bits >> n & 255));
  }
  return bytes;
}

std::string inflated(const std::string& bytes, std::size_t size) {
  std::string out(size, '\0');
  uLongf n = size;
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.data()), &n, reinterpret_cast<const Bytef*>(bytes.data()),
                       bytes.size()),
            Z_OK);
  EXPECT_EQ(n, size);
  return out;
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

TEST(Pack, CellsSkinAnglesAndNumbersComeBack) {
  const TetMesh mesh = cavity_mesh();
  const auto degrees = view::smallest_dihedrals(mesh, {});
  std::vector<std::uint8_t> reasons(mesh.n_cells(), view::kNoReason);
  for (std::size_t i = 0; i < reasons.size(); i += 7) reasons[i] = static_cast<std::uint8_t>(i % 10);
  const view::PackedMesh packed = view::pack(mesh, degrees, reasons);
  EXPECT_TRUE(packed.has_all_cells);
  EXPECT_EQ(packed.n_cells, mesh.n_cells());
  Unpacked back(packed);
  // Numbers of vertices differ from the mesh's; coordinates tell which is which, as none is there twice.
  std::map<std::array<int, 3>, std::size_t> vertex_at;
  const auto rounded = [&](Vec3 p) {
    std::array<int, 3> at{};
    for (int i = 0; i < 3; ++i)
      at[static_cast<std::size_t>(i)] = static_cast<int>(
          std::lround(65535 * (p[i] - packed.box_low[i]) / (packed.box_high[i] - packed.box_low[i])));
    return at;
  };
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) vertex_at[rounded(mesh.point(VertexHandle(v)))] = v;
  ASSERT_EQ(vertex_at.size(), mesh.n_vertices());
  std::vector<std::size_t> vertex;  // by number in the pack
  std::array<int, 3> last{};
  for (std::size_t k = 0; k < packed.n_vertices; ++k) {
    std::array<int, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t i = axis * packed.n_vertices + k;
      const int code = static_cast<unsigned char>(back.stream("low")[i]) |
                       static_cast<unsigned char>(back.stream("high")[i]) << 8;
      const int step = code & 1 ? -((code + 1) >> 1) : code >> 1;
      at[axis] = (last[axis] + step) & 65535;
    }
    last = at;
    ASSERT_TRUE(vertex_at.contains(at));
    vertex.push_back(vertex_at[at]);
  }
  const auto corners = [](const auto& vertices) {
    std::set<std::size_t> set;
    for (const VertexHandle v : vertices) set.insert(v.idx());
    return set;
  };
  std::size_t k = 0, n_listed = 0;
  std::int64_t id = 0;
  std::map<std::set<std::size_t>, CellHandle> cells;
  for (std::size_t i = 0; i < mesh.n_cells(); ++i)
    cells[corners(mesh.cell_vertices(CellHandle(i)))] = CellHandle(i);
  for (std::size_t v = 0; v < packed.n_vertices; ++v) {
    std::uint64_t a = 0;
    for (std::uint64_t left = back.number("cell_n"); left > 0; --left, ++k) {
      a += back.number("cell_a");
      const std::uint64_t b = a + 1 + back.number("cell_b"), c = b + 1 + back.number("cell_c");
      const auto found =
          cells.find({vertex[v], vertex[back.link(v, a)], vertex[back.link(v, b)], vertex[back.link(v, c)]});
      ASSERT_NE(found, cells.end());
      const std::size_t cell = found->second.idx();
      const int code = static_cast<unsigned char>(back.stream("angle")[k]);
      EXPECT_EQ(code == 0, view::is_invalid(degrees[cell]));
      EXPECT_EQ(code == 255, degrees[cell] >= 30);
      if (code == 255) continue;
      EXPECT_EQ(code, code == 0 ? 0 : 1 + static_cast<int>(8.0 * degrees[cell]));
      const auto zigzag = static_cast<std::int64_t>(back.number("id"));
      id += zigzag % 2 == 0 ? zigzag / 2 : -(zigzag + 1) / 2;
      EXPECT_EQ(id, static_cast<std::int64_t>(cell));
      EXPECT_EQ(static_cast<unsigned char>(back.stream("reason")[n_listed++]), reasons[cell]);
    }
  }
  EXPECT_EQ(k, mesh.n_cells());
  EXPECT_EQ(n_listed, packed.n_listed);
  EXPECT_GT(n_listed, 1000U);
  std::size_t n_skin = 0;
  for (std::size_t v = 0; v < packed.n_vertices; ++v)
    for (std::uint64_t left = back.number("skin_n"); left > 0; --left, ++n_skin) {
      const std::uint64_t b = back.number("skin"), c = b + 1 + back.number("skin");
      const FaceHandle face = mesh.find_face({VertexHandle(vertex[v]), VertexHandle(vertex[back.link(v, b)]),
                                              VertexHandle(vertex[back.link(v, c)])});
      ASSERT_TRUE(face.is_valid());
      EXPECT_TRUE(mesh.is_boundary(face));
    }
  EXPECT_EQ(n_skin, 2696U);
  for (const char* name : {"link_n", "link", "cell_n", "cell_a", "cell_b", "cell_c", "id", "skin_n", "skin"})
    EXPECT_TRUE(back.at_end(name)) << name;
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

TEST(Raster, TheNearerTriangleIsSeenWhicheverIsDrawnFirst) {
  using Corners = std::array<std::array<double, 3>, 3>;
  const Corners near = {{{0, 0, 2}, {20, 0, 2}, {0, 20, 2}}}, far = {{{0, 0, 1}, {20, 0, 1}, {0, 20, 1}}};
  const view::Colour red = view::hex(0xff0000), blue = view::hex(0x0000ff);
  for (const bool near_first : {true, false}) {
    view::Raster raster(20, 20);
    raster.triangle(near_first ? near : far, near_first ? red : blue, {});
    raster.triangle(near_first ? far : near, near_first ? blue : red, {});
    view::Canvas canvas(20, 20, view::hex(0xffffff));
    raster.resolve(canvas, 0, 0);
    EXPECT_EQ(canvas.at(4, 4).r, 1.0F);
    EXPECT_EQ(canvas.at(4, 4).b, 0.0F);
    EXPECT_EQ(canvas.at(15, 15).g, 1.0F);  // beyond the slanted edge
    const float on_edge = canvas.at(10, 9).g;
    EXPECT_GT(on_edge, 0.0F);  // anti-aliased
    EXPECT_LT(on_edge, 1.0F);
  }
}

TEST(Font, EveryLetterOfAsciiLeavesAMarkOfItsOwn) {
  std::set<std::vector<std::uint8_t>> seen;
  for (char c = '!'; c <= '~'; ++c) {
    view::Canvas canvas(40, 40, view::hex(0xffffff));
    view::draw_text(canvas, 10, 28, std::string(1, c), {.size = 24});
    EXPECT_TRUE(seen.insert(canvas.rgb()).second) << c;
  }
  EXPECT_EQ(seen.size(), 94U);
}

TEST(Font, ATextThatIsTooWideLosesItsMiddle) {
  const view::TextStyle style{.size = 20};
  const std::string cut = view::shortened("a-rather-long-name-of-a-mesh-\u00b0.vtu", 150, style);
  EXPECT_LE(view::text_width(cut, style), 150);
  EXPECT_THAT(cut, ::testing::StartsWith("a-r"));
  EXPECT_THAT(cut, ::testing::EndsWith(".vtu"));
  EXPECT_EQ(view::shortened("short.vtu", 150, style), "short.vtu");
}

#ifdef HFR_HAS_PNG
struct Decoded {
  unsigned width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  std::size_t n_colours(unsigned left, unsigned right) const {
    std::set<std::array<std::uint8_t, 3>> colours;
    for (unsigned y = 0; y < height; ++y)
      for (unsigned x = left; x < right; ++x) {
        const std::size_t at = 3 * (std::size_t{y} * width + x);
        colours.insert({rgb[at], rgb[at + 1], rgb[at + 2]});
      }
    return colours.size();
  }
};

Decoded decoded(const std::string& bytes) {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  Decoded out;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) return out;
  image.format = PNG_FORMAT_RGB;
  out.rgb.resize(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, out.rgb.data(), 0, nullptr)) return {};
  out.width = image.width;
  out.height = image.height;
  return out;
}

TEST(Picture, TheColourOfOnePoorCellSurvivesAmongManyOthers) {
  view::Canvas canvas(300, 300, view::hex(0xffffff));
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 300; ++x)
      canvas.blend(x, y, {static_cast<float>(x) / 300, static_cast<float>(y) / 300, 0.8F}, 1);
  const view::Colour poorest = view::poor_colour(0);
  canvas.blend(7, 5, poorest, 1);
  const Decoded picture = decoded(view::png_of(canvas, view::colours_that_matter()));
  ASSERT_EQ(picture.width, 300U);
  EXPECT_LE(picture.n_colours(0, 300), 256U);
  const std::size_t at = 3 * (5U * 300 + 7);
  EXPECT_NEAR(picture.rgb[at], 255 * poorest.r, 1);
  EXPECT_NEAR(picture.rgb[at + 1], 255 * poorest.g, 1);
  EXPECT_NEAR(picture.rgb[at + 2], 255 * poorest.b, 1);
}

TEST(Picture, ShowsBothMeshesAndIsTheSameForEveryNumberOfThreads) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh -o out.mesh --png a.png -j 1");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Decoded picture = decoded(tool.content("a.png"));
  ASSERT_EQ(picture.width, 1600U);
  ASSERT_EQ(picture.height, 1000U);
  EXPECT_GT(picture.n_colours(0, 800), 60U);
  EXPECT_GT(picture.n_colours(800, 1600), 30U);
  std::size_t n_different = 0;
  for (unsigned y = 80; y < 650; ++y)
    for (unsigned x = 24; x < 788; ++x) {
      const std::size_t at = 3 * (std::size_t{y} * picture.width + x);
      n_different += std::memcmp(&picture.rgb[at], &picture.rgb[at + 3 * 788], 3) != 0;
    }
  EXPECT_GT(n_different, 10000U) << "before and after look alike";
  ASSERT_EQ(tool.run("report in.mesh out.mesh --png b.png -j 3").code, 0);
  EXPECT_EQ(tool.content("a.png"), tool.content("b.png"));
}
#else
TEST(Picture, IsRefusedBeforeTheWorkByABuildWithoutLibpng) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  const Outcome outcome = tool.run("in.mesh -o out.mesh --png a.png");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no libpng"));
  EXPECT_THAT(tool.files(), ::testing::ElementsAre("in.mesh"));
}
#endif

TEST(Page, HasTheFiguresOfTheJsonReportAndBothMeshes) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh -o out.mesh --report page.html --json report.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string page = tool.content("page.html");
  const json payload = json::parse(element(page, "payload"));
  json report = json::parse(tool.content("report.json"));
  report.erase("exit_code");  // not known when the page is written
  EXPECT_EQ(payload["report"], report);
  EXPECT_FALSE(payload["moments"].empty());
  double last = 0;
  for (const json& moment : payload["moments"]) {
    EXPECT_GE(moment["seconds"], last);
    last = moment["seconds"];
  }
  for (const std::size_t i : {0U, 1U}) {
    const json& packed = payload["meshes"][i]["packed"];
    const json& figures = report[i == 0 ? "before" : "after"];
    EXPECT_EQ(packed["cells"], figures["cells"]);
    EXPECT_EQ(packed["skin"], figures["boundary_faces"]);
    std::size_t size = 0;
    for (const json& stream : packed["sizes"]) size += stream.get<std::size_t>();
    inflated(unbase64(element(page, "mesh-" + std::to_string(i))), size);
  }
  EXPECT_EQ(payload["meshes"][0]["cells"][0]["degrees"], report["before"]["min_dihedral"]["min"]);
  EXPECT_EQ(payload["meshes"][1]["cells"].size(), report["limits"]["n_cells"]);
  for (const char* elsewhere : {"http://", "https://", "{{", "src="})
    EXPECT_THAT(page, Not(HasSubstr(elsewhere)));
}

TEST(Page, OfTwoFilesHasNoReasonsButTheSameFigures) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o out.vtu --json run.json").code, 0);
  const Outcome outcome = tool.run("report in.mesh out.vtu -o page.html --json report.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json payload = json::parse(element(tool.content("page.html"), "payload"));
  const json run = json::parse(tool.content("run.json"));
  EXPECT_EQ(payload["report"]["before"], run["before"]);
  EXPECT_EQ(payload["report"]["after"], run["after"]);
  EXPECT_EQ(payload["report"]["after"], json::parse(tool.content("report.json"))["after"]);
  EXPECT_FALSE(payload["report"].contains("passes"));
  EXPECT_FALSE(payload["meshes"][1]["cells"][0].contains("limit"));
}

TEST(Page, ANameOfAFileCannotEndTheScriptThatHoldsIt) {
  Tool tool;
  tool.write("<script>.mesh", kTwoCells);
  ASSERT_EQ(tool.run("<script>.mesh -o out.mesh --report page.html").code, 0);
  const std::string page = tool.content("page.html");
  EXPECT_THAT(page, Not(HasSubstr("<script>.mesh")));
  EXPECT_EQ(json::parse(element(page, "payload"))["meshes"][0]["name"], "<script>.mesh");
}

TEST(Page, RefusesWhatItCannotShow) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  tool.write("surface.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto before = tool.files();
  for (const char* arguments :
       {"in.mesh -o out.mesh --report none/page.html", "in.mesh --plan --report page.html",
        "surface.off -o out.off --report page.html", "report in.mesh in.mesh",
        "in.mesh -o out.mesh --report out.mesh", "report in.mesh in.mesh -o in.mesh"}) {
    EXPECT_EQ(tool.run(arguments).code, 1) << arguments;
    EXPECT_EQ(tool.files(), before) << arguments;
  }
}

}  // namespace
}  // namespace hfr::app::test
