// SPDX-License-Identifier: BSD-3-Clause
// One step of a non-smooth ascent: the d that maximises min(f + g·d) - d²/2u over functions with values f and
// gradients g. Its dual are weights on the functions, not negative and with the sum 1, that minimise
// Σwf + u/2 (Σwg)²; then d = uΣwg. Without f that is the shortest vector in a polytope, and the way to it is
// that of P. Wolfe, Finding the nearest point in a polytope, 1976. Only + - * / and comparisons.
// For MaxMinForm.cc alone: not installed.
#ifndef HFR_OPERATORS_PROXIMAL_STEP_HH
#define HFR_OPERATORS_PROXIMAL_STEP_HH

#include <cstddef>

#include "HalfFace/RawArray.hh"
#include "Quality/Lowest.hh"
#include "Quality/Vectors.hh"

namespace hfr::detail {

HFR_FN hfr_real3 times(double s, hfr_real3 a) { return {s * a.x, s * a.y, s * a.z}; }
HFR_FN hfr_real3 plus(hfr_real3 a, hfr_real3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

/// Values and gradients of the functions that hold a step back, in the order of the cells; of more than
/// kCapacity, those of the first cells: whether a step is taken is asked of all cells. Up to the next
/// multiple of kLowestBlock, the values are infinite.
struct MaxMinSlopes {
  static constexpr std::size_t kCapacity = 384;
  static_assert(kCapacity % kLowestBlock == 0);
  using Array = RawArray<double, kCapacity>;

  std::size_t padded() const { return (size + kLowestBlock - 1) / kLowestBlock * kLowestBlock; }
  HFR_FN hfr_real3 gradient(std::size_t i) const { return {x[i], y[i], z[i]}; }
  /// Of function i after a step.
  HFR_FN double model(std::size_t i, hfr_real3 d) const { return value[i] + hfr_dot3(gradient(i), d); }

  std::size_t size = 0;
  alignas(64) Array value;
  Array x, y, z;
};

/// The functions that have weight. Four are enough, because three differences of gradients span space.
struct StepWeights {
  static constexpr std::size_t kMost = 4;
  using Way = double[kMost + 1];

  std::size_t size = 0;
  std::size_t at[kMost + 1];  // which functions; the last one may be on its way in
  double weight[kMost + 1];

  HFR_FN bool has(std::size_t i) const {
    for (std::size_t k = 0; k < size; ++k)
      if (at[k] == i) return true;
    return false;
  }

  /// u times the sum of the weighted gradients.
  HFR_FN hfr_real3 step(const MaxMinSlopes& f, double u) const {
    hfr_real3 sum = times(weight[0], f.gradient(at[0]));
    for (std::size_t i = 1; i < size; ++i) sum = plus(sum, times(weight[i], f.gradient(at[i])));
    return times(u, sum);
  }

  /// The largest model of theirs after a step, at least `least`.
  HFR_FN double highest(const MaxMinSlopes& f, hfr_real3 d, double least) const {
    for (std::size_t i = 0; i < size; ++i) {
      const double m = f.model(at[i], d);
      if (m > least) least = m;
    }
    return least;
  }

  /// Adds `most` times `way`, the sum of which is 0, or as much of it as leaves no weight negative. False
  /// when one has come to 0 before: that function is out.
  HFR_FN bool shift(const Way& way, double most) {
    std::size_t out = size;
    for (std::size_t i = 0; i < size; ++i) {
      if (!(way[i] < 0 && weight[i] < most * -way[i])) continue;
      most = weight[i] / -way[i];
      out = i;
    }
    for (std::size_t i = 0; i < size; ++i) weight[i] += most * way[i];
    if (out == size) return true;
    --size;
    for (std::size_t i = out; i < size; ++i) {
      at[i] = at[i + 1];
      weight[i] = weight[i + 1];
    }
    return false;
  }
};

/// Where the weights of two to five functions would be best, whatever their signs: equations for the changes
/// of all but the first, by LDLᵗ.
struct StepEquations {
  static constexpr double kIndependent = 1e-10;  // of a squared difference that is no sum of those before

  std::size_t size = 0;  ///< of those solved so far
  hfr_real3 across[StepWeights::kMost];
  double l[StepWeights::kMost][StepWeights::kMost], pivot[StepWeights::kMost], lacks[StepWeights::kMost];

  /// False for a gradient whose difference from the first one is a sum of those before.
  HFR_FN bool add(hfr_real3 difference, double lack, double u) {
    const std::size_t i = size;
    across[i] = difference;
    lacks[i] = lack;
    for (std::size_t j = 0; j < i; ++j) {
      double sum = u * hfr_dot3(across[i], across[j]);
      for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * (l[j][k] * pivot[k]);
      l[i][j] = sum / pivot[j];
    }
    const double whole = u * hfr_dot3(across[i], across[i]);
    double left = whole;
    for (std::size_t k = 0; k < i; ++k) left -= l[i][k] * (l[i][k] * pivot[k]);
    pivot[i] = left;
    if (i == StepWeights::kMost - 1 || !(left > kIndependent * whole)) return false;
    ++size;
    return true;
  }

  HFR_FN void solve(StepWeights::Way& way) {
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t k = 0; k < i; ++k) lacks[i] -= l[i][k] * lacks[k];
    way[0] = 0;
    for (std::size_t i = size; i-- > 0;) {
      double change = lacks[i] / pivot[i];
      for (std::size_t k = i + 1; k < size; ++k) change -= l[k][i] * way[k + 1];
      way[i + 1] = change;
      way[0] -= change;
    }
  }

  /// After add() was false: a way on which the step stays what it is, and the dual falls without end. Weight
  /// goes between that gradient and those whose sum it is.
  HFR_FN void exchange(std::size_t n_functions, StepWeights::Way& way) const {
    double rises = lacks[size];
    double rest = 1;
    for (std::size_t j = size; j-- > 0;) {
      double c = l[size][j];
      for (std::size_t k = j + 1; k < size; ++k) c += l[k][j] * way[k + 1];
      way[j + 1] = -c;
      rest -= c;
      rises -= c * lacks[j];
    }
    way[0] = -rest;
    way[size + 1] = 1;
    for (std::size_t j = size + 2; j < n_functions; ++j) way[j] = 0;
    if (rises < 0)
      for (std::size_t j = 0; j < n_functions; ++j) way[j] = -way[j];
  }
};

/// False where the way has no end.
HFR_FN bool find_way(const MaxMinSlopes& f, double u, const StepWeights& w, StepWeights::Way& way) {
  const hfr_real3 d = w.step(f, u);
  const hfr_real3 g = f.gradient(w.at[0]);
  const double level = f.model(w.at[0], d);
  StepEquations equations;
  for (std::size_t i = 1; i < w.size; ++i) {
    if (equations.add(hfr_sub3(f.gradient(w.at[i]), g), level - f.model(w.at[i], d), u)) continue;
    equations.exchange(w.size, way);
    return false;
  }
  equations.solve(way);
  return true;
}

/// Gives function i weight, and all that have some the best weights that are not negative. False when it has
/// some already or keeps none, which only rounding brings about.
HFR_FN bool take_in(const MaxMinSlopes& f, double u, std::size_t i, StepWeights& w) {
  if (w.has(i)) return false;
  w.at[w.size] = i;
  w.weight[w.size++] = 0;
  StepWeights::Way way;
  while (w.size > 1) {
    const bool ends = find_way(f, u, w, way);
    if (w.shift(way, ends ? 1 : HFR_INFINITY)) break;
  }
  return w.at[w.size - 1] == i;
}

/// A step, and the smallest value that the linear models promise after it.
struct MaxMinStep {
  hfr_real3 d;
  double promise;
};

inline constexpr int kMostStepTurns = 32;  // of one step; four to six are taken on average, 20 hardly ever

/// Of the functions that have weight all models are level; the one whose model is smallest gets some, until
/// that is one of these, up to a share `level` of what is promised, or of `enough`. V: lanes.
template <class V>
HFR_FN void proximal_step(const MaxMinSlopes* slopes, double u, double level, double enough,
                          MaxMinStep* out) {
  const MaxMinSlopes& f = *slopes;
  const std::size_t n = f.padded();
  const Lowest least = lowest_in<V>(f.value.data(), n);
  StepWeights w;
  w.size = 1;
  w.at[0] = least.at;
  w.weight[0] = 1;
  for (int turn = 0;; ++turn) {
    const hfr_real3 d = w.step(f, u);
    LowestSearch<V> search;
    search.begin();
    for (std::size_t i = 0; i < n; i += search.kLanes) {
      V v, x, y, z;
      load(v, &f.value[i]);
      load(x, &f.x[i]);
      load(y, &f.y[i]);
      load(z, &f.z[i]);
      search.take(v + ((x * d.x + y * d.y) + z * d.z));  // as model(), for the same bits
    }
    const Lowest low = search.get();
    const double gap = w.highest(f, d, low.value) - low.value;
    *out = {d, low.value};
    const bool is_level = !(gap > level * (low.value - least.value) && gap > level * enough);
    if (turn == kMostStepTurns || is_level || !take_in(f, u, low.at, w)) return;
  }
}

}  // namespace hfr::detail

#endif
