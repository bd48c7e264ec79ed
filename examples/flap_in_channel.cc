// SPDX-License-Identifier: BSD-3-Clause
// A flap stands in a channel, is pushed by the flow and swings. Its motion comes from a solid solver through
// a coupling library, which has each time window done over until both sides agree: what a user of preCICE
// writes, or one of OpenFOAM with its adapter. Fluid and solid are made up; the loop, its checkpoints and
// what it does to the mesh are not:
//   - at the beginning of a window mesh and fields are saved, and put back when it is to be done again;
//   - within a window the mesh only moves, so that the coupling's numbers of the flap's vertices stay;
//   - at the end of one it is repaired where it has to be, and the coupling is told of the new numbers.
// Ends with 1 where a window has left an inverted cell, or a repair has changed what a conserved field holds.
// Usage: example_flap_in_channel [N WINDOWS [FOLDER]]     24 N³ cells in the channel; N even
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/HalfFace/Geometry.hh>
#include <hfremesh/Remesh/Remesher.hh>
#include <numbers>

#include "Meshes.hh"

namespace {

constexpr double kHeight = 0.625;  // of the flap
constexpr double kWindow = 0.05;   // of time

/// Where a point of the flap at rest is when its tip is bent by so much.
hfr::Vec3 bent(hfr::Vec3 rest, double tip) {
  const double s = rest.z / kHeight;
  return {rest.x + tip * s * s, rest.y, rest.z - 0.5 * tip * tip * s * s};
}

/// Stands in for the coupling library, and for the solid solver at its other end: a damped spring that the
/// force on the flap bends.
class Coupling {
 public:
  explicit Coupling(int windows) : windows_left_(windows) {}

  bool is_ongoing() const { return windows_left_ > 0; }
  bool requires_writing_checkpoint() const { return iteration_ == 0; }
  bool requires_reading_checkpoint() const { return iteration_ > 0; }
  int n_iterations() const { return n_iterations_; }

  /// The vertices at which both sides meet, in the order in which data are read.
  void set_vertices(const std::vector<hfr::Vec3>& at_rest) { vertices_ = at_rest; }
  /// After the mesh has new numbers; only between two windows.
  void reset_vertices(const std::vector<hfr::Vec3>& at_rest) {
    if (iteration_ != 0) throw hfr::InvalidInput("a mesh may be reset at the end of a window only");
    set_vertices(at_rest);
  }
  std::vector<hfr::Vec3> read_positions() const {
    std::vector<hfr::Vec3> positions;
    for (const hfr::Vec3 rest : vertices_) positions.push_back(bent(rest, tip_));
    return positions;
  }
  void write_force(double force) { force_ = force; }
  /// The solid's turn. A window is over when the tip comes out where it was taken to be.
  void advance() {
    const double speed = (speed_ + kWindow * (force_ - 30 * tip_at_begin_)) / (1 + 1.5 * kWindow);
    const double tip = tip_at_begin_ + kWindow * speed;
    ++n_iterations_;
    if (std::abs(tip - tip_) < 1e-6) {
      tip_at_begin_ = tip_ = tip;
      speed_ = speed;
      iteration_ = 0;
      --windows_left_;
      return;
    }
    tip_ = tip;
    ++iteration_;
  }
  double tip() const { return tip_; }

 private:
  std::vector<hfr::Vec3> vertices_;
  double tip_ = 0, tip_at_begin_ = 0, speed_ = 0, force_ = 0;
  int windows_left_, iteration_ = 0, n_iterations_ = 0;
};

/// A channel, 4 by 1 by 1, without the cells of the flap.
hfr::TetMesh channel_with_flap(hfr::Index n) {
  const hfr::generate::Arrays grid = hfr::generate::box({4 * n, n, n}, {0, 0, 0}, {4, 1, 1});
  std::vector<hfr::Vec3> points;
  std::vector<hfr::Index> number(grid.points.size(), hfr::VertexHandle::kInvalid);
  std::vector<std::array<hfr::Index, 4>> cells;
  for (const auto& corners : grid.cells) {
    hfr::Vec3 middle;
    for (hfr::Index v : corners) middle = middle + 0.25 * grid.points[v];
    const bool in_flap =
        middle.x > 1.5 && middle.x < 1.5 + 1.0 / n && std::abs(middle.y - 0.5) < 0.25 && middle.z < kHeight;
    if (in_flap) continue;
    auto& cell = cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      hfr::Index& v = number[corners[k]];
      if (v == hfr::VertexHandle::kInvalid) {
        v = static_cast<hfr::Index>(points.size());
        points.push_back(grid.points[corners[k]]);
      }
      cell[k] = v;
    }
  }
  return hfr::build(points, cells);
}

/// The fluid solver's mesh, and what of it the coupling knows.
class Fluid {
 public:
  explicit Fluid(hfr::Index n)
      : mesh(channel_with_flap(n)), rest(mesh.request_vertex_property<hfr::Vec3>("rest")) {
    for (hfr::VertexHandle v : mesh.vertices()) rest[v] = mesh.point(v);
    auto dye = mesh.request_cell_property<double>("dye");
    for (hfr::CellHandle c : mesh.cells()) dye[c] = 1 + std::sin(3 * hfr::barycenter(mesh, c).x);
  }

