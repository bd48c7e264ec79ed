// SPDX-License-Identifier: BSD-3-Clause
// G. T. Klincsek, Minimal triangulations of polygonal domains, 1980.
#ifndef HFR_OPERATORS_KLINCSEK_HH
#define HFR_OPERATORS_KLINCSEK_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace hfr {

/// Klincsek's table over the sides (i, j) of the ring polygon.
class RingTriangulation {
 public:
  explicit RingTriangulation(int n) : n_(n) {}

  /// Largest worst value over all triangulations, `floor` where none is better than it. value(i, k, j, floor)
  /// is the worst of the two cells of triangle (i, k, j), or anything ≤ floor once it is no better.
  template <class Value>
  double solve(double floor, Value&& value) {
    for (int i = 0; i + 1 < n_; ++i) best(i, i + 1) = std::numeric_limits<double>::infinity();
    for (int span = 2; span < n_; ++span) {
      for (int i = 0; i + span < n_; ++i) {
        const int j = i + span;
        double top = floor;
        for (int k = i + 1; k < j; ++k) {
          const double sides = std::min(best(i, k), best(k, j));
          if (!(sides > top)) continue;
          const double worst = std::min(sides, value(i, k, j, top));
          if (worst > top) {
            top = worst;
            apex_[static_cast<std::size_t>(i * 32 + j)] = static_cast<std::uint8_t>(k);
          }
        }
        best(i, j) = top > floor ? top : -std::numeric_limits<double>::infinity();
      }
    }
    return std::max(floor, best(0, n_ - 1));
  }

  /// Writes the apexes in preorder.
  void preorder(std::uint8_t* out) const { preorder(0, n_ - 1, out); }

 private:
  double& best(int i, int j) { return best_[static_cast<std::size_t>(i * 32 + j)]; }
  std::uint8_t* preorder(int i, int j, std::uint8_t* out) const {
    if (j - i < 2) return out;
    const std::uint8_t k = apex_[static_cast<std::size_t>(i * 32 + j)];
    *out++ = k;
    return preorder(k, j, preorder(i, k, out));
  }

  int n_;
  std::array<double, 32 * 32> best_;
  std::array<std::uint8_t, 32 * 32> apex_;
};

/// visit(i, k, j) for each triangle of a triangulation stored in preorder.
template <class Visit>
const std::uint8_t* for_triangles(int i, int j, const std::uint8_t* apex, Visit&& visit) {
  if (j - i < 2) return apex;
  const int k = *apex++;
  visit(i, k, j);
  apex = for_triangles(i, k, apex, visit);
  return for_triangles(k, j, apex, visit);
}

}  // namespace hfr

#endif
