// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_PLACED_VALUE_HH
#define HFR_TRANSFER_PLACED_VALUE_HH

#include <algorithm>
#include <array>
#include <cstddef>

#include "Transfer/Edits.hh"
#include "Transfer/Gradients.hh"

namespace hfr {

/// What an old field of vertices has where a vertex lies, within its old cell: linear there and, with
/// gradients, bent by those that the field has at the corners, within the range of these. get(v): the old
/// value of an old vertex, one component.
template <class Get>
double value_at(const TetMesh& old, const PlacedVertex& v, const Gradients* gradients, Get&& get) {
  const auto& corners = old.cell_vertices(v.old_cell);
  std::array<double, 4> at{};
  for (std::size_t j = 0; j < 4; ++j) at[j] = get(corners[j]);
  double value = at[0];  // in differences, so that a constant stays one
  for (std::size_t j = 1; j < 4; ++j) value += v.weights[j] * (at[j] - at[0]);
  if (!gradients || !v.inside) return value;
  // Σ w_i g_i·(x - x_i) / 2 makes it exact for quadratic functions whose gradients these are. 0 where one is
  // not known.
  double sum = 0;
  for (std::size_t j = 0; j < 4; ++j) {
    const std::span<const Gradients::Term> terms = gradients->terms(corners[j]);
    if (terms.empty()) {
      sum = 0;
      break;
    }
    Vec3 gradient;
    for (const Gradients::Term& term : terms)
      gradient = gradient + (get(term.neighbour) - at[j]) * term.weight;
    sum += v.weights[j] * dot(gradient, v.point - old.point(corners[j]));
  }
  value += 0.5 * sum;
  const auto [low, high] = std::minmax_element(at.begin(), at.end());
  return value < *low ? *low : value > *high ? *high : value;
}

}  // namespace hfr

#endif
