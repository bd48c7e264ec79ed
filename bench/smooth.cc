// SPDX-License-Identifier: BSD-3-Clause
// The searches for a better place, by themselves: every inner vertex of a jittered box of 63,888 cells is
// asked once and none is moved. Times are per vertex, one thread; the star is read from the table that passes
// make. HFR_VECTORS = baseline, avx2 or avx512 chooses the copy that runs.
#include <benchmark/benchmark.h>

#include "HalfFace/Generate.hh"
#include "HalfFace/TetMesh.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothMaxMin.hh"
#include "Operators/SmoothNewton.hh"
#include "Scheduler/StarTable.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {
namespace {

template <class Search, class Metric>
void Smoothing(benchmark::State& state) {
  const generate::Arrays arrays = generate::jittered_box({22, 22, 22}, 0.2, 1);
  const TetMesh mesh = build(arrays.points, arrays.cells);
  Workspace work;
  work.attach(mesh, {});
  const Metric metric;
  work.set_qualities(mesh, metric, {});
  std::vector<VertexHandle> inner;
  for (VertexHandle v : mesh.vertices())
    if (!mesh.is_boundary(v)) inner.push_back(v);
  const StarTable stars(mesh, inner, work.star_size);
  const Search search;
  std::size_t moved = 0;
  for (auto _ : state) {
    moved = 0;
    for (std::size_t i = 0; i < inner.size(); ++i)
      if (search(mesh, inner[i], stars.link(i), metric, std::span<const double>(work.quality))) ++moved;
    benchmark::DoNotOptimize(moved);
  }
  const auto n = static_cast<double>(inner.size());
  state.counters["per_vertex"] =
      benchmark::Counter(n, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["share_that_moves"] = static_cast<double>(moved) / n;
}

BENCHMARK(Smoothing<CandidateSearch, VolumeLength>)->Unit(benchmark::kMillisecond);
BENCHMARK(Smoothing<NewtonSearch, VolumeLength>)->Unit(benchmark::kMillisecond);
BENCHMARK(Smoothing<MaxMinSearch, MinSine2>)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hfr

BENCHMARK_MAIN();
