// SPDX-License-Identifier: BSD-3-Clause
// Edge removal: the seeds, the search and commit A of Operators/EdgeRemoval.cc. A candidate's piece of the
// arena: its n cells in ring order, the n ring vertices, a, b, and the triangulation in preorder, four to a
// word.
#include "round.cl"

// Steps to the next cell counter-clockwise about a->b, where corners p and q make (a, b, p, q) positive; to
// an invalid one at the boundary.
static void step_in_ring(__global const cell_t* cells, uint* cell, uint* p, uint* q) {
  const uint m = cells[*cell].mate[*p];
  const uint w = cells[*cell].v[*q];
  *cell = m == INVALID ? INVALID : m / 4;
  if (m == INVALID) return;
  *q = m % 4;
  *p = own_corner(&cells[m / 4], w);
}

// Worst of the two cells of ring triangle (x, y, z), which is counter-clockwise about a->b: positive with b,
// and reversed with a. Anything <= top once it is no better.
static double triangle_worst(hfr_real3 x, hfr_real3 y, hfr_real3 z, hfr_real3 a, hfr_real3 b, double top) {
  const double upper = decision_of(x, y, z, b);
  return upper > top ? hfr_lesser(upper, decision_of(y, x, z, a)) : upper;
}
#define TRIANGLE_WORST(i, k, j, top) triangle_worst(p[i], p[k], p[j], point_a, point_b, (top))

// The triangulation of side (0, n-1) in preorder, from the table of apexes.
static void write_preorder(int n, int stride, const uchar* apex, uchar* out) {
  uchar from[HFR_MAX_RING], to[HFR_MAX_RING];
  int depth = 1;
  int n_out = 0;
  from[0] = 0;
  to[0] = (uchar)(n - 1);
  while (depth > 0) {
    --depth;
    const int i = from[depth];
    const int j = to[depth];
    if (j - i < 2) continue;
    const int k = apex[i * stride + j];
    out[n_out++] = (uchar)k;
    from[depth] = (uchar)k;  // after the left side
    to[depth] = (uchar)j;
    ++depth;
    from[depth] = (uchar)i;
    to[depth] = (uchar)k;
    ++depth;
  }
}

static void append_edge(uint seed, uint n, const uint* ring, const uint* scope, uint a, uint b,
                        const uchar* triangles, double old_worst, ulong salt, SEARCH_ARGUMENTS) {
  const uint n_words = (n - 2 + 3) / 4;
  identity_t id;
  id.v[0] = min(a, b);
  id.v[1] = max(a, b);
  id.v[2] = INVALID;
  const uint at =
      append_candidate(seed, id, old_worst, salt, n, 2 * (n - 2), 2 * n + 2 + n_words, SEARCH_VALUES);
  if (at == INVALID) return;
  for (uint k = 0; k < n; ++k) {
    arena[at + k] = scope[k];
    arena[at + n + k] = ring[k];
  }
  arena[at + 2 * n] = a;
  arena[at + 2 * n + 1] = b;
  for (uint w = 0; w < n_words; ++w) {
    uint word = 0;
    for (uint t = 0; t < 4; ++t)
      if (4 * w + t < n - 2) word |= (uint)triangles[4 * w + t] << (8 * t);
    arena[at + 2 * n + 2 + w] = word;
  }
}

// Cells and vertices of the ring of an edge (6*cell + edge), as far as there is room for them, and the worst
// of these cells. Returns the size of the ring; 0 when it is open, or when a smaller listed cell names the
// edge.
static uint walk_ring(uint seed, uint room, __global const cell_t* cells, __global const double* quality,
                      __global const uchar* listed, uint* ring, uint* scope, double* old_worst) {
  const uint c = seed / 6;
  uint at = c;
  uint corner_p = kEdgeOpposite[seed % 6][0];
  uint corner_q = kEdgeOpposite[seed % 6][1];
  uint n = 0;
  *old_worst = HFR_INFINITY;
  do {
    if (at < c && listed[at]) return 0;
    if (n < room) {
      scope[n] = at;
      ring[n] = cells[at].v[corner_p];
      *old_worst = hfr_lesser(*old_worst, quality[at]);
    }
    ++n;
    step_in_ring(cells, &at, &corner_p, &corner_q);
  } while (at != INVALID && at != c);
  return at == c ? n : 0;
}

