// SPDX-License-Identifier: BSD-3-Clause
// Heat spreads through a material that is stirred. The mesh moves with the material, linear elements and
// Eigen's conjugate gradients make each time step, and where the mesh has become bad it is repaired between
// two steps. Prints for each repair the iterations before and after it, and how many rows of the matrix the
// edits left alone: these are taken over, and the whole is compared with the matrix of a full assembly. Ends
// with 1 where the two differ, or iterations have not become fewer, or a cell is inverted.
// Usage: example_heat_equation [N STEPS]     6 N³ cells
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/Remesh/Remesher.hh>
#include <numbers>

namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Entries = std::vector<Eigen::Triplet<double>>;

constexpr double kTimeStep = 0.05;  // of heat: with the box of side 1, long enough for stiffness to rule

/// (mass + time step · stiffness) T = mass · T before. Mass is lumped, the boundary insulated.
struct System {
  Matrix matrix;
  Eigen::VectorXd mass;
};

/// What a cell adds to the rows of those of its vertices that are wanted.
template <class Wants>
void add_cell(const hfr::TetMesh& mesh, hfr::CellHandle c, Wants&& wants, Entries& entries,
              Eigen::VectorXd& mass) {
  const auto& v = mesh.cell_vertices(c);
  std::array<hfr::Vec3, 4> p, normal;
  for (std::size_t k = 0; k < 4; ++k) p[k] = mesh.point(v[k]);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& f = hfr::kFaceCorners[k];
    normal[k] = hfr::cross(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]]);
  }
  const double det = hfr::dot(p[1] - p[0], hfr::cross(p[2] - p[0], p[3] - p[0]));
  for (std::size_t i = 0; i < 4; ++i) {
    if (!wants(v[i])) continue;
    const auto row = static_cast<int>(v[i].idx());
    mass[row] += det / 24;
    entries.emplace_back(row, row, det / 24);
    for (std::size_t j = 0; j < 4; ++j)
      entries.emplace_back(row, static_cast<int>(v[j].idx()),
                           kTimeStep * hfr::dot(normal[i], normal[j]) / (6 * det));
  }
}

System made_of(Entries entries, Eigen::VectorXd mass) {
  System system;
  system.matrix.resize(mass.size(), mass.size());
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  system.mass = std::move(mass);
  return system;
}

System assemble(const hfr::TetMesh& mesh) {
  Entries entries;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.n_vertices()));
  for (hfr::CellHandle c : mesh.cells())
    add_cell(
        mesh, c, [](auto) { return true; }, entries, mass);
  return made_of(std::move(entries), std::move(mass));
}

