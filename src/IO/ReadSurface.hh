// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_READ_SURFACE_HH
#define HFR_IO_READ_SURFACE_HH

#include <cstddef>
#include <span>

#include "IO/InputFile.hh"
#include "IO/MeshData.hh"

/// What the readers of surface formats share.
namespace hfr::io {

/// Adds a polygon as a fan of triangles, and counts it in `n_split` if it is none itself.
void add_polygon(MeshData& mesh, std::span<const Index> corners, int label, std::size_t& n_split);
/// The note that such polygons were cut.
void note_polygons(MeshData& mesh, std::size_t n_split);

/// ASCII and binary, both byte orders.
MeshData read_ply(const InputFile& file);

}  // namespace hfr::io

#endif
