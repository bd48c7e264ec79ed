// SPDX-License-Identifier: BSD-3-Clause
// Broken files as a user meets them: whatever is wrong with a file of any format, the program ends by itself,
// with a code that docs/exit-codes.md gives for it, and one line that names the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <sstream>

#include "IO/WritableFormats.hh"
#include "Tool.hh"

namespace hfr::app::test {
namespace {

using io::samples::FormatVariant;
using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Far more than reading a dozen cells takes, also under a sanitizer: only a hang meets it.
constexpr unsigned kSeconds = 60;

/// Arguments that pick a variant of a format.
std::string write_options(const io::WriteOptions& options) {
  return (options.binary ? " --binary" : "") +
         (options.variant.empty() ? std::string() : " --variant " + options.variant);
}

/// Lines of stderr that are no notes.
std::vector<std::string> complaints(const std::string& err) {
  std::vector<std::string> lines;
  std::istringstream stream(err);
  for (std::string line; std::getline(stream, line);)
    if (line.rfind("hfremesh: note: ", 0) != 0) lines.push_back(line);
  return lines;
}

class BrokenFilesOfTheTool : public testing::TestWithParam<FormatVariant> {
 protected:
  // With the variable set the program does not start itself once more, which halves the time of these tests.
  static void SetUpTestSuite() { setenv("OMP_WAIT_POLICY", "passive", 1); }
  static void TearDownTestSuite() { unsetenv("OMP_WAIT_POLICY"); }

  void SetUp() override {
    const FormatVariant& format = GetParam();
    tool_.limit_seconds(kSeconds);
    ASSERT_EQ(tool_.run("generate box --n 2 1 1 --jitter 0.2 --regions 2 -o box.mesh").code, 0);
    make_richer();
    const Outcome made = tool_.run("convert -q good.vtu " + input_ + write_options(format.options));
    ASSERT_EQ(made.code, 0) << made.err;
    parts_ = tool_.files();  // TetGen's mesh is a set of files, and Medit has a second one for fields
    std::erase(parts_, "box.mesh");
    std::erase(parts_, "good.vtu");
    ASSERT_THAT(parts_, Contains(input_));
    ASSERT_EQ(tool_.run("check " + input_).code, 0);
  }

  /// From box.mesh to good.vtu: with some of everything that a file may hold.
  void make_richer() {
    io::MeshData mesh = io::read_mesh(tool_.path("box.mesh"));
    const auto& v = mesh.cells.front();
    mesh.triangles = {{v[0], v[1], v[2]}, {v[1], v[2], v[3]}};
    mesh.triangle_labels = {11, 12};
    mesh.edges = {{v[0], v[1]}, {v[2], v[3]}};
    mesh.edge_labels = {21, 22};
    mesh.names = {{{3, mesh.regions.front()}, "steel"}, {{2, 11}, "inlet"}};
    std::vector<double> values(mesh.points.size());
    std::iota(values.begin(), values.end(), 0.5);
    mesh.point_fields = {{"temperature", 1, false, values}};
    io::write_mesh(tool_.path("good.vtu"), mesh);
  }

  /// Runs the program on the mesh with this part replaced. True if the file was refused or found faulty.
  bool refused(const std::string& part, const std::string& bytes, bool check, const std::string& what) {
    SCOPED_TRACE(part + ": " + what);
    tool_.write(part, bytes);
    const Outcome outcome = tool_.run((check ? "check -j 1 " : "stats -j 1 ") + input_);
    if (check) {
      EXPECT_THAT(outcome.code, testing::AnyOf(0, 2, 4)) << outcome.err;
    } else {
      EXPECT_THAT(outcome.code, testing::AnyOf(0, 2)) << outcome.err;
    }
    const std::vector<std::string> lines = complaints(outcome.err);
    EXPECT_EQ(lines.size(), outcome.code == 0 ? 0U : 1U) << outcome.err;
    if (outcome.code == 2) {
      EXPECT_THAT(outcome.out, IsEmpty());
    }
    for (const std::string& line : lines) EXPECT_THAT(line, StartsWith("hfremesh: broken"));
    return outcome.code != 0;
  }

  Tool tool_;
  const std::string input_ = "broken" + GetParam().extension;
  std::vector<std::string> parts_;
};

TEST_P(BrokenFilesOfTheTool, CutAtEveryPercent) {
  int refusals = 0;
  for (const std::string& part : parts_) {
    const std::string good = tool_.content(part);
    for (std::size_t percent = 0; percent < 100; ++percent) {
      const std::size_t length = good.size() * percent / 100;
      refusals +=
          refused(part, good.substr(0, length), percent % 2 == 0, "cut at byte " + std::to_string(length));
    }
    tool_.write(part, good);
  }
  EXPECT_GT(refusals, 50);
}

TEST_P(BrokenFilesOfTheTool, BytesChangedAtRandom) {
  std::mt19937 random(2013);
  int refusals = 0;
  for (const std::string& part : parts_) {
    const std::string good = tool_.content(part);
    for (int trial = 0; trial < 60; ++trial) {
      std::string bytes = good;
      const unsigned changes = 1 + random() % 4;
      std::string what = "changed at";
      for (unsigned k = 0; k < changes; ++k) {
        const std::size_t at = random() % bytes.size();
        bytes[at] = static_cast<char>(trial % 4 < 2 ? random() : ' ' + random() % 95);
        what += " " + std::to_string(at);
      }
      refusals += refused(part, bytes, trial % 2 == 0, what + " in trial " + std::to_string(trial));
    }
    tool_.write(part, good);
  }
  EXPECT_GT(refusals, 6);
}

/// The others of TetGen's files are parts of the mesh that has a .node file.
std::vector<FormatVariant> formats() {
  std::vector<FormatVariant> all = io::samples::cell_formats();
  std::erase_if(all, [](const FormatVariant& f) { return f.extension == ".ele" || f.extension == ".face"; });
  return all;
}

INSTANTIATE_TEST_SUITE_P(Apps, BrokenFilesOfTheTool, testing::ValuesIn(formats()),
                         [](const auto& format) { return format.param.name(); });

}  // namespace
}  // namespace hfr::app::test
