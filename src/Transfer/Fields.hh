// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_FIELDS_HH
#define HFR_TRANSFER_FIELDS_HH

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Transfer/Edits.hh"

namespace hfr {

enum class Transfer {
  /// A field of vertices: linear within each cell of the mesh as it was. Exact for linear functions, and for
  /// constants to the bit. A vertex beyond the mesh as it was has what the nearest cell says there, and is
  /// counted.
  kLinear,
  /// A field of cells, of any type: a created cell has the value of the old one that it shares most volume
  /// with. For history, data of integration points, numbers of materials.
  kInherit,
  /// A field of cells, of floating-point numbers: what a cell holds is value times volume, and each part of
  /// an old cell hands what it holds to the new cells that cover it. In each cavity the sum stays, and no
  /// value leaves the range of the old ones.
  kConserve,
  /// By FieldTransfer::callback.
  kCallback,
  /// A field of vertices that is smooth: as kLinear, and bent by the gradients that the old values have at
  /// the
  /// corners of the old cell. The errors of kLinear have one sign where vertices move between old ones, and
  /// add up over repairs; these are a fraction of them. Exact for linear functions, and for constants to the
  /// bit; no value leaves the range of the corners'. Beyond the mesh as it was: as kLinear.
  kQuadratic,
};
/// "linear", "quadratic", "inherit", "conserve"; throws InvalidInput that lists them.
Transfer transfer_from_name(std::string_view name);
/// Whether what it carries over is a field of vertices, or of cells. False for kCallback.
bool is_of_vertices(Transfer how);

/// How one field, a property of vertices or cells, gets from the mesh as it was to the mesh as it is.
struct FieldTransfer {
  std::string name;
  Transfer how = Transfer::kLinear;
  /// With kConserve: the field of cells by which the values are weighted, as velocities are by densities, so
  /// that the sum of value times density times volume stays. Has one component and is itself conserved.
  std::string density = {};
  /// With kCallback. The mesh as it is has the field with what operators made of it.
  std::function<void(const TetMesh& old, TetMesh& now, const Edits& edits)> callback = nullptr;
};

/// What became of one field.
struct FieldReport {
  std::string name;
  std::size_t n_changed = 0;  ///< values that were written
  std::size_t n_outside = 0;  ///< things beyond the mesh as it was, in part or as a whole: those with nothing
                              ///< of it have the value of an old vertex or cell near them
  /// With kConserve, by component: what there was in the changed cells, and what of it found no place within
  /// the range of the old values; less than 0 for what cells beyond the old mesh have come to hold. Where the
  /// surface stays, the latter is rounding.
  std::vector<double> integral, lost;
};

/// Whether fields of these names and kinds can be transferred: throws InvalidInput that names the first that
/// is missing, of another type, or of other things.
void validate_fields(const TetMesh& mesh, std::span<const FieldTransfer> fields);

/// Brings fields of `now` up to date, of which operators have made `now` out of `old`. Values of vertices
/// that have not moved, and of cells with the same vertices where they were, keep every bit. The same bits
/// for any number of threads. Throws InvalidInput where a field is inherited and the edits have no parents.
std::vector<FieldReport> transfer_fields(const TetMesh& old, TetMesh& now, const Edits& edits,
                                         std::span<const FieldTransfer> fields, par::Policy policy);

}  // namespace hfr

#endif
