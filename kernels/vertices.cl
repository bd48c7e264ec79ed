// SPDX-License-Identifier: BSD-3-Clause
// Vertex collapse: the search and commit A of Operators/VertexCollapse.cc for the vertices that
// list_vertices() in DeviceMesh.cc finds. A candidate's piece of the arena: the n cells of the star in the
// order of TetMesh::gather_star, the vertex that goes, and the apex, the vertex of its link that all faces of
// the link are joined to.
#include "round.cl"

// A connected closed surface of n triangles has n / 2 + 2 vertices at most: those of a sphere.
#define LINK_VERTICES(max_star) ((max_star) / 2 + 2)

// The cells of vertex v that are connected through faces with its incident cell, in the order in which a walk
// in breadth finds them. Returns their number, `room` at most.
static uint walk_star(__global const cell_t* cells, uint incident_cell, uint v, uint room, uint* star) {
  uint n = 1;
  star[0] = incident_cell;
  for (uint i = 0; i < n; ++i) {
    __global const cell_t* cell = &cells[star[i]];
    const uint corner = own_corner(cell, v);
    for (uint turn = 1; turn < 4; ++turn) {
      const uint m = cell->mate[(corner + turn) & 3];
      if (m == INVALID) continue;
      uint known = n;
      while (known > 0 && star[known - 1] != m / 4) --known;
      if (known == 0 && n < room) star[n++] = m / 4;
    }
  }
  return n;
}

// Looks for the apex with the best worst cell, and appends it if that beats what is there. Arrays: n cells of
// the star; 3*n bytes for the faces of the link; n / 2 + 2 items in the others, for its vertices.
static void search_star(uint v, uint n, const uint* star, uchar* faces, uint* link, uchar* ascending,
                        hfr_real3* p, __global const cell_t* cells, __global const double* points,
                        __global const double* quality, __global const uint* origin,
                        __global const int* regions, uint has_regions, ulong salt, SEARCH_ARGUMENTS) {
  uint n_link = 0;
  double old_worst = HFR_INFINITY;
  for (uint i = 0; i < n; ++i) {
    __global const cell_t* cell = &cells[star[i]];
    const uint corner = own_corner(cell, v);
    old_worst = hfr_lesser(old_worst, quality[star[i]]);
    for (uint j = 0; j < 3; ++j) {
      const uint u = cell->v[kFaceCorners[corner][j]];
      uint k = 0;
      while (k < n_link && link[k] != u) ++k;
      faces[3 * i + j] = (uchar)k;
      if (k < n_link) continue;
      link[n_link++] = u;
      p[k] = point_of(points, u);
      for (; k > 0 && u < link[ascending[k - 1]]; --k) ascending[k] = ascending[k - 1];
      ascending[k] = (uchar)(n_link - 1);
    }
  }
  // Of several apexes that are as good, the one of smallest number, as on the host.
  double new_worst = old_worst;
  uint best = INVALID;
  uint n_best = 0;
  uint killer = 0;  // the face that refused the last apex is likely to refuse the next
  for (uint a = 0; a < n_link; ++a) {
    const uint apex = ascending[a];
    double worst = HFR_INFINITY;
    uint n_created = 0;
    for (uint k = 0; k < n && worst > new_worst; ++k) {
      const uint i = k == 0 ? killer : k <= killer ? k - 1 : k;
      const uchar* f = faces + 3 * i;
      if (f[0] == apex || f[1] == apex || f[2] == apex) continue;
      ++n_created;
      worst = hfr_lesser(worst, decision_of(p[f[0]], p[f[1]], p[f[2]], p[apex]));
      if (!(worst > new_worst)) killer = i;
    }
    if (!(worst > new_worst) || n_created == 0) continue;
    new_worst = worst;
    best = link[apex];
    n_best = n_created;
  }
  if (best == INVALID) return;
  if (has_regions && !in_one_region(star, n, origin, regions)) return;
  const uint at = append_candidate(v, vertex_identity(v), old_worst, salt, n, n_best, n + 2, SEARCH_VALUES);
  if (at == INVALID) return;
  for (uint i = 0; i < n; ++i) arena[at + i] = star[i];
  arena[at + n] = v;
  arena[at + n + 1] = best;
}