  /// Finds the flap's vertices again, under the numbers that they have now. The surface is frozen, so they
  /// are always the same ones, and a field that is attached to them says where each was at rest.
  std::vector<hfr::Vec3> list_flap() {
    flap.clear();
    std::vector<hfr::Vec3> at_rest;
    for (hfr::VertexHandle v : mesh.boundary_vertices()) {
      const hfr::Vec3 p = rest[v];
      const bool on_walls = p.x == 0 || p.x == 4 || p.y == 0 || p.y == 1 || p.z == 0 || p.z == 1;
      if (on_walls) continue;
      flap.push_back(v);
      at_rest.push_back(p);
    }
    return at_rest;
  }
  std::vector<hfr::Vec3> displacement_to(const std::vector<hfr::Vec3>& positions) const {
    std::vector<hfr::Vec3> d(mesh.n_vertices());
    for (std::size_t i = 0; i < flap.size(); ++i) d[flap[i].idx()] = positions[i] - mesh.point(flap[i]);
    return d;
  }
  /// Made up: a pulsating pressure on what of the flap faces the flow.
  double force(double time) const {
    std::vector<char> is_flap(mesh.n_vertices(), 0);
    for (hfr::VertexHandle v : flap) is_flap[v.idx()] = 1;
    double area = 0;
    for (hfr::HalfFaceHandle h : mesh.boundary_halffaces()) {
      const auto f = mesh.halfface_vertices(h);
      if (!is_flap[f[0].idx()] && !is_flap[f[1].idx()] && !is_flap[f[2].idx()]) continue;
      const hfr::Vec3 a = mesh.point(f[0]), b = mesh.point(f[1]), c = mesh.point(f[2]);
      area += 0.5 * std::max(0.0, hfr::cross(b - a, c - a).x);
    }
    return 40 * area * std::sin(std::numbers::pi * time);
  }
  double dye() const {
    const auto values = mesh.get_cell_property<double>("dye");
    double sum = 0;
    for (hfr::CellHandle c : mesh.cells()) sum += (*values)[c] * hfr::volume(mesh, c);
    return sum;
  }

  hfr::TetMesh mesh;
  hfr::VertexProperty<hfr::Vec3> rest;
  std::vector<hfr::VertexHandle> flap;
};

}  // namespace

int main(int argc, char** argv) try {
  const auto n = static_cast<hfr::Index>(argc > 2 ? std::atoi(argv[1]) : 8);
  const int n_windows = argc > 2 ? std::atoi(argv[2]) : 30;
  Fluid fluid(n);
  hfr::RemesherOptions options;
  options.improve.min_dihedral = 18;
  options.triggers.min_dihedral = 12;
  options.motion = hfr::Motion::kLaplace;  // walls rest, the flap moves, the others follow
  options.fields = {{.name = "dye", .how = hfr::Transfer::kConserve}};
  hfr::Remesher remesher(fluid.mesh, options);

  const example::Folder folder(argc > 3 ? argv[3] : nullptr);
  double worst_shown = 180;
  Coupling coupling(n_windows);
  coupling.set_vertices(fluid.list_flap());
  hfr::TetMesh saved;
  double time = 0, worst = 180, farthest = 0, lost = 0;
  int n_repairs = 0, n_put_back = 0;
  std::size_t n_inverted = 0;
  while (coupling.is_ongoing()) {
    if (coupling.requires_writing_checkpoint()) saved = fluid.mesh;
    remesher.move(fluid.displacement_to(coupling.read_positions()));
    // Here the fluid solver would make its time step on the mesh as it is.
    coupling.write_force(fluid.force(time + kWindow));
    coupling.advance();
    if (coupling.requires_reading_checkpoint()) {
      fluid.mesh.restore(saved);  // fields and all; handles of fields stay good
      remesher.reset();
      ++n_put_back;
      continue;
    }
    time += kWindow;
    farthest = std::max(farthest, std::abs(coupling.tip()));
    if (remesher.needs_repair() != hfr::RepairCause::kNone) {
      const double before = fluid.dye();
      const bool shows = folder.is_wanted() && remesher.min_dihedral() < worst_shown;
      if (shows) folder.write("before.vtu", fluid.mesh);
      if (shows) worst_shown = remesher.min_dihedral();
      remesher.repair();
      remesher.transfer();
      if (shows) folder.write("after.vtu", fluid.mesh);
      lost = std::max(lost, std::abs(fluid.dye() - before) / before);
      coupling.reset_vertices(fluid.list_flap());
      ++n_repairs;
    }
    worst = std::min(worst, remesher.min_dihedral());
    n_inverted += remesher.n_inverted();
  }
  std::printf("%zu cells, %d windows, %d iterations of the coupling, %d times put back\n",
              fluid.mesh.n_cells(), n_windows, coupling.n_iterations(), n_put_back);
  std::printf(
      "tip bent by up to %.3f, %d repairs at the end of a window, smallest angle %.2f, dye off by %.1e\n",
      farthest, n_repairs, worst, lost);
  return n_repairs > 0 && n_put_back > 0 && n_inverted == 0 && lost < 1e-12 ? 0 : 1;
} catch (const hfr::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
