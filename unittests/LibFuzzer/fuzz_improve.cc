// SPDX-License-Identifier: BSD-3-Clause
// A mesh and options that the bytes decide are run, and the promises of docs/fuzzing.md held against what
// comes out: what hfr_fuzz does with a number. The first byte says how the mesh is made, the next two number
// the case (which formats, whether more threads), then come the options, then the mesh.
#include <fmt/format.h>

#include "Fuzz/Case.hh"
#include "LibFuzzer/Target.hh"

namespace hfr::fuzz {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHeader = 3;
constexpr std::size_t kOptions = 64;    // bytes, two for each number drawn
constexpr std::size_t kPart = 24;       // cells, about
constexpr std::size_t kMostCells = 48;  // with sanitizers a larger mesh takes seconds
/// Cells of a mesh whose worst angle is raised for as long as that goes on.
constexpr std::size_t kMostToRaise = 12;
/// How often a run asks whether it is cancelled; then it is. Few ask as often: what is tried for a goal that
/// a dozen cells cannot reach takes hundreds of times as long as other runs, and inputs that reach it are
/// kept.
constexpr int kMostQuestions = 150;

/// Cells of any corners, coordinates of any size: what build() does not refuse has duplicates, pinches, cells
/// without volume and regions that mix.
Complex complex_of(Random random) {
  Complex complex;
  complex.made_of = "of bytes";
  const std::size_t n_points = 4 + random.below(9);
  const double scale = random.pick({1.0, 1.0, 1.0, 1e-300, 1e150, 1e-9});
  const auto coordinate = [&] {
    if (random.chance(0.7)) return scale * random.from_to(-2, 2);
    return random.chance(0.5) ? scale * random.between(-2, 2)
                              : random.pick({1e-300, 1e150, -1e150, 5e-324, 1e15, 1e-15});
  };
  for (std::size_t v = 0; v < n_points; ++v) {
    const double x = coordinate(), y = coordinate();
    complex.points.push_back({x, y, coordinate()});
  }
  const std::size_t n_cells = 1 + random.below(16);
  const auto vertex = [&] { return static_cast<Index>(random.below(n_points)); };
  for (std::size_t c = 0; c < n_cells; ++c) {
    Corners corners = {vertex(), vertex(), vertex(), vertex()};
    if (c > 0 && random.chance(0.8)) {  // on a face of one that is there
      const Triangle f = face_of(complex.cells[random.below(c)], random.below(4));
      corners = {f[0], f[2], f[1], corners[3]};
    }
    complex.cells.push_back(corners);
  }
  if (random.chance(0.4))
    for (std::size_t c = 0; c < n_cells; ++c) complex.regions.push_back(random.from_to(0, 2));
  for (std::size_t i = random.below(4); i > 0; --i)
    complex.faces.push_back(
        {face_of(complex.cells[random.below(n_cells)], random.below(4)), random.from_to(-1, 2)});
  for (std::size_t i = random.below(3); i > 0; --i) {
    const Corners& on = complex.cells[random.below(n_cells)];
    const auto& e = kEdgeCorners[random.below(6)];
    complex.edges.push_back({{on[e[0]], on[e[1]]}, random.from_to(-1, 2)});
  }
  if (random.chance(0.2))
    for (std::size_t v = 0; v < n_points; ++v) complex.vertex_labels.push_back(random.from_to(0, 2));
  for (std::size_t v = 0; v < n_points; ++v)
    if (random.chance(0.05)) complex.fixed.push_back(static_cast<Index>(v));
  return complex;
}

Case case_of(Bytes bytes) {
  Case made;
  made.number = static_cast<std::uint64_t>(bytes[1] | bytes[2] << 8);
  const Bytes options = bytes.subspan(kHeader, std::min(kOptions, bytes.size() - kHeader));
  const Random mesh(bytes.subspan(kHeader + options.size()));
  made.complex = bytes[0] % 2 == 0 ? random_complex(mesh, kPart) : complex_of(mesh);
  made.options = random_options(Random(options), made.complex);
  if (made.complex.cells.size() > kMostToRaise) made.options.improve.raise_min_dihedral = false;
  if (made.options.cancel_at == 0) made.options.cancel_at = kMostQuestions;
  return made;
}

}  // namespace
}  // namespace hfr::fuzz

int LLVMFuzzerInitialize(int*, char***) { return 0; }

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hfr::fuzz;
  if (size < kHeader) return -1;
  const Case wanted = case_of({data, size});
  if (wanted.complex.cells.size() > kMostCells) return -1;
  const Outcome outcome = run_case(wanted, scratch());
  if (outcome.findings.empty()) return 0;
  std::string all;
  for (const Finding& finding : outcome.findings)
    all += fmt::format("\n  {}: {}", finding.promise, finding.detail);
  broken(outcome.findings.front().promise,
         fmt::format("{} cells: {} | {}{}", wanted.complex.cells.size(), wanted.complex.made_of,
                     wanted.options.command_line(), all));
}
