// SPDX-License-Identifier: BSD-3-Clause
// No file may crash a reader: every format, cut at every length and with bytes changed at random, gives one
// clear line or a mesh that keeps the rules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "IO/MeshDataSamples.hh"
#include "IO/Validate.hh"
#include "IO/WritableFormats.hh"

namespace hfr::io {
namespace {

using samples::FormatVariant;
using samples::TemporaryFolder;

class BrokenFiles : public testing::TestWithParam<FormatVariant> {
 protected:
  void SetUp() override {
    write_mesh(path_, samples::full(), GetParam().options);
    good_ = samples::read_bytes(path_);
    // Fields of Medit stand in a second file, which is broken in its own test.
    std::filesystem::remove(folder_ / "mesh.sol");
    std::filesystem::remove(folder_ / "mesh.solb");
  }

  /// Reads the bytes in place of the good file; nothing if they are refused as they should be.
  std::optional<MeshData> read(const std::string& bytes) {
    samples::write_bytes(path_, bytes);
    try {
      return read_mesh(path_);
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_LT(message.size(), 400U) << message;
      EXPECT_THAT(message, testing::StartsWith((folder_.path() / "mesh").string()));
      return std::nullopt;
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / ("mesh" + GetParam().extension);
  std::string good_;
};

TEST_P(BrokenFiles, CutAtEveryByte) {
  const MeshData whole = samples::full();
  int refused = 0;
  const std::size_t step = std::max<std::size_t>(1, good_.size() / 1000);
  for (std::size_t length = 0; length < good_.size(); length += step) {
    const auto mesh = read(good_.substr(0, length));
    if (!mesh) {
      ++refused;
      continue;
    }
    // What a format cannot tell from a whole file may be read; a mesh that lost something else must say so.
    if (mesh->points.size() != whole.points.size() || mesh->cells != whole.cells ||
        !samples::same_bits(mesh->points, whole.points)) {
      EXPECT_FALSE(mesh->notes.empty()) << "cut at byte " << length << " of " << good_.size();
    }
  }
  EXPECT_GT(refused, 10);
}

TEST_P(BrokenFiles, BytesChangedAtRandom) {
  std::mt19937 random(2013);
  int refused = 0;
  constexpr int kTrials = 600;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string bytes = good_;
    const unsigned changes = 1 + random() % 4;
    for (unsigned k = 0; k < changes; ++k) {
      bytes[random() % bytes.size()] = static_cast<char>(trial % 2 == 0 ? random() : ' ' + random() % 95);
    }
    const auto mesh = read(bytes);
    if (!mesh) ++refused;
    if (mesh) {
      EXPECT_NO_THROW(validate(*mesh, "again"));
    }
  }
  EXPECT_GT(refused, kTrials / 10);
}

TEST_P(BrokenFiles, PiecesMovedAboutAtRandom) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::string bytes = good_;
    const std::size_t from = random() % bytes.size();
    const std::string piece = bytes.substr(from, random() % 40);
    trial % 2 == 0 ? bytes.erase(from, piece.size()) : bytes.insert(random() % bytes.size(), piece);
    read(bytes);
  }
}

TEST_P(BrokenFiles, NumbersMadeHuge) {
  for (const char* const huge : {"1000000000000000000", "99999999999", "-1", "4294967296", "1e400", "nan"}) {
    for (std::size_t at = 0; at < good_.size(); ++at) {
      const auto is_digit = [&](std::size_t i) {
        return i < good_.size() && good_[i] >= '0' && good_[i] <= '9';
      };
      if (!is_digit(at) || (at > 0 && good_[at - 1] != ' ' && good_[at - 1] != '\n')) continue;
      std::size_t end = at;
      while (is_digit(end)) ++end;
      read(std::string(good_).replace(at, end - at, huge));
    }
  }
}

TEST_P(BrokenFiles, EmptyBlankAndRandomFiles) {
  std::mt19937 random(99);
  EXPECT_FALSE(read(""));
  EXPECT_FALSE(read("\n\n  \n"));
  for (int trial = 0; trial < 20; ++trial) {
    std::string bytes(1 + random() % 3000, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    EXPECT_FALSE(read(bytes));
  }
}

INSTANTIATE_TEST_SUITE_P(IO, BrokenFiles, testing::ValuesIn(samples::cell_formats()),
                         [](const auto& format) { return format.param.name(); });

TEST(BrokenSolution, CutAtEveryByte) {
  for (const auto& [mesh_name, name] : {std::pair{"a.mesh", "a.sol"}, std::pair{"a.meshb", "a.solb"}}) {
    const TemporaryFolder folder;
    write_mesh(folder / mesh_name, samples::full());
    const std::string good = samples::read_bytes(folder / name);
    int refused = 0;
    // A text file is whole without its last line break.
    for (std::size_t length = 0; length + 1 < good.size(); ++length) {
      samples::write_bytes(folder / name, good.substr(0, length));
      try {
        EXPECT_FALSE(read_mesh(folder / mesh_name).notes.empty()) << name << " cut at byte " << length;
      } catch (const InvalidInput& error) {
        ++refused;
        EXPECT_THAT(error.what(), testing::StartsWith((folder / name).string()));
      }
    }
    EXPECT_GT(refused, 10);
  }
}

}  // namespace
}  // namespace hfr::io
