// SPDX-License-Identifier: BSD-3-Clause
#include "Json.hh"

#include <algorithm>

#include "hfremesh/HalfFace/Config.hh"
#include "hfremesh/IO/Hash.hh"

namespace hfr::app {
namespace {

Json to_json(const Distribution& distribution) {
  Json percentiles;
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    std::string name = Json(kPercentiles[i]).dump();
    if (name.ends_with(".0")) name.resize(name.size() - 2);
    percentiles["p" + name] = distribution.percentiles[i];
  }
  return {{"min", distribution.min},
          {"mean", distribution.mean},
          {"max", distribution.max},
          {"percentiles", std::move(percentiles)}};
}

Json to_json(const EdgeWedge& wedge) {
  if (!wedge.a.is_valid()) return Json();
  return {{"degrees", wedge.degrees}, {"edge", {wedge.a.idx(), wedge.b.idx()}}, {"cell", wedge.cell.idx()}};
}

Json to_json(Vec3 p) { return {p.x, p.y, p.z}; }

Json to_json(const RegionStatistics& region) {
  return {{"region", region.region}, {"cells", region.cells},   {"inverted", region.inverted},
          {"flat", region.flat},     {"volume", region.volume}, {"min_dihedral", region.min_dihedral}};
}

Json to_json(const PatchStatistics& patch) {
  return {{"label", patch.label}, {"faces", patch.faces}, {"area", patch.area}};
}

template <class T>
Json list_json(const std::vector<T>& items) {
  Json list = Json::array();
  for (const T& item : items) list.push_back(to_json(item));
  return list;
}

}  // namespace

Json new_report(const std::string& command) {
  Json report;
  report["schema"] = "hfremesh-1";
  report["tool"] = {{"name", "hfremesh"}, {"version", HFR_VERSION}};
  report["command"] = command;
  return report;
}

