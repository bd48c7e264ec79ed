// SPDX-License-Identifier: BSD-3-Clause
#include "Fields.hh"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "ExitCode.hh"
#include "Paths.hh"
#include "Report.hh"
#include "hfremesh/Quality/CellQuality.hh"

namespace hfr::app {
namespace {

bool less(const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

}  // namespace

PointsOfFields::PointsOfFields(const io::MeshData& before) {
  if (!before.point_fields.empty()) points_ = before.points;
  std::sort(points_.begin(), points_.end(), less);
}

std::vector<std::string> PointsOfFields::notes(const io::MeshData& after) const {
  if (points_.empty() || after.point_fields.empty()) return {};
  const auto is_new = [&](const Vec3& p) {
    return !std::binary_search(points_.begin(), points_.end(), p, less);
  };
  const auto n = std::count_if(after.points.begin(), after.points.end(), is_new);
  if (n == 0) return {};
  std::vector<std::string> names;
  for (const io::Field& field : after.point_fields) names.push_back(field.name);
  return {note_on_values_elsewhere(names, static_cast<std::size_t>(n), after.points.size())};
}

std::string note_on_values_elsewhere(const std::vector<std::string>& names, std::size_t n_elsewhere,
                                     std::size_t n_vertices) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "'" : ", '") + name + "'";
  return fmt::format(
      "fields of vertices ({}) are attached, not carried over: {} of {} vertices moved with their values, or "
      "are new with those of the nearest",
      list, grouped(n_elsewhere), grouped(n_vertices));
}

void require_quality_array(const std::string& name, const std::string& output,
                           const io::WriteOptions& options) {
  if (name.empty()) return;
  const auto refuse = [](const std::string& why) {
    throw Failure(ExitCode::kUsage, "--quality-array: " + why);
  };
  if (std::any_of(name.begin(), name.end(),
                  [](unsigned char c) { return c <= ' ' || c == 0x7f || c == '"'; }))
    refuse("a name without blanks, quotes and line breaks is wanted");
  if (name == "region") refuse("'region' is what the numbers of regions are called; take another name");
  if (output.empty()) refuse("there is no output file for the angles to be in");
  if (!io::holds_fields(output_path(output), options))
    refuse(output + ": the format has no place for values of cells; .vtu, .vtk, .msh and .ovm have");
}

void add_quality_array(const std::string& name, par::Policy policy, io::MeshData& data) {
  io::Field field;
  field.name = name;
  field.values.resize(data.cells.size());
  par::for_each(policy, data.cells.size(), [&](std::size_t i) {
    const auto& v = data.cells[i];
    const auto& p = data.points;
    field.values[i] = reported_quality(Metric::kMinDihedral, p[v[0]], p[v[1]], p[v[2]], p[v[3]]);
  });
  const auto has_name = [&](const io::Field& other) { return other.name == name; };
  std::erase_if(data.cell_fields, has_name);
  data.cell_fields.push_back(std::move(field));
}

}  // namespace hfr::app