/// The system after a repair, of that before it: rows of vertices with a created or moved cell are made anew,
/// of their cells alone; the others are those that there were, under new numbers.
System updated(const System& old, const hfr::TetMesh& mesh, const hfr::Edits& edits, std::size_t& n_kept) {
  const auto n = static_cast<Eigen::Index>(mesh.n_vertices());
  std::vector<char> is_new(mesh.n_vertices(), 0);
  const auto mark = [&](hfr::CellHandle c) {
    for (hfr::VertexHandle v : mesh.cell_vertices(c)) is_new[v.idx()] = 1;
  };
  for (const hfr::CreatedCell& c : edits.created_cells) mark(c.cell);
  for (hfr::CellHandle c : edits.moved_cells) mark(c);
  Entries entries;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
  std::vector<hfr::CellHandle> cells;
  n_kept = 0;
  for (hfr::VertexHandle v : mesh.vertices()) {
    if (is_new[v.idx()]) {
      for (hfr::CellHandle c : mesh.vertex_cells(v)) cells.push_back(c);
      continue;
    }
    ++n_kept;
    const auto before = static_cast<Eigen::Index>(edits.maps.old_vertices[v.idx()].idx());
    mass[static_cast<Eigen::Index>(v.idx())] = old.mass[before];
    for (Matrix::InnerIterator at(old.matrix, before); at; ++at)
      entries.emplace_back(static_cast<int>(v.idx()),
                           static_cast<int>(edits.maps.vertices[static_cast<std::size_t>(at.col())].idx()),
                           at.value());
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  for (hfr::CellHandle c : cells)
    add_cell(
        mesh, c, [&](hfr::VertexHandle v) { return is_new[v.idx()] != 0; }, entries, mass);
  return made_of(std::move(entries), std::move(mass));
}

/// Largest difference of an entry, as a share of the largest entry.
double difference(const Matrix& a, const Matrix& b) {
  if (a.nonZeros() != b.nonZeros()) return 1;
  const Matrix apart = a - b;
  double most = 0, largest = 0;
  for (Eigen::Index k = 0; k < apart.nonZeros(); ++k) most = std::max(most, std::abs(apart.valuePtr()[k]));
  for (Eigen::Index k = 0; k < b.nonZeros(); ++k) largest = std::max(largest, std::abs(b.valuePtr()[k]));
  return most / largest;
}

/// One time step; returns the iterations that it took.
int solve(const System& system, Eigen::VectorXd& heat) {
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> solver;  // Jacobi's preconditioner
  solver.setTolerance(1e-10);
  solver.compute(system.matrix);
  const Eigen::VectorXd load = system.mass.cwiseProduct(heat);
  heat = solver.solve(load);  // from nothing, so that iterations can be compared
  return static_cast<int>(solver.iterations());
}

/// A vortex about the middle of the box that leaves its boundary alone; turns one way, then the other.
std::vector<hfr::Vec3> stir(const hfr::TetMesh& mesh, double by) {
  using std::numbers::pi;
  std::vector<hfr::Vec3> displacement(mesh.n_vertices());
  for (hfr::VertexHandle v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    const hfr::Vec3 p = mesh.point(v);
    const double sx = std::sin(pi * p.x), sy = std::sin(pi * p.y), lift = by * std::sin(pi * p.z);
    displacement[v.idx()] = {lift * sx * sx * std::sin(2 * pi * p.y),
                             -lift * sy * sy * std::sin(2 * pi * p.x), 0};
  }
  return displacement;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto n = static_cast<hfr::Index>(argc > 2 ? std::atoi(argv[1]) : 10);
  const int n_steps = argc > 2 ? std::atoi(argv[2]) : 30;
  const hfr::generate::Arrays box = hfr::generate::jittered_box({n, n, n}, 0.15, 1);
  hfr::TetMesh mesh = hfr::build(box.points, box.cells);
  auto kept = mesh.request_vertex_property<double>("heat");
  for (hfr::VertexHandle v : mesh.vertices()) kept[v] = mesh.point(v).x < 0.5 ? 1 : 0;

  hfr::RemesherOptions options;
  options.improve.min_dihedral = 18;
  options.triggers.min_dihedral = 4;
  options.fields = {{.name = "heat"}};
  hfr::Remesher remesher(mesh, options);
  std::printf("%zu cells\nstep  angle  CG  ->  angle  CG   rows left alone   differ by\n", mesh.n_cells());
  int n_repairs = 0, n_wrong = 0;
  for (int i = 1; i <= n_steps; ++i) {
    remesher.move(stir(mesh, 0.015));
    System system = assemble(mesh);
    Eigen::VectorXd heat =
        Eigen::Map<const Eigen::VectorXd>(kept.values().data(), static_cast<Eigen::Index>(mesh.n_vertices()));
    const int iterations = solve(system, heat);
    std::copy(heat.begin(), heat.end(), kept.values().begin());
    if (remesher.needs_repair() == hfr::RepairCause::kNone) continue;
    const double angle = remesher.min_dihedral();
    const hfr::RepairResult repair = remesher.repair();
    remesher.transfer();
    std::size_t n_kept = 0;
    system = updated(system, mesh, repair.edits, n_kept);
    const double off = difference(system.matrix, assemble(mesh).matrix);
    heat = Eigen::Map<const Eigen::VectorXd>(kept.values().data(), static_cast<Eigen::Index>(kept.size()));
    const int now = solve(system, heat);
    std::printf("%4d  %5.2f %3d  ->  %5.2f %3d   %6zu of %6zu   %.1e\n", i, angle, iterations,
                remesher.min_dihedral(), now, n_kept, mesh.n_vertices(), off);
    ++n_repairs;
    if (off > 1e-12 || now > iterations || remesher.n_inverted() > 0) ++n_wrong;
  }
  return n_repairs > 0 && n_wrong == 0 ? 0 : 1;
} catch (const hfr::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
