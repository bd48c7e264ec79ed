// SPDX-License-Identifier: BSD-3-Clause
// From file to file: reads a mesh with all that is attached to it, improves it, and writes it again.
// Usage: example_file_to_file [INPUT OUTPUT]     without files it makes its own; docs/library.md explains it.
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/IO/ReadWrite.hh>
#include <hfremesh/Operators/EdgeRemoval.hh>
#include <hfremesh/Remesh/Improve.hh>
#include <hfremesh/Scheduler/RunUntilQuiet.hh>

std::atomic<bool> stop_wanted = false;  // a signal handler or another thread may set it

/// A box with crooked cells in two regions, with a field.
void write_some_mesh(const std::filesystem::path& path) {
  const hfr::generate::Arrays box = hfr::generate::jittered_box({8, 8, 8}, 0.35, 1);
  hfr::TetMesh mesh = hfr::build(box.points, box.cells);
  auto heat = mesh.request_vertex_property<double>("heat", 0.0);
  for (hfr::VertexHandle v : mesh.vertices()) heat[v] = mesh.point(v).x;
  for (hfr::CellHandle c : mesh.cells())
    mesh.set_region(c, mesh.point(mesh.cell_vertices(c)[0]).z < 0.5 ? 1 : 2);
  hfr::io::write(path, mesh);
}

/// A metric of one's own: here the smallest edge by the largest, which no inverted cell gets a value from.
double shortest_by_longest(hfr::Vec3 a, hfr::Vec3 b, hfr::Vec3 c, hfr::Vec3 d) {
  double low = hfr::norm2(b - a), high = low;
  for (hfr::Vec3 e : {c - a, d - a, c - b, d - b, d - c}) {
    low = std::min(low, hfr::norm2(e));
    high = std::max(high, hfr::norm2(e));
  }
  return low / high;
}

/// Edge removal by that metric, until it finds nothing more.
std::size_t remove_edges(hfr::TetMesh& mesh) {
  const hfr::CustomMetric metric(shortest_by_longest);
  hfr::Workspace work;
  work.attach(mesh, {});
  work.set_qualities(mesh, metric, {});
  const auto op = [&] { return hfr::EdgeRemoval<hfr::CustomMetric>{metric, work.quality}; };
  const auto seeds = [](const hfr::TetMesh& m, const hfr::Worklist& list) {
    return hfr::edge_seeds(m, list, {});
  };
  const std::size_t n = hfr::run_until_quiet(mesh, work, op, seeds).winners;
  mesh.collect_garbage();
  return n;
}

int main(int argc, char** argv) try {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  const std::filesystem::path input = argc == 3 ? argv[1] : folder / "hfremesh_example_in.vtu";
  const std::filesystem::path output = argc == 3 ? argv[2] : folder / "hfremesh_example_out.vtu";
  if (argc != 3) write_some_mesh(input);

  hfr::io::ReadReport report;
  hfr::TetMesh mesh = hfr::io::read(input, hfr::par::Policy::all(), &report);
  for (const std::string& note : report.notes) std::printf("%s\n", note.c_str());
  for (const std::string& name : mesh.properties().vertices.names())
    std::printf("field on vertices: %s\n", name.c_str());

  hfr::ImproveOptions options;
  options.min_dihedral = 15;  // only cells below are worked on; without a goal, the whole mesh
  options.time_limit = 60;
  options.progress = [](const hfr::Progress& p) {
    std::printf("%s %d: %zu inverted, %.1f degrees\n", p.stage.c_str(), p.iteration, p.n_inverted,
                p.min_dihedral);
  };
  options.cancel = [] { return stop_wanted.load(); };
  const hfr::Result result = hfr::improve(mesh, options);
  std::printf("smallest angle %.2f -> %.2f degrees, %zu invalid cells left\n", result.before.min_dihedral.min,
              result.after.min_dihedral.min, result.invalid_cells.size());
  std::printf("%zu edges removed by a metric of one's own\n", remove_edges(mesh));

  for (const std::string& lost : hfr::io::write(output, mesh)) std::printf("%s\n", lost.c_str());
  return result.invalid_cells.empty() ? 0 : 1;
} catch (const hfr::Error& error) {  // one line that says where and what to do
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
