// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_METRIC_HH
#define HFR_QUALITY_METRIC_HH

#include <array>
#include <string_view>

namespace hfr {

/// What the quality of a cell is measured by; formulas and sources: docs/quality.md. Each has a decision
/// value (higher is better, the same bits on every machine) and a report value (what the literature prints).
enum class Metric {
  kVolumeLength,    ///< q = 6√2·V / l_rms³, in [-1, 1]; decision q|q|
  kMinDihedral,     ///< smallest dihedral in degrees, at most 70.53; decision sin²
  kMaxDihedral,     ///< largest dihedral in degrees, at least 70.53; decision sin² if obtuse, else 2 - sin²
  kMinSine,         ///< smallest sine of a dihedral, at most 0.943; decision sin²
  kMeanRatio,       ///< 12·(3V)^⅔ / Σl², in [-1, 1]; its decision is that of kVolumeLength
  kRadiusRatio,     ///< 3·r_in / r_circum, in [-1, 1]; decision the same
  kScaledJacobian,  ///< smallest √2·det / (l·l·l) at a corner, in [-1, 1]; decision its signed square
  kEdgeRatio,       ///< shortest / longest edge, in [-1, 1]; decision its signed square
  kVolume,          ///< signed volume; decision 6V
};

inline constexpr std::array<Metric, 9> kMetrics = {
    Metric::kVolumeLength,   Metric::kMinDihedral, Metric::kMaxDihedral,
    Metric::kMinSine,        Metric::kMeanRatio,   Metric::kRadiusRatio,
    Metric::kScaledJacobian, Metric::kEdgeRatio,   Metric::kVolume};

/// "volume-length", "min-dihedral", "max-dihedral", "min-sine", "mean-ratio", "radius-ratio",
/// "scaled-jacobian", "edge-ratio", "volume".
std::string_view metric_name(Metric metric);
/// Throws InvalidInput that lists the names.
Metric metric_from_name(std::string_view name);

/// Decision value → report value; monotone (decreasing for kMaxDihedral of positive cells).
double report_value(Metric metric, double decision);
/// Report value (a goal such as 20 degrees) → decision value; the inverse of report_value.
double decision_value(Metric metric, double report);
/// sin² of an angle in degrees: what cells and triangles whose smallest angle that is have as decision value.
/// Every goal in degrees is compared by this one.
double dihedral_decision(double degrees);

}  // namespace hfr

#endif