// Appends the best triangulation of a ring, if it beats what is there. The arrays best and apex have
// stride*stride items, p and triangles `stride`.
static void search_ring(uint seed, uint n, const uint* ring, const uint* scope, double old_worst, int stride,
                        double* best, uchar* apex, hfr_real3* p, uchar* triangles,
                        __global const cell_t* cells, __global const double* points,
                        __global const uint* origin, __global const int* regions, uint has_regions,
                        ulong salt, SEARCH_ARGUMENTS) {
  for (uint k = 0; k < n; ++k) p[k] = point_of(points, ring[k]);
  const uint a = cells[seed / 6].v[kEdgeCorners[seed % 6][0]];
  const uint b = cells[seed / 6].v[kEdgeCorners[seed % 6][1]];
  const hfr_real3 point_a = point_of(points, a);
  const hfr_real3 point_b = point_of(points, b);
  double new_worst;
  HFR_KLINCSEK((int)n, stride, best, apex, old_worst, TRIANGLE_WORST, new_worst);
  if (!(new_worst > old_worst)) return;
  if (has_regions && !in_one_region(scope, n, origin, regions)) return;
  write_preorder((int)n, stride, apex, triangles);
  append_edge(seed, n, ring, scope, a, b, triangles, old_worst, salt, SEARCH_VALUES);
}

// Inner edges of the listed cells, each from the smallest listed cell of its ring. Small rings are searched
// at once, the others are noted for search_large_rings, whose arrays would not fit the registers of a device.
KERNEL void search_edges(__global const cell_t* cells, __global const double* points,
                         __global const double* quality, __global const uchar* listed,
                         __global const uint* cell_list, __global const uint* origin,
                         __global const int* regions, uint has_regions, ulong salt, __global uint* large,
                         SEARCH_ARGUMENTS) {
  uint ring[HFR_SMALL_RING], scope[HFR_SMALL_RING];
  double best[HFR_SMALL_RING * HFR_SMALL_RING];
  uchar apex[HFR_SMALL_RING * HFR_SMALL_RING], triangles[HFR_SMALL_RING];
  hfr_real3 p[HFR_SMALL_RING];
  uint n_seeds = 0;
  const uint n_items = 6 * counters[HFR_LISTED];
  FOR_EACH(item, n_items) {
    const uint seed = 6 * cell_list[item / 6] + item % 6;
    double old_worst;
    const uint n = walk_ring(seed, HFR_SMALL_RING, cells, quality, listed, ring, scope, &old_worst);
    n_seeds += n > 0;
    if (n > HFR_SMALL_RING)
      large[atomic_inc(&counters[HFR_LARGE])] = seed;
    else if (n >= 3)
      search_ring(seed, n, ring, scope, old_worst, HFR_SMALL_RING, best, apex, p, triangles, cells, points,
                  origin, regions, has_regions, salt, SEARCH_VALUES);
  }
  if (n_seeds) atomic_add(&counters[HFR_SEEDS], n_seeds);
}

KERNEL void search_large_rings(__global const cell_t* cells, __global const double* points,
                               __global const double* quality, __global const uchar* listed,
                               __global const uint* origin, __global const int* regions, uint has_regions,
                               ulong salt, __global const uint* large, SEARCH_ARGUMENTS) {
  uint ring[HFR_MAX_RING], scope[HFR_MAX_RING];
  double best[HFR_MAX_RING * HFR_MAX_RING];
  uchar apex[HFR_MAX_RING * HFR_MAX_RING], triangles[HFR_MAX_RING];
  hfr_real3 p[HFR_MAX_RING];
  FOR_EACH(item, counters[HFR_LARGE]) {
    const uint seed = large[item];
    double old_worst;
    const uint n = walk_ring(seed, HFR_MAX_RING, cells, quality, listed, ring, scope, &old_worst);
    if (n <= HFR_MAX_RING)
      search_ring(seed, n, ring, scope, old_worst, HFR_MAX_RING, best, apex, p, triangles, cells, points,
                  origin, regions, has_regions, salt, SEARCH_VALUES);
  }
}

