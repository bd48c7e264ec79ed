// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PETSC_BISECT_HH
#define HFR_BINDINGS_PETSC_BISECT_HH

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "hfremesh/Distributed/Comm.hh"
#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/Vec3.hh"

namespace hfr::petsc {

/// What a vertex is known by on all ranks: that of the middle of an edge follows from those of its ends.
struct VertexId {
  std::uint64_t a = 0, b = 0;
  auto operator<=>(const VertexId&) const = default;
};

/// Cells and labelled faces and edges of one rank; vertices by their index.
struct Simplices {
  template <std::size_t N>
  struct Labelled {
    std::array<Index, N> v = {};
    std::int32_t value = 0;
  };
  struct Cell : Labelled<4> {
    double largest = 0;  ///< volume that it may have; 0 for any
  };
  std::vector<Vec3> points;
  std::vector<VertexId> ids;            ///< by vertex
  std::vector<std::uint8_t> is_shared;  ///< by vertex: other ranks may have it
  std::vector<double> sizes;            ///< by vertex, or none: how long edges are to be
  std::vector<Cell> cells;              ///< each on one rank
  std::vector<Labelled<3>> faces;
  std::vector<Labelled<2>> edges;
};

double volume_of(const Simplices& mine, const Simplices::Cell& c);

/// Halves cells by their longest edge until none is larger than it may be, nor has an edge longer than √2
/// times the mean of the sizes at its ends, which is that of its middle, too; and whatever else has an edge
/// that is halved, with it (M.-C. Rivara, Mesh refinement processes based on the generalized bisection of
/// simplices, SIAM J. Numer. Anal. 21, 1984). Of edges of one length the one with the larger ids is the
/// longer one. What comes of it does not depend on which rank has which cell. Edges that are halved between
/// ranks go to all. All take part.
void bisect(mpi::Comm& comm, Simplices& mine);

}  // namespace hfr::petsc

#endif
