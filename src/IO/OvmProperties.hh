// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_OVM_PROPERTIES_HH
#define HFR_IO_OVM_PROPERTIES_HH

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace hfr::io {

/// Names of the properties by which an .ovm file holds what OpenVolumeMesh itself has no place for.
inline constexpr std::string_view kOvmRegion = "hfremesh:region";    ///< of cells, int
inline constexpr std::string_view kOvmLabel = "hfremesh:label";      ///< of vertices, edges and faces, int
inline constexpr std::string_view kOvmElement = "hfremesh:element";  ///< of edges and faces, bool
inline constexpr std::string_view kOvmFixed = "hfremesh:fixed";      ///< of vertices, bool

/// Half-face k of a polyhedron is opposite this vertex of the cell: the order in which OpenVolumeMesh makes
/// the half-faces of a tetrahedron, (0 1 2), (0 2 3), (0 3 1), (1 3 2), all seen from inside.
inline constexpr std::array<std::size_t, 4> kOvmFaceOrder = {3, 1, 2, 0};

enum class OvmEntity { kVertex, kEdge, kHalfEdge, kFace, kHalfFace, kCell, kMesh };

/// By the name in lower case: vprop, eprop, heprop, fprop, hfprop, cprop, mprop.
std::optional<OvmEntity> ovm_entity(std::string_view name);

struct OvmType {
  std::string_view name;
  int components;
  bool integer;
};

/// Types made of numbers; nothing for the others.
std::optional<OvmType> ovm_type(std::string_view name);
std::optional<OvmType> ovm_type(int components, bool integer);

}  // namespace hfr::io

#endif