// A star of more cells than HFR_MAX_STAR, and one that is in several parts, is left alone, as on the host.
#define SEARCH_STARS_KERNEL(name, min_star, max_star)                                                      \
  KERNEL void name(__global const cell_t* cells, __global const double* points,                            \
                   __global const double* quality, __global const uint* incident_cells,                    \
                   __global const uint* star_size, __global const uint* vertices,                          \
                   __global const uint* origin, __global const int* regions, uint has_regions, ulong salt, \
                   SEARCH_ARGUMENTS) {                                                                     \
    uint star[max_star], link[LINK_VERTICES(max_star)];                                                    \
    uchar faces[3 * (max_star)], ascending[LINK_VERTICES(max_star)];                                       \
    hfr_real3 p[LINK_VERTICES(max_star)];                                                                  \
    uint n_seeds = 0;                                                                                      \
    FOR_EACH(item, counters[HFR_VERTICES]) {                                                               \
      const uint v = vertices[item];                                                                       \
      const uint n = star_size[v];                                                                         \
      if (n < (min_star) || n > (max_star)) continue;                                                      \
      if (walk_star(cells, incident_cells[v], v, n, star) != n) continue;                                  \
      ++n_seeds;                                                                                           \
      search_star(v, n, star, faces, link, ascending, p, cells, points, quality, origin, regions,          \
                  has_regions, salt, SEARCH_VALUES);                                                       \
    }                                                                                                      \
    if (n_seeds) atomic_add(&counters[HFR_SEEDS], n_seeds);                                                \
  }

// As for smoothing: what a work-item may need decides how many of them a device can hold at once.
#if HFR_LOCAL == 1
SEARCH_STARS_KERNEL(search_all_stars, 1, HFR_MAX_STAR)
#else
SEARCH_STARS_KERNEL(search_small_stars, 1, HFR_SMALL_STAR)
SEARCH_STARS_KERNEL(search_large_stars, HFR_SMALL_STAR + 1, HFR_MAX_STAR)
#endif

// Commit A. Each cell of the star without the apex becomes the one of its face of the link (corners 0 to 2)
// and the apex (corner 3); the k-th of these takes the slot of the k-th cell of the star. A cell with the
// apex goes, and leaves its face of the link to the cell that was behind its face opposite the apex.
KERNEL void commit_stars(__global const uint* counters, uint capacity, __global const uint* order,
                         __global const uint* offsets, __global const uint* sizes, __global const uint* arena,
                         __global const uchar* won, __global cell_t* cells, __global uint* moved,
                         __global uint* incident_cells, __global uint* star_size) {
  FOR_EACH(r, min(counters[HFR_CANDIDATES], capacity)) {
    if (!won[r]) continue;
    const uint candidate = order[r];
    __global const uint* scope = arena + offsets[candidate];
    const uint n = n_removed_of(sizes[candidate]);
    const uint n_created = n_created_of(sizes[candidate]);
    const uint v = scope[n];
    const uint apex = scope[n + 1];
    // First, for every half-face that is looked up below, what takes its place.
    uint created = 0;
    for (uint i = 0; i < n; ++i) {
      const uint c = scope[i];
      const uint corner = own_corner(&cells[c], v);
      const uint corner_apex = own_corner(&cells[c], apex);
      if (cells[c].v[corner_apex] == apex) {
        moved[4 * c + corner_apex] = cells[c].mate[corner];
        for (uint j = 0; j < 3; ++j) atomic_dec(&star_size[cells[c].v[kFaceCorners[corner][j]]]);
        continue;
      }
      for (uint j = 0; j < 3; ++j) moved[4 * c + kFaceCorners[corner][j]] = 4 * scope[created] + j;
      moved[4 * c + corner] = 4 * scope[created] + 3;
      ++created;
    }
    atomic_add(&star_size[apex], n_created);
    // Then the cells, in place: a slot that is written is that of a cell which has had its turn.
    created = 0;
    for (uint i = 0; i < n; ++i) {
      const uint c = scope[i];
      const uint corner = own_corner(&cells[c], v);
      const uint corner_apex = own_corner(&cells[c], apex);
      if (cells[c].v[corner_apex] == apex) {
        moved[4 * c + corner] = moved[cells[c].mate[corner_apex]];
        continue;
      }
      cell_t cell;
      for (uint j = 0; j < 3; ++j) {
        cell.v[j] = cells[c].v[kFaceCorners[corner][j]];
        cell.mate[j] = moved[cells[c].mate[kFaceCorners[corner][j]]];
        incident_cells[cell.v[j]] = INVALID;
      }
      cell.v[3] = apex;
      cell.mate[3] = cells[c].mate[corner];
      store_cell(&cells[scope[created++]], &cell);
    }
    incident_cells[apex] = INVALID;
    for (uint k = n_created; k < n; ++k) {
      for (uint j = 0; j < 4; ++j) cells[scope[k]].v[j] = cells[scope[k]].mate[j] = INVALID;
    }
    incident_cells[v] = INVALID;
    star_size[v] = 0;
  }
}
