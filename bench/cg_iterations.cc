// SPDX-License-Identifier: BSD-3-Clause
// What a better mesh buys a solver: iterations of conjugate gradients on a Laplace problem with linear
// elements, before and after a run, with Jacobi's and an incomplete Cholesky preconditioner (Eigen's, with
// its ordering and shifts). -Δu = 1, u = 0 on the boundary, from u = 0 until |r| < 1e-10 |b|. Inverted cells
// have negative entries on the diagonal and can make the matrix indefinite, for which the method is not made.
// The mesh before is given both ways: with signed volumes, as most assembly codes take them, and with
// absolute ones, as those do that integrate with |det J|. Flat cells, whose gradients do not exist, are left
// out. Usage: bench_cg_iterations [N_X N_Y N_Z JITTER SIGMA AMPLITUDE] without numbers for the two cavities
// of docs/performance.md.
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "HalfFace/Generate.hh"
#include "HalfFace/TetMesh.hh"
#include "Quality/Metrics.hh"
#include "Quality/Statistics.hh"
#include "Remesh/Improve.hh"

namespace hfr {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
constexpr double kTolerance = 1e-10;
constexpr int kMostIterations = 5000;

enum class Volumes { kSigned, kAbsolute };

struct System {
  Matrix matrix;
  Eigen::VectorXd load;
  std::size_t n_left_out = 0;  ///< flat cells
};

/// Gradients of the four linear functions of a cell, times 6V.
std::array<Vec3, 4> gradients(const std::array<Vec3, 4>& p) {
  std::array<Vec3, 4> g;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& f = kFaceCorners[k];
    g[k] = cross(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]]);
  }
  return g;
}

System assemble(const TetMesh& mesh, Volumes volumes) {
  std::vector<int> unknown(mesh.n_vertices(), 0);
  for (VertexHandle v : mesh.boundary_vertices()) unknown[v.idx()] = -1;
  int n = 0;
  for (VertexHandle v : mesh.vertices())
    if (unknown[v.idx()] == 0) unknown[v.idx()] = mesh.incident_cell(v).is_valid() ? n++ : -1;
  System system;
  system.load = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double>> entries;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const std::array<Vec3, 4> p = {mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])};
    double det = dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]));
    if (volumes == Volumes::kAbsolute) det = std::abs(det);
    if (orientation(p[0], p[1], p[2], p[3]) == 0) {
      ++system.n_left_out;
      continue;
    }
    const auto g = gradients(p);
    for (std::size_t i = 0; i < 4; ++i) {
      const int row = unknown[v[i].idx()];
      if (row < 0) continue;
      system.load[row] += det / 24;
      for (std::size_t j = 0; j < 4; ++j)
        if (const int column = unknown[v[j].idx()]; column >= 0)
          entries.emplace_back(row, column, dot(g[i], g[j]) / (6 * det));
    }
  }
  system.matrix.resize(n, n);
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  return system;
}

/// Nothing where the preconditioner cannot be made or the tolerance is not met.
template <class Preconditioner>
std::optional<int> iterations(const System& system) {
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Preconditioner> solver;
  solver.setTolerance(kTolerance);
  solver.setMaxIterations(kMostIterations);
  solver.compute(system.matrix);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd solution = solver.solve(system.load);
  if (solver.info() != Eigen::Success) return std::nullopt;
  return static_cast<int>(solver.iterations());
}

std::string text(std::optional<int> n) {
  return n ? std::to_string(*n) : "more than " + std::to_string(kMostIterations);
}

void print_row(const char* run, const TetMesh& mesh, Volumes volumes) {
  const Statistics figures = statistics(mesh);
  const System system = assemble(mesh, volumes);
  std::printf("| %zu | %s | %zu | %.2f | %s | %s |\n", mesh.n_cells(), run, figures.inverted.size(),
              figures.min_dihedral.min,
              text(iterations<Eigen::DiagonalPreconditioner<double>>(system)).c_str(),
              text(iterations<Eigen::IncompleteCholesky<double>>(system)).c_str());
  if (system.n_left_out > 0) std::printf("(%zu flat cells are left out)\n", system.n_left_out);
  std::fflush(stdout);
}

void run(const generate::CavityOptions& cavity) {
  const generate::Arrays arrays = generate::cavity(cavity);
  const TetMesh before = build(arrays.points, arrays.cells);
  print_row("before, signed volumes", before, Volumes::kSigned);
  print_row("before, absolute volumes", before, Volumes::kAbsolute);
  TetMesh mesh = before;
  ImproveOptions options;
  options.min_dihedral = 15;
  options.statistics = false;
  improve(mesh, options);
  print_row("`--min-dihedral 15`", mesh, Volumes::kSigned);
  mesh = before;
  options.min_dihedral.reset();
  improve(mesh, options);
  print_row("default", mesh, Volumes::kSigned);
}

}  // namespace
}  // namespace hfr

int main(int argc, char** argv) {
  using namespace hfr;
  if (argc != 1 && argc != 7) {
    std::fprintf(stderr, "usage: bench_cg_iterations [N_X N_Y N_Z JITTER SIGMA AMPLITUDE]\n");
    return 1;
  }
  std::printf(
      "| cells | run | inverted | smallest angle | Jacobi | incomplete Cholesky "
      "|\n|---|---|---|---|---|---|\n");
  generate::CavityOptions cavity;
  if (argc == 7) {
    const auto count = [&](int i) { return static_cast<Index>(std::strtoul(argv[i], nullptr, 10)); };
    cavity.counts = {count(1), count(2), count(3)};
    cavity.jitter = std::strtod(argv[4], nullptr);
    cavity.sigma = std::strtod(argv[5], nullptr);
    cavity.amplitude = std::strtod(argv[6], nullptr);
    run(cavity);
    return 0;
  }
  run(cavity);
  cavity.counts = {26, 27, 28};
  run(cavity);
  return 0;
}
