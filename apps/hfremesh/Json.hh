// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_JSON_HH
#define HFR_APPS_JSON_HH

#include <nlohmann/json.hpp>
#include <string>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshData.hh"
#include "hfremesh/Quality/Statistics.hh"
#include "hfremesh/Remesh/Improve.hh"

/// The parts of the JSON report; docs/json.md describes the schema.
namespace hfr::app {

using Json = nlohmann::ordered_json;

/// Schema, tool and command.
Json new_report(const std::string& command);
std::string json_text(const Json& report);

/// Counts and hash of what a file holds.
Json contents(const io::MeshData& data);
Json to_json(const Statistics& statistics);
Json to_json(const PassReport& pass);
Json distribution_json(const Distribution& distribution);
Json surface_json(const SurfaceReport& surface);
Json to_json(const BuildReport& report);
/// What keeps the cells that are left below the goal: counts, and the first hundred of them.
Json limits_json(const Result& result);
/// The vertices of the first hundred faces.
Json faces_json(const TetMesh& mesh, const std::vector<HalfFaceHandle>& faces);

/// The first `limit` handles as numbers.
template <class Handles>
Json ids(const Handles& handles, std::size_t limit = 100) {
  Json list = Json::array();
  for (const auto& handle : handles) {
    if (list.size() == limit) break;
    list.push_back(handle.idx());
  }
  return list;
}

}  // namespace hfr::app

#endif
