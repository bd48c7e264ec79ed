// SPDX-License-Identifier: BSD-3-Clause
// Prints a fingerprint of the output of each of a few runs, one a line. scripts/same-bits.sh compares the
// lines of several builds and numbers of threads. Usage: same_bits THREADS
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "HalfFace/Generate.hh"
#include "HalfFace/TetMesh.hh"
#include "Remesh/Improve.hh"

namespace hfr {
namespace {

std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9e3779b97f4a7c15ULL;
  return hash ^ hash >> 32;
}

/// Of every coordinate and every corner, in their order.
std::uint64_t fingerprint(const TetMesh& mesh) {
  std::uint64_t hash = mesh.n_cells();
  for (const Vec3& p : mesh.points()) {
    for (const double x : {p.x, p.y, p.z}) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &x, sizeof bits);
      hash = mix(hash, bits);
    }
  }
  for (CellHandle c : mesh.cells())
    for (VertexHandle v : mesh.cell(c).v) hash = mix(hash, v.idx());
  return hash;
}

int failures = 0;

void run(const std::string& name, const generate::Arrays& arrays, ImproveOptions options, int threads) {
  TetMesh mesh = build(arrays.points, arrays.cells, options.policy);
  const std::uint64_t before = fingerprint(mesh);
  options.statistics = false;
  options.policy = {threads, /*serial_below=*/1};  // so that small loops really run in parallel
  const Result result = improve(mesh, options);
  const std::uint64_t after = fingerprint(mesh);
  std::printf("%s %016llx, %zu cells\n", name.c_str(), static_cast<unsigned long long>(after),
              mesh.n_cells());
  if (!result.changed || before == after) {
    std::fprintf(stderr, "same_bits: nothing was changed in '%s'\n", name.c_str());
    ++failures;
  }
}

}  // namespace
}  // namespace hfr

int main(int argc, char** argv) {
  using namespace hfr;
  if (argc != 2 || std::atoi(argv[1]) < 1) {
    std::fprintf(stderr, "usage: same_bits THREADS\n");
    return 1;
  }
  const int threads = std::atoi(argv[1]);
  const generate::Arrays tangled = generate::jittered_box({7, 7, 7}, 0.42, 5);
  generate::CavityOptions deformed;
  deformed.counts = {11, 11, 11};
  deformed.sigma = 0.12;
  deformed.amplitude = 0.45;
  const generate::Arrays cavity = generate::cavity(deformed);
  run("default, jittered box", tangled, {}, threads);
  run("default, cavity", cavity, {}, threads);
  generate::Arrays pressed = generate::jittered_box({3, 3, 3}, 0.3, 7);
  for (Vec3& p : pressed.points) p.z *= 0.05;
  run("default, poor throughout", pressed, {}, threads);
  ImproveOptions options;
  options.min_dihedral = 18;
  run("goal, cavity", cavity, options, threads);
  options = {};
  options.rounds = Rounds::kByKind;
  run("kinds in turn, jittered box", tangled, options, threads);
  options = {};
  options.smoother = Smoother::kCandidates;
  run("candidates, cavity", cavity, options, threads);
  options = {};
  options.compat = Compat::kJpdc2013;
  run("paper, cavity", cavity, options, threads);
  return failures == 0 ? 0 : 1;
}
