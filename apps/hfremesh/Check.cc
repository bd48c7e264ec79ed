// SPDX-License-Identifier: BSD-3-Clause
// hfremesh check IN: is this a mesh that a solver can take? Exit code 0 when it is, 3 when it is but misses
// --min-dihedral, 4 when it is not, 2 when no mesh can be made of the file at all.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "Numbers.hh"
#include "Report.hh"
#include "hfremesh/HalfFace/Check.hh"
#include "hfremesh/Quality/FoldedFaces.hh"

namespace hfr::app {
namespace {

/// The sums of absolute volumes and of the enclosed volume differ by rounding in a mesh without overlap.
constexpr double kOverlapTolerance = 1e-9;

struct CommandLine {
  std::string input;
  std::string ids;
  std::optional<double> min_dihedral;
  bool manifold = false;  ///< wanted
};

/// What is wrong with the cells, one kind each.
struct Finding {
  std::string kind;
  std::vector<CellHandle> cells;
  std::string remark;
};

std::vector<CellHandle> both(const std::vector<CellHandle>& a, const std::vector<CellHandle>& b) {
  std::vector<CellHandle> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return common;
}

std::vector<Finding> find_invalid(const BuildReport& build, const Statistics& statistics) {
  std::vector<Finding> findings = {{"inverted", statistics.inverted, ""},
                                   {"flat", statistics.flat, ""},
                                   {"renumbered", build.reoriented, ""}};
  const std::size_t hidden = both(build.reoriented, statistics.inverted).size();
  findings[2].remark = "ordered against their neighbours";
  if (hidden > 0)
    findings[2].remark += fmt::format(", which hides that {} of them are inverted", grouped(hidden));
  return findings;
}

bool is_manifold(const CheckResult& structure) {
  return !(structure == Rule::kNonManifoldEdge) && !(structure == Rule::kNonManifoldVertex);
}

/// Solvers go from cell to cell across faces: parts that touch at an edge or a vertex only are no fault, nor
/// is a labelled triangle or edge of the file that belongs to no cell. `improve` takes both.
bool is_fault(const CheckResult& structure, const CommandLine& line) {
  if (!is_manifold(structure)) return line.manifold;
  return !(structure == Rule::kNone) && !(structure == Rule::kLabel);
}

std::string ids_text(const LoadedMesh& loaded, const std::vector<Finding>& findings,
                     const std::vector<HalfFaceHandle>& folded) {
  std::string text = "# kind and 0-based index of each bad cell; folded: the vertices of a boundary face\n";
  for (const Finding& finding : findings)
    for (CellHandle cell : finding.cells) text += fmt::format("{} {}\n", finding.kind, cell.idx());
  for (HalfFaceHandle h : folded) {
    const auto f = loaded.mesh.halfface_vertices(h);
    text += fmt::format("folded {} {} {}\n", f[0].idx(), f[1].idx(), f[2].idx());
  }
  return text;
}

void print_findings(const CommandLine& line, const LoadedMesh& loaded, const Statistics& statistics,
                    const std::vector<Finding>& findings, const CheckResult& structure, bool overlaps,
                    std::size_t n_folded) {
  const auto row = [](const std::string& name, const std::string& text) { print("{:<12}{}\n", name, text); };
  print("{}: {} vertices, {} cells\n", line.input, grouped(statistics.vertices), grouped(statistics.cells));
  row("orientation", loaded.report.flipped ? "the other way round as a whole, which is no fault" : "ok");
  for (const Finding& finding : findings) {
    std::string text = "none";
    if (!finding.cells.empty()) text = grouped(finding.cells.size()) + ": " + id_list(finding.cells);
    if (!finding.cells.empty() && !finding.remark.empty()) text += " (" + finding.remark + ")";
    row(finding.kind, text);
  }
  row("structure",
      structure ? "ok" : structure.message + (is_fault(structure, line) ? "" : ", which is no fault"));
  row("overlap", overlaps ? fmt::format("{:.3e} of the enclosed volume", statistics.overlap) : "none");
  if (n_folded > 0) row("folded", grouped(n_folded) + " boundary faces lie on or go through another one");
  if (statistics.unused_vertices > 0)
    row("unused", grouped(statistics.unused_vertices) + " vertices, which is no fault");
  row("dihedral", fmt::format("{:.4f} to {:.4f}", statistics.min_dihedral.min, statistics.max_dihedral));
}

ExitCode run(const CommandLine& line, const CommonOptions& common, Json& report) {
  report["input"]["file"] = line.input;
  if (!line.ids.empty()) require_writable(line.ids);
  const LoadedMesh loaded = load(line.input, common);
  const Statistics figures = statistics(loaded.mesh, common.policy());
  const std::vector<Finding> findings = find_invalid(loaded.report, figures);
  const bool overlaps = figures.overlap > kOverlapTolerance;
  const CheckResult structure = check(loaded.mesh, {.policy = common.policy()});
  const std::vector<HalfFaceHandle> folded = folded_faces(loaded.mesh, common.policy());
  bool valid = !overlaps && !is_fault(structure, line);
  for (const Finding& finding : findings) valid = valid && finding.cells.empty();
  const bool goal_met = !line.min_dihedral || figures.min_dihedral.min >= *line.min_dihedral;

  report["input"].update(to_json(loaded.report));
  report["seconds"] = {{"read", loaded.seconds_read}, {"build", loaded.seconds_build}};
  report["result"] = {{"valid", valid},
                      {"goal_reached", valid && goal_met},
                      {"manifold", is_manifold(structure)},
                      {"overlaps", overlaps},
                      {"n_folded_faces", folded.size()},
                      {"folded_faces", faces_json(loaded.mesh, folded)},
                      {"structure", structure ? Json() : Json(structure.message)}};
  report["statistics"] = to_json(figures);
  report["notes"] = loaded.notes;
  if (!common.quiet) print_notes(loaded.notes);
  if (common.prints_table())
    print_findings(line, loaded, figures, findings, structure, overlaps, folded.size());
  if (!valid) print_error(line.input + ": the mesh is not valid");
  if (valid && !goal_met)
    print_error(fmt::format("{}: the smallest dihedral angle is {:.4f}, below the goal of {}", line.input,
                            figures.min_dihedral.min, *line.min_dihedral));
  const ExitCode code = !valid ? ExitCode::kInvalidCells : goal_met ? ExitCode::kDone : ExitCode::kGoalMissed;
  return line.ids.empty() ? code
                          : save_report(
                                line.ids, [&] { return ids_text(loaded, findings, folded); }, code);
}

}  // namespace

Subcommand add_check(Command program, CommonOptions& common) {
  const auto line = std::make_shared<CommandLine>();
  Command command =
      program.subcommand("check", "Fail on inverted, flat, renumbered, overlapping or broken cells");
  command.example("hfremesh check in.mesh --ids bad.txt",
                  "exit code 0 only for a mesh that a solver can take");
  command.example("hfremesh check in.mesh --min-dihedral 10",
                  "exit code 3 where an angle is below 10 degrees, too");
  command.group("Mesh");
  command.option("IN", line->input, "Mesh to read").required().type_name("FILE").transform(stream_name());
  command.group("What is looked for");
  command.option("--ids", line->ids, "Write kind and index of every bad cell; - is stdout")
      .type_name("FILE")
      .transform(stream_name());
  command.option("--min-dihedral", line->min_dihedral, "Fail on a smaller dihedral angle too")
      .type_name("DEG")
      .check(real_number(0, 180));
  command.flag("--manifold", line->manifold, "Fail on edges and vertices at which parts only touch, too");
  add_format_options(command, common, true, false);
  add_split_option(command, common);
  add_common_options(command, common);
  using Kind = FileUse::Kind;
  return {
      command,
      [line] {
        return std::vector<FileUse>{{Kind::kInput, "IN", line->input}, {Kind::kReport, "--ids", line->ids}};
      },
      [line, &common](Json& report) { return run(*line, common, report); }};
}

}  // namespace hfr::app
