// SPDX-License-Identifier: BSD-3-Clause
// A cavity whose inside pulsates: every inner vertex moves to and fro over two periods, so far that angles
// fall below the trigger and cells invert. A temperature, of vertices, and a density, of cells, move with the
// material and are carried over the repairs. Prints how far they are from what they began with after each
// period, when all material is back at its place, and what became of the mass. Ends with 1 where that is more
// than rounding. Usage: example_pulsating_cavity [N STEPS_A_PERIOD [FOLDER]]     6 N³ cells
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/HalfFace/Geometry.hh>
#include <hfremesh/Remesh/Remesher.hh>
#include <numbers>

#include "Meshes.hh"

namespace {

const hfr::generate::CavityOptions kPush;
constexpr double kLargest = 1.5;  // how long the material flows one way

double field(hfr::Vec3 p) {
  return 2 + std::sin(2 * std::numbers::pi * p.x) * std::cos(std::numbers::pi * p.y) * (0.5 + p.z);
}

/// Where material at p is after flowing for `time`, or before it where that is negative: by Runge and Kutta's
/// fourth-order steps.
hfr::Vec3 flow(hfr::Vec3 p, double time) {
  const auto velocity = [](hfr::Vec3 q) { return hfr::generate::deform(q, kPush) - q; };
  constexpr int kSteps = 4;
  const double h = time / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const hfr::Vec3 a = velocity(p), b = velocity(p + 0.5 * h * a), c = velocity(p + 0.5 * h * b),
                    d = velocity(p + h * c);
    p = p + (h / 6) * (a + 2 * b + 2 * c + d);
  }
  return p;
}

std::vector<double> volumes(const hfr::TetMesh& mesh) {
  std::vector<double> out;
  for (hfr::CellHandle c : mesh.cells()) out.push_back(hfr::volume(mesh, c));
  return out;
}

double mass(const hfr::TetMesh& mesh, const hfr::CellProperty<double>& density) {
  double sum = 0;
  for (hfr::CellHandle c : mesh.cells()) sum += density[c] * hfr::volume(mesh, c);
  return sum;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto n = static_cast<hfr::Index>(argc > 2 ? std::atoi(argv[1]) : 10);
  const int period = argc > 2 ? std::atoi(argv[2]) : 20;
  const hfr::generate::Arrays box = hfr::generate::jittered_box({n, n, n}, 0.15, 1);
  hfr::TetMesh mesh = hfr::build(box.points, box.cells);
  auto heat = mesh.request_vertex_property<double>("heat");
  auto density = mesh.request_cell_property<double>("density");
  for (hfr::VertexHandle v : mesh.vertices()) heat[v] = field(mesh.point(v));
  for (hfr::CellHandle c : mesh.cells()) density[c] = field(hfr::barycenter(mesh, c));
  const double mass_first = mass(mesh, density);

  hfr::RemesherOptions options;
  options.improve.min_dihedral = 15;
  options.fields = {{.name = "heat"}, {.name = "density", .how = hfr::Transfer::kConserve}};
  hfr::Remesher remesher(mesh, options);
  const example::Folder folder(argc > 3 ? argv[3] : nullptr);
  double mass_error = 0, worst = 180;  // the worst mesh that was repaired is shown
  int n_repairs = 0;
  const auto time = [&](int i) { return kLargest * std::sin(2 * std::numbers::pi * i / period); };
  for (int i = 1; i <= 2 * period; ++i) {
    std::vector<hfr::Vec3> displacement(mesh.n_vertices());
    for (hfr::VertexHandle v : mesh.vertices())
      displacement[v.idx()] = flow(mesh.point(v), time(i) - time(i - 1)) - mesh.point(v);
    const std::vector<double> before = volumes(mesh);
    remesher.move(displacement);
    for (hfr::CellHandle c : mesh.cells())  // a cell keeps what it holds
      density[c] *= before[c.idx()] / hfr::volume(mesh, c);
    if (remesher.needs_repair() != hfr::RepairCause::kNone) {
      const bool shows = folder.is_wanted() && remesher.min_dihedral() < worst;
      if (shows) folder.write("before.vtu", mesh);
      if (shows) worst = remesher.min_dihedral();
      remesher.repair();
      remesher.transfer();
      if (shows) folder.write("after.vtu", mesh);
      ++n_repairs;
    }
    mass_error = std::max(mass_error, std::abs(mass(mesh, density) - mass_first) / mass_first);
    if (i % period != 0) continue;
    double heat_error = 0, density_error = 0;
    for (hfr::VertexHandle v : mesh.vertices())
      heat_error = std::max(heat_error, std::abs(heat[v] - field(mesh.point(v))));
    for (hfr::CellHandle c : mesh.cells())
      density_error += std::abs(density[c] - field(hfr::barycenter(mesh, c))) * hfr::volume(mesh, c);
    std::printf("after period %d: %zu cells, %zu inverted, smallest angle %.2f degrees\n", i / period,
                mesh.n_cells(), remesher.n_inverted(), remesher.min_dihedral());
    std::printf("  temperature off by at most %.3f of 2, density by %.3f in the mean\n", heat_error,
                density_error);
  }
  std::printf("%d repairs in %d steps; the mass changed by at most %.1e of it\n", n_repairs, 2 * period,
              mass_error);
  return mass_error < 1e-12 && remesher.n_inverted() == 0 && n_repairs > 0 ? 0 : 1;
} catch (const hfr::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
