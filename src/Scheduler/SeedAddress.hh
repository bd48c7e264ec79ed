// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_SEED_ADDRESS_HH
#define HFR_SCHEDULER_SEED_ADDRESS_HH

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr {

/// Where a seed is: a vertex, or a place within a cell. Seeds are made of handles, which mean something in
/// one mesh only; two parts of a mesh that hold the same cell can tell each other where a seed is by the
/// number of the cell or vertex.
struct SeedAddress {
  CellHandle cell;      ///< invalid for a vertex
  VertexHandle vertex;  ///< invalid for the others
  std::uint32_t place = 0;
  std::uint32_t kind = 0;  ///< of seeds of several kinds
};

inline SeedAddress address_of(VertexHandle v) { return {{}, v}; }
inline SeedAddress address_of(EdgeHandle e) {
  return {CellHandle(e.idx() / 6), {}, static_cast<std::uint32_t>(e.idx() % 6)};
}
inline SeedAddress address_of(HalfFaceHandle h) {
  return {cell_of(h), {}, static_cast<std::uint32_t>(corner_of(h))};
}
/// Seeds that grow from a half-face, as those of MultiFaceRemoval: evaluated again, they grow as before.
template <class Seed>
requires requires(const Seed& seed) { seed.halfface; }
SeedAddress address_of(const Seed& seed) { return address_of(seed.halfface); }

/// Seeds at a local edge of a cell, as those of FanMerge.
template <class Seed>
concept IsCellAndEdge = requires(const Seed& seed) {
  { seed.cell } -> std::convertible_to<CellHandle>;
  { seed.edge } -> std::convertible_to<std::uint8_t>;
};
template <IsCellAndEdge Seed>
SeedAddress address_of(const Seed& seed) {
  return {seed.cell, {}, seed.edge};
}

/// Seeds that grow from a cell, as those of VertexInsertion: likewise.
template <class Seed>
concept GrowsFromCell = std::constructible_from<Seed, CellHandle> && requires(const Seed& seed) {
  { seed.cell } -> std::convertible_to<CellHandle>;
  seed.growth;
};
template <GrowsFromCell Seed>
SeedAddress address_of(const Seed& seed) {
  return {seed.cell, {}};
}

/// Seeds that grow from an edge, as those of SurfaceSplit: likewise.
template <class Seed>
concept GrowsFromEdge = std::constructible_from<Seed, EdgeHandle> && requires(const Seed& seed) {
  { seed.edge } -> std::convertible_to<EdgeHandle>;
  seed.growth;
};
template <GrowsFromEdge Seed>
SeedAddress address_of(const Seed& seed) {
  return address_of(seed.edge);
}

/// Seeds at a vertex, as those of SurfaceCollapse. What else such a seed says does not go with the address,
/// so they can be told of, but not evaluated again: for rounds that commit their own winners alone.
template <class Seed>
concept IsAtVertex = requires(const Seed& seed) {
  { seed.vertex } -> std::convertible_to<VertexHandle>;
};
template <IsAtVertex Seed>
SeedAddress address_of(const Seed& seed) {
  return address_of(seed.vertex);
}

template <class Seed>
concept HasAddress = requires(const Seed& seed) {
  { address_of(seed) } -> std::same_as<SeedAddress>;
};

/// Seeds of one of several kinds, as those of AnyOf.
template <class... Seeds>
requires(HasAddress<Seeds>&&...) SeedAddress address_of(const std::variant<Seeds...>& seed) {
  SeedAddress at = std::visit([](const auto& one) { return address_of(one); }, seed);
  at.kind = static_cast<std::uint32_t>(seed.index());
  return at;
}
template <class Seed>
concept IsOfAnyKind = requires {
  std::variant_size<Seed>::value;
};

template <class Seed>
Seed seed_at(const SeedAddress& at);

namespace detail {

template <class Seed, std::size_t kKind = 0>
Seed seed_of_kind(const SeedAddress& at) {
  if constexpr (kKind + 1 < std::variant_size_v<Seed>)
    if (at.kind != kKind) return seed_of_kind<Seed, kKind + 1>(at);
  return Seed(std::in_place_index<kKind>, seed_at<std::variant_alternative_t<kKind, Seed>>(at));
}

}  // namespace detail

/// The seed at an address.
template <class Seed>
Seed seed_at(const SeedAddress& at) {
  if constexpr (IsOfAnyKind<Seed>)
    return detail::seed_of_kind<Seed>(at);
  else if constexpr (std::is_same_v<Seed, VertexHandle>)
    return at.vertex;
  else if constexpr (std::is_same_v<Seed, EdgeHandle>)
    return EdgeHandle(6 * at.cell.idx() + static_cast<Index>(at.place));
  else if constexpr (std::is_same_v<Seed, HalfFaceHandle>)
    return halfface_of(at.cell, static_cast<int>(at.place));
  else if constexpr (IsCellAndEdge<Seed>)
    return Seed{at.cell, static_cast<std::uint8_t>(at.place)};
  else if constexpr (GrowsFromCell<Seed>)
    return Seed(at.cell);
  else if constexpr (GrowsFromEdge<Seed>)
    return Seed(seed_at<EdgeHandle>(at));
  else if constexpr (IsAtVertex<Seed>)
    return Seed{at.vertex};
  else
    return Seed(halfface_of(at.cell, static_cast<int>(at.place)));
}

}  // namespace hfr

#endif
