// SPDX-License-Identifier: BSD-3-Clause
#include "Angles.hh"

#include <algorithm>
#include <array>

#include "hfremesh/Quality/CellQuality.hh"

namespace hfr::view {

std::vector<float> smallest_dihedrals(const TetMesh& mesh, par::Policy policy) {
  std::vector<float> degrees(mesh.n_cells());
  par::for_each(policy, degrees.size(), [&](std::size_t i) {
    degrees[i] = static_cast<float>(quality(mesh, CellHandle(i), Metric::kMinDihedral));
  });
  return degrees;
}

Colour poor_colour(double degrees) {
  static constexpr std::array<Colour, 5> kStops = {hex(0x7a0022), hex(0xc81e1e), hex(0xf4701f), hex(0xfdb338),
                                                   hex(0xffe794)};
  const double place = std::clamp(degrees / kPoorBelow, 0.0, 1.0) * (kStops.size() - 1);
  const auto stop = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  return mix(kStops[stop], kStops[stop + 1], static_cast<float>(place - static_cast<double>(stop)));
}

std::vector<Colour> colours_that_matter() {
  std::vector<Colour> colours;
  for (const float shade : {1.0F, 0.9F, 0.8F, 0.7F}) {
    for (int degrees = 0; degrees <= static_cast<int>(kPoorBelow); ++degrees)
      colours.push_back(mix({}, poor_colour(degrees), shade));
    colours.push_back(mix({}, kInvalidColour, shade));
  }
  return colours;
}

Colour cell_colour(double degrees, Colour others) {
  if (!(degrees > 0)) return kInvalidColour;
  return degrees < kPoorBelow ? poor_colour(degrees) : others;
}

}  // namespace hfr::view
