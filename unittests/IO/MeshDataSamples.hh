// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_IO_MESH_DATA_SAMPLES_HH
#define HFR_UNITTESTS_IO_MESH_DATA_SAMPLES_HH

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "HalfFace/Errors.hh"
#include "IO/MeshData.hh"
#include "IO/MeshFile.hh"

namespace hfr::io::samples {

/// Two tetrahedra on a shared face and nothing else.
inline MeshData two_cells() {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.cells = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  return mesh;
}

/// Two cells with everything that MeshData can hold: regions, patches, edges, labels, names, fixed vertices,
/// fields of each width, and coordinates that only an exact round trip keeps.
inline MeshData full() {
  MeshData mesh = two_cells();
  constexpr double kDenormal = 4.9406564584124654e-324;
  mesh.points = {{-0.0, 0.1, 1.0 / 3.0},
                 {1e300, kDenormal, -1e-300},
                 {0.5, 1.7976931348623157e308, 2},
                 {2.2250738585072014e-308, 0.30000000000000004, 123456789.12345679},
                 {1, 1, 1e22}};
  mesh.regions = {3, 7};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}, {4, 2, 3}};
  mesh.triangle_labels = {11, 12, 13};
  mesh.edges = {{0, 1}, {3, 4}};
  mesh.edge_labels = {21, 22};
  mesh.vertex_labels = {0, 31, 0, 32, 0};
  mesh.fixed_vertices = {1, 4};
  mesh.names = {{{3, 3}, "steel"}, {{3, 7}, "soft rubber"}, {{2, 11}, "inlet"}, {{1, 21}, "crease"}};
  mesh.point_fields = {{"temperature", 1, false, {0.1, -0.0, 3, 1e-5, 1e200}},
                       {"velocity", 3, false, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0.1, 13, 14, 15}}};
  mesh.cell_fields = {{"density", 1, false, {7850.5, 1.0 / 7.0}}, {"rank", 1, true, {-4, 5}}};
  return mesh;
}

/// One long row of cells over points whose coordinates are random bit patterns, denormals among them.
inline MeshData random_bits(std::size_t n_points, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto finite = [&] {
    for (;;) {
      const auto value = std::bit_cast<double>(random());
      if (value - value == 0.0) return random() % 8 == 0 ? value * 1e-320 : value;
    }
  };
  MeshData mesh;
  for (std::size_t i = 0; i < n_points; ++i) {
    const double x = finite();
    const double y = finite();
    mesh.points.push_back({x, y, finite()});
  }
  for (std::size_t i = 0; i + 3 < n_points; ++i) {
    const auto v = static_cast<Index>(i);
    mesh.cells.push_back({v, v + 1, v + 2, v + 3});
    mesh.regions.push_back(static_cast<int>(random() % 1000));
  }
  return mesh;
}

/// Equal to the last bit: -0.0 differs from 0.0, and NaN equals itself.
inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  }
  return true;
}

inline bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  const auto flat = [](const std::vector<Vec3>& points) {
    std::vector<double> values;
    for (const Vec3& p : points) values.insert(values.end(), {p.x, p.y, p.z});
    return values;
  };
  return same_bits(flat(a), flat(b));
}

/// A folder of its own for a test, removed with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::random_device random;
    path_ = std::filesystem::temp_directory_path() /
            ("hfr_io_" + std::to_string(random()) + std::to_string(random()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// With HFR_KEEP_SAMPLES=FOLDER in the environment, what tests write for readers is kept there once more:
/// FOLDER/read-EXTENSION, small files only, named by their content; of more than 60 of an extension, which
/// are those of loops over every byte, one in 32. libFuzzer begins with them.
inline void keep_sample(const std::filesystem::path& path, const std::string& bytes) {
  constexpr std::size_t kMost = 4096;  // bytes
  constexpr std::size_t kAll = 60, kOneIn = 32;
  const char* const folder = std::getenv("HFR_KEEP_SAMPLES");
  if (!folder || bytes.size() > kMost || path.extension().empty()) return;
  static std::map<std::string, std::size_t> n_seen;
  const std::string extension = path.extension().string();
  if (const std::size_t n = n_seen[extension]++; n > kAll && n % kOneIn != 0) return;
  const auto into = std::filesystem::path(folder) / ("read-" + extension.substr(1));
  std::filesystem::create_directories(into);
  std::ofstream(into / std::to_string(std::hash<std::string>()(bytes)), std::ios::binary) << bytes;
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  keep_sample(path, bytes);
  std::filesystem::remove(path);  // some file systems wait for the disk when a file is cut to nothing
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// What read_mesh says of a file with these bytes: the message of its error without the folder, "ok" for
/// none.
inline std::string message_of_reading(const TemporaryFolder& folder, const std::string& name,
                                      const std::string& bytes) {
  write_bytes(folder / name, bytes);
  try {
    read_mesh(folder / name);
  } catch (const Error& error) {
    const std::string message = error.what();
    const std::string prefix = folder.path().string() + "/";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : "no path: " + message;
  }
  return "ok";
}

inline MeshData read_text(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder / name, bytes);
  return read_mesh(folder / name);
}

/// Does one of the lines have this in it?
inline bool mentions(const std::vector<std::string>& lines, const std::string& what) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(what) != std::string::npos; });
}

}  // namespace hfr::io::samples

#endif
