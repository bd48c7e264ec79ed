// SPDX-License-Identifier: BSD-3-Clause
// The 2-3 swap: seeds, search and commit A of Operators/FaceSwap.cc. A candidate's piece of the arena: its
// two cells, the apex below, the apex above, the three vertices of the face as the seed's cell sees them.
#include "round.cl"

KERNEL void search_faces(__global const cell_t* cells, __global const double* points,
                         __global const double* quality, __global const uchar* listed,
                         __global const uint* cell_list, __global const uint* origin,
                         __global const int* regions, uint has_regions, ulong salt, SEARCH_ARGUMENTS) {
  uint n_seeds = 0;
  const uint n_items = 4 * counters[HFR_LISTED];
  FOR_EACH(item, n_items) {
    const uint c = cell_list[item / 4];
    const uint corner = item % 4;
    const uint h = 4 * c + corner;
    const uint m = cells[c].mate[corner];
    if (m == INVALID || !(h < m || !listed[m / 4])) continue;
    ++n_seeds;
    const uint above = cells[c].v[corner];
    const uint below = cells[m / 4].v[m % 4];
    if (above == below) continue;
    const double old_worst = hfr_lesser(quality[c], quality[m / 4]);
    uint f[3];
    for (int k = 0; k < 3; ++k) f[k] = cells[c].v[kFaceCorners[corner][k]];
    const hfr_real3 top = point_of(points, above);
    const hfr_real3 bottom = point_of(points, below);
    double new_worst = HFR_INFINITY;
    for (int k = 0; k < 3 && new_worst > old_worst; ++k)
      new_worst = hfr_lesser(
          new_worst, decision_of(bottom, top, point_of(points, f[k]), point_of(points, f[(k + 1) % 3])));
    if (!(new_worst > old_worst)) continue;
    if (has_regions && regions[origin[c]] != regions[origin[m / 4]]) continue;
    const uint at = append_candidate(h, face_identity(cells, h), old_worst, salt, 2, 3, 7, SEARCH_VALUES);
    if (at == INVALID) continue;
    arena[at] = c;
    arena[at + 1] = m / 4;
    arena[at + 2] = below;
    arena[at + 3] = above;
    for (int k = 0; k < 3; ++k) arena[at + 4 + k] = f[k];
  }
  if (n_seeds) atomic_add(&counters[HFR_SEEDS], n_seeds);
}

// Cell k is (below, above, f[k], f[k+1]): its faces 2 and 3 are shared with the cells after and before it.
KERNEL void commit_faces(__global const uint* counters, uint capacity, __global const uint* order,
                         __global const uint* offsets, __global const uint* sizes, __global const uint* arena,
                         __global const uchar* won, __global const uint* extra_at,
                         __global const uint* free_cells, uint n_free, uint n_cells, __global cell_t* cells,
                         __global uint* moved, __global uint* incident_cells, __global uint* star_size,
                         __global uint* origin, uint has_data) {
  FOR_EACH(r, min(counters[HFR_CANDIDATES], capacity)) {
    if (!won[r]) continue;
    const uint candidate = order[r];
    __global const uint* scope = arena + offsets[candidate];
    const uint n_removed = n_removed_of(sizes[candidate]);
    const uint top_cell = scope[0];
    const uint bottom_cell = scope[1];
    const uint below = scope[2];
    const uint above = scope[3];
    uint f[3], slot[3], behind_top[3], behind_bottom[3], old_top[3], old_bottom[3];
    for (uint k = 0; k < 3; ++k) f[k] = scope[4 + k];
    for (uint k = 0; k < 3; ++k) {  // face (f[k], f[k+1]) of either cell lies opposite f[k+2]
      slot[k] = slot_of(k, n_removed, scope, extra_at[r], free_cells, n_free, n_cells);
      const uint opposite = f[(k + 2) % 3];
      old_top[k] = 4 * top_cell + own_corner(&cells[top_cell], opposite);
      old_bottom[k] = 4 * bottom_cell + own_corner(&cells[bottom_cell], opposite);
      behind_top[k] = cells[top_cell].mate[old_top[k] % 4];
      behind_bottom[k] = cells[bottom_cell].mate[old_bottom[k] % 4];
    }
    if (has_data) origin[slot[2]] = origin[top_cell];
    for (uint k = 0; k < 3; ++k) {
      cell_t created;
      created.v[0] = below;
      created.v[1] = above;
      created.v[2] = f[k];
      created.v[3] = f[(k + 1) % 3];
      created.mate[0] = behind_top[k];     // opposite the lower apex
      created.mate[1] = behind_bottom[k];  // opposite the upper apex
      created.mate[2] = 4 * slot[(k + 1) % 3] + 3;
      created.mate[3] = 4 * slot[(k + 2) % 3] + 2;
      store_cell(&cells[slot[k]], &created);
      moved[old_top[k]] = 4 * slot[k];
      moved[old_bottom[k]] = 4 * slot[k] + 1;
      incident_cells[f[k]] = INVALID;  // its number of cells is the same: two go, two come
    }
    incident_cells[below] = INVALID;
    incident_cells[above] = INVALID;
    atomic_add(&star_size[below], 2u);  // one goes, three come
    atomic_add(&star_size[above], 2u);
  }
}
