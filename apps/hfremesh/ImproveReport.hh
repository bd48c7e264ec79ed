// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_IMPROVE_REPORT_HH
#define HFR_APPS_IMPROVE_REPORT_HH

#include <string>

#include "ExitCode.hh"
#include "Json.hh"
#include "Options.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Remesh/Improve.hh"

/// What `improve` tells of a run.
namespace hfr::app {

/// Wall time by step.
struct Seconds {
  double read = 0, build = 0, statistics = 0, improve = 0, write = 0;
};

ExitCode exit_code_of(const Result& result);
/// One line that says why the exit code is not 0.
std::string shortfall(const Result& result, const ImproveOptions& options);
void report_run(Json& report, const TetMesh& mesh, const Result& result, const ImproveOptions& options,
                const Seconds& seconds);
/// The tables, for humans.
void print_result(const Result& result, const Seconds& seconds, bool dry_run, const CommonOptions& common);
/// Kind, index, angle and reason of each cell below the goal, and the folded faces, and those that leave no
/// mesh without invalid cells, by their vertices.
std::string ids_text(const TetMesh& mesh, const Result& result);

}  // namespace hfr::app

#endif
