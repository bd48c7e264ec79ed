// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PYTHON_FIELDS_HH
#define HFR_BINDINGS_PYTHON_FIELDS_HH

#include <cstddef>
#include <string>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshData.hh"

/// Single fields of a mesh, as properties of the types that files have them in (IO/ReadWrite.hh).
namespace hfr::python {

/// A field without its values.
struct FieldKind {
  std::string name;
  bool of_vertices = true;
  bool integer = false;
  int components = 1;
};

/// Of all fields of the mesh.
std::vector<FieldKind> field_kinds(const TetMesh& mesh);
/// One row a vertex or cell.
std::vector<double> field_values(const TetMesh& mesh, const FieldKind& kind);
/// Makes the field where there is none. Throws InvalidInput where there is one of the name and another kind.
void set_field_values(TetMesh& mesh, const FieldKind& kind, const std::vector<double>& values);

}  // namespace hfr::python

#endif
