// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Metrics.hh"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace hfr {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct NamedMetric {
  Metric metric;
  std::string_view name;
};

constexpr std::array<NamedMetric, 9> kNames = {{{Metric::kVolumeLength, "volume-length"},
                                                {Metric::kMinDihedral, "min-dihedral"},
                                                {Metric::kMaxDihedral, "max-dihedral"},
                                                {Metric::kMinSine, "min-sine"},
                                                {Metric::kMeanRatio, "mean-ratio"},
                                                {Metric::kRadiusRatio, "radius-ratio"},
                                                {Metric::kScaledJacobian, "scaled-jacobian"},
                                                {Metric::kEdgeRatio, "edge-ratio"},
                                                {Metric::kVolume, "volume"}}};

double signed_root(double x) { return std::copysign(std::sqrt(std::abs(x)), x); }
double signed_square(double x) { return x * std::abs(x); }

// Angle of a sine whose square is given, in degrees; rounding may have carried the square above 1.
double arcsine_of_root(double sine2) { return kDegrees * std::asin(std::sqrt(std::fmin(sine2, 1.0))); }

double max_dihedral_report(double decision) {
  const double d = std::abs(decision);
  const double angle = d <= 1.0 ? 180.0 - arcsine_of_root(d) : arcsine_of_root(2.0 - d);
  return decision < 0.0 ? -angle : angle;
}

double max_dihedral_decision(double degrees) {
  const double sine = std::sin(std::abs(degrees) / kDegrees);
  const double d = std::abs(degrees) >= 90.0 ? sine * sine : 2.0 - sine * sine;
  return degrees < 0.0 ? -d : d;
}

}  // namespace

std::string_view metric_name(Metric metric) {
  for (const NamedMetric& named : kNames)
    if (named.metric == metric) return named.name;
  throw InvalidInput("no such metric");
}

Metric metric_from_name(std::string_view name) {
  for (const NamedMetric& named : kNames)
    if (named.name == name) return named.metric;
  std::string message = "no metric is called '" + std::string(name) + "'; there are";
  for (const NamedMetric& named : kNames) message.append(" ").append(named.name);
  throw InvalidInput(message);
}

double report_value(Metric metric, double decision) {
  switch (metric) {
    case Metric::kMinDihedral:
      return std::copysign(arcsine_of_root(std::abs(decision)), decision);
    case Metric::kMaxDihedral:
      return max_dihedral_report(decision);
    case Metric::kMeanRatio:
      return std::cbrt(decision);
    case Metric::kRadiusRatio:
      return decision;
    case Metric::kVolume:
      return decision / 6.0;
    case Metric::kVolumeLength:
    case Metric::kMinSine:
    case Metric::kScaledJacobian:
    case Metric::kEdgeRatio:
      return signed_root(decision);
  }
  throw InvalidInput("no such metric");
}

double decision_value(Metric metric, double report) {
  switch (metric) {
    case Metric::kMinDihedral:
      return signed_square(std::sin(report / kDegrees));
    case Metric::kMaxDihedral:
      return max_dihedral_decision(report);
    case Metric::kMeanRatio:
      return report * report * report;
    case Metric::kRadiusRatio:
      return report;
    case Metric::kVolume:
      return 6.0 * report;
    case Metric::kVolumeLength:
    case Metric::kMinSine:
    case Metric::kScaledJacobian:
    case Metric::kEdgeRatio:
      return signed_square(report);
  }
  throw InvalidInput("no such metric");
}

double dihedral_decision(double degrees) {
  const double sine = std::sin(degrees * (std::numbers::pi / 180.0));
  return sine * sine;
}

double quality(Metric metric, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  return with_metric(metric, [&](const auto& decision) { return decision(a, b, c, d); });
}

double reported_quality(Metric metric, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  return report_value(metric, quality(metric, a, b, c, d));
}

std::array<double, 6> dihedrals(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const hfr_tet_frame frame = hfr_make_frame(to_real3(a), to_real3(b), to_real3(c), to_real3(d));
  std::array<double, 6> degrees{};
  for (int edge = 0; edge < 6; ++edge) {
    const hfr_cos_sin angle = hfr_dihedral_cos_sin(frame, edge);
    degrees[static_cast<std::size_t>(edge)] = kDegrees * std::atan2(angle.sine, angle.cosine);
  }
  return degrees;
}

CustomMetric::CustomMetric(Function function) : function_(std::move(function)) {
  HFR_REQUIRE(function_ != nullptr, "a custom metric needs a function");
}

double CustomMetric::operator()(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const {
  const double value = function_(a, b, c, d);
  if (std::isnan(value)) return 0.0;
  return value > 0.0 && orientation(a, b, c, d) <= 0 ? 0.0 : value;
}

}  // namespace hfr
