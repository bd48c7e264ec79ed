// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_METRICS_HH
#define HFR_QUALITY_METRICS_HH

#include <array>
#include <concepts>
#include <functional>

#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/HalfFace/Vec3.hh"
#include "hfremesh/Quality/Metric.hh"
#include "hfremesh/kernels/dihedral.h"
#include "hfremesh/kernels/shape.h"
#include "hfremesh/kernels/tet_volume.h"
#include "hfremesh/kernels/volume_length.h"

/// Quality of one tetrahedron (a, b, c, d), positive when det(b-a, c-a, d-a) > 0.
/// Every metric has a decision form (higher is better; > 0 only for a cell whose volume is positive beyond
/// rounding, 0 flat, < 0 inverted; the same bits on every machine) and a report form (what the literature
/// prints). Formulas and sources: docs/quality.md.
namespace hfr {

constexpr hfr_real3 to_real3(Vec3 p) { return {p.x, p.y, p.z}; }

/// Something that gives the decision value of a cell. Operators are templates on it.
template <class M>
concept TetMetric = requires(const M& metric, Vec3 p) {
  { metric(p, p, p, p) } -> std::convertible_to<double>;
};

template <double (*Decision)(hfr_real3, hfr_real3, hfr_real3, hfr_real3)>
struct KernelMetric {
  double operator()(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const {
    return Decision(to_real3(a), to_real3(b), to_real3(c), to_real3(d));
  }
};
struct VolumeLength : KernelMetric<hfr_volume_length_decision> {};
struct MinDihedral : KernelMetric<hfr_min_dihedral_decision> {};
struct MaxDihedral : KernelMetric<hfr_max_dihedral_decision> {};
struct MinSine2 : KernelMetric<hfr_min_sin2_decision> {};
struct MeanRatio : KernelMetric<hfr_volume_length_decision> {};
struct RadiusRatio : KernelMetric<hfr_radius_ratio_decision> {};
struct ScaledJacobian : KernelMetric<hfr_scaled_jacobian_decision> {};
struct EdgeRatio : KernelMetric<hfr_edge_ratio_decision> {};
struct Volume : KernelMetric<hfr_volume_decision> {};

/// Whether the decision value of a metric is a sin² of the cell's dihedral angles, so that raising angles
/// raises it.
template <class Metric>
inline constexpr bool kMeasuresAngles = false;
template <>
inline constexpr bool kMeasuresAngles<MinSine2> = true;
template <>
inline constexpr bool kMeasuresAngles<MinDihedral> = true;

/// Calls f with the functor of the metric: one switch outside a loop, inlined formulas inside it.
template <class F>
decltype(auto) with_metric(Metric metric, F&& f) {
  switch (metric) {
    case Metric::kVolumeLength:
      return f(VolumeLength{});
    case Metric::kMinDihedral:
      return f(MinDihedral{});
    case Metric::kMaxDihedral:
      return f(MaxDihedral{});
    case Metric::kMinSine:
      return f(MinSine2{});
    case Metric::kMeanRatio:
      return f(MeanRatio{});
    case Metric::kRadiusRatio:
      return f(RadiusRatio{});
    case Metric::kScaledJacobian:
      return f(ScaledJacobian{});
    case Metric::kEdgeRatio:
      return f(EdgeRatio{});
    case Metric::kVolume:
      return f(Volume{});
  }
  throw InvalidInput("no such metric");
}

/// Decision value of one cell.
double quality(Metric metric, Vec3 a, Vec3 b, Vec3 c, Vec3 d);
/// Report value of one cell.
double reported_quality(Metric metric, Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// The six dihedrals in degrees, at the local edges of kEdgeCorners. Negative in an inverted cell, 0 or 180
/// in a flat one.
std::array<double, 6> dihedrals(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// +1 positive, -1 inverted, 0 flat: the volume hides in the rounding of its own coordinates.
inline int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  return hfr_orient_sign(to_real3(a), to_real3(b), to_real3(c), to_real3(d));
}

/// A user's own metric. The callable is called from several threads at once and must be pure. A cell whose
/// value is not above 0 counts as inverted or flat, so good cells need one that is.
class CustomMetric {
 public:
  using Function = std::function<double(Vec3, Vec3, Vec3, Vec3)>;
  /// Throws InvalidInput when there is nothing to call.
  explicit CustomMetric(Function function);
  /// The user's value; never above 0 for a cell that is not surely positive; 0 for NaN.
  double operator()(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const;

 private:
  Function function_;
};

}  // namespace hfr

#endif
