// SPDX-License-Identifier: BSD-3-Clause
// Work lists, prefix sums, and the figures of a whole mesh.
#include "common.cl"

KERNEL void fill_words(__global uint* array, uint first, uint n, uint value) {
  FOR_EACH(i, n) { array[first + i] = value; }
}

KERNEL void fill_bytes(__global uchar* array, uint first, uint n, uint value) {
  FOR_EACH(i, n) { array[first + i] = (uchar)value; }
}

// Flags the cells that an operator has to look at, and counts them by work-group. With everything_bit, those
// whose pending bit is set; else those below `below` with a vertex that has changed since.
KERNEL void list_cells(__global const cell_t* cells, __global const double* quality,
                       __global const uchar* pending, __global const uint* changed, uint n_cells,
                       double below, uint since, uint everything_bit, __global uchar* listed,
                       __global uint* sums) {
  __local uint tile[HFR_LOCAL];
  uint sum = 0;
  FOR_PART(c, n_cells, valid) {
    uint flag = 0;
    if (valid) {
      if (everything_bit) {
        flag = (pending[c] & everything_bit) != 0 && cells[c].v[0] != INVALID;
      } else if (quality[c] < below && cells[c].v[0] != INVALID) {
        for (int k = 0; k < 4; ++k) flag |= changed[cells[c].v[k]] > since;
      }
      listed[c] = (uchar)flag;
    }
    uint total;
    scan_tile(tile, flag, &total);
    sum += total;
  }
  if (get_local_id(0) == 0) sums[get_group_id(0)] = sum;
}

// The listed cells count as looked at from now on.
KERNEL void clear_pending(__global const uint* cell_list, __global const uint* counters, uint bit,
                          __global uchar* pending) {
  FOR_EACH(i, counters[HFR_LISTED]) { pending[cell_list[i]] &= (uchar)~bit; }
}

KERNEL void count_flags(__global const uchar* flags, uint n, __global uint* sums) {
  __local uint tile[HFR_LOCAL];
  uint sum = 0;
  FOR_PART(i, n, valid) {
    uint total;
    scan_tile(tile, valid ? flags[i] : 0, &total);
    sum += total;
  }
  if (get_local_id(0) == 0) sums[get_group_id(0)] = sum;
}

// Exclusive prefix sums of `n_rows` rows of n sums each, in place, a work-group a row; the totals go to
// counters[first + row].
KERNEL void scan_sums(__global uint* sums, uint n, uint n_rows, __global uint* counters, uint first) {
  __local uint tile[HFR_LOCAL];
  for (uint row = (uint)get_group_id(0); row < n_rows; row += (uint)get_num_groups(0)) {
    uint at = 0;
    for (uint begin = 0; begin < n; begin += HFR_LOCAL) {
      const uint i = begin + (uint)get_local_id(0);
      uint total;
      const uint before = scan_tile(tile, i < n ? sums[row * n + i] : 0, &total);
      if (i < n) sums[row * n + i] = at + before;
      at += total;
    }
    if (get_local_id(0) == 0) counters[first + row] = at;
  }
}

// The flagged indices, ascending.
KERNEL void write_flagged(__global const uchar* flags, uint n, __global const uint* sums,
                          __global uint* list) {
  __local uint tile[HFR_LOCAL];
  uint at = sums[get_group_id(0)];
  FOR_PART(i, n, valid) {
    const uint flag = valid ? flags[i] : 0;
    uint total;
    const uint before = scan_tile(tile, flag, &total);
    if (flag) list[at + before] = i;
    at += total;
  }
}

KERNEL void sum_parts(__global const uint* values, uint n, __global uint* sums) {
  __local uint tile[HFR_LOCAL];
  uint sum = 0;
  FOR_PART(i, n, valid) {
    uint total;
    scan_tile(tile, valid ? values[i] : 0, &total);
    sum += total;
  }
  if (get_local_id(0) == 0) sums[get_group_id(0)] = sum;
}

// Exclusive prefix sum in place, given the sums before each part.
KERNEL void scan_parts(__global uint* values, uint n, __global const uint* sums) {
  __local uint tile[HFR_LOCAL];
  uint at = sums[get_group_id(0)];
  FOR_PART(i, n, valid) {
    const uint value = valid ? values[i] : 0;
    uint total;
    const uint before = scan_tile(tile, value, &total);
    if (valid) values[i] = at + before;
    at += total;
  }
}

// Decision value of every cell; +infinity in deleted slots.
KERNEL void cell_qualities(__global const cell_t* cells, __global const double* points, uint n_cells,
                           __global double* quality) {
  FOR_EACH(c, n_cells) {
    double q = HFR_INFINITY;
    if (cells[c].v[0] != INVALID)
      q = decision_of(point_of(points, cells[c].v[0]), point_of(points, cells[c].v[1]),
                      point_of(points, cells[c].v[2]), point_of(points, cells[c].v[3]));
    quality[c] = q;
  }
}

// Smallest decision value by work-item, and the number of cells that are not positive.
KERNEL void tally_qualities(__global const double* quality, uint n_cells, __global double* worst,
                            __global uint* counters) {
  double least = HFR_INFINITY;
  uint n_invalid = 0;
  FOR_EACH(c, n_cells) {
    const double q = quality[c];
    least = hfr_lesser(least, q);
    n_invalid += !(q > 0.0);
  }
  worst[get_global_id(0)] = least;
  if (n_invalid) atomic_add(&counters[HFR_INVALID_CELLS], n_invalid);
}

// Smallest dihedral by work-item, as decision value.
KERNEL void tally_dihedrals(__global const cell_t* cells, __global const double* points, uint n_cells,
                            __global double* worst) {
  double least = 8.0 / 9.0;
  FOR_EACH(c, n_cells) {
    if (cells[c].v[0] == INVALID) continue;
    least = hfr_lesser(
        least, hfr_min_dihedral_decision(point_of(points, cells[c].v[0]), point_of(points, cells[c].v[1]),
                                         point_of(points, cells[c].v[2]), point_of(points, cells[c].v[3])));
  }
  worst[get_global_id(0)] = least;
}
