// SPDX-License-Identifier: BSD-3-Clause
// The smoothers of Operators/SmoothNewton.cc and SmoothCandidates.cc on the vertices of one colour, which
// share no cell.
#include "candidates.h"
#include "common.cl"
#include "damage.h"
#include "newton_step.h"

// Smallest decision value of the star with the vertex moved by x, or anything <= floor once it is no better.
static double star_worst(const hfr_star_cell* star, uint n, hfr_real3 x, double floor_value) {
  double worst = HFR_INFINITY;
  for (uint k = 0; k < n && worst > floor_value; ++k)
    worst = hfr_lesser(worst, hfr_star_decision(star[k], x));
  return worst;
}

static double largest_measure(const hfr_star_cell* star, uint n, hfr_real3 x, double ceiling_value) {
  double top = 0.0;
  for (uint k = 0; k < n && top < ceiling_value; ++k) {
    const double m = hfr_star_m(star[k], x);
    if (m > top) top = m;
  }
  return top;
}

static hfr_newton_share shares(const hfr_star_cell* star, uint n, hfr_real3 x, double m_max) {
  hfr_newton_share sum = hfr_newton_zero();
  for (uint k = 0; k < n; ++k) sum = hfr_newton_sum(sum, hfr_star_newton(star[k], x, m_max));
  return sum;
}

static hfr_real3 newton_place(const hfr_star_cell* star, uint n) {
  hfr_real3 place;
#define LARGEST(x, ceiling_value) largest_measure(star, n, (x), (ceiling_value))
#define SHARES(x, m_max) shares(star, n, (x), (m_max))
  HFR_NEWTON_SEARCH(HFR_NEWTON_ITERATIONS, LARGEST, SHARES, place);
#undef LARGEST
#undef SHARES
  return place;
}

// The largest of `best` and of the candidates' worst values; *next becomes the first candidate that has it.
static double look_round(const hfr_star_cell* star, uint n, hfr_section section, hfr_real3 place,
                         double radius, double best, hfr_real3* next) {
  for (int i = 0; i < HFR_CANDIDATE_DIRECTIONS; ++i) {
    const hfr_real3 candidate = hfr_candidate(place, radius, i);
    if (!hfr_section_contains(section, candidate)) continue;
    const double q = star_worst(star, n, candidate, best);
    if (q > best) {
      best = q;
      *next = candidate;
    }
  }
  return best;
}

static hfr_real3 candidate_place(const hfr_star_cell* star, uint n, hfr_section section, double worst_now) {
  hfr_real3 place;
#define LOOK(place, radius, best, next) best = look_round(star, n, section, place, radius, best, &(next))
  HFR_CANDIDATE_SEARCH(HFR_CANDIDATE_HALVINGS, hfr_section_radius(section, (double)n), worst_now, LOOK,
                       place);
#undef LOOK
  return place;
}

// Decision value of cell c with vertex v at x, its vertices in stored order.
static double quality_with(__global const cell_t* cells, __global const double* points, uint c, uint v,
                           hfr_real3 x) {
  hfr_real3 p[4];
  for (int k = 0; k < 4; ++k) p[k] = cells[c].v[k] == v ? x : point_of(points, cells[c].v[k]);
  return decision_of(p[0], p[1], p[2], p[3]);
}

// Cell c with vertex v at x added to what is wrong with a star.
static hfr_damage damage_with(hfr_damage sum, __global const cell_t* cells, __global const double* points,
                              uint c, uint v, hfr_real3 x) {
  hfr_real3 p[4];
  for (int k = 0; k < 4; ++k) p[k] = cells[c].v[k] == v ? x : point_of(points, cells[c].v[k]);
  return hfr_damage_with(sum, p[0], p[1], p[2], p[3]);
}

