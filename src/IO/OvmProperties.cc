// SPDX-License-Identifier: BSD-3-Clause
#include "IO/OvmProperties.hh"

#include <algorithm>
#include <iterator>
#include <utility>

namespace hfr::io {
namespace {

/// The first row that fits is the one to write. char and uchar are missing: they stand in the file as
/// characters.
constexpr OvmType kOvmTypes[] = {
    {"double", 1, false}, {"int", 1, true},    {"vec2d", 2, false}, {"vec2i", 2, true},  {"vec3d", 3, false},
    {"vec3i", 3, true},   {"vec4d", 4, false}, {"vec4i", 4, true},  {"float", 1, false}, {"bool", 1, true},
    {"short", 1, true},   {"long", 1, true},   {"uint", 1, true},   {"ulong", 1, true},  {"vec2f", 2, false},
    {"vec3f", 3, false},  {"vec4f", 4, false}, {"vec2ui", 2, true}, {"vec3ui", 3, true}, {"vec4ui", 4, true},
};

template <class Condition>
std::optional<OvmType> first_type(Condition condition) {
  const auto* const found = std::find_if(std::begin(kOvmTypes), std::end(kOvmTypes), condition);
  if (found == std::end(kOvmTypes)) return std::nullopt;
  return *found;
}

}  // namespace

std::optional<OvmEntity> ovm_entity(std::string_view name) {
  constexpr std::pair<std::string_view, OvmEntity> kEntities[] = {
      {"vprop", OvmEntity::kVertex}, {"eprop", OvmEntity::kEdge},      {"heprop", OvmEntity::kHalfEdge},
      {"fprop", OvmEntity::kFace},   {"hfprop", OvmEntity::kHalfFace}, {"cprop", OvmEntity::kCell},
      {"mprop", OvmEntity::kMesh}};
  for (const auto& [known, entity] : kEntities) {
    if (known == name) return entity;
  }
  return std::nullopt;
}

std::optional<OvmType> ovm_type(std::string_view name) {
  return first_type([&](const OvmType& type) { return type.name == name; });
}

std::optional<OvmType> ovm_type(int components, bool integer) {
  return first_type(
      [&](const OvmType& type) { return type.components == components && type.integer == integer; });
}

}  // namespace hfr::io
