// SPDX-License-Identifier: BSD-3-Clause
// --png, --report and the subcommand report. What a browser makes of the page: page_test.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "Tool.hh"
#include "apps/report/Decode.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// What stands in the element of that id.
std::string element(const std::string& page, const std::string& id) {
  const std::size_t begin = page.find(">", page.find("id=\"" + id + "\"")) + 1;
  return page.substr(begin, page.find("</script>", begin) - begin);
}

#ifdef HFR_HAS_PNG
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
  ASSERT_EQ(tool.run("report in.mesh out.mesh --png c.png --png-width 800").code, 0);
  EXPECT_EQ(decoded(tool.content("c.png")).width, 800U);
  EXPECT_EQ(decoded(tool.content("c.png")).height, 500U);
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
