// SPDX-License-Identifier: BSD-3-Clause
// Files that several processes write in stretches have the bytes of the writers for one.
#include "IO/MeshStretch.hh"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "IO/MeshDataSamples.hh"
#include "IO/MeshFile.hh"

namespace hfr::io {
namespace {

using samples::TemporaryFolder;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Stretches : public ByteSink {
 public:
  std::vector<std::string> finish() {
    flush();
    return all_;
  }
  void next_stretch() override {
    flush();
    all_.emplace_back();
  }

 private:
  void put(std::string_view bytes) override { all_.back() += bytes; }
  std::vector<std::string> all_{1};
};

/// With labels of some kinds, names, and fixed vertices in no order; without fields, which are not in it.
std::vector<MeshData> meshes() {
  MeshData full = samples::full();
  full.point_fields.clear();
  full.cell_fields.clear();
  std::vector<MeshData> all = {full, samples::two_cells()};
  all.push_back(full);
  all.back().regions.clear();
  all.back().fixed_vertices = {4, 0, 2};
  all.push_back(all.back());
  all.back().triangle_labels.assign(all.back().triangles.size(), 0);
  all.back().edge_labels.assign(all.back().edges.size(), 0);
  all.back().vertex_labels.clear();
  all.push_back(full);
  all.back().triangles.clear();
  all.back().triangle_labels.clear();
  all.push_back(full);
  all.back().names.clear();
  all.back().edges.clear();
  all.back().edge_labels.clear();
  return all;
}

TEST(MeshStretch, OfOneProcessTheBytesAreThoseOfTheMesh) {
  const TemporaryFolder folder;
  std::size_t n_bytes = 0;
  for (const MeshData& mesh : meshes())
    for (const char* const name : {"a.mesh", "a.meshb", "a.msh", "a.vtu"}) {
      write_mesh(folder / name, mesh, {});
      MeshStretch stretch = stretch_of(mesh);
      if (wants_boxes(folder / name, {})) stretch.boxes = boxes_of(mesh);
      Stretches sink;
      stretched_file(folder / name, stretch, {}).write(sink);
      std::string all;
      for (const std::string& one : sink.finish()) all += one;
      EXPECT_TRUE(all == bytes_of(folder / name)) << name << ", " << all.size() << " bytes";
      n_bytes += all.size();
    }
  EXPECT_GT(n_bytes, 10'000U);
}

/// Values of cells stand before zeros of triangles and edges; a field that would be read as labels has some
/// before it.
TEST(MeshStretch, AVtuHasFields) {
  const TemporaryFolder folder;
  for (const bool like_labels : {false, true}) {
    MeshData mesh = samples::full();
    mesh.regions.clear();
    mesh.triangle_labels.assign(mesh.triangles.size(), 0);
    mesh.edge_labels.assign(mesh.edges.size(), 0);
    mesh.vertex_labels.clear();
    const std::size_t n = mesh.points.size(), m = mesh.cells.size();
    mesh.point_fields = {{"a<b", 2, false, std::vector<double>(2 * n, 0.1)},
                         {like_labels ? "labels" : "wide", 1, true, std::vector<double>(n, 5e9)}};
    mesh.cell_fields = {{like_labels ? "material" : "x", 1, true, std::vector<double>(m, 3)},
                        {"half", 1, true, std::vector<double>(m, 0.5)}};
    const Notes notes = write_mesh(folder / "a.vtu", mesh, {});
    const MeshStretch stretch = stretch_of(mesh);
    Stretches sink;
    const StretchedFile file = stretched_file(folder / "a.vtu", stretch, {});
    file.write(sink);
    std::string all;
    for (const std::string& one : sink.finish()) all += one;
    EXPECT_TRUE(all == bytes_of(folder / "a.vtu")) << like_labels;
    EXPECT_EQ(file.notes, notes);
    EXPECT_EQ(all.find("Name=\"region\"") != std::string::npos, like_labels);
  }
}

template <std::size_t N>
void share_out(std::vector<std::array<Index, N>>& items, std::vector<int>& labels, bool is_first,
               std::size_t n, ElementStretch& stretch, std::uint64_t total) {
  const auto mid = static_cast<std::ptrdiff_t>(n);
  const auto cut = [&](auto& values) {
    if (values.empty()) return;
    if (is_first)
      values.erase(values.begin() + mid, values.end());
    else
      values.erase(values.begin(), values.begin() + mid);
  };
  cut(items);
  cut(labels);
  stretch = {total, NumberRows(items), labels, is_first ? 0 : n};
}

/// Each of two processes has some of everything, or nothing of a kind.
TEST(MeshStretch, OfTwoProcessesOneVtuHasTheBytesOfTheMesh) {
  const TemporaryFolder folder;
  for (const MeshData& mesh : meshes())
    for (const std::size_t n : {0U, 1U, 2U}) {
      write_mesh(folder / "a.vtu", mesh, {});
      std::vector<std::vector<std::string>> written;
      for (const bool is_first : {true, false}) {
        MeshData mine = mesh;
        MeshStretch stretch = stretch_of(mine);
        const MeshStretch whole = stretch_of(mesh);
        stretch.processes.rank = is_first ? 0 : 1;
        stretch.processes.n = 2;
        share_out(mine.cells, mine.regions, is_first, std::min(n, mesh.cells.size()), stretch.cells,
                  whole.cells.total);
        share_out(mine.triangles, mine.triangle_labels, is_first, std::min(n, mesh.triangles.size()),
                  stretch.triangles, whole.triangles.total);
        share_out(mine.edges, mine.edge_labels, is_first, std::min(n, mesh.edges.size()), stretch.edges,
                  whole.edges.total);
        stretch.first_point = is_first ? 0 : n;
        const std::size_t n_points = is_first ? n : mesh.points.size() - n;
        stretch.points = std::span(mesh.points).subspan(stretch.first_point, n_points);
        if (!mesh.vertex_labels.empty())
          stretch.vertex_labels = std::span(mesh.vertex_labels).subspan(stretch.first_point, n_points);
        std::erase_if(mine.fixed_vertices, [&](Index v) { return (v < n) != is_first; });
        stretch.fixed = {mesh.fixed_vertices.size(), NumberRows(mine.fixed_vertices), {}};
        Stretches sink;
        stretched_file(folder / "a.vtu", stretch, {}).write(sink);
        written.push_back(sink.finish());
      }
      ASSERT_EQ(written[0].size(), written[1].size());
      std::string all;
      for (std::size_t i = 0; i < written[0].size(); ++i) all += written[0][i] + written[1][i];
      EXPECT_TRUE(all == bytes_of(folder / "a.vtu")) << n << ", " << all.size() << " bytes";
    }
}

}  // namespace
}  // namespace hfr::io
