// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_METRICS_HH
#define HFR_OPERATORS_METRICS_HH

#include "Quality/Metrics.hh"

/// Instantiates an operator template for the metrics that runs use: the bulk's, the polish's, and any other
/// through a callable.
#define HFR_INSTANTIATE_FOR_METRICS(Operator) \
  template struct Operator<VolumeLength>;     \
  template struct Operator<MinSine2>;         \
  template struct Operator<MinDihedral>;      \
  template struct Operator<CustomMetric>;

#endif
