// SPDX-License-Identifier: BSD-3-Clause
#include "Fields.hh"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "Report.hh"

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
  std::string names;
  for (const io::Field& field : after.point_fields) names += (names.empty() ? "'" : ", '") + field.name + "'";
  return {
      fmt::format("fields of vertices ({}) are attached, not carried over: {} of {} vertices moved with "
                  "their values, or are new with those of the nearest",
                  names, grouped(static_cast<std::size_t>(n)), grouped(after.points.size()))};
}

}  // namespace hfr::app
