// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartMessage.hh"

namespace hfr::mpi {

/// Puts the arrays behind one another, the widest types first (handles have 4 bytes or 8), so that each
/// begins where its type may. Returns where they end.
std::size_t PartArrays::place(std::byte* base, const PartHeader& header) {
  static_assert(sizeof(PartHeader) % sizeof(double) == 0);
  std::size_t at = sizeof(PartHeader);
  const auto put = [&]<class T>(std::span<T>& array, std::uint64_t n) {
    array = {base ? reinterpret_cast<T*>(base + at) : nullptr, static_cast<std::size_t>(n)};
    at += array.size_bytes();
  };
  put(point, header.n_vertices);
  put(quality, header.n_cells);
  put(vertex_number, header.n_vertices);
  put(incident, header.n_vertices);
  put(cell_number, header.n_cells);
  put(corners, header.n_cells);
  put(mates, header.n_cells);
  put(free, header.n_free);
  put(owner, header.n_vertices);
  put(star_size, header.n_vertices);
  put(changed, header.n_vertices);
  put(region, header.has_regions ? header.n_cells : 0);
  put(frozen, header.n_vertices);
  put(pending, header.n_cells);
  return at;
}

Block PartArrays::block_for(const PartHeader& header) {
  Block block(PartArrays{}.place(nullptr, header));
  std::memcpy(block.data(), &header, sizeof(header));
  return block;
}

PartHeader PartArrays::header_of(const Block& block) {
  PartHeader header;
  if (block.size() < sizeof(header)) throw InternalError("a part of a mesh came without a header");
  std::memcpy(&header, block.data(), sizeof(header));
  if (block.size() != PartArrays{}.place(nullptr, header))
    throw InternalError("a part of a mesh is not as long as its header says");
  return header;
}

PartArrays PartArrays::in(Block& block) {
  PartArrays arrays;
  arrays.place(block.data(), header_of(block));
  return arrays;
}

}  // namespace hfr::mpi
