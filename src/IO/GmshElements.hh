// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_GMSH_ELEMENTS_HH
#define HFR_IO_GMSH_ELEMENTS_HH

namespace hfr::io::gmsh {

/// What the reader needs to know of one of Gmsh's element types.
struct ElementType {
  const char* name = nullptr;  ///< plural, for messages; null when the type is not known
  int dimension = -1;
  int corners = 0;  ///< the first `corners` nodes make the linear element
  int nodes = 0;    ///< all nodes; 0 when the type is refused before its nodes matter
};

inline constexpr int kLine2 = 1;
inline constexpr int kTriangle3 = 2;
inline constexpr int kTetrahedron4 = 4;
inline constexpr int kPoint = 15;

/// The type with Gmsh's number `type`; `name` is null for a number that Gmsh's manual does not list.
ElementType element_type(int type);

/// Elements that the reader takes: points, lines, triangles and tetrahedra of any order.
constexpr bool is_simplex(const ElementType& type) { return type.corners == type.dimension + 1; }

}  // namespace hfr::io::gmsh

#endif
