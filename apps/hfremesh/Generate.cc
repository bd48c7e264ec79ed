// SPDX-License-Identifier: BSD-3-Clause
// hfremesh generate SHAPE: meshes of simple shapes, and the cavity that the paper's figures are measured on.
#include "hfremesh/HalfFace/Generate.hh"

#include <memory>
#include <nlohmann/json.hpp>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "Memory.hh"
#include "Numbers.hh"
#include "Report.hh"
#include "WriteMesh.hh"

namespace hfr::app {
namespace {

struct GenerateOptions {
  std::string output;
  io::WriteOptions write;
  generate::CavityOptions cavity;
  std::string field;          ///< of the cavity's deformation
  std::vector<Index> counts;  ///< as many as the shape has directions, or none
  std::vector<double> low = {0, 0, 0};
  std::vector<double> high = {1, 1, 1};
  double jitter = 0;
  std::uint64_t seed = 1;
  int regions = 1;
  double radius = 1;
  double height = 2;
  double twist = 0;
  double wring = 0;
};

/// Counts of a shape: the given ones or those it has by itself.
template <std::size_t N>
std::array<Index, N> counts(const GenerateOptions& options, std::array<Index, N> standard) {
  if (!options.counts.empty()) std::copy_n(options.counts.begin(), N, standard.begin());
  return standard;
}

generate::Arrays make_cavity(const GenerateOptions& options) {
  generate::CavityOptions cavity = options.cavity;
  cavity.counts = counts<3>(options, cavity.counts);
  if (options.field == "bulk-shear") cavity.field = generate::CavityField::kBulkShear;
  return generate::cavity(cavity);
}

generate::Arrays make_box(const GenerateOptions& options) {
  const auto n = counts<3>(options, {10, 10, 10});
  const Vec3 low = {options.low[0], options.low[1], options.low[2]};
  const Vec3 high = {options.high[0], options.high[1], options.high[2]};
  generate::Arrays mesh = generate::jittered_box(n, options.jitter, options.seed, low, high);
  if (options.regions == 2) mesh.regions = generate::two_region_box(n, low, high).regions;
  return mesh;
}

generate::Arrays make_cylinder(const GenerateOptions& options) {
  const auto n = counts<2>(options, {4, 12});
  generate::Arrays mesh =
      generate::cylinder(n[0], n[1], options.radius, options.height, options.twist, options.wring);
  if (options.jitter != 0) generate::jitter_inner(mesh, options.jitter, options.seed);
  return mesh;
}

generate::Arrays make_ball(const GenerateOptions& options) {
  generate::Arrays mesh = generate::ball(counts<1>(options, {8})[0], options.radius);
  if (options.jitter != 0) generate::jitter_inner(mesh, options.jitter, options.seed);
  return mesh;
}

generate::Arrays make_fandisk(const GenerateOptions& options) {
  return generate::fandisk(counts<3>(options, {6, 6, 4}), options.jitter, options.seed);
}

generate::Arrays make(const std::string& shape, const GenerateOptions& options) {
  if (shape == "cavity") return make_cavity(options);
  if (shape == "box") return make_box(options);
  if (shape == "ball") return make_ball(options);
  if (shape == "fandisk") return make_fandisk(options);
  return make_cylinder(options);
}

/// What a mesh will be, before it is made.
struct Size {
  double cells;
  double bytes;  ///< that making it takes at its peak, about
};

Size size_of(const std::string& shape, const GenerateOptions& options) {
  constexpr double kCell = sizeof(std::array<Index, 4>) + sizeof(int);
  constexpr double kPoint = sizeof(Vec3);
  constexpr double kBallPoint = kPoint + 64;  // its entry in a hash table
  constexpr double kBuiltCell = 110;          // of the half-face mesh that tells what is inside
  const double built = options.jitter != 0 ? kBuiltCell : 0;
  if (shape == "ball") {
    const auto n = static_cast<double>(counts<1>(options, {8})[0]);
    return {20 * n * n * n, 20 * n * n * n * (kCell + built) + 10 * n * n * n / 3 * kBallPoint};
  }
  if (shape == "cylinder") {
    const auto n = counts<2>(options, {4, 12});
    const auto nr = static_cast<double>(n[0]), nz = static_cast<double>(n[1]);
    const double cells = 18 * nr * nr * nz;
    return {cells, cells * (kCell + built) + 3 * nr * (nr + 1) * (nz + 1) * kPoint};
  }
  // The counts of a grid, and which part of it has cells.
  const generate::Counts n = shape == "cavity"    ? counts<3>(options, options.cavity.counts)
                             : shape == "fandisk" ? counts<3>(options, {6, 6, 4})
                                                  : counts<3>(options, {10, 10, 10});
  const double twice = shape == "fandisk" ? 2 : 1;
  const auto x = static_cast<double>(n[0]), y = twice * static_cast<double>(n[1]),
             z = twice * static_cast<double>(n[2]);
  const double cells = (shape == "fandisk" ? 4.5 : 6) * x * y * z;
  return {cells, cells * kCell + (x + 1) * (y + 1) * (z + 1) * (kPoint + sizeof(Index))};
}

ExitCode run(const std::string& shape, const GenerateOptions& options, const CommonOptions& common,
             Json& report) {
  report["output"]["file"] = options.output;
  report["options"]["shape"] = shape;
  const io::WriteOptions write_options = require_writable_mesh(options.output, options.write, common);
  const Stopwatch making;
  const Size size = size_of(shape, options);
  if (size.cells <=
      static_cast<double>(VertexHandle::kInvalid / 12))  // beyond, the library has a word for it
    require_memory(size.bytes, "a mesh of " + grouped(static_cast<std::size_t>(size.cells)) + " cells");
  generate::Arrays arrays = make(shape, options);
  io::MeshData data;
  data.points = std::move(arrays.points);
  data.cells = std::move(arrays.cells);
  data.regions = std::move(arrays.regions);
  report["seconds"]["generate"] = making.seconds();
  return write_mesh(options.output, data, write_options, {}, common, report);
}

void add_jitter_options(Command shape, GenerateOptions& options, const char* text) {
  shape.option("--jitter", options.jitter, text).check(real_number()).shows_default().type_name("X");
  shape.option("--seed", options.seed, "Seed of the jitter")
      .check(whole_number())
      .shows_default()
      .type_name("N");
}

/// `standard`: the counts without the option; one for each direction of the shape.
void add_counts_option(Command shape, GenerateOptions& options, const char* text, const char* type,
                       const char* standard, int n_directions) {
  shape.option("--n", options.counts, text)
      .shows_default(standard)
      .type_name(type)
      .expected(n_directions)
      .check(whole_number(0, std::numeric_limits<Index>::max()));
}

void add_cavity_options(Command shape, GenerateOptions& options) {
  generate::CavityOptions& cavity = options.cavity;
  shape.group("Shape");
  shape.option("--jitter", cavity.jitter, "Random move of inner coordinates, in cube widths")
      .check(real_number())
      .shows_default()
      .type_name("X");
  shape.option("--sigma", cavity.sigma, "Width of the Gaussians")
      .check(positive_number())
      .shows_default()
      .type_name("X");
  shape.option("--amplitude", cavity.amplitude, "Strength of the deformation; 0 for none")
      .shows_default()
      .type_name("X")
      .check(real_number());
  shape.option("--seed", cavity.seed, "Seed of the jitter")
      .check(whole_number())
      .shows_default()
      .type_name("N");
  shape.option("--field", options.field, "Deformation")
      .type_name("NAME")
      .one_of({"gaussians", "bulk-shear"})
      .shows_default("gaussians");
  add_counts_option(shape, options, "Grid cubes along x, y and z", "NX NY NZ", "14 15 16", 3);
}

void add_box_options(Command shape, GenerateOptions& options) {
  shape.group("Shape");
  shape.option("--low", options.low, "Lower corner, in LENGTHs")
      .type_name("X Y Z")
      .shows_default("0 0 0")
      .expected(3)
      .check(real_number());
  shape.option("--high", options.high, "Upper corner, in LENGTHs")
      .type_name("X Y Z")
      .shows_default("1 1 1")
      .expected(3)
      .check(real_number());
  add_jitter_options(shape, options, "Random move of inner coordinates, in cube widths");
  shape.option("--regions", options.regions, "1, or 2 for two halves along x")
      .check(whole_number(1, 2))
      .shows_default()
      .type_name("N");
  add_counts_option(shape, options, "Grid cubes along x, y and z", "NX NY NZ", "10 10 10", 3);
}

void add_radius_option(Command shape, GenerateOptions& options) {
  shape.group("Shape");
  shape.option("--radius", options.radius, "Radius")
      .check(positive_number())
      .type_name("LENGTH")
      .shows_default();
}

void add_ball_options(Command shape, GenerateOptions& options) {
  add_radius_option(shape, options);
  add_jitter_options(shape, options, "Random move of inner vertices, in shortest edges");
  add_counts_option(shape, options, "Shells", "N", "8", 1);
}

void add_cylinder_options(Command shape, GenerateOptions& options) {
  add_radius_option(shape, options);
  shape.option("--height", options.height, "Height")
      .check(positive_number())
      .type_name("LENGTH")
      .shows_default();
  shape.option("--twist", options.twist, "Degrees by which the top is turned")
      .check(real_number())
      .shows_default()
      .type_name("DEG");
  shape
      .option("--wring", options.wring,
              "Degrees by which the side is turned back and forth; from 58 on it folds over")
      .shows_default()
      .type_name("DEG")
      .check(real_number());
  add_jitter_options(shape, options, "Random move of inner vertices, in shortest edges");
  add_counts_option(shape, options, "Rings and layers", "NR NZ", "4 12", 2);
}

void add_fandisk_options(Command shape, GenerateOptions& options) {
  shape.group("Shape");
  add_counts_option(shape, options, "Grid cubes along the radius, each half of the arc, each level",
                    "NR NA NZ", "6 6 4", 3);
  add_jitter_options(shape, options, "Random move within faces and inside, in cube widths");
}

}  // namespace

Subcommand add_generate(Command program, CommonOptions& common) {
  const auto options = std::make_shared<GenerateOptions>();
  Command command = program.subcommand("generate", "Make a mesh: cavity, box, ball, cylinder or fandisk");
  command.require_subcommand();
  command.example("hfremesh generate cavity -o bad.mesh", "a mesh with inverted cells");
  command.example("hfremesh generate box --n 20 10 10 --low 0 0 0 --high 2 1 1 --regions 2 -o box.msh",
                  "two regions with an interface between them");
  Command cavity = command.subcommand("cavity", "Unit cube, deformed inside until cells invert");
  add_cavity_options(cavity, *options);
  Command box = command.subcommand("box", "Box of cubes cut into six cells each");
  add_box_options(box, *options);
  Command ball = command.subcommand("ball", "Ball round the origin, 20 n^3 cells");
  add_ball_options(ball, *options);
  Command cylinder = command.subcommand("cylinder", "Upright cylinder, 18 nr^2 nz cells");
  add_cylinder_options(cylinder, *options);
  Command fandisk =
      command.subcommand("fandisk", "Quarter of a ring with a step: planes, cylinders, sharp edges");
  add_fandisk_options(fandisk, *options);
  for (Command shape : {cavity, box, ball, cylinder, fandisk}) {
    shape.example("hfremesh generate " + shape.name() + " -o out.mesh", "by the default numbers");
    shape.group("Output");
    shape.option("-o,--output", options->output, "Mesh to write")
        .required()
        .type_name("FILE")
        .transform(stream_name());
    add_format_options(shape, common, false, true);
    add_write_options(shape, options->write);
    add_common_options(shape, common);
  }
  return {
      command,
      [options] {
        return std::vector<FileUse>{{FileUse::Kind::kMesh, "-o", options->output}};
      },
      [options, command, &common](Json& report) { return run(command.chosen(), *options, common, report); }};
}

}  // namespace hfr::app
