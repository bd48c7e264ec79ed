// SPDX-License-Identifier: BSD-3-Clause
// A writer and its reader get a mesh that the bytes decide, with all that MeshData can hold. Points, cells,
// regions and labels of vertices come back; where the writer has no note, so does everything. Elements have
// different corners, and fields no name that a format gives a meaning.
#include <algorithm>
#include <limits>

#include "Fuzz/Random.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeshFile.hh"
#include "IO/Validate.hh"
#include "IO/WritableFormats.hh"
#include "LibFuzzer/Formats.hh"
#include "LibFuzzer/Target.hh"

namespace hfr::fuzz {
namespace {

/// Makes a mesh of what the sequence says.
class MeshDataMaker {
 public:
  explicit MeshDataMaker(const Random& random) : random_(random) {}

  io::MeshData run() {
    const std::size_t n_points = 1 + random_.below(12);
    for (std::size_t v = 0; v < n_points; ++v) {
      const double x = real(), y = real();
      mesh_.points.push_back({x, y, real()});
    }
    tuples(mesh_.cells, random_.below(8));
    if (!mesh_.cells.empty() && random_.chance(0.6)) labels(mesh_.regions, mesh_.cells.size());
    tuples(mesh_.triangles, random_.below(6));
    labels(mesh_.triangle_labels, mesh_.triangles.size());
    tuples(mesh_.edges, random_.below(4));
    labels(mesh_.edge_labels, mesh_.edges.size());
    if (random_.chance(0.4)) labels(mesh_.vertex_labels, n_points);
    for (std::size_t v = 0; v < n_points; ++v)
      if (random_.chance(0.1)) mesh_.fixed_vertices.push_back(static_cast<Index>(v));
    for (std::size_t i = random_.below(3); i > 0; --i) mesh_.names[{random_.from_to(1, 3), label()}] = name();
    fields(mesh_.point_fields, n_points);
    fields(mesh_.cell_fields, mesh_.cells.size());
    return std::move(mesh_);
  }

 private:
  double real() {
    if (random_.chance(0.5)) return static_cast<double>(random_.from_to(-3, 3));
    if (random_.chance(0.5))
      return random_.pick({-0.0, 0.1, 1.0 / 3, 1e-300, -1e150, 1e300, 5e-324, 1.7976931348623157e308, 1e22,
                           2.2250738585072014e-308, 123456789.12345679, 1e-5});
    return random_.between(-1, 1);
  }
  int label() {
    return random_.chance(0.8) ? random_.from_to(0, 4)
                               : random_.pick({-1, -2147483647 - 1, 2147483647, 1000000, -7});
  }
  void labels(std::vector<int>& list, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) list.push_back(label());
  }
  template <std::size_t N>
  void tuples(std::vector<std::array<Index, N>>& list, std::size_t n) {
    const std::size_t n_points = mesh_.points.size();
    for (std::size_t i = 0; i < n && n_points >= N; ++i) {
      std::array<Index, N> tuple{};
      for (std::size_t k = 0; k < N; ++k) {
        auto v = static_cast<Index>(random_.below(n_points));
        while (std::find(tuple.begin(), tuple.begin() + k, v) != tuple.begin() + k)
          v = (v + 1) % static_cast<Index>(n_points);
        tuple[k] = v;
      }
      list.push_back(tuple);
    }
  }
  std::string name() {
    if (random_.chance(0.4))
      return random_.pick({"a", "b c", "$EndNodes", "</DataArray>", "&amp;", "Vertices", "LOOKUP_TABLE",
                           "solution_1", "\xc3\xa4", "100%25", "]]>"});
    std::string made = "f";
    for (std::size_t i = random_.below(9); i > 0; --i)
      made += static_cast<char>(random_.from_to(' ' + 1, '~'));
    return made;
  }
  void fields(std::vector<io::Field>& list, std::size_t n_items) {
    for (std::size_t i = random_.below(3); i > 0; --i) {
      io::Field field{
          name() + std::to_string(i), random_.pick({1, 1, 2, 3, 4, 6, 9, 10}), random_.chance(0.3), {}};
      for (std::size_t k = 0; k < n_items * static_cast<std::size_t>(field.components); ++k)
        field.values.push_back(field.integer ? static_cast<double>(label()) : value());
      list.push_back(std::move(field));
    }
  }
  double value() {
    if (random_.chance(0.9)) return real();
    return random_.pick({std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity()});
  }

  Random random_;
  io::MeshData mesh_;
};

/// Regions and labels that are all 0 may come back as none, and the other way round.
io::MeshData without_zeros(io::MeshData mesh) {
  const auto all_zero = [](const std::vector<int>& list) {
    return std::all_of(list.begin(), list.end(), [](int label) { return label == 0; });
  };
  if (all_zero(mesh.regions)) mesh.regions.clear();
  if (all_zero(mesh.vertex_labels)) mesh.vertex_labels.clear();
  return mesh;
}

void compare(const io::MeshData& wanted, const io::MeshData& again, const std::string& format,
             const std::vector<std::string>& notes) {
  const std::string differs = difference(without_zeros(wanted), without_zeros(again));
  if (differs.empty()) return;
  if (notes.empty()) broken("round trip", format + ": without a note: " + differs);
  for (const char* held : {"points", "cells", "regions", "vertex labels"})
    if (differs == held) broken("round trip", format + ": " + differs + ", in spite of " + notes.front());
}

}  // namespace
}  // namespace hfr::fuzz

int LLVMFuzzerInitialize(int*, char***) { return 0; }

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hfr;
  using namespace hfr::fuzz;
  if (size < 2) return -1;
  static const auto formats = io::samples::cell_formats();
  const auto& format = formats[data[0] % formats.size()];
  const io::MeshData mesh = MeshDataMaker(Random(std::span(data + 1, size - 1))).run();
  const std::filesystem::path path = scratch() / ("mesh" + format.extension);
  for (const auto& old : std::filesystem::directory_iterator(scratch())) std::filesystem::remove(old);
  try {
    const auto notes = io::write_mesh(path, mesh, format.options);
    const io::MeshData again = io::read_mesh(path);
    io::validate(again, "again");
    compare(mesh, again, format.name(), notes);
  } catch (const std::exception& error) {
    broken("round trip", format.name() + ": " + error.what());
  }
  return 0;
}
