// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_HASH_HH
#define HFR_IO_HASH_HH

#include <cstdint>
#include <string>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshData.hh"

namespace hfr::io {

/// 64-bit fingerprint of a mesh: the bits of the coordinates, the cells, regions, triangles, edges, their
/// labels, vertex labels and fixed vertices, all in their order; not names and fields. Equal on every machine
/// and for every width of index. Regions or vertex labels that are all 0 count as absent, so that a mesh and
/// the file it was written to agree. Meant to tell results apart, not to withstand forgery.
std::uint64_t mesh_hash(const MeshData& mesh);
/// That of disassemble(mesh).
std::uint64_t mesh_hash(const TetMesh& mesh);

/// 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace hfr::io

#endif
