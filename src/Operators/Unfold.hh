// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_UNFOLD_HH
#define HFR_OPERATORS_UNFOLD_HH

#include "Operators/StarForm.hh"

namespace hfr {

/// Moves the vertex of a star, which stands at 0, so that the regularised shape energy of its cells falls:
/// the sum of S√S / χ(D), with S the squared edges, D six times the volume and χ(D) = (D + √(D² + ε²)) / 2.
/// χ is all but D for a positive cell and small but above 0 for an inverted one, so the energy is smooth and
/// finite everywhere and leads out of inversions. ε follows the most inverted cell. At most `steps` Newton
/// steps; returns the displacement. It is no better by any metric: whoever asks has to compare.
Vec3 unfold(const StarForm& star, int steps);

}  // namespace hfr

#endif
