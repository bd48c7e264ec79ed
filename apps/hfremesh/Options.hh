// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_OPTIONS_HH
#define HFR_APPS_OPTIONS_HH

#include <functional>
#include <string>

#include "Parser.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Parallel/Parallel.hh"
#include "hfremesh/Remesh/Improve.hh"

namespace hfr::app {

/// What does a run: hfr::improve(), or the same on several ranks.
using ImproveFunction = std::function<Result(TetMesh&, const ImproveOptions&)>;

/// What every subcommand takes.
struct CommonOptions {
  int threads = 0;                    ///< 0 = every core
  std::string json;                   ///< file for the report, "-" for stdout, empty for none
  std::string format, output_format;  ///< of meshes on "-"; the second where the output's is another one
  bool stdout_taken = false;          ///< by a mesh or a list: "-"
  bool quiet = false;
  bool verbose = false;
  bool split_nonmanifold = false;  ///< vertices whose cells do not connect come apart while a mesh is read

  ImproveFunction improve = [](TetMesh& mesh, const ImproveOptions& options) {
    return hfr::improve(mesh, options);
  };

  par::Policy policy() const;
  /// Tables for humans go to stdout unless they are unwanted or something else goes there.
  bool prints_table() const { return !quiet && json != "-" && !stdout_taken; }
};

void add_common_options(Command command, CommonOptions& common);
/// --format, of a mesh that is read from or written to a standard stream.
void add_format_options(Command command, CommonOptions& common, bool reads, bool writes);
/// A file that is named here and is a standard stream is "-" from then on.
ValueCheck stream_name();
void add_split_option(Command command, CommonOptions& common);
void add_write_options(Command command, io::WriteOptions& options);

}  // namespace hfr::app

#endif
