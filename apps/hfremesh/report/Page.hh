// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_PAGE_HH
#define HFR_APPS_REPORT_PAGE_HH

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "Pack.hh"
#include "hfremesh/Remesh/Result.hh"

/// A report as one HTML file that needs nothing else: no network, no folder beside it.
namespace hfr::view {

/// What the worst angle was, and when.
struct Moment {
  double seconds = 0;  ///< since the run began
  std::string stage;
  int iteration = 0;
  double degrees = 0;  ///< the smallest dihedral of the mesh
  std::size_t n_inverted = 0;
};

/// A mesh as the page has it: what its viewer needs, and its worst cells with their corners.
struct PageMesh {
  std::string name;
  PackedMesh packed;
  nlohmann::ordered_json cells;  ///< see worst_cells()
};

/// Of the worst `most` cells: "cell", "degrees", "angles" (six), "points" (four, as in the mesh), "region".
nlohmann::ordered_json worst_cells(const TetMesh& mesh, const std::vector<float>& degrees, std::size_t most);
/// The same of the cells that are stuck, the worst `most` of each reason, with "limit", "frozen_vertices"
/// and, where there is one, "ceiling".
nlohmann::ordered_json stuck_cells(const TetMesh& mesh, const Result& result, std::size_t most);
/// By cell, the number of its reason in kStuckReasonNames, else kNoReason.
std::vector<std::uint8_t> reasons_of(const TetMesh& mesh, const Result& result);

/// The page. `report`: what --json gives for the run, with "before" and "after". The script in the page makes
/// tables, charts and words of it; its element "payload" holds {"report", "moments", "meshes"}.
std::string page_of(const nlohmann::ordered_json& report, const std::vector<Moment>& moments,
                    const PageMesh& before, const PageMesh& after);

}  // namespace hfr::view

#endif
