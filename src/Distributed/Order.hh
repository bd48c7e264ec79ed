// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_ORDER_HH
#define HFR_DISTRIBUTED_ORDER_HH

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "hfremesh/Distributed/Comm.hh"

/// An order over all ranks, from which numbers come that do not depend on who has what.
namespace hfr::mpi {

/// Unsigned numbers in the order of the values, which are no NaN; -0 is as 0.
inline std::uint64_t ordered_bits(double value) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}
/// The value of which these are.
inline double value_of_ordered(std::uint64_t bits) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return std::bit_cast<double>((bits & kSign) != 0 ? bits & ~kSign : ~bits);
}

/// Compared from the first to the last.
using OrderKey = std::array<std::uint64_t, 4>;
/// For each key of this rank, how many different ones among those of all ranks are smaller: equal keys have
/// one place, wherever they are. O(n log n), and each key goes to another rank and its place back. All take
/// part.
std::vector<std::uint64_t> places_in_order(Comm& comm, std::span<const OrderKey> keys);

}  // namespace hfr::mpi

#endif
