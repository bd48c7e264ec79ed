// SPDX-License-Identifier: BSD-3-Clause
// What tests of shares ask of files.
#ifndef HFR_UNITTESTS_IO_SHARE_TESTS_HH
#define HFR_UNITTESTS_IO_SHARE_TESTS_HH

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <random>
#include <string>

#include "HalfFace/Errors.hh"
#include "HalfFace/Generate.hh"
#include "IO/MeshDataSamples.hh"
#include "IO/MeshFile.hh"
#include "IO/Shares.hh"
#include "LibFuzzer/Formats.hh"

namespace hfr::test {

using io::MeshData;
using io::samples::comparable;
using io::samples::put_together;
using io::samples::read_shares;
using io::samples::TemporaryFolder;

/// A box of a few hundred cells, with regions, patches, edges and labels, so that a text has many chunks.
inline MeshData labelled_box(unsigned seed) {
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
inline std::string refusal(const std::filesystem::path& path, std::size_t n_processes = 1) {
  try {
    put_together(read_shares(path, n_processes, 3));
  } catch (const InvalidInput& error) {
    return error.what();
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

inline std::string refusal_of(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  io::samples::write_bytes(folder / name, bytes);
  const std::string line = refusal(folder / name), alone = (folder / name).string() + ": ";
  for (const std::size_t n : {2, 3})
    EXPECT_EQ(refusal(folder / name, n).empty(), line.empty()) << n << " processes: " << line;
  EXPECT_TRUE(line.empty() || line.starts_with(alone)) << line;
  return line.empty() ? line : line.substr(alone.size());
}

/// Any number of processes, and of elements at once, read what the reader of whole files does.
inline void expect_shares_of(const std::filesystem::path& path) {
  const MeshData whole = comparable(io::read_mesh(path));
  for (const std::size_t n : {1, 2, 3, 7})
    for (const std::uint64_t at_once : {1, 5, 1000})
      EXPECT_EQ(fuzz::difference(put_together(read_shares(path, n, at_once)), whole), "")
          << n << " processes, " << at_once << " at once";
}

/// Cut off anywhere, or with other bytes: what both readers take is the same mesh, and what is refused is so
/// in one line that begins with the path. `n_same` and `n_refused` count what was seen.
class BrokenShares {
 public:
  int n_same = 0, n_refused = 0;

  void end_anywhere(const std::string& extension, const std::string& good) {
    for (std::size_t n = 0; n < good.size(); ++n)
      ASSERT_NO_FATAL_FAILURE(look(extension, good.substr(0, n), 1 + n % 2)) << n;
  }
  void change_bytes(const std::string& extension, const std::string& good, int n_runs) {
    std::mt19937_64 random(1);
    for (int run = 0; run < n_runs; ++run) {
      std::string bytes = good;
      for (std::uint64_t k = random() % 3 + 1; k > 0; --k) {
        // Half of them are bytes that the file has, and so more like a file.
        const auto other = run % 2 == 0 ? static_cast<char>(random()) : good[random() % good.size()];
        bytes[random() % bytes.size()] = other;
      }
      ASSERT_NO_FATAL_FAILURE(look(extension, bytes, 1 + random() % 2)) << run;
    }
  }

  void look(const std::string& extension, const std::string& bytes, std::size_t n_processes) {
    const auto path = folder_ / ("a" + extension);
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

  const TemporaryFolder folder_;
};

}  // namespace hfr::test

#endif
