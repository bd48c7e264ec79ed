// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_INPUT_SURFACE_HH
#define HFR_SURFACE_INPUT_SURFACE_HH

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "HalfFace/Vec3.hh"

namespace hfr {

/// Triangles, or line segments, that can be asked for their point nearest to another. Copies what it is
/// given. Const members may be called from several threads.
class InputSurface {
 public:
  struct Hit {
    Vec3 point;
    double distance = 0;
    std::size_t item = 0;  ///< number of the triangle or segment; of several as near, the one found first
  };

  /// With `exact`, distances are right to rounding for needles, too: to measure by, at some cost.
  explicit InputSurface(std::span<const std::array<Vec3, 3>> triangles, bool exact = false);
  explicit InputSurface(std::span<const std::array<Vec3, 2>> segments);
  ~InputSurface();
  InputSurface(InputSurface&&) noexcept;
  InputSurface& operator=(InputSurface&&) noexcept;

  std::size_t size() const;
  /// Where the item nearest to x comes nearest. Precondition: size() > 0.
  Hit nearest(Vec3 x) const;
  /// Where the nearest item no further than `limit` comes nearest; distance is infinite where there is none.
  /// The quicker the smaller the limit. With `side`: only triangles whose normal does not point away from it
  /// count.
  Hit nearest_within(Vec3 x, double limit) const;
  Hit nearest_within(Vec3 x, double limit, Vec3 side) const;
  /// nearest_within() and nearest() with guesses, items that may be the answer: quick where one of them is,
  /// or is little further. Of items as near as a guess, the guess counts.
  Hit nearest_within(Vec3 x, double limit, Vec3 side, std::span<const std::uint32_t> guesses) const;
  Hit nearest(Vec3 x, std::size_t guess) const;
  /// Is this item no further from x than `limit`? Most often quicker than its distance.
  bool is_within(Vec3 x, double limit, std::size_t item) const;
  /// An item that is no further from x than `limit`, the first that is found; none where there is none.
  std::optional<std::size_t> any_within(Vec3 x, double limit) const;
  double distance(Vec3 x, std::size_t item) const;  ///< of x from one triangle or segment
  Vec3 normal(std::size_t item) const;              ///< of a triangle, length 1; zero when it has no area

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Point of a triangle or segment nearest to x. Where all corners agree in a coordinate, so does the result,
/// to the last bit.
Vec3 nearest_point(const std::array<Vec3, 3>& triangle, Vec3 x);
Vec3 nearest_point(const std::array<Vec3, 2>& segment, Vec3 x);
/// Point of a triangle of any height nearest to x, to rounding. nearest_point() is wrong by as much as the
/// height of triangles whose height is lost beside their longest edge.
Vec3 exact_nearest_point(const std::array<Vec3, 3>& triangle, Vec3 x);

}  // namespace hfr

#endif
