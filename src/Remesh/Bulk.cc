// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Bulk.hh"

#include "Remesh/PassRunner.hh"

namespace hfr {
namespace {

/// Calls f with a metric functor that the operators are instantiated for.
template <class F>
void with_stage_metric(Metric metric, F&& f) {
  switch (metric) {
    case Metric::kVolumeLength:
    case Metric::kMeanRatio:  // the same order of cells
      return f(VolumeLength{});
    case Metric::kMinSine:
      return f(MinSine2{});
    case Metric::kMinDihedral:
      return f(MinDihedral{});
    default:
      return f(
          CustomMetric([metric](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return quality(metric, a, b, c, d); }));
  }
}

// Share of a run, for its progress.
constexpr double kBegins = 0.1;
constexpr double kTakes = 0.4;

}  // namespace

void improve_bulk(const Run& run, const BulkEffort& effort) {
  with_stage_metric(effort.metric, [&](auto metric) {
    PassRunner<decltype(metric)> runner(run, metric, "bulk");
    for (int i = 1; i <= effort.iterations && !run.control.stopped(); ++i) {
      if (runner.iterate({i, Focus{effort.focus}, effort.removes_vertices}) == 0) break;
      run.control.set_fraction(kBegins + kTakes * i / effort.iterations);
    }
    runner.to_host();
  });
}

}  // namespace hfr
