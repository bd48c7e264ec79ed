// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_SAFE_FRACTION_HH
#define HFR_REMESH_SAFE_FRACTION_HH

namespace hfr {

/// How much of a displacement may be taken that is not safe as a whole: found by halving, and put there.
/// put_at(fraction) moves the points and looks at the cells, is_safe() says what came of it.
template <class PutAt, class IsSafe>
double put_at_safe_fraction(int halvings, PutAt&& put_at, IsSafe&& is_safe) {
  double safe = 0, unsafe = 1;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (safe + unsafe);
    put_at(middle);
    (is_safe() ? safe : unsafe) = middle;
  }
  put_at(safe);
  return safe;
}

}  // namespace hfr

#endif
