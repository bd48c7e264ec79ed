// SPDX-License-Identifier: BSD-3-Clause
// Makes the inputs that libFuzzer begins with, a folder for each target: what the writers make of the meshes
// of unittests/IO, and bytes of a random sequence for the targets that make meshes of them. Usage:
// hfr_make_inputs FOLDER
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "Fuzz/Random.hh"
#include "HalfFace/Generate.hh"
#include "IO/MeshDataSamples.hh"
#include "IO/WritableFormats.hh"
#include "LibFuzzer/Formats.hh"

namespace hfr::fuzz {
namespace {

using io::MeshData;
using io::samples::read_bytes;
using io::samples::TemporaryFolder;
using io::samples::write_bytes;

/// One input of all files that the mesh is made of.
std::string packed(const std::filesystem::path& path) {
  std::string input = read_bytes(path);
  for (const auto& other : io::files_of_mesh(path))
    if (other != path && std::filesystem::exists(other))
      input += std::string(kBeside) + other.extension().string() + "\n" + read_bytes(other);
  return input;
}

std::vector<std::pair<std::string, MeshData>> meshes() {
  std::vector<std::pair<std::string, MeshData>> all = {{"two", io::samples::two_cells()},
                                                       {"full", io::samples::full()},
                                                       {"bits", io::samples::random_bits(9, 1)}};
  const generate::Arrays box = generate::box({1, 1, 1});
  MeshData plain;
  plain.points = box.points;
  plain.cells = box.cells;
  all.emplace_back("box", plain);
  MeshData points_only;
  points_only.points = plain.points;
  all.emplace_back("points", points_only);
  MeshData wide = io::samples::two_cells();  // a field of each width, values that are no numbers
  for (const int width : {1, 2, 3, 6, 9}) {
    io::Field field{"w" + std::to_string(width), width, false, {}};
    for (std::size_t i = 0; i < wide.points.size() * static_cast<std::size_t>(width); ++i)
      field.values.push_back(i % 5 == 0 ? std::numeric_limits<double>::infinity() : 0.25 * double(i));
    wide.point_fields.push_back(field);
  }
  all.emplace_back("fields", wide);
  return all;
}

void write_files(const std::filesystem::path& folder) {
  auto formats = io::samples::cell_formats();
  for (const std::string extension : {".stl", ".obj", ".off", ".ply"})
    for (const bool binary : {false, true}) formats.push_back({extension, {binary, ""}});
  for (const auto& format : formats) {
    const auto into = folder / ("read-" + format.extension.substr(1));
    std::filesystem::create_directories(into);
    for (const auto& [name, mesh] : meshes()) {
      const TemporaryFolder scratch;
      const auto path = scratch / ("mesh" + format.extension);
      try {
        io::write_mesh(path, mesh, format.options);
      } catch (const InvalidInput&) {
        continue;  // a surface of what has no triangles
      }
      write_bytes(into / (name + "-" + format.name()), packed(path));
    }
  }
}

void write_sequences(const std::filesystem::path& folder, const std::string& target, std::uint64_t n,
                     std::size_t longest) {
  std::filesystem::create_directories(folder / target);
  for (std::uint64_t seed = 0; seed < n; ++seed) {
    Random random(seed + 1);
    std::string bytes(8 + random.below(longest), '\0');
    for (char& c : bytes) c = static_cast<char>(random.below(256));
    bytes[0] = static_cast<char>(seed);  // the format, or how the mesh is made: all of them come
    write_bytes(folder / target / ("sequence-" + std::to_string(seed)), bytes);
  }
}

}  // namespace
}  // namespace hfr::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: hfr_make_inputs FOLDER\n");
    return 2;
  }
  try {
    hfr::fuzz::write_files(argv[1]);
    hfr::fuzz::write_sequences(argv[1], "round_trip", 120, 300);
    hfr::fuzz::write_sequences(argv[1], "improve", 80, 400);
  } catch (const std::exception& error) {
    fmt::print(stderr, "hfr_make_inputs: {}\n", error.what());
    return 1;
  }
  return 0;
}
