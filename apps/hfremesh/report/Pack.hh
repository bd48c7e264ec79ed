// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_PACK_HH
#define HFR_APPS_REPORT_PACK_HH

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"

/// A mesh in few bytes, for the viewer in a page (view.js unpacks it): about 4 bytes a cell.
namespace hfr::view {

/// What packing leaves out.
struct PackOptions {
  /// Of a mesh with more cells only poor ones and the surface are packed, so that the page stays one that
  /// browsers open.
  std::size_t most_cells = 2'500'000;
};

/// Reason of a cell that has none.
inline constexpr std::uint8_t kNoReason = 255;

/// Vertices are numbered along a Morton curve and have 16 bits a coordinate; a cell is four ascending numbers
/// of vertices. What belongs to a vertex stands in ascending order: its neighbours of larger numbers, as
/// differences; the cells that it is the smallest vertex of, as places in that list; the boundary faces
/// likewise. Each of these is a stream of bytes; one deflate goes over all of them, in the order of `sizes`.
struct PackedMesh {
  /// Names of the streams. "low", "high": the two bytes of differences of coordinates, x of all vertices,
  /// then y, then z, zigzag. Those that end in "_n" are counts a vertex. Numbers are LEB128. "angle": 0 for
  /// an invalid cell, 1 + 8 * degrees for one below 30, 255 for the others; a byte a cell. "id": the index in
  /// the mesh, of those with angle below 255, as zigzag differences; "reason" beside each.
  static constexpr std::array<const char*, 13> kStreams = {"low",    "high",   "link_n", "link",  "cell_n",
                                                           "cell_a", "cell_b", "cell_c", "angle", "id",
                                                           "reason", "skin_n", "skin"};
  std::array<std::size_t, kStreams.size()> sizes{};  ///< bytes of each before deflate
  std::size_t n_vertices = 0, n_cells = 0, n_skin = 0, n_listed = 0;
  bool has_all_cells = true;
  Vec3 box_low, box_high;  ///< of the coordinates 0 and 65535
  std::string deflated;    ///< in zlib's format
};

/// `degrees`: smallest_dihedrals(mesh). `reasons`: of each cell, or empty. Precondition: nothing is deleted.
/// The same bytes for the same mesh and zlib.
PackedMesh pack(const TetMesh& mesh, const std::vector<float>& degrees,
                const std::vector<std::uint8_t>& reasons, const PackOptions& options = {});

std::string base64(std::string_view bytes);

}  // namespace hfr::view

#endif
