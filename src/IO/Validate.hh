// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_VALIDATE_HH
#define HFR_IO_VALIDATE_HH

#include <string>

#include "IO/MeshData.hh"

namespace hfr::io {

/// Throws InvalidInput, "NAME: WHERE: WHAT", at the first rule that `mesh` breaks: coordinates are finite;
/// corners of cells, triangles and edges and fixed vertices are points of the mesh; label arrays and fields
/// have as many entries as what they belong to (vertex_labels, regions and triangle and edge labels may be
/// empty). Items are counted from 0. ResourceLimit when there are more points than an Index can count.
void validate(const MeshData& mesh, const std::string& name);

/// A number of a file is a label: an integer of 32 bits, the lowest and the highest included.
bool is_label(double number);

}  // namespace hfr::io

#endif
