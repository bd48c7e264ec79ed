// SPDX-License-Identifier: BSD-3-Clause
// --quality-array: the smallest dihedral of each cell in the output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "Tool.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Quality/Metrics.hh"

namespace hfr::app::test {
namespace {

using ::testing::HasSubstr;

std::size_t n_fields(const io::MeshData& data, const std::string& name) {
  return static_cast<std::size_t>(std::count_if(data.cell_fields.begin(), data.cell_fields.end(),
                                                [&](const io::Field& f) { return f.name == name; }));
}

void expect_angles(const io::MeshData& data, const std::vector<double>& values, double lowest) {
  ASSERT_EQ(values.size(), data.cells.size());
  double smallest = 180;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& v = data.cells[i];
    EXPECT_EQ(values[i], reported_quality(Metric::kMinDihedral, data.points[v[0]], data.points[v[1]],
                                          data.points[v[2]], data.points[v[3]]));
    smallest = std::min(smallest, values[i]);
  }
  EXPECT_EQ(smallest, lowest);
}

TEST(QualityArray, IsTheSmallestDihedralOfEachCellInEveryFormatThatKeepsNames) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 6 6 6 -o in.mesh").code, 0);
  for (const std::string name : {"out.vtu", "out.vtk", "out.msh", "out.ovm"}) {
    const Outcome outcome = tool.run("in.mesh -o " + name + " --quality-array angle --json report.json");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto report = nlohmann::json::parse(tool.content("report.json"));
    const io::MeshData data = io::read_mesh(tool.path(name));
    ASSERT_EQ(n_fields(data, "angle"), 1U) << name;
    expect_angles(data, data.cell_fields[0].values, report["after"]["min_dihedral"]["min"]);
  }
}

TEST(QualityArray, IsNegativeInAnInvertedCell) {
  Tool tool;
  tool.write("in.mesh", kHopelessCells);
  EXPECT_EQ(tool.run("in.mesh -o out.vtu --quality-array angle").code, 4);
  const io::MeshData data = io::read_mesh(tool.path("out.vtu"));
  ASSERT_EQ(n_fields(data, "angle"), 1U);
  const auto& values = data.cell_fields[0].values;
  EXPECT_LT(*std::min_element(values.begin(), values.end()), 0);
}

TEST(QualityArray, TakesThePlaceOfAFieldOfItsName) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 6 6 6 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o a.vtu --quality-array angle --iterations 1").code, 0);
  ASSERT_EQ(tool.run("a.vtu -o b.vtu --quality-array angle --json report.json").code, 0);
  const auto report = nlohmann::json::parse(tool.content("report.json"));
  const io::MeshData data = io::read_mesh(tool.path("b.vtu"));
  ASSERT_EQ(n_fields(data, "angle"), 1U);
  expect_angles(data, data.cell_fields[0].values, report["after"]["min_dihedral"]["min"]);
}

TEST(QualityArray, IsRefusedBeforeTheWorkWhereItCouldNotBeWritten) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  tool.write("surface.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    const auto before = tool.files();
    const Outcome outcome = tool.run(arguments);
    EXPECT_EQ(outcome.code, 1) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("--quality-array")) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(why)) << arguments;
    EXPECT_EQ(tool.files(), before) << arguments;
  };
  refused("in.mesh -o out.stl --quality-array q", "no place for values of cells");
  refused("in.mesh -o - --format mesh --quality-array q", "no place for values of cells");
  refused("in.mesh -o out.vtu --quality-array region", "region");
  refused("in.mesh -o out.vtu --dry-run --quality-array q", "no output file");
  refused("surface.off -o out.vtu --surface free --quality-array q", "has none");
}

}  // namespace
}  // namespace hfr::app::test
