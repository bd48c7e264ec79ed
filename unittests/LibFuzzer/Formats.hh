// SPDX-License-Identifier: BSD-3-Clause
// What the targets, the maker of inputs, and the script know of formats.
#ifndef HFR_UNITTESTS_LIB_FUZZER_FORMATS_HH
#define HFR_UNITTESTS_LIB_FUZZER_FORMATS_HH

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "IO/MeshData.hh"

namespace hfr::fuzz {

inline bool is_surface_format(std::string_view extension) {
  constexpr std::array<std::string_view, 4> kSurfaces = {".stl", ".obj", ".off", ".ply"};
  return std::find(kSurfaces.begin(), kSurfaces.end(), extension) != kSurfaces.end();
}

/// An input is the bytes of the file, and may go on with those of files beside it, each after a line that
/// names its extension: "\n%%% .sol\n".
inline constexpr std::string_view kBeside = "\n%%% ";

struct Part {
  std::string extension;
  std::string_view bytes;
};

/// The files of an input. A line that names no extension of a format of several files is bytes like others.
inline std::vector<Part> parts_of(std::string_view input, const std::string& extension) {
  constexpr std::array<std::string_view, 6> kKnown = {".sol", ".solb", ".node", ".ele", ".face", ".edge"};
  std::vector<Part> parts = {{extension, input}};
  std::size_t from = 0;
  while ((from = input.find(kBeside, from)) != std::string_view::npos) {
    const std::size_t name = from + kBeside.size();
    const std::size_t end = input.find('\n', name);
    if (end == std::string_view::npos) break;
    const std::string_view other = input.substr(name, end - name);
    if (std::find(kKnown.begin(), kKnown.end(), other) != kKnown.end()) {
      parts.back().bytes = parts.back().bytes.substr(
          0, static_cast<std::size_t>(input.data() + from - parts.back().bytes.data()));
      parts.push_back({std::string(other), input.substr(end + 1)});
    }
    from = end;
  }
  return parts;
}

inline bool same_value(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}
inline bool same_points(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Vec3& p, const Vec3& q) {
    return same_value(p.x, q.x) && same_value(p.y, q.y) && same_value(p.z, q.z);
  });
}
/// What files call a field that has no name.
inline std::string name_of(const io::Field& field) { return field.name.empty() ? "unnamed" : field.name; }

/// The first field that is another, and by what; empty where all are the same. Whether values are to be
/// written as integers is a hint that may be lost, as is the sign of an integer 0.
inline std::string difference(const std::vector<io::Field>& a, const std::vector<io::Field>& b) {
  if (a.size() != b.size()) return std::to_string(a.size()) + " and " + std::to_string(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const io::Field &x = a[i], &y = b[i];
    if (name_of(x) != name_of(y)) return "name '" + x.name + "' and '" + y.name + "'";
    if (x.components != y.components) return "components of '" + x.name + "'";
    const auto same = [&](double p, double q) {
      return same_value(p, q) || ((x.integer || y.integer) && p == q);
    };
    if (!std::equal(x.values.begin(), x.values.end(), y.values.begin(), y.values.end(), same))
      return "values of '" + x.name + "'";
  }
  return "";
}

/// The first thing in which two meshes differ, in a word; empty where they are the same.
inline std::string difference(const io::MeshData& a, const io::MeshData& b) {
  if (!same_points(a.points, b.points)) return "points";
  if (a.cells != b.cells) return "cells";
  if (a.regions != b.regions) return "regions";
  if (a.triangles != b.triangles) return "triangles";
  if (a.triangle_labels != b.triangle_labels) return "triangle labels";
  if (a.edges != b.edges) return "edges";
  if (a.edge_labels != b.edge_labels) return "edge labels";
  if (a.vertex_labels != b.vertex_labels) return "vertex labels";
  if (a.fixed_vertices != b.fixed_vertices) return "fixed vertices";
  if (a.names != b.names) return "names";
  if (const auto text = difference(a.point_fields, b.point_fields); !text.empty())
    return "point fields: " + text;
  if (const auto text = difference(a.cell_fields, b.cell_fields); !text.empty())
    return "cell fields: " + text;
  return "";
}

}  // namespace hfr::fuzz

#endif
