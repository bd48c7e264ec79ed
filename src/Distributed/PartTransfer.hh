// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_TRANSFER_HH
#define HFR_DISTRIBUTED_PART_TRANSFER_HH

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Transfer/Fields.hh"

namespace hfr::mpi {

/// A field of a mesh in parts: of each vertex of a rank, or of each of its cells, in the order of numbers,
/// all components of one after the other.
struct PartField {
  FieldTransfer how;
  std::size_t n_components = 1;
  std::vector<double> values;
};

/// hfr::transfer_fields() in parts: makes the values that each rank has of `old`, a copy of the mesh before a
/// repair, those of `now`, to the last bit as in shared memory. `renumbered`: where the repair gave cells
/// other numbers first, of each that this rank held the one before and the one then; ascending. Vertices
/// belong to whom they belonged. The fields have passed validate_fields(); none has a callback. All take
/// part. Returns reports, the same on all ranks; none where nothing has changed.
///
/// Each rank looks for its own new vertices and cells, in what it had of the old mesh and in what it asks
/// others for: stars that a search comes to, and changed cells whose boxes meet those of its own ones.
std::vector<FieldReport> transfer_in_parts(
    const DistributedMesh& old, DistributedMesh& now,
    std::span<const std::pair<std::uint64_t, std::uint64_t>> renumbered, std::span<PartField> fields,
    par::Policy policy);

/// Own vertices and own cells as they are, in the order of numbers: which of the own ones in `old` each was,
/// counted in their order.
struct OldPlaces {
  static constexpr std::size_t kCreated = static_cast<std::size_t>(-1);
  std::vector<std::size_t> vertices, cells;
};
/// `old` and `renumbered` as transfer_in_parts() has them. Each rank by itself.
OldPlaces old_places(const DistributedMesh& old, const DistributedMesh& now,
                     std::span<const std::pair<std::uint64_t, std::uint64_t>> renumbered);

/// Rows of `width` values, by number, from the ranks that have them to those that want them. Each number is
/// had by one rank, and wanted by one; both lists ascend. `n`: there are so many numbers, from 0. All take
/// part. There are those of double and std::uint64_t.
template <class T>
std::vector<T> rows_where_wanted(Comm& comm, std::uint64_t n, std::span<const std::uint64_t> had,
                                 std::span<const T> rows, std::size_t width,
                                 std::span<const std::uint64_t> wanted);

}  // namespace hfr::mpi

#endif
