// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_READ_MEDIT_SOLUTION_HH
#define HFR_IO_READ_MEDIT_SOLUTION_HH

#include "IO/InputFile.hh"
#include "IO/MeshData.hh"

namespace hfr::io::medit {

/// Reads the solution file that stands beside a mesh file under the same stem (X.sol or X.solb), if there is
/// one, into the fields of `mesh`. A solution for another number of points or cells is left out, with a note.
void read_solution_beside(const InputFile& mesh_file, MeshData& mesh);

/// Symmetric tensors are kept as xx yy zz xy yz xz; Medit stores the lower triangle by rows: xx xy yy xz yz
/// zz. Entry i of Medit's order is component kTensorOrder[i] of ours.
inline constexpr int kTensorOrder[6] = {0, 3, 1, 5, 4, 2};

}  // namespace hfr::io::medit

#endif
