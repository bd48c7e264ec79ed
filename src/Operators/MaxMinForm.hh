// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_MAX_MIN_FORM_HH
#define HFR_OPERATORS_MAX_MIN_FORM_HH

#include <array>
#include <type_traits>

#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"
#include "Quality/Metrics.hh"

namespace hfr {

/// The dihedral angles of all cells that triangles make with one free point, as functions of where the point
/// stands. Lengths are in units of the mean edge of the triangles, relative to an origin near the point, so
/// that neither scale nor place of the mesh matters.
class MaxMinForm {
 public:
  /// Which angles count: all (sin² of the worst, as MinSine2), or acute ones only (as MinDihedral).
  enum class Angles { kAll, kAcute };
  /// What a metric wants; for one that measures no angles all of them are a fair substitute.
  template <class Metric>
  static constexpr Angles kAnglesOf = std::is_same_v<Metric, MinDihedral> ? Angles::kAcute : Angles::kAll;

  explicit MaxMinForm(Vec3 origin, Angles angles = Angles::kAll) : origin_(origin), angles_(angles) {}

  /// Where the point may go: anywhere, in the plane through its place normal to `axis`, or along `axis`,
  /// which has length 1.
  enum class Room { kSpace, kPlane, kLine };
  void confine(Room room, Vec3 axis) {
    room_ = room;
    axis_ = axis;
  }

  /// Adds the cell (a, b, c, point); positive in this order.
  void add(Vec3 a, Vec3 b, Vec3 c);
  bool full() const { return cells_.full(); }

  /// Place at which the smallest sin² is as large as a non-smooth steepest ascent from `start` takes it;
  /// `start` itself when some cell is not positive there, or nothing is gained.
  Vec3 ascend(Vec3 start, int iterations);

 private:
  struct Link {  // of one cell, before it is known how the form is scaled
    std::array<Vec3, 3> p;
    std::array<Vec3, 3> e;     // e[i] = p[i+1] - p[i]
    std::array<double, 3> e2;  // squared lengths
    Vec3 normal;               // of the triangle, towards the point; gradient of 6V
    double q = 0;              // normal²
  };
  struct Slope {
    double value = 0;
    Vec3 gradient;
  };
  using Slopes = FixedVector<Slope, 384>;

  void scale();
  double worst(Vec3 x, double floor) const;
  void slopes(Vec3 x, double below, Slopes& out) const;

  Vec3 origin_;
  Angles angles_;
  Room room_ = Room::kSpace;
  Vec3 axis_;
  double unit_ = 0;
  FixedVector<Link, Star::kCapacity> cells_;
};

}  // namespace hfr

#endif
