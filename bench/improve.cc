// SPDX-License-Identifier: BSD-3-Clause
// improve() on one mesh file, again and again, with nothing else timed.
// Usage: bench_improve FILE [--goal DEGREES] [--threads N] [--repeat N] [--ops LIST]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "IO/Assemble.hh"
#include "IO/MeshFile.hh"
#include "Remesh/Improve.hh"

namespace {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Times {
  double total = 0, evaluate = 0, select = 0, commit = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr,
                 "usage: bench_improve FILE [--goal DEGREES] [--threads N] [--repeat N] [--ops LIST]\n");
    return 1;
  }
  hfr::ImproveOptions options;
  options.statistics = false;
  options.policy.threads = 1;
  int repeat = 5;
  for (int i = 2; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--goal") options.min_dihedral = std::atof(argv[i + 1]);
    if (name == "--threads") options.policy.threads = std::atoi(argv[i + 1]);
    if (name == "--repeat") repeat = std::atoi(argv[i + 1]);
    if (name == "--ops") options.ops = hfr::ops_from_list(argv[i + 1]);
  }
  const hfr::TetMesh loaded = hfr::io::assemble(hfr::io::read_mesh(argv[1]));
  std::vector<double> seconds;
  std::map<std::string, Times> by_pass;
  std::size_t n_cells = 0;
  for (int i = 0; i < repeat; ++i) {
    hfr::TetMesh mesh = loaded;
    const hfr::Result result = hfr::improve(mesh, options);
    seconds.push_back(result.seconds);
    n_cells = mesh.n_cells();
    for (const hfr::PassReport& pass : result.passes) {
      Times& t = by_pass[pass.stage + " " + pass.op];
      t.total += pass.seconds / repeat;
      t.evaluate += pass.seconds_evaluate / repeat;
      t.select += pass.seconds_select / repeat;
      t.commit += pass.seconds_commit / repeat;
    }
  }
  double in_passes = 0;
  std::printf("%-18s %9s %9s %9s %9s   ms, mean of %d\n", "pass", "total", "evaluate", "select", "commit",
              repeat);
  for (const auto& [name, t] : by_pass) {
    in_passes += t.total;
    std::printf("%-18s %9.2f %9.2f %9.2f %9.2f\n", name.c_str(), 1e3 * t.total, 1e3 * t.evaluate,
                1e3 * t.select, 1e3 * t.commit);
  }
  std::printf("in passes %.1f ms, whole %.1f ms (median), %zu -> %zu cells\n", 1e3 * in_passes,
              1e3 * median(seconds), loaded.n_cells(), n_cells);
  return 0;
}
