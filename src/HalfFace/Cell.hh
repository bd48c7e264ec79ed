// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_CELL_HH
#define HFR_HALFFACE_CELL_HH

#include <array>
#include <cstdint>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/RawArray.hh"

/// The record of a cell, and scratch memory for the neighbourhoods of a mesh.
namespace hfr {

/// One tetrahedron: 32 bytes with 32-bit indices. mate[k] is the half-face that lies on half-face k from the
/// other side, invalid on the boundary. A deleted cell has invalid vertices.
struct Cell {
  std::array<VertexHandle, 4> v;
  std::array<HalfFaceHandle, 4> mate;

  /// Corner of vertex w; 4 when w is none of this cell's.
  int corner(VertexHandle w) const {
    for (int i = 0; i < 4; ++i)
      if (v[static_cast<std::size_t>(i)] == w) return i;
    return 4;
  }
  /// The same for a vertex that is this cell's, without branches: in a walk over an irregular mesh, nobody
  /// can foretell the corner.
  std::uint8_t own_corner(VertexHandle w) const {
    return static_cast<std::uint8_t>(static_cast<unsigned>(v[1] == w) + 2 * static_cast<unsigned>(v[2] == w) +
                                     3 * static_cast<unsigned>(v[3] == w));
  }
  bool has(VertexHandle w) const { return v[0] == w || v[1] == w || v[2] == w || v[3] == w; }
};

/// Cells round one vertex, gathered once. Fixed memory, reusable; see TetMesh::gather_star.
struct Star {
  static constexpr int kCapacity = 256;
  int size = 0;
  RawArray<CellHandle, kCapacity + 1> cells;  ///< in order of discovery from the incident cell
  RawArray<std::uint8_t, kCapacity> corners;  ///< corner of the vertex in each cell
  RawArray<CellHandle, 2 * kCapacity> slot;   ///< hash table of them while they are gathered
};

/// A cell on a walk round an edge a→b: with p and q the corners that are not on the edge, in the order that
/// makes (a, b, p, q) positive. The next cell counter-clockwise lies behind the face opposite p, the one
/// before behind that opposite q.
struct RingPlace {
  CellHandle cell;
  std::uint8_t p = 0, q = 0;
};

/// Cells round one edge, gathered once. Fixed memory, reusable; see TetMesh::gather_ring.
struct Ring {
  static constexpr int kCapacity = 63;
  int size = 0;
  bool closed = false;  ///< the cells go all the way round
  RawArray<RingPlace, kCapacity> places;
};

}  // namespace hfr

#endif
