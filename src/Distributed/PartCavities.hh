// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_CAVITIES_HH
#define HFR_DISTRIBUTED_PART_CAVITIES_HH

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "Distributed/Comm.hh"
#include "Distributed/OldRegion.hh"
#include "Transfer/Conserve.hh"

namespace hfr::mpi {

/// The cavities of a mesh in parts: each rank has its own changed cells in them, old and new, and what it
/// knows of a cavity that goes on elsewhere is joined with what others know. All ranks make one, and use it,
/// at the same time.
class PartCavities : public CavityParts {
 public:
  /// A new cell that is changed, of this rank or another one.
  struct NewNeighbour {
    std::size_t cell = 0;      ///< by its place in the list of this rank: one that covers nothing
    std::uint64_t number = 0;  ///< of a cell on one of its faces
    std::int64_t owner = 0;
  };
  /// `old_cells`: all that the overlaps name, and the changed ones of this rank, in the region; `new_cells`:
  /// the changed ones of this rank, with their numbers, ascending.
  PartCavities(Comm& comm, const OldRegion& region, std::vector<CellHandle> old_cells,
               std::vector<CellHandle> new_cells, std::span<const std::uint64_t> new_numbers,
               Overlaps overlaps, std::vector<double> new_volume, std::vector<CellHandle> beside,
               std::span<const NewNeighbour> neighbours);

  const Cavities& cavities() const { return *cavities_; }

  void join(std::span<CavityBounds> bounds) override;
  void join(std::span<FixedSum> sums) override;
  double total(std::span<const double> by_cavity) override;

 private:
  template <class T>
  void join_all(std::span<T> mine);

  Comm& comm_;
  std::optional<Cavities> cavities_;
  struct Shared {
    std::uint64_t name = 0;  ///< the same on all ranks
    std::size_t cavity = 0;  ///< by its place in the list
  };
  std::vector<Shared> shared_;            // with other ranks, ascending by name
  std::vector<std::uint8_t> is_counted_;  // by cavity: by this rank, of all that have cells of it
};

}  // namespace hfr::mpi

#endif