// Commit A. Triangle t of the preorder on side (i, j) with apex k makes cell 2t = (i, k, j, b) and cell 2t +
// 1 = (k, i, j, a). Each side is shared with the triangle that made it, or is an outer face of ring cell i.
KERNEL void commit_edges(__global const uint* counters, uint capacity, __global const uint* order,
                         __global const uint* offsets, __global const uint* sizes, __global const uint* arena,
                         __global const uchar* won, __global const uint* extra_at,
                         __global const uint* free_cells, uint n_free, uint n_cells, __global cell_t* cells,
                         __global uint* moved, __global uint* incident_cells, __global uint* star_size,
                         __global uint* origin, uint has_data) {
  FOR_EACH(r, min(counters[HFR_CANDIDATES], capacity)) {
    if (!won[r]) continue;
    const uint candidate = order[r];
    __global const uint* scope = arena + offsets[candidate];
    const uint n = sizes[candidate] & 0xffff;
    __global const uint* ring = scope + n;
    const uint a = ring[n];
    const uint b = ring[n + 1];
    __global const uint* triangles = ring + n + 2;
    uint above[HFR_MAX_RING], below[HFR_MAX_RING];  // what lies behind the faces with b, and with a
    uint old_above[HFR_MAX_RING], old_below[HFR_MAX_RING];
    for (uint k = 0; k < n; ++k) {
      const uint c = scope[k];
      const uint corner_a = own_corner(&cells[c], a);
      const uint corner_b = own_corner(&cells[c], b);
      above[k] = cells[c].mate[corner_a];
      below[k] = cells[c].mate[corner_b];
      old_above[k] = 4 * c + corner_a;
      old_below[k] = 4 * c + corner_b;
      incident_cells[ring[k]] = INVALID;
      atomic_sub(&star_size[ring[k]], 2u);
    }
    incident_cells[a] = INVALID;
    incident_cells[b] = INVALID;
    atomic_sub(&star_size[a], 2u);  // n cells go, n - 2 come
    atomic_sub(&star_size[b], 2u);
    for (uint k = 2 * (n - 2); k < n; ++k) {  // a ring of three leaves one slot
      for (uint j = 0; j < 4; ++j) cells[scope[k]].v[j] = cells[scope[k]].mate[j] = INVALID;
    }
    // Sides that wait for their triangle, with the half-faces that lie on them from the other side.
    uchar from[HFR_MAX_RING], to[HFR_MAX_RING];
    uint outer_above[HFR_MAX_RING], outer_below[HFR_MAX_RING];
    int depth = 1;
    from[0] = 0;
    to[0] = (uchar)(n - 1);
    outer_above[0] = above[n - 1];
    outer_below[0] = below[n - 1];
    for (uint t = 0; t < n - 2; ++t) {
      --depth;
      const uint i = from[depth];
      const uint j = to[depth];
      const uint k = (triangles[t / 4] >> (8 * (t % 4))) & 0xff;
      const uint up = slot_of(2 * t, n, scope, extra_at[r], free_cells, n_free, n_cells);
      const uint down = slot_of(2 * t + 1, n, scope, extra_at[r], free_cells, n_free, n_cells);
      cell_t upper, lower;
      upper.v[0] = ring[i];
      upper.v[1] = ring[k];
      upper.v[2] = ring[j];
      upper.v[3] = b;
      lower.v[0] = ring[k];
      lower.v[1] = ring[i];
      lower.v[2] = ring[j];
      lower.v[3] = a;
      upper.mate[3] = 4 * down + 3;
      lower.mate[3] = 4 * up + 3;
      upper.mate[1] = outer_above[depth];
      lower.mate[0] = outer_below[depth];
      if (t == 0) {
        moved[old_above[n - 1]] = 4 * up + 1;
        moved[old_below[n - 1]] = 4 * down;
      }
      // The left part comes next in preorder, the right part after all of the left's.
      if (j - k < 2) {
        upper.mate[0] = above[k];
        lower.mate[1] = below[k];
        moved[old_above[k]] = 4 * up;
        moved[old_below[k]] = 4 * down + 1;
      } else {
        const uint other = t + (k - i);
        upper.mate[0] = 4 * slot_of(2 * other, n, scope, extra_at[r], free_cells, n_free, n_cells) + 1;
        lower.mate[1] = 4 * slot_of(2 * other + 1, n, scope, extra_at[r], free_cells, n_free, n_cells);
        from[depth] = (uchar)k;
        to[depth] = (uchar)j;
        outer_above[depth] = 4 * up;
        outer_below[depth] = 4 * down + 1;
        ++depth;
      }
      if (k - i < 2) {
        upper.mate[2] = above[i];
        lower.mate[2] = below[i];
        moved[old_above[i]] = 4 * up + 2;
        moved[old_below[i]] = 4 * down + 2;
      } else {
        const uint other = t + 1;
        upper.mate[2] = 4 * slot_of(2 * other, n, scope, extra_at[r], free_cells, n_free, n_cells) + 1;
        lower.mate[2] = 4 * slot_of(2 * other + 1, n, scope, extra_at[r], free_cells, n_free, n_cells);
        from[depth] = (uchar)i;
        to[depth] = (uchar)k;
        outer_above[depth] = 4 * up + 2;
        outer_below[depth] = 4 * down + 2;
        ++depth;
      }
      if (has_data && 2 * t >= n) origin[up] = origin[scope[0]];
      if (has_data && 2 * t + 1 >= n) origin[down] = origin[scope[0]];
      store_cell(&cells[up], &upper);
      store_cell(&cells[down], &lower);
      atomic_add(&star_size[ring[i]], 2u);
      atomic_add(&star_size[ring[k]], 2u);
      atomic_add(&star_size[ring[j]], 2u);
    }
  }
}
