// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_MESH_DATA_HH
#define HFR_IO_MESH_DATA_HH

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/Vec3.hh"

namespace hfr::io {

/// A user's field on points or cells.
struct Field {
  std::string name;
  int components = 1;          ///< 1 scalar, 3 vector, 6 symmetric tensor (xx yy zz xy yz xz), 9 tensor
  bool integer = false;        ///< the file stored integers: write them as such where the format can
  std::vector<double> values;  ///< components per item, item by item
  bool wide = false;           ///< integers take 64 bits even where these would do with 32
};

/// What a mesh file holds, as plain arrays, before any connectivity is built. All indices are 0-based.
/// Cells keep the vertex order of the file; whether it is right is decided by build(), not by a reader.
struct MeshData {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> cells;      ///< linear tetrahedra
  std::vector<int> regions;                     ///< per cell, or empty when the file has none
  std::vector<std::array<Index, 3>> triangles;  ///< surface elements in the file, any of boundary or inside
  std::vector<int> triangle_labels;             ///< per triangle
  std::vector<std::array<Index, 2>> edges;      ///< line elements in the file
  std::vector<int> edge_labels;                 ///< per edge
  std::vector<int> vertex_labels;               ///< per point (0 = none), or empty
  std::vector<Index> fixed_vertices;            ///< Medit's RequiredVertices: never moved nor removed
  /// (dimension, label) → name: Gmsh's physical names, also region and patch names of other formats.
  std::map<std::pair<int, int>, std::string> names;
  std::vector<Field> point_fields;
  std::vector<Field> cell_fields;
  /// Of a piece of a mesh (.vtu): the numbers of its triangles and edges in the whole, which are those of the
  /// cell field "number" behind the tetrahedra's; or empty.
  std::vector<double> triangle_numbers, edge_numbers;
  /// One line each, for the user: what was linearised, skipped or dropped while reading.
  std::vector<std::string> notes;
};

}  // namespace hfr::io

#endif
