// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PYTHON_ARRAYS_HH
#define HFR_BINDINGS_PYTHON_ARRAYS_HH

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/Vec3.hh"
#include "hfremesh/IO/MeshData.hh"

/// NumPy arrays into the library's and back. What comes in may have any integer or float type, any strides
/// and either byte order, and is read where it lies; what does not fit raises ValueError that names the first
/// offending index.
namespace hfr::python {

namespace nb = nanobind;

/// (n, 3) finite coordinates.
std::vector<Vec3> points_of(nb::handle object, const std::string& name);
/// (m, N) indices below `n_points`.
template <std::size_t N>
std::vector<std::array<Index, N>> tuples_of(nb::handle object, const std::string& name, std::size_t n_points);
/// (n) integers that an int holds; `what` says what there are n of.
std::vector<int> labels_of(nb::handle object, const std::string& name, std::size_t n,
                           const std::string& what);
/// (k) indices below `n`.
std::vector<Index> indices_of(nb::handle object, const std::string& name, std::size_t n);
/// (n) or (n, k) numbers; integers up to 2^53.
io::Field field_of(nb::handle object, const std::string& name, std::size_t n, const std::string& what);
/// First of the shape, and nothing else looked at; throws ValueError for no array at all.
std::size_t length_of(nb::handle object, const std::string& name);
/// Throws ValueError for the first coordinate that is not finite.
void require_finite(const Vec3* points, std::size_t n, const std::string& name);

/// Of getters that return arrays, which own what they show: left to itself, a getter says that its object
/// does.
inline constexpr auto kOwned = nb::rv_policy::automatic;

template <class T>
using Array = nb::ndarray<nb::numpy, T, nb::c_contig>;

/// A new array of the given shape that owns `values`.
template <class T>
Array<T> to_array(std::vector<T> values, std::initializer_list<std::size_t> shape) {
  auto* kept = new std::vector<T>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return Array<T>(kept->data(), shape, owner);
}
template <class T>
Array<T> to_array(std::vector<T> values) {
  const std::size_t n = values.size();
  return to_array(std::move(values), {n});
}

/// As signed numbers, -1 for an invalid handle.
template <class Handles>
Array<std::int64_t> handle_array(const Handles& handles) {
  std::vector<std::int64_t> ids;
  for (const auto& h : handles) ids.push_back(h.is_valid() ? static_cast<std::int64_t>(h.idx()) : -1);
  return to_array(std::move(ids));
}

template <class T, std::size_t N>
Array<std::int64_t> tuple_array(const std::vector<std::array<T, N>>& tuples) {
  std::vector<std::int64_t> flat;
  flat.reserve(N * tuples.size());
  for (const auto& t : tuples)
    for (const auto& v : t)
      if constexpr (std::is_integral_v<T>)
        flat.push_back(static_cast<std::int64_t>(v));
      else
        flat.push_back(static_cast<std::int64_t>(v.idx()));
  return to_array(std::move(flat), {tuples.size(), N});
}

}  // namespace hfr::python

#endif
