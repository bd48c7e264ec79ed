// SPDX-License-Identifier: BSD-3-Clause
#include "Page.hh"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "Angles.hh"
#include "PageFiles.hh"
#include "hfremesh/Quality/CellQuality.hh"

namespace hfr::view {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(Vec3 p) { return {p.x, p.y, p.z}; }

Json cell_json(const TetMesh& mesh, CellHandle c, double degrees) {
  const auto& v = mesh.cell_vertices(c);
  std::array<Vec3, 4> p{};
  std::transform(v.begin(), v.end(), p.begin(), [&](VertexHandle at) { return mesh.point(at); });
  Json points = Json::array();
  for (const Vec3& at : p) points.push_back(to_json(at));
  Json json = {{"cell", c.idx()},
               {"degrees", degrees},
               {"angles", dihedrals(p[0], p[1], p[2], p[3])},
               {"points", std::move(points)}};
  if (mesh.has_regions()) json["region"] = mesh.region(c);
  return json;
}

Json to_json(const PackedMesh& packed) {
  Json sizes = Json::object();
  for (std::size_t i = 0; i < packed.sizes.size(); ++i) sizes[PackedMesh::kStreams[i]] = packed.sizes[i];
  return {{"vertices", packed.n_vertices},
          {"cells", packed.n_cells},
          {"skin", packed.n_skin},
          {"listed", packed.n_listed},
          {"all_cells", packed.has_all_cells},
          {"low", to_json(packed.box_low)},
          {"high", to_json(packed.box_high)},
          {"sizes", std::move(sizes)}};
}

Json to_json(const Moment& m) {
  return {{"seconds", m.seconds},
          {"stage", m.stage},
          {"iteration", m.iteration},
          {"degrees", m.degrees},
          {"inverted", m.n_inverted}};
}

/// Within a script element, nothing may look like the end of it.
std::string script_text(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
    text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

/// The template with what stands for each "{{name}}".
std::string filled(std::string_view page, const std::map<std::string, std::string_view>& parts) {
  std::string text;
  while (!page.empty()) {
    const std::size_t open = page.find("{{");
    text += page.substr(0, open);
    if (open == std::string_view::npos) break;
    const std::size_t close = page.find("}}", open);
    text += parts.at(std::string(page.substr(open + 2, close - open - 2)));
    page.remove_prefix(close + 2);
  }
  return text;
}

}  // namespace

nlohmann::ordered_json worst_cells(const TetMesh& mesh, const std::vector<float>& degrees, std::size_t most) {
  std::vector<std::uint32_t> order(degrees.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto n = static_cast<std::ptrdiff_t>(std::min(most, order.size()));
  std::partial_sort(order.begin(), order.begin() + n, order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(degrees[a], a) < std::pair(degrees[b], b);
  });
  Json list = Json::array();
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const CellHandle c(order[static_cast<std::size_t>(i)]);
    list.push_back(cell_json(mesh, c, quality(mesh, c, Metric::kMinDihedral)));
  }
  return list;
}

nlohmann::ordered_json stuck_cells(const TetMesh& mesh, const Result& result, std::size_t most) {
  std::vector<StuckCell> stuck = result.stuck;
  std::sort(stuck.begin(), stuck.end(), [](const StuckCell& a, const StuckCell& b) {
    return std::tuple(a.reason, a.degrees, a.cell) < std::tuple(b.reason, b.degrees, b.cell);
  });
  Json list = Json::array();
  std::array<std::size_t, kStuckReasonNames.size()> n_of{};
  for (const StuckCell& cell : stuck) {
    const auto reason = static_cast<std::size_t>(cell.reason);
    if (++n_of[reason] > most) continue;
    Json json = cell_json(mesh, cell.cell, cell.degrees);
    json["limit"] = kStuckReasonNames[reason];
    json["frozen_vertices"] = cell.n_frozen_vertices;
    if (cell.a.is_valid() && is_proof(cell.reason) && cell.ceiling < 180) json["ceiling"] = cell.ceiling;
    list.push_back(std::move(json));
  }
  return list;
}

std::vector<std::uint8_t> reasons_of(const TetMesh& mesh, const Result& result) {
  std::vector<std::uint8_t> reasons(mesh.n_cells(), kNoReason);
  for (const StuckCell& cell : result.stuck)
    reasons[cell.cell.idx()] = static_cast<std::uint8_t>(cell.reason);
  return reasons;
}

std::string page_of(const nlohmann::ordered_json& report, const std::vector<Moment>& moments,
                    const PageMesh& before, const PageMesh& after) {
  Json payload;
  payload["report"] = report;
  payload["reasons"] = kStuckReasonNames;
  payload["moments"] = Json::array();
  for (const Moment& moment : moments) payload["moments"].push_back(to_json(moment));
  payload["meshes"] = Json::array();
  for (const PageMesh* mesh : {&before, &after})
    payload["meshes"].push_back(
        {{"name", mesh->name}, {"packed", to_json(mesh->packed)}, {"cells", mesh->cells}});
  const std::string json = script_text(payload);
  const std::string first = base64(before.packed.deflated), second = base64(after.packed.deflated);
  return filled(page_file("report.html"), {{"style", page_file("report.css")},
                                           {"payload", json},
                                           {"before", first},
                                           {"after", second},
                                           {"words", page_file("words.js")},
                                           {"charts", page_file("charts.js")},
                                           {"mesh", page_file("mesh.js")},
                                           {"view", page_file("view.js")},
                                           {"script", page_file("report.js")}});
}

}  // namespace hfr::view
