// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_WRITE_MESH_HH
#define HFR_APPS_WRITE_MESH_HH

#include <string>
#include <vector>

#include "ExitCode.hh"
#include "Json.hh"
#include "Options.hh"
#include "hfremesh/IO/MeshData.hh"
#include "hfremesh/IO/MeshFile.hh"

namespace hfr::app {

/// The end of a command whose result is a mesh: writes it, and says so in the report, in the notes, of which
/// `notes` are the first, and in the table.
ExitCode write_mesh(const std::string& path, const io::MeshData& data, const io::WriteOptions& options,
                    std::vector<std::string> notes, const CommonOptions& common, Json& report);

}  // namespace hfr::app

#endif
