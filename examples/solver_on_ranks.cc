// SPDX-License-Identifier: BSD-3-Clause
// A solver on several ranks whose mesh moves: each rank has its cells and their points as arrays, a swirl
// carries the inner vertices and what the cells hold along, and all ranks repair the mesh where it has to be,
// without any of them having the whole. Prints a line a step; ends with 1 where a step has left an inverted
// cell, an angle below the goal, or another mass than there was. Usage: mpirun -n 2 example_solver_on_ranks
// [N STEPS]     6 N³ cells (16)
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <hfremesh/Distributed/Remesher.hh>
#include <hfremesh/HalfFace/Generate.hh>
#include <map>
#include <numbers>
#include <span>
#include <vector>

namespace {

using hfr::Vec3;
using hfr::mpi::RankArrays;

constexpr double kTrigger = 10, kGoal = 15;  // degrees

/// A slab of a cube: cells of this rank, with the points that they need, numbered as in the whole.
RankArrays slab(hfr::Index n, int rank, int n_ranks) {
  const hfr::generate::Arrays cube = hfr::generate::box({n, n, n});
  const std::size_t n_cells = cube.cells.size(), size = static_cast<std::size_t>(n_ranks);
  RankArrays mine;
  std::map<std::uint64_t, Vec3> points;
  for (std::size_t c = 0; c < n_cells; ++c) {
    if (static_cast<int>(c * size / n_cells) != rank) continue;
    auto& corners = mine.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = cube.cells[c][k];
      points[corners[k]] = cube.points[cube.cells[c][k]];
    }
  }
  for (const auto& [number, point] : points) {
    mine.vertex_number.push_back(number);
    mine.points.push_back(point);
  }
  return mine;  // without numbers of cells: they are given in the order of ranks
}

/// The displacement of a point in a step, along a swirl that leaves the surface of the cube where it is.
Vec3 displacement(Vec3 p) {
  constexpr double kPi = std::numbers::pi, kStep = 0.02;
  const auto hump = [](double t) { return std::sin(kPi * t) * std::sin(kPi * t); };
  const double speed = kStep * hump(p.z);
  return {speed * hump(p.x) * std::sin(2 * kPi * p.y), -speed * std::sin(2 * kPi * p.x) * hump(p.y), 0};
}

/// Volumes of the cells of a rank, with its points as they are or displaced.
std::vector<double> volumes(const RankArrays& mine, double fraction) {
  std::vector<double> out;
  for (const auto& cell : mine.cells) {
    std::array<Vec3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto at = std::lower_bound(mine.vertex_number.begin(), mine.vertex_number.end(), cell[k]);
      const Vec3 was = mine.points[static_cast<std::size_t>(at - mine.vertex_number.begin())];
      p[k] = was + fraction * displacement(was);
    }
    out.push_back(dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) / 6);
  }
  return out;
}

/// Density times volume, over all ranks.
double mass_of(std::span<const double> density, const RankArrays& mine) {
  double mass = 0, all = 0;
  const std::vector<double> volume = volumes(mine, 0);
  for (std::size_t i = 0; i < volume.size(); ++i) mass += density[i] * volume[i];
  MPI_Allreduce(&mass, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return all;
}

bool run(hfr::mpi::Comm& comm, hfr::Index n, int n_steps) {
  hfr::RemesherOptions options;
  options.improve.min_dihedral = kGoal;
  options.improve.policy.threads = 1;  // a core for each rank
  options.triggers.min_dihedral = kTrigger;
  options.fields = {{.name = "temperature"}, {.name = "density", .how = hfr::Transfer::kConserve}};
  hfr::mpi::Remesher remesher(comm, slab(n, comm.rank(), comm.size()), options);
  {  // values of the points and of the cells that this rank has
    const RankArrays mine = remesher.arrays();
    std::vector<double> temperature, density(mine.cells.size(), 1.0);
    for (const Vec3& p : mine.points) temperature.push_back(p.x);
    remesher.set_field("temperature", temperature);
    remesher.set_field("density", density);
  }
  bool is_good = true;
  for (int step = 1; step <= n_steps; ++step) {
    const RankArrays mine = remesher.arrays();  // what the solver goes on with: its cells, points and numbers
    std::vector<Vec3> displacements;
    for (const Vec3& p : mine.points) displacements.push_back(displacement(p));
    // A cell keeps what it holds while it moves.
    const auto density = remesher.field("density");
    std::vector<double> moved(density.begin(), density.end());
    const std::vector<double> before = volumes(mine, 0), after = volumes(mine, 1);
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] *= before[i] / after[i];
    const double mass_before = mass_of(density, mine);
    remesher.set_field("density", moved);
    const hfr::mpi::PartsStep done = remesher.step(displacements);
    const double mass = mass_of(remesher.field("density"), remesher.arrays());
    is_good = is_good && done.n_inverted == 0 && done.min_dihedral >= kTrigger &&
              std::abs(mass - mass_before) < 1e-12;
    if (comm.rank() == 0)
      std::printf("step %2d: smallest angle %5.2f, mass %.15f%s\n", step, done.min_dihedral, mass,
                  done.changed ? ", repaired: other cells now" : "");
  }
  return is_good;
}

}  // namespace

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  const auto argument = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
  int code = 0;
  {
    hfr::mpi::Comm comm(MPI_COMM_WORLD);
    try {
      code = run(comm, static_cast<hfr::Index>(argument(1, 16)), argument(2, 20)) ? 0 : 1;
    } catch (const hfr::mpi::RankFailed& failed) {
      code = failed.code();
    } catch (const std::exception& error) {  // the other ranks end, too
      const hfr::mpi::RankFailed failed = comm.fail(2, error.what());
      code = failed.code();
      std::fprintf(stderr, "%s\n", failed.what());
    }
  }
  MPI_Finalize();
  return code;
}
