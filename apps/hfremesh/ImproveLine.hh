// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_IMPROVE_LINE_HH
#define HFR_APPS_IMPROVE_LINE_HH

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "Options.hh"
#include "Parser.hh"
#include "Presentation.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Remesh/Improve.hh"

namespace hfr::app {

/// What may become of the surface, as it was given.
struct SurfaceLine {
  std::string mode;
  double hausdorff = -1;  ///< negative = not given
  std::optional<double> feature_angle;
  std::vector<std::string> fix;

  /// `unless_given`: without one.
  SurfaceMode surface_mode(SurfaceMode unless_given = SurfaceMode::kFrozen) const {
    if (mode.empty()) return unless_given;
    return mode == "free" ? SurfaceMode::kFree : mode == "flat" ? SurfaceMode::kFlat : SurfaceMode::kFrozen;
  }
};

/// What of a command line counts for `improve`, as it was given; names are looked up before the input is
/// read.
struct ImproveLine {
  std::string input, output;
  bool dry_run = false;
  bool plan = false;
  bool progress = false;
  bool label_features = false;
  bool ignore_labels = false;
  std::string ops, metric, smoother, rounds, compat;
  SurfaceLine surface;
  std::vector<std::string> periodic;
  std::string device;  ///< as device_choice_from_name() has it
  bool no_insert = false;
  std::string min_dihedral;        ///< degrees or "max"
  double min_angle = 0;            ///< degrees, for surfaces; 0 = none
  std::string ids;                 ///< file for the cells that are stuck, empty for none
  std::string quality_array;       ///< name of the field of cells, empty for none
  PresentationFiles presentation;  ///< pictures and pages to make
  double time_limit = 0;           ///< 0 = none
  io::WriteOptions write;
  ImproveOptions improve;
};

/// The goal of a run, degrees or "max"; `degrees` must outlive the parser's run.
void add_min_dihedral_option(Command command, std::string& degrees, const std::string& what);
/// Into the options; nothing where none is given.
void set_min_dihedral(const std::string& degrees, ImproveOptions& options);
/// The operators of a run and how they take turns; `ops` and `rounds` must outlive the parser's run.
void add_ops_option(Command command, std::string& ops);
void add_rounds_option(Command command, std::string& rounds);
void add_surface_mode_options(Command command, SurfaceLine& line);
void add_fix_option(Command command, std::vector<std::string>& fix);
/// Into the options; `periodic`: pairs of patches.
void set_surface(const SurfaceLine& line, const std::vector<std::string>& periodic, SurfaceOptions& options);
/// `line` and `common` must outlive the parser's run.
void add_improve_options(Command command, ImproveLine& line, CommonOptions& common);
/// Of these the ones that count for nothing. `has_distance`: whether --hausdorff and --feature-angle do,
/// which they do with `where`; `is_frozen`: whether the surface is.
std::vector<std::string> notes_on_idle_surface_options(const SurfaceLine& line, bool has_distance,
                                                       const char* where, bool is_frozen);
/// What the library is asked for. Throws for a name that there is not.
ImproveOptions improve_options(const ImproveLine& line, const CommonOptions& common);
/// The same for the report.
nlohmann::ordered_json options_json(const ImproveLine& line, const ImproveOptions& options);
/// Options that count for nothing without another one.
std::vector<std::string> notes_on_idle_options(const ImproveLine& line, bool on_tetrahedra);

}  // namespace hfr::app

#endif
