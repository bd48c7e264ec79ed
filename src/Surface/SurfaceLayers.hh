// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface: which way the surface looks where several layers of it lie on one another.
#ifndef HFR_SURFACE_SURFACE_LAYERS_HH
#define HFR_SURFACE_SURFACE_LAYERS_HH

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "Surface/Features.hh"

namespace hfr::surface {

/// Area vectors of the surface near a place, whatever way leads there on the surface: the three layers of a
/// fold add up to one that looks outwards, however wide the fold is, where rings of faces see no more than
/// one layer.
class SurfaceLayers {
 public:
  /// Knows what lies within `reach` (a length, positive) of the box of the faces numbered `near`.
  SurfaceLayers(const Arrays& arrays, std::span<const Vec3> points, double reach,
                std::span<const std::uint32_t> near);

  /// Sum of the area vectors within reach, nearer ones with more weight; length 1, or zero without any.
  Vec3 outward(Vec3 x) const;
  /// Does the triangle look against what lies round its middle? Not where layers of opposite sides cancel
  /// out, as at a thin edge.
  bool against(const Triangle& t) const;
  /// Is there more than one layer round the middle of the triangle?
  bool covered(const Triangle& t) const;

 private:
  using Box = std::array<int, 3>;
  struct Sample {
    Box box;
    Vec3 place, area;
  };
  struct View {
    Vec3 sum;
    double total = 0;  // of the areas
  };
  View view(Vec3 x) const;
  Box box_of(Vec3 x) const;
  void add(const Triangle& t);

  double reach_;
  Vec3 low_;
  std::vector<Sample> samples_;  // by box
};

}  // namespace hfr::surface

#endif
