// SPDX-License-Identifier: BSD-3-Clause
// What a step of Remesher costs beside a pass over the quality of all cells, and a repair beside improve()
// with the same goal. Medians of steps in turn, in one run; with one thread of CPU seconds, so that it
// matters little what else the machine does. Usage: bench_remesher [THREADS [N ...]]     boxes of 6 N³ cells
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/Quality/Decisions.hh>
#include <hfremesh/Remesh/Improve.hh>
#include <hfremesh/Remesh/Remesher.hh>

namespace {

bool by_cpu = false;

double now() {
  if (!by_cpu)
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double seconds(const std::function<void()>& f) {
  const double start = now();
  f();
  return now() - start;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// Moves every k-th inner vertex so far that one of its cells falls below the trigger.
std::vector<hfr::Vec3> damage(const hfr::TetMesh& mesh, std::size_t n_bad, double h) {
  std::vector<hfr::Vec3> d(mesh.n_vertices());
  std::vector<hfr::VertexHandle> inner;
  for (hfr::VertexHandle v : mesh.vertices())
    if (!mesh.is_boundary(v)) inner.push_back(v);
  for (std::size_t i = 0; i < n_bad; ++i)
    d[inner[i * inner.size() / n_bad].idx()] = {0.6 * h, 0.1 * h, -0.2 * h};
  return d;
}

void measure(hfr::Index n, int threads) {
  const hfr::generate::Arrays arrays = hfr::generate::jittered_box({n, n, n}, 0.05, 1);
  const hfr::TetMesh fresh = hfr::build(arrays.points, arrays.cells);
  hfr::RemesherOptions options;
  options.improve.policy.threads = threads;
  options.improve.statistics = false;
  hfr::TetMesh mesh = fresh;
  hfr::Remesher remesher(mesh, options);
  const double h = 1.0 / n;
  std::vector<hfr::Vec3> all(mesh.n_vertices()), few(mesh.n_vertices());
  for (hfr::VertexHandle v : mesh.vertices()) all[v.idx()] = {1e-4 * h, -1e-4 * h, 1e-4 * h};
  for (std::size_t i = 0; i < few.size(); i += 100) few[i] = all[i];
  std::vector<double> pass, moved_all, moved_few, t_values(mesh.n_cells());
  for (int i = 0; i < 15; ++i) {
    pass.push_back(seconds([&] {
      hfr::par::for_ranges(options.improve.policy, mesh.n_cells(), [&](std::size_t begin, std::size_t end) {
        hfr::for_decisions(mesh, hfr::MinDihedral{}, begin, end,
                           [&](std::size_t c, double value) { t_values[c] = value; });
      });
    }));
    moved_all.push_back(seconds([&] { remesher.step(all); }));
    moved_few.push_back(seconds([&] { remesher.step(few); }));
    for (auto* d : {&all, &few})
      for (hfr::Vec3& p : *d) p = -p;
  }
  std::printf(
      "%9zu cells, %d threads: quality pass %.2f ms; step, all moved %.2f ms (%.2f of a pass), 1 %% moved "
      "%.2f ms\n",
      mesh.n_cells(), threads, 1e3 * median(pass), 1e3 * median(moved_all), median(moved_all) / median(pass),
      1e3 * median(moved_few));
  for (const std::size_t n_bad : {50, 500, 5000}) {
    const std::vector<hfr::Vec3> d = damage(fresh, n_bad, h);
    std::vector<double> stepped, with_parents, improved, with_fields;
    std::size_t created = 0, n_parents = 0;
    for (int i = 0; i < 5; ++i) {
      hfr::TetMesh one = fresh, two = fresh, three = fresh, four = fresh;
      hfr::Remesher a(one, options);
      stepped.push_back(seconds([&] {
        const hfr::StepResult step = a.step(d);
        created = step.repairs.empty() ? 0 : step.repairs[0].edits.created_cells.size();
      }));
      hfr::Remesher c(four, options);
      with_parents.push_back(seconds([&] {
        for (const hfr::RepairResult& repair : c.step(d).repairs)
          n_parents += repair.edits.parents().all.size();
      }));
      for (hfr::VertexHandle v : two.vertices()) two.set_point(v, two.point(v) + d[v.idx()]);
      improved.push_back(seconds([&] { hfr::improve(two, options.improve); }));
      three.request_cell_property<double>("rho", 1.0);
      three.request_vertex_property<double>("T", 1.0);
      hfr::RemesherOptions fields = options;
      fields.fields = {{.name = "T"}, {.name = "rho", .how = hfr::Transfer::kConserve}};
      hfr::Remesher b(three, fields);
      with_fields.push_back(seconds([&] { b.step(d); }));
    }
    std::printf(
        "  %5zu vertices displaced: improve %.1f ms; step %.2f of it, with parents %.2f, with two fields "
        "%.2f; "
        "%zu cells created, %zu parents\n",
        n_bad, 1e3 * median(improved), median(stepped) / median(improved),
        median(with_parents) / median(improved), median(with_fields) / median(improved), created,
        n_parents / with_parents.size());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int threads = argc > 1 ? std::atoi(argv[1]) : 2;
  by_cpu = threads == 1;
  if (argc > 2)
    for (int i = 2; i < argc; ++i) measure(static_cast<hfr::Index>(std::atoi(argv[i])), threads);
  else
    for (const hfr::Index n : {22U, 46U}) measure(n, threads);
}
