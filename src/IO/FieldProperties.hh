// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_FIELD_PROPERTIES_HH
#define HFR_IO_FIELD_PROPERTIES_HH

#include <string>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "IO/MeshData.hh"

/// Users' fields as properties of the same name. A scalar becomes a property of double, a vector one of Vec3,
/// 2, 4, 6 and 9 components one of std::array<double, N>, any other number one of std::vector<double>;
/// integer fields use std::int64_t instead (std::array<std::int64_t, 3> for vectors).
namespace hfr::io {

/// A field without a name becomes "unnamed". A name that a property of the same kind already has is skipped,
/// with a line in `notes` where given. Throws InvalidInput when a field has not one value for each item and
/// component.
void attach_fields(TetMesh& mesh, const std::vector<Field>& point_fields,
                   const std::vector<Field>& cell_fields, std::vector<std::string>* notes);

/// The way back, for all properties of the types above, of int, float and bool; others are no fields. Deleted
/// vertices and cells are left out.
std::vector<Field> point_fields(const TetMesh& mesh);
std::vector<Field> cell_fields(const TetMesh& mesh);

}  // namespace hfr::io

#endif