std::string json_text(const Json& report) {
  // File names may hold any byte; one that is not UTF-8 must not cost the report.
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json contents(const io::MeshData& data) {
  return {{"vertices", data.points.size()},
          {"cells", data.cells.size()},
          {"triangles", data.triangles.size()},
          {"edges", data.edges.size()},
          {"hash", io::hash_text(io::mesh_hash(data))}};
}

Json to_json(const Statistics& s) {
  Json json;
  json["vertices"] = s.vertices;
  json["unused_vertices"] = s.unused_vertices;
  json["cells"] = s.cells;
  json["edges"] = s.edges;
  json["faces"] = s.faces;
  json["boundary_faces"] = s.boundary_faces;
  json["interface_faces"] = s.interface_faces;
  json["components"] = s.components;
  json["inverted"] = s.inverted.size();
  json["inverted_cells"] = ids(s.inverted);
  json["flat"] = s.flat.size();
  json["flat_cells"] = ids(s.flat);
  json["min_dihedral"] = to_json(s.min_dihedral);
  json["worst_cell"] = s.worst_cell.is_valid() ? Json(s.worst_cell.idx()) : Json();
  json["mean_dihedral"] = s.mean_dihedral;
  json["max_dihedral"] = s.max_dihedral;
  json["dihedral_histogram"] = s.dihedral_histogram;
  json["min_dihedral_histogram"] = s.min_dihedral_histogram;
  json["cells_below"] = Json::object();
  for (const std::size_t degrees : {5, 10, 15, 20, 30})
    json["cells_below"][std::to_string(degrees)] = n_cells_below(s, degrees);
  json["volume_length"] = to_json(s.volume_length);
  json["volume_length_histogram"] = s.volume_length_histogram;
  json["edge_length"] = to_json(s.edge_length);
  json["box"] = {{"low", to_json(s.box_low)}, {"high", to_json(s.box_high)}};
  json["volume"] = s.volume;
  json["absolute_volume"] = s.absolute_volume;
  json["enclosed_volume"] = s.enclosed_volume;
  json["overlap"] = s.overlap;
  json["regions"] = list_json(s.regions);
  json["patches"] = list_json(s.patches);
  json["surface_ceiling"] = to_json(s.surface_ceiling);
  json["interface_ceiling"] = to_json(s.interface_ceiling);
  json["angle_ceiling"] = to_json(s.angle_ceiling);
  return json;
}

Json distribution_json(const Distribution& distribution) { return to_json(distribution); }

Json surface_json(const SurfaceReport& surface) {
  Json json;
  json["mode"] = surface.mode == SurfaceMode::kFlat ? "flat" : "free";
  json["bound"] = surface.bound;
  json["hausdorff"] = surface.hausdorff;
  json["unfold_needs"] = surface.unfold_needs;
  json["diagonal"] = surface.diagonal;
  json["volume_change"] = surface.volume_change;
  json["feature_edges"] = surface.feature_edges;
  json["triangles_before"] = surface.triangles_before;
  json["triangles_after"] = surface.triangles_after;
  json["regions"] = Json::array();
  for (const RegionChange& r : surface.regions)
    json["regions"].push_back({{"region", r.region}, {"volume_before", r.before}, {"volume_after", r.after}});
  return json;
}

Json to_json(const PassReport& pass) {
  Json json;
  json["stage"] = pass.stage;
  json["op"] = pass.op;
  json["iteration"] = pass.iteration;
  json["rounds"] = pass.rounds;
  json["sub_rounds"] = pass.sub_rounds;
  json["seeds"] = pass.seeds;
  json["candidates"] = pass.candidates;
  json["winners"] = pass.winners;
  json["on_device"] = pass.on_device;
  json["inverted"] = pass.n_inverted;
  json["worst"] = pass.worst;
  json["seconds"] = {{"total", pass.seconds},
                     {"evaluate", pass.seconds_evaluate},
                     {"select", pass.seconds_select},
                     {"commit", pass.seconds_commit}};
  return json;
}

Json limits_json(const Result& result) {
  constexpr std::size_t kMostCells = 100;
  Json counts;
  const auto n = count_reasons(result.stuck);
  for (std::size_t i = 0; i < n.size(); ++i) counts[kStuckReasonNames[i]] = n[i];
  Json cells = Json::array();
  for (std::size_t i = 0; i < std::min(result.stuck.size(), kMostCells); ++i) {
    const StuckCell& stuck = result.stuck[i];
    cells.push_back({{"cell", stuck.cell.idx()},
                     {"degrees", stuck.degrees},
                     {"limit", kStuckReasonNames[static_cast<std::size_t>(stuck.reason)]},
                     {"frozen_vertices", stuck.n_frozen_vertices}});
    const bool has_edge = stuck.a.is_valid() && is_proof(stuck.reason) && stuck.ceiling < 180;
    cells.back()["ceiling"] = has_edge ? Json(stuck.ceiling) : Json();
    cells.back()["edge"] = has_edge ? Json({stuck.a.idx(), stuck.b.idx()}) : Json();
  }
  Json held = {{"cells", result.held.cells}};
  if (result.held.known)
    held.update(
        {{"flat", result.held.by_flat}, {"free", result.held.by_free}, {"shape", result.held.by_shape}});
  Json bound;
  if (const CellBoundMet& met = result.cell_bound; met.bound > 0)
    bound = {{"bound", met.bound}, {"cells", met.cells}, {"wanted", met.wanted}};
  return {{"below", result.stuck_below},    {"cell_bound", std::move(bound)},
          {"n_cells", result.stuck.size()}, {"held_by_surface", std::move(held)},
          {"counts", std::move(counts)},    {"cells", std::move(cells)}};
}

Json faces_json(const TetMesh& mesh, const std::vector<HalfFaceHandle>& faces) {
  constexpr std::size_t kMostFaces = 100;
  Json list = Json::array();
  for (std::size_t i = 0; i < std::min(faces.size(), kMostFaces); ++i) {
    const auto f = mesh.halfface_vertices(faces[i]);
    list.push_back({f[0].idx(), f[1].idx(), f[2].idx()});
  }
  return list;
}

Json to_json(const BuildReport& report) {
  return {{"flipped", report.flipped},
          {"reoriented", report.reoriented.size()},
          {"reoriented_cells", ids(report.reoriented)},
          {"split_vertices", report.copied.size()}};
}

}  // namespace hfr::app
