// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_ATTACHED_ARRAYS_HH
#define HFR_DISTRIBUTED_ATTACHED_ARRAYS_HH

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "Distributed/Comm.hh"
#include "Distributed/Slices.hh"
#include "IO/MeshData.hh"
#include "IO/MeshShare.hh"

namespace hfr::mpi {

/// All values of a file on its points, or on its cells: a row for each, by number. Each rank keeps those of a
/// range of the numbers, and gives rows of it to whoever needs them: they stay where they are while the mesh
/// changes, and each vertex and cell of a part knows whose row it has (Sources.hh).
class KeptRows {
 public:
  KeptRows() = default;
  /// Whether integers stay such is for the values of all ranks to say. `rows`: of this rank's slice. All take
  /// part.
  KeptRows(Comm& comm, std::vector<io::ShareField> fields, Slices slices, std::vector<double> rows);

  const std::vector<io::ShareField>& fields() const { return fields_; }
  /// The fields of items that have the rows of these numbers. All take part.
  std::vector<io::Field> fields_of(Comm& comm, std::span<const std::uint64_t> sources) const;

 private:
  std::vector<io::ShareField> fields_;
  std::size_t width_ = 0;  // of a row
  Slices slices_;
  std::vector<double> rows_;
};

/// What a file has on points and cells. `places`: where the points were, as a field of three components.
struct AttachedArrays {
  KeptRows points, cells, places;

  /// One line for each, for a format that has no place for them.
  std::vector<std::string> notes_on_leaving_out() const;
};

/// The rows of even ranges of the numbers below n, from those that ranks have in any order. Of several of one
/// number that of the lowest rank of `precedence` counts. All take part.
struct NumberedRows {
  std::vector<std::uint64_t> numbers, precedence;  ///< one each
  std::vector<double> rows;
};
KeptRows rows_in_ranges(Comm& comm, std::vector<io::ShareField> fields, std::uint64_t n,
                        const NumberedRows& mine);

}  // namespace hfr::mpi

#endif
