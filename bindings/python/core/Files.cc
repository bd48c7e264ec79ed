// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "Mesh.hh"
#include "hfremesh/HalfFace/Generate.hh"
#include "hfremesh/IO/Assemble.hh"
#include "hfremesh/IO/ReadWrite.hh"

namespace hfr::python {
namespace {

using namespace nb::literals;
using Triple = std::array<double, 3>;

Mesh read_file(const std::filesystem::path& path, int threads) {
  const par::Policy policy = policy_of(threads);
  Mesh mesh;
  nb::gil_scoped_release others_run;
  io::ReadReport report;
  mesh.tets = io::read(path, policy, &report);
  mesh.build = std::move(report.build);
  mesh.notes = std::move(report.notes);
  return mesh;
}

std::vector<std::string> write_file(const std::filesystem::path& path, const Mesh& mesh, bool binary,
                                    const std::string& variant, int threads) {
  const par::Policy policy = policy_of(threads);
  nb::gil_scoped_release others_run;
  return io::write(path, mesh.tets, {.binary = binary, .variant = variant}, policy);
}

/// As the tool writes and reads it.
Mesh mesh_of(generate::Arrays arrays) {
  io::MeshData data;
  data.points = std::move(arrays.points);
  data.cells = std::move(arrays.cells);
  data.regions = std::move(arrays.regions);
  Mesh mesh;
  nb::gil_scoped_release others_run;
  mesh.tets = io::assemble(std::move(data), par::Policy::all(), &mesh.build, &mesh.notes);
  return mesh;
}

generate::CavityField field_of_name(const std::string& name) {
  if (name == "gaussians") return generate::CavityField::kGaussians;
  if (name == "bulk-shear") return generate::CavityField::kBulkShear;
  throw nb::value_error(("field: gaussians or bulk-shear is wanted, not '" + name + "'").c_str());
}

Mesh make_cavity(generate::Counts n, double jitter, double sigma, double amplitude, std::uint64_t seed,
                 const std::string& field) {
  return mesh_of(generate::cavity({n, jitter, sigma, amplitude, seed, field_of_name(field)}));
}

Mesh make_box(generate::Counts n, Triple low, Triple high, double jitter, std::uint64_t seed, int regions) {
  if (regions != 1 && regions != 2) throw nb::value_error("regions: 1 or 2 is wanted");
  const Vec3 a = {low[0], low[1], low[2]}, b = {high[0], high[1], high[2]};
  generate::Arrays arrays = generate::jittered_box(n, jitter, seed, a, b);
  if (regions == 2) arrays.regions = generate::two_region_box(n, a, b).regions;
  return mesh_of(std::move(arrays));
}

Mesh make_ball(Index n, double radius, double jitter, std::uint64_t seed) {
  generate::Arrays arrays = generate::ball(n, radius);
  if (jitter != 0) generate::jitter_inner(arrays, jitter, seed);
  return mesh_of(std::move(arrays));
}

Mesh make_cylinder(std::array<Index, 2> n, double radius, double height, double twist, double wring,
                   double jitter, std::uint64_t seed) {
  generate::Arrays arrays = generate::cylinder(n[0], n[1], radius, height, twist, wring);
  if (jitter != 0) generate::jitter_inner(arrays, jitter, seed);
  return mesh_of(std::move(arrays));
}

Mesh make_fandisk(generate::Counts n, double jitter, std::uint64_t seed) {
  return mesh_of(generate::fandisk(n, jitter, seed));
}

void bind_generate(nb::module_& module) {
  const generate::CavityOptions cavity;
  nb::module_ shapes =
      module.def_submodule("generate", "Meshes of simple shapes: those of 'hfremesh generate'.");
  shapes.def(
      "cavity", &make_cavity, "n"_a = cavity.counts, nb::kw_only(), "jitter"_a = cavity.jitter,
      "sigma"_a = cavity.sigma, "amplitude"_a = cavity.amplitude, "seed"_a = cavity.seed,
      "field"_a = "gaussians",
      "The unit cube of n[0] n[1] n[2] cubes, jittered, then deformed inside until cells invert; field: "
      "'gaussians' or 'bulk-shear'. By default 20,160 cells, 48 of them inverted.");
  shapes.def("box", &make_box, "n"_a = generate::Counts{10, 10, 10}, nb::kw_only(), "low"_a = Triple{0, 0, 0},
             "high"_a = Triple{1, 1, 1}, "jitter"_a = 0.0, "seed"_a = 1, "regions"_a = 1,
             "A box of n[0] n[1] n[2] cubes of six cells each; regions: 1, or 2 for two halves along x.");
  shapes.def("ball", &make_ball, "n"_a = 8, nb::kw_only(), "radius"_a = 1.0, "jitter"_a = 0.0, "seed"_a = 1,
             "A ball of n shells, 20 n^3 cells.");
  shapes.def("cylinder", &make_cylinder, "n"_a = std::array<Index, 2>{4, 12}, nb::kw_only(), "radius"_a = 1.0,
             "height"_a = 2.0, "twist"_a = 0.0, "wring"_a = 0.0, "jitter"_a = 0.0, "seed"_a = 1,
             "A cylinder of n[0] rings and n[1] layers, 18 n[0]^2 n[1] cells; twist, wring: degrees.");
  shapes.def("fandisk", &make_fandisk, "n"_a = generate::Counts{6, 6, 4}, nb::kw_only(), "jitter"_a = 0.0,
             "seed"_a = 1,
             "A quarter of a ring with a step and an inclined top: planes, cylinders, sharp edges.");
}

}  // namespace

void bind_files(nb::module_& module) {
  module.def(
      "read", &read_file, "path"_a, "threads"_a = 0,
      "Reads a mesh of any known format (by extension) with regions, labels, names and fields. Its notes "
      "say what was skipped. OSError when the file cannot be opened, ValueError, with the place, when what "
      "it says is broken.");
  module.def(
      "write", &write_file, "path"_a, "mesh"_a, nb::kw_only(), "binary"_a = false, "variant"_a = "",
      "threads"_a = 0,
      "Writes the mesh with all that hangs on it, whole or not at all; the format goes by the extension. "
      "Returns a line for each thing that the format cannot hold. binary: the binary variant of .msh, .vtk "
      "and .vtu; variant: a version or encoding, as 'hfremesh convert --variant'.");
  bind_generate(module);
}

}  // namespace hfr::python
