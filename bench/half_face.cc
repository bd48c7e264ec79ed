// SPDX-License-Identifier: BSD-3-Clause
// The kernel by itself on a box of 622,938 cells: in the order of its making, in random order, and put in
// order by reorder(). Times are per cell or per visit; one thread unless the name says otherwise.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "HalfFace/Check.hh"
#include "HalfFace/EdgeList.hh"
#include "HalfFace/Generate.hh"
#include "HalfFace/Reorder.hh"
#include "HalfFace/TetMesh.hh"
#include "HalfFace/Writer.hh"
#include "Operators/Operator.hh"
#include "Scheduler/StarTable.hh"

namespace hfr {
namespace {

enum Order { kAsMade, kRandom, kHilbert, kMorton };

template <class T>
std::vector<std::size_t> shuffle(std::vector<T>& items, std::uint64_t seed) {
  std::vector<std::size_t> place(items.size());
  std::iota(place.begin(), place.end(), 0);
  for (std::size_t i = items.size(); i > 1; --i) {
    const auto j = static_cast<std::size_t>(generate::random_unit(seed, i) * static_cast<double>(i));
    std::swap(items[i - 1], items[j]);
    std::swap(place[i - 1], place[j]);
  }
  return place;  // where each came from
}

/// Turns each cell by a random even permutation.
void mix_corners(generate::Arrays& box) {
  for (std::size_t i = 0; i < box.cells.size(); ++i) {
    auto& c = box.cells[i];
    const auto first = static_cast<std::size_t>(4 * generate::random_unit(3, i));
    if (first > 0) {
      std::swap(c[0], c[first]);
      std::swap(c[1 + first % 3], c[1 + (first + 1) % 3]);
    }
    const auto turn = static_cast<std::ptrdiff_t>(3 * generate::random_unit(4, i));
    std::rotate(c.begin() + 1, c.begin() + 1 + turn, c.end());
  }
}

generate::Arrays make_arrays(Order order) {
  generate::Arrays box = generate::jittered_box({47, 47, 47}, 0.1, 1);
  mix_corners(box);
  if (order == kAsMade) return box;
  const std::vector<std::size_t> came_from = shuffle(box.points, 1);
  std::vector<Index> went_to(came_from.size());
  for (std::size_t i = 0; i < came_from.size(); ++i) went_to[came_from[i]] = static_cast<Index>(i);
  shuffle(box.cells, 2);
  for (auto& cell : box.cells)
    for (Index& v : cell) v = went_to[v];
  return box;
}

/// Made once an order and kept, since every benchmark function is entered several times.
const TetMesh& mesh_in(Order order) {
  static std::map<Order, TetMesh> made;
  const auto at = made.find(order);
  if (at != made.end()) return at->second;
  const generate::Arrays arrays = make_arrays(order);
  TetMesh mesh = build(arrays.points, arrays.cells);
  if (order == kHilbert) reorder(mesh);
  if (order == kMorton) reorder(mesh, {.curve = SpaceCurve::kMorton});
  return made.emplace(order, std::move(mesh)).first->second;
}

void per(benchmark::State& state, const char* what, double n) {
  state.counters[what] =
      benchmark::Counter(n, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void Build(benchmark::State& state) {
  const generate::Arrays arrays = make_arrays(static_cast<Order>(state.range(0)));
  par::Policy policy;
  policy.threads = static_cast<int>(state.range(1));
  for (auto _ : state) {
    state.PauseTiming();
    std::vector<Vec3> points = arrays.points;
    state.ResumeTiming();
    TetMesh mesh = build(std::move(points), arrays.cells, policy);
    benchmark::DoNotOptimize(mesh);
    state.PauseTiming();
    mesh = TetMesh();
    state.ResumeTiming();
  }
  per(state, "per_cell", static_cast<double>(arrays.cells.size()));
}

/// All edges by ascending handle, each ring once round.
void RingWalk(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  const std::vector<EdgeHandle> edges(mesh.edges().begin(), mesh.edges().end());
  std::size_t visits = 0;
  for (auto _ : state) {
    visits = 0;
    Index sum = 0;
    for (EdgeHandle e : edges) {
      for (CellHandle c : mesh.edge_cells(e)) {
        sum += c.idx();
        ++visits;
      }
    }
    benchmark::DoNotOptimize(sum);
  }
  per(state, "per_visit", static_cast<double>(visits));
}

/// The same through walk_ring(), which does not look for the boundary beforehand.
void RingWalkCallback(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  const std::vector<EdgeHandle> edges(mesh.edges().begin(), mesh.edges().end());
  std::size_t visits = 0;
  for (auto _ : state) {
    visits = 0;
    Index sum = 0;
    for (EdgeHandle e : edges) {
      mesh.walk_ring(CellHandle(e.idx() / 6), static_cast<int>(e.idx() % 6),
                     [&](CellHandle c, VertexHandle, VertexHandle) {
                       sum += c.idx();
                       ++visits;
                       return true;
                     });
    }
    benchmark::DoNotOptimize(sum);
  }
  per(state, "per_visit", static_cast<double>(visits));
}

/// The cells of every vertex.
void StarWalk(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  std::size_t visits = 0;
  for (auto _ : state) {
    visits = 0;
    Index sum = 0;
    for (VertexHandle v : mesh.vertices()) {
      for (CellHandle c : mesh.vertex_cells(v)) {
        sum += c.idx();
        ++visits;
      }
    }
    benchmark::DoNotOptimize(sum);
  }
  per(state, "per_visit", static_cast<double>(visits));
}

StarTable table_of(const TetMesh& mesh) {
  const std::vector<VertexHandle> all(mesh.vertices().begin(), mesh.vertices().end());
  return StarTable(mesh, all, star_sizes(mesh));
}

void MakeStarTable(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  for (auto _ : state) {
    const StarTable table = table_of(mesh);
    benchmark::DoNotOptimize(table.link(0).data());
  }
  per(state, "per_cell", static_cast<double>(mesh.n_cells()));
}

/// The cells of every vertex from the table that is made while topology stands still, reading their records.
void StarTableWalk(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  const StarTable table = table_of(mesh);
  std::size_t visits = 0;
  for (auto _ : state) {
    visits = 0;
    Index sum = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      for (HalfFaceHandle h : table.link(i)) {
        sum += mesh.cell(cell_of(h)).v[h.idx() % 4].idx();
        ++visits;
      }
    }
    benchmark::DoNotOptimize(sum);
  }
  per(state, "per_visit", static_cast<double>(visits));
}

void VertexNeighbours(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  std::size_t visits = 0;
  for (auto _ : state) {
    visits = 0;
    Index sum = 0;
    for (VertexHandle v : mesh.vertices()) {
      for (VertexHandle w : mesh.vertex_vertices(v)) {
        sum += w.idx();
        ++visits;
      }
    }
    benchmark::DoNotOptimize(sum);
  }
  per(state, "per_visit", static_cast<double>(visits));
}

void AllEdges(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(mesh.n_edges());
  per(state, "per_cell", static_cast<double>(mesh.n_cells()));
}

/// Every edge looked up by its ends.
void FindEdge(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  std::vector<std::array<VertexHandle, 2>> ends;
  for (EdgeHandle e : mesh.edges()) ends.push_back(mesh.edge_vertices(e));
  for (auto _ : state) {
    Index sum = 0;
    for (const auto& [a, b] : ends) sum += mesh.find_edge(a, b).idx();
    benchmark::DoNotOptimize(sum);
  }
  per(state, "per_edge", static_cast<double>(ends.size()));
}

/// One cell in the middle goes after an operator wrote, which voids every table of the kernel.
void DeleteCellAfterWriting(benchmark::State& state) {
  TetMesh mesh = mesh_in(kAsMade);
  std::size_t bytes = mesh.memory_bytes();
  Index next = static_cast<Index>(mesh.n_cells() / 2);
  for (auto _ : state) {
    TetMesh::Writer(mesh).cell(CellHandle(0));
    mesh.delete_cell(CellHandle(next++));
  }
  bytes = mesh.memory_bytes() - bytes;
  state.counters["more_bytes"] = static_cast<double>(bytes);
}

void MakeEdgeList(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(EdgeList(mesh).size());
  per(state, "per_cell", static_cast<double>(mesh.n_cells()));
}

void EdgeListWalk(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  const EdgeList list(mesh);
  for (auto _ : state) {
    Index sum = 0;
    for (EdgeHandle e : list) sum += e.idx();
    benchmark::DoNotOptimize(sum);
  }
  per(state, "per_edge", static_cast<double>(list.size()));
}

void CheckAll(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(static_cast<Order>(state.range(0)));
  for (auto _ : state)
    if (!check(mesh)) state.SkipWithError("the mesh is broken");
  per(state, "per_cell", static_cast<double>(mesh.n_cells()));
}

void ReorderRandom(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(kRandom);
  for (auto _ : state) {
    state.PauseTiming();
    TetMesh copy = mesh;
    state.ResumeTiming();
    reorder(copy, {.curve = static_cast<SpaceCurve>(state.range(0))});
    benchmark::DoNotOptimize(copy);
  }
  per(state, "per_cell", static_cast<double>(mesh.n_cells()));
}

void CollectGarbage(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(kAsMade);
  for (auto _ : state) {
    state.PauseTiming();
    TetMesh copy = mesh;
    state.ResumeTiming();
    copy.collect_garbage();
    benchmark::DoNotOptimize(copy);
  }
  per(state, "per_cell", static_cast<double>(mesh.n_cells()));
}

/// Not a time: memory of connectivity and points.
void Memory(benchmark::State& state) {
  const TetMesh& mesh = mesh_in(kAsMade);
  for (auto _ : state) benchmark::DoNotOptimize(mesh.memory_bytes());
  state.counters["bytes_per_cell"] =
      static_cast<double>(mesh.memory_bytes()) / static_cast<double>(mesh.n_cells());
}

BENCHMARK(Build)
    ->ArgNames({"order", "threads"})
    ->ArgsProduct({{kAsMade, kRandom}, {1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(Build)
    ->Name("BuildParallel")
    ->ArgNames({"order", "threads"})
    ->ArgsProduct({{kAsMade, kRandom}, {2, 4}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(RingWalk)->ArgName("order")->DenseRange(kAsMade, kMorton)->Unit(benchmark::kMillisecond);
BENCHMARK(RingWalkCallback)->ArgName("order")->DenseRange(kAsMade, kMorton)->Unit(benchmark::kMillisecond);
BENCHMARK(StarWalk)->ArgName("order")->DenseRange(kAsMade, kMorton)->Unit(benchmark::kMillisecond);
BENCHMARK(MakeStarTable)->ArgName("order")->DenseRange(kAsMade, kMorton)->Unit(benchmark::kMillisecond);
BENCHMARK(StarTableWalk)->ArgName("order")->DenseRange(kAsMade, kMorton)->Unit(benchmark::kMillisecond);
BENCHMARK(VertexNeighbours)->ArgName("order")->DenseRange(kAsMade, kHilbert)->Unit(benchmark::kMillisecond);
BENCHMARK(AllEdges)->ArgName("order")->DenseRange(kAsMade, kHilbert)->Unit(benchmark::kMillisecond);
BENCHMARK(FindEdge)->ArgName("order")->DenseRange(kAsMade, kHilbert)->Unit(benchmark::kMillisecond);
BENCHMARK(DeleteCellAfterWriting)->Iterations(20)->Unit(benchmark::kMicrosecond);
BENCHMARK(MakeEdgeList)->ArgName("order")->DenseRange(kAsMade, kHilbert)->Unit(benchmark::kMillisecond);
BENCHMARK(EdgeListWalk)->ArgName("order")->DenseRange(kAsMade, kHilbert)->Unit(benchmark::kMillisecond);
BENCHMARK(CheckAll)->ArgName("order")->DenseRange(kAsMade, kHilbert)->Unit(benchmark::kMillisecond);
BENCHMARK(ReorderRandom)->ArgName("curve")->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(CollectGarbage)->Unit(benchmark::kMillisecond);
BENCHMARK(Memory);

}  // namespace
}  // namespace hfr

BENCHMARK_MAIN();