// Moves one vertex where its star gets better; 1 when it moved. use_newton: Newton's method on stars whose
// cells are all positive, the candidate search on the others; else the candidate search on all.
static uint smooth_vertex(__global const cell_t* cells, __global double* points, __global double* quality,
                          __global uchar* pending, __global uint* changed, __global const uint* link, uint n,
                          uint v, uint use_newton, uint clock, uint holds_damage, double floor_value,
                          hfr_star_cell* star) {
  const hfr_real3 origin = point_of(points, v);
  double old_worst = HFR_INFINITY;
  hfr_section section = hfr_section_zero();
  for (uint k = 0; k < n; ++k) old_worst = hfr_lesser(old_worst, quality[link[k] / 4]);
  const uint by_newton = use_newton && old_worst > 0.0;
  for (uint k = 0; k < n; ++k) {
    hfr_real3 f[3];
    for (uint j = 0; j < 3; ++j) f[j] = point_of(points, cells[link[k] / 4].v[kFaceCorners[link[k] % 4][j]]);
    if (!by_newton) {
      for (uint j = 0; j < 3; ++j)
        section = hfr_section_add(section, hfr_sub3(f[j], origin), hfr_sub3(f[(j + 1) % 3], f[j]));
    }
    star[k] = hfr_make_star_cell(hfr_sub3(f[0], origin), hfr_sub3(f[1], origin), hfr_sub3(f[2], origin));
  }
  const hfr_real3 place = by_newton ? newton_place(star, n) : candidate_place(star, n, section, old_worst);
  if (place.x == 0.0 && place.y == 0.0 && place.z == 0.0) return 0;
  const hfr_real3 target = hfr_make3(origin.x + place.x, origin.y + place.y, origin.z + place.z);
  // What decides is the formula that the cells are judged by, on the rounded position.
  double new_worst = HFR_INFINITY;
  int more_invalid = 0;
  for (uint k = 0; k < n && new_worst > old_worst; ++k) {
    const double q = quality_with(cells, points, link[k] / 4, v, target);
    new_worst = hfr_lesser(new_worst, q);
    more_invalid += (int)!(q > 0.0) - (int)!(quality[link[k] / 4] > 0.0);
  }
  if (!(new_worst > old_worst) || more_invalid > 0) return 0;
  if (!(old_worst > 0.0) && holds_damage) {
    hfr_damage before = hfr_no_damage();
    hfr_damage after = hfr_no_damage();
    for (uint k = 0; k < n; ++k) {
      before = damage_with(before, cells, points, link[k] / 4, v, origin);
      after = damage_with(after, cells, points, link[k] / 4, v, target);
    }
    if (!hfr_damage_may_become(before, after, floor_value)) return 0;
  }
  points[3 * (size_t)v] = target.x;
  points[3 * (size_t)v + 1] = target.y;
  points[3 * (size_t)v + 2] = target.z;
  for (uint k = 0; k < n; ++k) {
    const uint c = link[k] / 4;
    quality[c] = quality_with(cells, points, c, v, target);
    pending[c] = 0xff;
    for (int j = 0; j < 4; ++j) changed[cells[c].v[j]] = clock;
  }
  return 1;
}

#define SMOOTH_KERNEL(name, min_star, max_star)                                                              \
  KERNEL void name(__global const cell_t* cells, __global const uint* vertices, __global const uint* begin,  \
                   __global const uint* star_size, __global const uint* links, __global const uint* grouped, \
                   __global const uint* colour_begin, uint colour, uint use_newton, uint clock,              \
                   uint holds_damage, double floor_value, __global double* points, __global double* quality, \
                   __global uchar* pending, __global uint* changed, __global uint* counters) {               \
    hfr_star_cell star[max_star];                                                                            \
    uint n_moved = 0;                                                                                        \
    const uint first = colour_begin[colour];                                                                 \
    const uint n_group = colour_begin[colour + 1] - first;                                                   \
    FOR_EACH(at, n_group) {                                                                                  \
      const uint i = grouped[first + at];                                                                    \
      const uint v = vertices[i];                                                                            \
      const uint n = star_size[v];                                                                           \
      if (n < (min_star) || n > (max_star)) continue;                                                        \
      n_moved += smooth_vertex(cells, points, quality, pending, changed, links + begin[i], n, v, use_newton, \
                               clock, holds_damage, floor_value, star);                                      \
    }                                                                                                        \
    if (n_moved) atomic_add(&counters[HFR_MOVED], n_moved);                                                  \
  }

// What a work-item may need decides how many of them a device can hold at once, hence two kernels; a CPU has
// one work-item a core.
#if HFR_LOCAL == 1
SMOOTH_KERNEL(smooth_all_stars, 1, HFR_MAX_STAR)
#else
SMOOTH_KERNEL(smooth_small_stars, 1, HFR_SMALL_STAR)
SMOOTH_KERNEL(smooth_large_stars, HFR_SMALL_STAR + 1, HFR_MAX_STAR)
#endif
