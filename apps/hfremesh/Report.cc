// SPDX-License-Identifier: BSD-3-Clause
#include "Report.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "Console.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::app {
namespace {

struct Row {
  const char* name;
  std::string (*text)(const Statistics&);
};

std::string angle(double degrees) { return fmt::format("{:.2f}", degrees); }

std::string ceiling(const EdgeWedge& wedge) { return wedge.a.is_valid() ? angle(wedge.degrees) : "-"; }

constexpr std::size_t kP01 = 0, kP1 = 1, kP5 = 2, kMedian = 4, kP95 = 6;  // places in kPercentiles

const Row kRows[] = {
    {"cells", [](const Statistics& s) { return grouped(s.cells); }},
    {"vertices", [](const Statistics& s) { return grouped(s.vertices); }},
    {"boundary faces", [](const Statistics& s) { return grouped(s.boundary_faces); }},
    {"regions", [](const Statistics& s) { return grouped(s.regions.size()); }},
    {"inverted", [](const Statistics& s) { return grouped(s.inverted.size()); }},
    {"flat", [](const Statistics& s) { return grouped(s.flat.size()); }},
    {"dihedral min", [](const Statistics& s) { return angle(s.min_dihedral.min); }},
    {"  p0.1", [](const Statistics& s) { return angle(s.min_dihedral.percentiles[kP01]); }},
    {"  p1", [](const Statistics& s) { return angle(s.min_dihedral.percentiles[kP1]); }},
    {"  p5", [](const Statistics& s) { return angle(s.min_dihedral.percentiles[kP5]); }},
    {"  median", [](const Statistics& s) { return angle(s.min_dihedral.percentiles[kMedian]); }},
    {"dihedral max", [](const Statistics& s) { return angle(s.max_dihedral); }},
    {"surface ceiling", [](const Statistics& s) { return ceiling(s.surface_ceiling); }},
    {"edge p5", [](const Statistics& s) { return fmt::format("{:.4g}", s.edge_length.percentiles[kP5]); }},
    {"  median",
     [](const Statistics& s) { return fmt::format("{:.4g}", s.edge_length.percentiles[kMedian]); }},
    {"  p95", [](const Statistics& s) { return fmt::format("{:.4g}", s.edge_length.percentiles[kP95]); }},
    {"volume", [](const Statistics& s) { return fmt::format("{:.8g}", s.volume); }},
    {"overlap", [](const Statistics& s) { return fmt::format("{:.1e}", s.overlap); }},
};

}  // namespace

std::string grouped(std::size_t n) {
  std::string text = std::to_string(n);
  for (std::size_t i = text.size(); i > 3;) text.insert(i -= 3, 1, ',');
  return text;
}

std::string id_list(const std::vector<CellHandle>& cells, std::size_t limit) {
  std::string text;
  for (std::size_t i = 0; i < std::min(cells.size(), limit); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(cells[i].idx());
  if (cells.size() > limit) text += " and " + grouped(cells.size() - limit) + " more";
  return text;
}

void print_statistics(const std::vector<Column>& columns) {
  // Angles of percentiles are those of each cell's smallest dihedral.
  std::vector<std::size_t> width;
  for (const Column& column : columns) {
    std::size_t widest = column.heading.size();
    for (const Row& row : kRows) widest = std::max(widest, row.text(*column.statistics).size());
    width.push_back(widest);
  }
  const auto print_row = [&](const std::string& name, auto&& text) {
    print("{:<16}", name);
    for (std::size_t i = 0; i < columns.size(); ++i) print("  {:>{}}", text(columns[i]), width[i]);
    print("\n");
  };
  print_row("", [](const Column& column) { return column.heading; });
  for (const Row& row : kRows)
    print_row(row.name, [&](const Column& column) { return row.text(*column.statistics); });
}

void print_passes(const std::vector<PassReport>& passes) {
  print("{:<10} {:<10} {:>4} {:>6} {:>10} {:>10} {:>10} {:>8} {:>10} {:>8}\n", "stage", "op", "iter",
        "rounds", "seeds", "candidates", "winners", "inverted", "worst", "seconds");
  for (const PassReport& pass : passes)
    print("{:<10} {:<10} {:>4} {:>6} {:>10} {:>10} {:>10} {:>8} {:>10.3g} {:>8.3f}\n", pass.stage, pass.op,
          pass.iteration, pass.rounds, pass.seeds, pass.candidates, pass.winners, pass.n_inverted, pass.worst,
          pass.seconds);
  print("\n");
}

void print_limits(const Result& result) {
  if (result.n_large_stars > 0)
    print("{} vertices have more than {} cells: they are moved, but not taken out\n",
          grouped(result.n_large_stars), Star::kCapacity);
  if (result.stuck.empty()) return;
  const auto counts = count_reasons(result.stuck);
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(counts[i]), kStuckReasonNames[i]);
  print("below {:g} degrees: {} cells; why: {}\n", result.stuck_below, grouped(result.stuck.size()), text);
  if (const CellBoundMet& met = result.cell_bound; met.cells > 0)
    print(
        "the bound of {} cells was in the way: a vertex would raise {} of them; --max-cells {} has room for "
        "that\n",
        grouped(met.bound), grouped(met.cells), met.wanted);
  else if (met.bound > 0)
    print("the bound on cells was met; a larger --max-cells may bring more\n");
  const HeldCells& held = result.held;
  if (held.cells == 0 || !held.known) return;
  print(
      "{} of them are held by the surface or have no vertex that may move: --surface flat would let that "
      "change at {}, free at {} more, neither at {}\n",
      grouped(held.cells), grouped(held.by_flat), grouped(held.by_free), grouped(held.by_shape));
}

void print_surface(const SurfaceReport& s) {
  print(
      "surface: {} triangles, {} before; Hausdorff distance {:.3g} ({:.2g} % of the diagonal), at most "
      "{:.3g} "
      "allowed; volume {:+.2e}\n",
      grouped(s.triangles_after), grouped(s.triangles_before), s.hausdorff,
      s.diagonal > 0 ? 100 * s.hausdorff / s.diagonal : 0.0, s.bound, s.volume_change);
  const auto change = [](const RegionChange& r) { return r.before != 0 ? r.after / r.before - 1 : 0.0; };
  const auto most =
      std::max_element(s.regions.begin(), s.regions.end(), [&](const RegionChange& a, const RegionChange& b) {
        return std::abs(change(a)) < std::abs(change(b));
      });
  if (most == s.regions.end() || s.regions.size() < 2) return;
  constexpr double kKept = 5e-4;  // of its volume: from here on a region's changes may only go back
  const auto n_beyond = std::count_if(s.regions.begin(), s.regions.end(),
                                      [&](const RegionChange& r) { return !(std::abs(change(r)) <= kKept); });
  print("regions: {}; volume changed most in region {}, by {:+.2e} of it{}\n", grouped(s.regions.size()),
        most->region, change(*most),
        n_beyond == 0 ? "" : fmt::format("; by more than 0.05 % in {} of them", n_beyond));
}

void print_written(const std::string& path, const io::MeshData& data) {
  print("{}: {} vertices, {} cells, {} triangles\n", path, grouped(data.points.size()),
        grouped(data.cells.size()), grouped(data.triangles.size()));
}

}  // namespace hfr::app
