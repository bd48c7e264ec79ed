// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_QUALITY_TETS_HH
#define HFR_UNITTESTS_QUALITY_TETS_HH

#include <array>
#include <cmath>
#include <random>

#include "HalfFace/Vec3.hh"

namespace hfr::test {

using Tet = std::array<Vec3, 4>;

inline Tet regular_tet() {
  return {{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}, {0.5, std::sqrt(0.75) / 3, std::sqrt(2.0 / 3)}}};
}

inline Tet swapped(Tet t) { return {{t[0], t[2], t[1], t[3]}}; }

/// Uniform coordinates in the unit cube, of either orientation.
class RandomTets {
 public:
  explicit RandomTets(unsigned seed) : engine_(seed) {}
  double coordinate() { return std::uniform_real_distribution<double>(0.0, 1.0)(engine_); }
  Vec3 point() {
    const double x = coordinate();
    const double y = coordinate();
    return {x, y, coordinate()};
  }
  Tet next() {
    const Vec3 a = point();
    const Vec3 b = point();
    const Vec3 c = point();
    return {{a, b, c, point()}};
  }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace hfr::test

#endif
