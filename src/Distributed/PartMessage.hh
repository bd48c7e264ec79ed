// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_MESSAGE_HH
#define HFR_DISTRIBUTED_PART_MESSAGE_HH

#include <array>
#include <cstdint>
#include <span>

#include "Distributed/Buffer.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr::mpi {

/// The part of a mesh that one rank holds, as rank 0 hands it out: what PartHeader says, then arrays whose
/// sizes it tells, in the order of PartArrays. 45 bytes a vertex, 45 a cell, 4 more where cells have regions,
/// 4 a free slot of the whole, with handles of 32 bits. Numbers are handles in the mesh of rank 0.
struct PartHeader {
  std::uint64_t n_slots = 0, n_free = 0, n_vertices = 0, n_cells = 0;
  std::uint64_t n_vertices_of_whole = 0;
  double floor = 0;
  std::uint32_t clock = 0;
  std::uint8_t holds_damage = 0, has_regions = 0;
};

/// Cells and vertices ascend by number. Corners and mates name vertices and half-faces of the part; kNothing:
/// what is not in it.
struct PartArrays {
  using Four = std::array<Index, 4>;
  static constexpr Index kNothing = CellHandle::kInvalid;

  std::span<Vec3> point;
  std::span<double> quality;
  std::span<Index> vertex_number, incident;
  std::span<Index> cell_number;
  std::span<Four> corners, mates;
  std::span<Index> free;
  std::span<std::int32_t> owner;
  std::span<std::uint32_t> star_size, changed;
  std::span<std::int32_t> region;
  std::span<std::uint8_t> frozen, pending;

  /// A message for the header, which is written; the arrays are not.
  static Block block_for(const PartHeader& header);
  /// Throws InternalError unless the block is as long as its header says.
  static PartHeader header_of(const Block& block);
  static PartArrays in(Block& block);

 private:
  std::size_t place(std::byte* base, const PartHeader& header);
};

}  // namespace hfr::mpi

#endif
