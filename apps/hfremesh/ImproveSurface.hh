// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_IMPROVE_SURFACE_HH
#define HFR_APPS_IMPROVE_SURFACE_HH

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ExitCode.hh"
#include "Options.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Surface/SurfaceOptions.hh"

namespace hfr::app {

/// What of `improve` counts where the file has triangles only.
struct SurfaceCommand {
  std::string input, output;
  bool dry_run = false;
  std::string mode;          ///< as given; empty = free
  std::string min_dihedral;  ///< must be empty
  double min_angle = 0;      ///< degrees; 0 = none
  double time_limit = 0;     ///< seconds; 0 = none
  SurfaceOptions surface;
  io::WriteOptions write;
  double seconds_read = 0;
};

/// Improves the triangles of `data`, which has no cells.
ExitCode improve_surface(const SurfaceCommand& command, io::MeshData data, const CommonOptions& common,
                         nlohmann::ordered_json& report);

}  // namespace hfr::app

#endif
