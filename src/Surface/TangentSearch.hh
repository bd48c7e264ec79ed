// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface. D'Amato & Venere, JPDC 73 (2013), SMOOTH: candidate positions at a radius, which is
// halved when none is better.
#ifndef HFR_SURFACE_TANGENT_SEARCH_HH
#define HFR_SURFACE_TANGENT_SEARCH_HH

#include <cmath>
#include <cstddef>

#include "HalfFace/Vec3.hh"
#include "Operators/Cavity.hh"

namespace hfr::surface {

/// A direction normal to n, of any length. Exact zeros stay zeros, so that a vertex of a facet along two axes
/// keeps the third coordinate to the last bit.
inline Vec3 normal_to(Vec3 n) {
  const Vec3 a = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  return a.x <= a.y && a.x <= a.z ? Vec3{0, n.z, -n.y} : a.y <= a.z ? Vec3{-n.z, 0, n.x} : Vec3{n.y, -n.x, 0};
}

/// Where a vertex of the surface may step to: both ways along a line, or to the eight corners and middles of
/// sides of a square in a plane.
class TangentSteps {
 public:
  static constexpr std::size_t kMost = 8;
  using Places = FixedVector<Vec3, kMost>;

  static TangentSteps on_line(Vec3 axis) { return {axis, {}, true}; }
  /// `axis` is normal to the plane, `u` in it, both of length 1.
  static TangentSteps in_plane(Vec3 axis, Vec3 u) { return {u, cross(axis, u), false}; }

  /// In the order in which they are tried.
  Places at(double radius, Vec3 centre) const {
    Places places;
    if (on_line_) {
      for (double s : {1.0, -1.0}) places.push_back(centre + (s * radius) * u_);
      return places;
    }
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        if (i != 0 || j != 0) places.push_back(centre + radius * ((i * 1.0) * u_ + (j * 1.0) * v_));
    return places;
  }

 private:
  TangentSteps(Vec3 u, Vec3 v, bool on_line) : u_(u), v_(v), on_line_(on_line) {}

  Vec3 u_, v_;
  bool on_line_;
};

/// Steps of one search, of all radii together. Beyond them it gets better for ever and goes nowhere: an
/// inverted cell is less so the further away its vertex is, and one of a body far thinner than wide gains a
/// little from each lift outwards.
inline constexpr int kMostSteps = 100;

/// Looks for better places at `radius`, again and again as long as there is one, and then at half of it,
/// until it has been halved so many times. look(radius) tries the places, goes to the best one and returns
/// how many times the radius is to be halved before the next look: 0 when it has found a better one, which
/// counts as 1 from kMostSteps on.
template <class Look>
void search_by_halving(double radius, int halvings, Look&& look) {
  int n_steps = 0;
  for (int level = 0; level < halvings;) {
    int n = look(radius);
    if (n == 0 && ++n_steps >= kMostSteps) n = 1;
    for (int i = 0; i < n; ++i) radius *= 0.5;
    level += n;
  }
}

/// Search by halving where each look tries all places that places_at(radius) names, round the one that it
/// begins with. consider(place) goes to a place that is better than where it stood, and says whether it was.
template <class PlacesAt, class Consider>
void search_places_by_halving(double radius, int halvings, PlacesAt&& places_at, Consider&& consider) {
  search_by_halving(radius, halvings, [&](double r) {
    bool better = false;
    for (Vec3 x : places_at(r)) better = consider(x) || better;
    return better ? 0 : 1;
  });
}

}  // namespace hfr::surface

#endif
